"""Targets of reachability: the modes and transitions of a system's machines, each as a goal of runs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from safeloc.language.expr import Bool, Lit, NumVar, before_step
from safeloc.language.machine import Machine
from safeloc.language.spec import Goal, observe, reachable
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import Substitution


def happens(system: TransitionSystem, name: str, term: Bool) -> Goal:
    """Return the goal that some step meets `term`, which is over the state before the step and its inputs."""
    twins = {var: before_step(var) for var in system.state}
    return observe(system, reachable(name, Substitution(dict(twins)).bool(term)))


def without_assumption(goal: Goal) -> Goal:
    """Return the goal without the assumption: for all inputs in range."""
    return observe(goal.original, replace(goal.prop, unconditional=True))


@dataclass(frozen=True, eq=False)
class Target:
    """A mode or else a transition of machine number `part`; `goal` is under the assumption, `free` for all inputs in range."""

    name: str
    statement: str
    goal: Goal
    free: Goal
    part: int
    mode: bool


def targets_of(system: TransitionSystem) -> list[Target]:
    """Return modes and transitions of all machines, in order, each with the number of its machine."""
    if system.parts:
        return [target for number in range(len(system.parts)) for target in _of_part(system, number)]
    machine = system.machines[0]
    return list(_of_machine(system, machine, machine.mode, machine.fired_name))


def _of_part(system: TransitionSystem, number: int) -> Iterator[Target]:
    part = system.parts[number]
    mode, fired = part.into(part.machine.mode), part.into(part.machine.fired_name)
    assert isinstance(mode, NumVar)
    assert isinstance(fired, NumVar)
    yield from _of_machine(system, part.machine, mode, fired, number)


def _of_machine(
    system: TransitionSystem, machine: Machine, mode: NumVar, fired: NumVar, part: int = 0
) -> Iterator[Target]:
    for number, label in enumerate(machine.modes):
        goal = observe(system, reachable(f"mode {number} of machine {part}", mode.eq(label)))
        name, text = f"mode {machine.name} {label.label}", f"{machine.name} reaches mode {label.label}"
        yield Target(name, text, goal, without_assumption(goal), part, mode=True)
    for number, row in enumerate(machine.transitions, 1):
        goal = observe(system, reachable(f"row {number} of machine {part}", fired.eq(Lit(number, fired.unit))))
        name, text = f"transition {machine.name}: {row.name}", f"{machine.name}: {row.name!r} fires ({_place(row.src)})"
        yield Target(name, text, goal, without_assumption(goal), part, mode=False)


def _place(src: str) -> str:
    """Return file name and line, without the folder, which differs between computers."""
    return src.replace("\\", "/").rpartition("/")[2]
