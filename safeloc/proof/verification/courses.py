"""Steps of runs as text, and runs whose steps are read out of it when somebody asks for them.

Most runs of a report are not looked at again while it is made: what shows them is kept. To read all steps of all machines that
ship takes as long as everything else of their findings together.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem
from safeloc.language.trace import Step, Trace

_MAPPINGS = ("inputs", "fired", "state", "outputs")


class Course:
    """Steps of runs of which each begins the longest one.

    text  a line for the names of their values, and one for each step
    """

    def __init__(self, steps: Sequence[Step]) -> None:
        self._names = [list(getattr(steps[0], each)) for each in _MAPPINGS] if steps else []
        self._steps: list[Step] = []
        self._lines = [_line(self._names)]
        self.extend(steps)

    @property
    def text(self) -> str:
        """The lines, one below the other."""
        return "\n".join(self._lines)

    def shares(self, steps: Sequence[Step]) -> bool:
        """Return whether these steps are the same objects as those of the course, as far as both go."""
        return all(mine is other for mine, other in zip(self._steps, steps, strict=False))

    def extend(self, steps: Sequence[Step]) -> None:
        """Add those of the steps that the course lacks."""
        for step in steps[len(self._steps) :]:
            self._steps.append(step)
            columns = zip(_MAPPINGS, self._names, strict=True)
            self._lines.append(_line([[getattr(step, each)[name] for name in names] for each, names in columns]))


class KeptCourse:
    """The text of a course, of which steps are read as far as somebody asks for them; each is one object, whoever asks."""

    def __init__(self, text: str) -> None:
        self._names, *self._lines = text.split("\n")
        self._steps: list[Step] = []

    def __len__(self) -> int:
        return len(self._lines)

    def first(self, count: int) -> tuple[Step, ...]:
        """Return so many steps from the beginning; ValueError for text that no course has."""
        if len(self._steps) < count:
            names = json.loads(self._names)
            for line in self._lines[len(self._steps) : count]:
                self._steps.append(_step(names, json.loads(line)))
        return tuple(self._steps[:count])


class KeptTrace(Trace):
    """A run whose steps are read when somebody asks for them; equal to every run of the same content."""

    _course: KeptCourse
    _length: int
    _read: tuple[Step, ...] | None

    def __init__(self, system: TransitionSystem, initial: Mapping[str, Value], course: KeptCourse, length: int) -> None:
        if not 0 <= length <= len(course):
            raise ValueError(f"a run of {length} steps of a course of {len(course)}")
        own = {"system": system, "initial": initial, "_course": course, "_length": length, "_read": None}
        for name, value in own.items():
            object.__setattr__(self, name, value)

    @property
    def steps(self) -> tuple[Step, ...]:  # pyright: ignore[reportIncompatibleVariableOverride] # nobody may set either
        """The steps; ValueError for text that no course has."""
        if self._read is None:
            object.__setattr__(self, "_read", self._course.first(self._length))
        return self._read or ()

    @property
    def length(self) -> int:
        """The number of steps, which needs none of them."""
        return self._length

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Trace):
            return NotImplemented
        return (self.system, self.initial, self.steps) == (other.system, other.initial, other.steps)

    __hash__ = Trace.__hash__


def _line(data: Any) -> str:
    return json.dumps(data, separators=(",", ":"))


def _step(names: Sequence[Sequence[str]], row: Sequence[Sequence[Any]]) -> Step:
    return Step(*(dict(zip(columns, values, strict=True)) for columns, values in zip(names, row, strict=True)))
