"""Machines inside a host's controller: see docs/embedding.md. The names here are public and stay."""

from safeloc.runtime.embedding.controller import EVERY, Controller
from safeloc.runtime.embedding.localizer import Localizer, localizer_program
from safeloc.runtime.embedding.program import Program
from safeloc.runtime.embedding.report import Interval, Move, Report

__all__ = ["EVERY", "Controller", "Interval", "Localizer", "Move", "Program", "Report", "localizer_program"]
