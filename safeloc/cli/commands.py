"""The commands by name, each with its summary and module. A command's module is loaded only when it is called."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import typer
from typer.main import get_command


@dataclass(frozen=True)
class Known:
    """The description of a command, available before its module is loaded.

    module, function  the place of its code
    summary           the first paragraph of its own help (a test compares them)
    """

    module: str
    function: str
    summary: str


COMMANDS: Mapping[str, Known] = {
    "init": Known(
        "init",
        "init",
        "Write a project of your own: machine, world, claims, a recording, tests and CI, verified as it stands.",
    ),
    "list": Known(
        "listing",
        "list_",
        "List machines, properties, lines, or requirements with the transitions and properties that implement and verify them.",
    ),
    "docs": Known(
        "docs",
        "docs",
        "List the documentation that is installed with safeloc, or print the path of one page, or its text.",
    ),
    "import": Known(
        "line_import",
        "import_line",
        "Import a map; report everything that was not understood, dropped or assumed. Exit code 1 where elements were refused.",
    ),
    "audit": Known(
        "audit",
        "audit_line",
        "Check that the layout of a line satisfies the assumptions of the proofs. Exit code 1 where a rule is violated.",
    ),
    "drive": Known(
        "line_drive",
        "drive",
        "Drive a recorded train over a network: write records of odometers, balise readers, satellites and the true position.",
    ),
    "guard": Known(
        "guard",
        "guard",
        "Filter a receiver's positions: pass each on with its interval along the track, or withhold it with a reason.",
    ),
    "export": Known("export", "export", "Export a machine as code, diagram, table or solver text."),
    "simulate": Known(
        "simulate",
        "simulate",
        "Write simulated sensor data with the true position: for one machine, or for vehicles on a line.",
    ),
    "run": Known(
        "run",
        "run",
        "Run a machine as a separate process: read lines, write one report per cycle, until SIGTERM or the end of the input.",
    ),
    "recheck": Known(
        "recheck",
        "recheck",
        "Check every proof of a report again, from the report's files and the declaration alone.",
    ),
    "migrate": Known(
        "migrate",
        "migrate",
        "Convert files of version 0.1.0 to the names of 0.2.0. If one of them is refused, no file is written.",
    ),
    "cache": Known("keeping", "cache", "Show the size of the cache of earlier results, or clear it."),
    "prove": Known(
        "prove",
        "prove",
        "Prove the properties and obligations of a machine for all streams that obey its assumption, or for those near one.",
    ),
    "explain": Known(
        "explain",
        "explain",
        "Explain one property: what it says and assumes, how it was decided, what that rests on, and the run that violates it.",
    ),
    "test": Known("property_tests", "test", "Run property tests along plausible and faulty streams."),
    "replay": Known(
        "replay",
        "replay",
        "Run a recorded stream through a machine; check every property on it, or the proofs' assumptions about the world.",
    ),
    "step": Known(
        "step",
        "step",
        "Run a machine step by step: set inputs, see which transition fires and what refuses the others, go back, save the run.",
    ),
    "report": Known(
        "report",
        "report",
        "Render the page of a report folder again, unpack its certificates and traces, or compare it with an earlier report.",
    ),
    "open": Known(
        "opening",
        "open_",
        "Show a report, a stream or the recordings of a machine in a browser: search, and step through every run.",
    ),
    "mutate": Known(
        "mutate",
        "mutate",
        "Make a machine wrong on purpose, term by term; report which proof notices, and which wrong machines nothing notices.",
    ),
    "cores": Known(
        "cores",
        "cores",
        "Find a smallest set of clauses, lemmas and rows for each proved claim, and say which of them no claim needs.",
    ),
    "margins": Known(
        "margins",
        "margins",
        "Find how far each figure may move before a claim fails: the last value with a proof, and the next one with a run.",
    ),
    "campaign": Known(
        "campaign",
        "campaign",
        "Run many simulated vehicles drawn from declared distributions; estimate how often what happens, each figure with its interval.",
    ),
    "faults": Known(
        "faults",
        "faults",
        "Break every clause of the world, and report the effect on each claim, on the reported interval and on the declared hazard.",
    ),
    "verify": Known(
        "verify", "verify", "Prove, test, replay the shipped recordings, and write the report: the main command."
    ),
}


def loaded(name: str) -> Any:
    """Return the command, made by Typer from its function."""
    known = COMMANDS[name]
    alone = typer.Typer(add_completion=False)
    alone.command(name)(getattr(import_module(f"safeloc.cli.{known.module}"), known.function))
    return get_command(alone)
