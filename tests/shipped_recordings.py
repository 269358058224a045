"""Recordings that ship, by their names alone."""

from __future__ import annotations

from pathlib import Path

from safeloc.target import MODELS


def shipped(name: str) -> Path:
    """The one file of that name, such as `odometry-service`; it stands in the folder of its machine."""
    (path,) = MODELS.glob(f"*/recordings/{name}.jsonl.gz")
    return path
