"""Shipped recordings under other figures: a configuration may lack inputs, or have ranges, that a recording does not fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from safeloc.errors import StreamError
from safeloc.proof.verification.replay import run_recorded
from safeloc.target import Target


def refused_recordings(target: Target) -> Mapping[Path, str]:
    """Return the recordings that the target cannot take, with the reasons; none if its figures are those of the recordings."""
    found: dict[Path, str] = {}
    for path in target.streams if target.other_figures else ():
        try:
            run_recorded(target, path)
        except StreamError as error:
            found[path] = str(error)
    return found


def with_fitting_recordings(target: Target) -> Target:
    """Return the target with only those recordings that it can take."""
    refused = refused_recordings(target)
    return replace(target, streams=tuple(path for path in target.streams if path not in refused)) if refused else target
