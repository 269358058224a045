"""Check of the runs in a report: modes, rows and cases that occur, and an assumption that is satisfied.

A result with `by itself` is about one machine of a composition, and its run is a run of that machine.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

from safeloc.checker.answer import CONFIRMED, WRONG, Answer, Check, Row, seen
from safeloc.checker.terms import Translation
from safeloc.checker.walk import Walk
from safeloc.errors import InputError
from safeloc.language.antecedents import case_name, cases, occurs, occurs_alone
from safeloc.language.expr import FALSE, Bool, Lit
from safeloc.language.machine import Machine
from safeloc.language.spec import Goal, Property, observe, reachable
from safeloc.language.system import TransitionSystem
from safeloc.runtime.streams.steps import StepStream, read_steps
from safeloc.target import Target

_BY_ITSELF = ", by itself"
_DEFENCE = "a defence: "
Key = tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class _Sought:
    """An event that must occur; each goal is given under the assumption, and for all inputs in range.

    together  the goals in the system of the target
    alone  the goals in one machine of a composition by itself; None if there is no such machine
    prop   the property, if the event is one of its cases
    """

    name: str
    together: tuple[Goal, Goal]
    alone: tuple[Goal, Goal] | None
    prop: Property | None = None


class Occurrences:
    """The evidence from the runs of a target.

    kept     returns the run that the report stores for a result
    claimed  ids of all results of the target
    """

    def __init__(
        self, target: Target, write: Translation, kept: Callable[[str], StepStream | None], claimed: frozenset[str]
    ) -> None:
        self._target, self._write, self._kept, self._claimed = target, write, kept, claimed
        self._walks: dict[Key, Walk] = {}
        self._single: dict[Goal, Walk] = {}

    def checks(self) -> Iterator[tuple[str, Check]]:
        """Yield the checks of all results about events that occur, by name."""
        for one in self._sought:
            yield one.name, lambda row, one=one: self._occurs(row, one)  # type: ignore[misc]
        yield "antecedents", self._every_case

    def happens(self, row: Row, goal: Goal) -> Answer:
        """Check that the run violates `good`, and satisfies the assumption up to that state."""
        if goal not in self._single:
            self._single[goal] = Walk([goal], self._write)
        run = self._run(row)
        return seen(bool(self._single[goal].met(run.first, run.steps)))

    def kept_for_a_while(self, row: Row) -> Answer:
        """Check that the run satisfies the assumption for the stated number of steps."""
        count = re.search(r"for (\d+) (more )?steps", row["statement"])
        return seen(count is not None and len(self._states(row)) > int(count[1]))

    def comes_round(self, row: Row) -> Answer:
        """Check that the run returns to an earlier state."""
        states = self._states(row)
        return seen(len({*states}) < len(states))

    def _states(self, row: Row) -> list[tuple[bool | int, ...]]:
        nothing, run = observe(self._target.system, reachable("nothing", FALSE)), self._run(row)
        return list(Walk([nothing], self._write).states(run.first, run.steps))

    def _run(self, row: Row) -> StepStream:
        stream = self._kept(str(row["id"]))
        if stream is None:
            raise InputError("the report stores no run for it")
        return stream

    # -------------------------------------------------------------- events

    def _occurs(self, row: Row, one: _Sought) -> Answer:
        sought = one.alone if str(row["statement"]).endswith(_BY_ITSELF) else one.together
        if sought is None:
            return WRONG, "no machine of the composition has this event by itself"
        run, goal = self._run(row), sought[_DEFENCE in row["method"]]
        key, place = self._places[goal]
        return seen(place in self._walk(key).met(run.first, run.steps))

    def _every_case(self, row: Row) -> Answer:
        """Check that each case occurs in a recording of the target, or has a result with a run of its own."""
        found, counts = self._recorded(), re.match(r"(\d+) of (\d+) ", row["method"])
        every = [one for one in self._sought if one.prop is not None]
        missing = [one.name for one in every if one.together[0] not in found and not self._has_its_own(one.name)]
        if missing or counts is None or not int(counts[1]) == int(counts[2]) == len(every):
            return (
                WRONG,
                f"{len(missing)} of {len(every)} cases occur in no recording, and the report stores no run for them",
            )
        return CONFIRMED, ""

    def _has_its_own(self, obligation: str) -> bool:
        return f"{self._target.name}/obligation/{obligation}" in self._claimed

    def _recorded(self) -> set[Goal]:
        """Return the cases that occur in recordings, as far as the system accepts these; first values of other variables are
        ignored."""
        system, found = self._target.system, set[Goal]()
        known = {var.name for var in system.state}
        keys = {self._places[one.together[0]][0] for one in self._sought if one.prop is not None}
        for recording in map(read_steps, self._target.streams if keys else ()):
            first = {name: value for name, value in recording.first.items() if name in known}
            for key in keys:
                with suppress(InputError):
                    for met in self._walk(key).met_in_turn(first, recording.steps):
                        found |= {self._together[key][place] for place in met}
        return found

    # -------------------------------------------------------------- goals that are checked in one walk

    @cached_property
    def _sought(self) -> list[_Sought]:
        system = self._target.system
        found = [one for number in range(len(system.machines)) for one in _targets(system, number)]
        for prop in self._target.properties:
            for place, case in enumerate(cases(prop)):
                goal, alone = occurs(system, case, f"case {len(found)}"), occurs_alone(system, prop, place)
                by_itself = None if alone is None else _named(alone[1], f"case {len(found)}")
                name = case_name(prop, place + 1)
                found.append(_Sought(name, (goal, goal), None if by_itself is None else (by_itself, by_itself), prop))
        return found

    @cached_property
    def _together(self) -> dict[Key, list[Goal]]:
        """The goals of one system under one assumption, by a key of both."""
        found: dict[Key, list[Goal]] = {}
        for goal in dict.fromkeys(goal for one in self._sought for goal in (*one.together, *(one.alone or ()))):
            found.setdefault(self._key(goal), []).append(goal)
        return found

    @cached_property
    def _places(self) -> dict[Goal, tuple[Key, int]]:
        return {goal: (key, place) for key, goals in self._together.items() for place, goal in enumerate(goals)}

    def _key(self, goal: Goal) -> Key:
        return id(goal.original), self._write(goal.plain.init), self._write(goal.plain.assume)

    def _walk(self, key: Key) -> Walk:
        if key not in self._walks:
            self._walks[key] = Walk(self._together[key], self._write)
        return self._walks[key]


def _targets(system: TransitionSystem, number: int) -> Iterator[_Sought]:
    """Yield the modes and rows of a machine as events in the whole system, and in a machine of a composition by itself."""
    machine, part = system.machines[number], system.parts[number] if system.parts else None
    for name, term in _reached(machine):
        goal_name = f"machine {number}, {name}"
        together = _both(system, goal_name, term if part is None else part.into.bool(term))
        yield _Sought(name, together, None if part is None else _both(part.alone, goal_name, term))


def _reached(machine: Machine) -> Iterable[tuple[str, Bool]]:
    for label in machine.modes:
        yield f"mode {machine.name} {label.label}", machine.mode.eq(label)
    for row, transition in enumerate(machine.transitions, 1):
        fired = machine.fired_name
        yield f"transition {machine.name}: {transition.name}", fired.eq(Lit(row, fired.unit))


def _both(system: TransitionSystem, name: str, term: Bool) -> tuple[Goal, Goal]:
    """Return the goals that an event occurs under the assumption, and that it occurs for all inputs in range."""
    free = reachable(f"{name}, for all inputs", term, unconditional=True)
    return observe(system, reachable(name, term)), observe(system, free)


def _named(goal: Goal, name: str) -> Goal:
    return observe(goal.original, replace(goal.prop, name=name))
