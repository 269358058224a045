"""Runs that were worked out by hand: their steps, and the expected outcome in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from safeloc.runtime.streams.steps import Cell

Config_ = TypeVar("Config_", contravariant=True)
Steps = list[dict[str, Cell]]


@dataclass(frozen=True)
class WorkedRun(Generic[Config_]):
    """A named run: its expected outcome in words, and its steps for a given configuration."""

    outcome: str
    steps: Callable[[Config_], Sequence[Mapping[str, Cell]]]
