"""A simulated run that says where the world begins: its steps, and first values of ghosts and state that are left open."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import overload

from safeloc.language.nodes import Value

Steps = Sequence[Mapping[str, Value | str]]
"""The steps of a run: of each, the values of inputs, choices of the world and remarks, by name."""


@dataclass(frozen=True)
class SimulatedRun(Sequence[Mapping[str, Value | str]]):
    """The result of `simulate(seed)` if the world does not begin at its values nearest to zero: a sequence of its steps.

    steps  of each cycle, the values of inputs, choices of the world and remarks such as `truth_mm`
    first  first values of ghosts and state variables that are declared `ANY`, by name; of others their value nearest to zero
    """

    steps: Steps
    first: Mapping[str, Value] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.steps)

    @overload
    def __getitem__(self, at: int) -> Mapping[str, Value | str]: ...
    @overload
    def __getitem__(self, at: slice) -> Steps: ...
    def __getitem__(self, at: int | slice) -> Mapping[str, Value | str] | Steps:
        return self.steps[at]


def first_values(run: Steps) -> Mapping[str, Value]:
    """Return the first values that a simulated run chooses; none for a plain list of steps."""
    return run.first if isinstance(run, SimulatedRun) else {}
