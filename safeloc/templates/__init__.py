"""A project of the user's own: what `safeloc init` writes, and the templates that it copies.

project      writes a new project: machine, recording, tests, and the files around them
common       the files around a machine, the same for every template: Makefile, pyproject.toml, CI
machine      template: one machine with the error law of a sensor
composition  template: a sensor's machine and a supervising one, composed, with a contract between them

A template is a project as it is written: its machine is verified, its tests are run, and its code is checked in place.
"""
