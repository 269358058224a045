"""Machines inside a host's controller: see docs/embedding.md. The names here are public and stay."""

from safeloc.embedding.controller import EVERY, Controller
from safeloc.embedding.localizer import Localizer, localizer_program
from safeloc.embedding.program import Program
from safeloc.embedding.report import Interval, Move, Report

__all__ = ["EVERY", "Controller", "Interval", "Localizer", "Move", "Program", "Report", "localizer_program"]
