"""The run of a defence: one that breaks as few laws as possible.

A defence is what a machine does against a fault that its world excludes. A run that was found without the assumption breaks many
laws at once, and a reader does not see against which fault the defence stands. So a run is searched that breaks one law in one
step, of a device or the line if possible; then one that breaks one law in any steps, and the same with two. All other laws hold in it, and inputs that do not matter
are at rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from safeloc.language.expr import Bool, BoolVar, Expr, Num, NumVar, Var, all_of, as_num, ite
from safeloc.language.interpret import holds
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal, is_initially
from safeloc.language.system import TransitionSystem
from safeloc.language.trace import Trace
from safeloc.language.units import COUNT
from safeloc.proof.cores.clauses import ClauseId, assumed_clauses, laws
from safeloc.proof.provers.bmc import Exhausted, search
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.shorten import rested

FURTHER = 3
"""Steps that a run with fewer broken laws may have more than the one at hand."""
_NO_DEVICE = ("operator", "nobody")
"""Owners of laws that no device and no part of the line can break."""
_NAMED = 3
"""Broken laws that are named; the others are counted."""


def sparing_run(goal: Goal, run: Trace, limits: Limits) -> Trace:
    """Return a run to the goal that breaks as few laws as the limits allow to find; the given run if none is found that breaks fewer.

    goal  a goal without the assumption; its `original` has the laws
    run   a run that reaches it
    """
    ends, broken = deadline(limits.seconds), broken_laws(goal.original, run)
    if not broken and begins_lawfully(goal.original, run):
        return run
    for sparing in _more_and_more(goal, broken):
        if ends.passed:
            break
        found = search(sparing, replace(limits, depth=len(run.steps) + FURTHER, seconds=ends.left / 2))
        if not isinstance(found, Exhausted):
            return rested(sparing, found.initial, [step.inputs for step in found.steps])
    return run


def broken_laws(system: TransitionSystem, run: Trace) -> dict[ClauseId, list[int]]:
    """Return each law of the system that the run breaks, with the numbers of the steps, from 1."""
    befores: list[Mapping[str, Value]] = [run.initial, *(step.state for step in run.steps)]
    found: dict[ClauseId, list[int]] = {}
    for number, (before, step) in enumerate(zip(befores, run.steps, strict=False), 1):
        values = {var: before[var.name] for var in system.state} | {var: step.inputs[var.name] for var in system.inputs}
        for law, term in assumed_clauses(system).items():
            if not holds(term, values):
                found.setdefault(law, []).append(number)
    return found


def begins_lawfully(system: TransitionSystem, run: Trace) -> bool:
    """Return whether the first state is one that the world allows."""
    return holds(system.init, {var: run.initial[var.name] for var in system.state})


def how_it_breaks(system: TransitionSystem, run: Trace) -> str:
    """Return in words which laws the run breaks, and in which steps; nothing for a run that breaks none."""
    broken, name = broken_laws(system, run), str if system.parts else (lambda law: law.name)
    told = [f"{name(law)!r} {_in_steps(steps, len(run.steps))}" for law, steps in broken.items()]
    more = [f"and {len(told) - _NAMED} more"] if len(told) > _NAMED else []
    count = "one law" if len(told) == 1 else f"{len(told)} laws"
    breaks = [f"breaks {count}: {', '.join([*told[:_NAMED], *more])}"] if told else []
    first = [] if begins_lawfully(system, run) else ["begins in a state that its world excludes"]
    return " and ".join([*first, *breaks])


def _in_steps(steps: Sequence[int], every: int) -> str:
    if len(steps) == 1:
        return f"in step {steps[0]}"
    together = steps[-1] - steps[0] == len(steps) - 1
    return f"in steps {steps[0]} to {steps[-1]}" if together else f"in {len(steps)} of {every} steps"


# ------------------------------------------------------------------ the same goal, with few broken laws


def _more_and_more(goal: Goal, broken: Mapping[ClauseId, Sequence[int]]) -> Iterator[Goal]:
    """Yield the goal for runs that break one law in one step, one law, two, as far as that is fewer than `broken`.

    One law in one step is asked in any case, since the run at hand may be longer, and its other inputs need not be at rest: at
    first of devices and line alone, since how the train is run is the last to be called a fault.
    """
    times, every = sum(map(len, broken.values())), assumed_clauses(goal.original)
    breakable = {law: every[law] for law, one in laws(goal.original).items() if one.owner not in _NO_DEVICE}
    if 0 < len(breakable) < len(every):
        yield _in_few_steps(goal, breakable, 1)
    for most in (1, 2):
        if most == 1 or most < times:
            yield _in_few_steps(goal, every, most)
        if most < len(broken):
            yield _of_few_laws(goal, most)


def _in_few_steps(goal: Goal, breakable: Mapping[ClauseId, Bool], most: int) -> Goal:
    """Return the goal for runs in which these laws are broken at most so many times, counted in each step, and no other law."""
    times = NumVar("observer.times a law was broken", COUNT, 0, most)
    after = times + _count(~term for term in breakable.values())
    others = [term for law, term in assumed_clauses(goal.original).items() if law not in breakable]
    return _allowed(goal, {times: after}, {times: 0}, all_of([after <= most, *others]))


def _of_few_laws(goal: Goal, most: int) -> Goal:
    """Return the goal for runs in which at most so many laws are broken, in however many steps."""
    every = list(assumed_clauses(goal.original).values())
    flags = [BoolVar(f"observer.law {number} was broken") for number in range(1, len(every) + 1)]
    after: dict[Var, Bool] = {flag: flag | ~law for flag, law in zip(flags, every, strict=True)}
    return _allowed(goal, after, dict.fromkeys(flags, False), _count(after.values()) <= most)


def _count(terms: Iterable[Bool]) -> Num:
    total = as_num(0, COUNT)
    for term in terms:
        total = total + ite(term, as_num(1, COUNT), as_num(0, COUNT))
    return total


def _allowed(goal: Goal, moves: Mapping[Var, Expr], first: Mapping[Var, Value], in_a_step: Bool) -> Goal:
    """Return the goal with further observers, under an assumption that reads them, from first states that the world allows."""
    system = goal.system
    init = all_of([system.init, goal.original.init, *(is_initially(var, value) for var, value in first.items())])
    watched = replace(
        system,
        state=(*system.state, *moves),
        next={**system.next, **moves},
        initial={**system.initial, **first},
        init=init,
        assume=all_of([system.assume, in_a_step]),
    )
    return replace(goal, system=watched, observers=(*goal.observers, *moves))
