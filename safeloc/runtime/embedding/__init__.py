"""Machines inside a host's controller: see docs/embedding.md. The names here are public and stay."""

from typing import TYPE_CHECKING, Any

from safeloc.runtime.embedding.controller import EVERY, Controller
from safeloc.runtime.embedding.program import Program
from safeloc.runtime.embedding.report import Interval, Move, Report

if TYPE_CHECKING:
    from safeloc.runtime.embedding.localizer import Localizer, localizer_program

__all__ = ["EVERY", "Controller", "Interval", "Localizer", "Move", "Program", "Report", "localizer_program"]


def __getattr__(name: str) -> Any:
    """Load the localizer at its first use: a host with a machine of its own needs none that ships."""
    if name not in ("Localizer", "localizer_program"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from safeloc.runtime.embedding import localizer

    return getattr(localizer, name)
