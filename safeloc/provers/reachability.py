"""What can happen at all: every mode and every transition.

One incremental search serves all targets; a target found is a stream, replayed in the interpreter.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import z3

from safeloc.backends.smt import Unrolling
from safeloc.backends.smtlib import Query
from safeloc.expr import Bool, Lit, NumVar, before, was
from safeloc.machine import Machine
from safeloc.provers.base import base
from safeloc.provers.bmc import run_of
from safeloc.provers.evidence import confirmed
from safeloc.provers.implication import unproved
from safeloc.provers.kinduction import kinduction
from safeloc.provers.limits import Deadline, Limits, deadline, milliseconds
from safeloc.provers.obligation import Obligation
from safeloc.provers.recorded import Recording, shown
from safeloc.provers.spacer import spacer
from safeloc.spec import Goal, Watch, observe, reachable, watch
from safeloc.system import TransitionSystem, environment, in_range
from safeloc.terms import Substitution
from safeloc.trace import Trace
from safeloc.verdict import Proved, Unknown, Verdict, Violated

# ------------------------------------------------------------------ search for many targets at once


@dataclass(frozen=True, eq=False)
class Runs:
    """The shortest run to each target that was found, and the number of steps that were searched completely."""

    found: Mapping[Goal, Trace]
    depth: int


def first_runs(goals: Sequence[Goal], limits: Limits, known: Container[Goal] = ()) -> Runs:
    """Shortest runs to as many targets as the limits allow; all goals are of one system and one assumption.

    The search ends where all that is left is `known` to be reached.
    """
    if not goals:
        return Runs({}, limits.depth)
    watched = watch(goals[0].plain, goals)
    unrolling, solver, found = Unrolling(watched.system), z3.Solver(), dict[Goal, Trace]()
    ends = deadline(limits.seconds)
    solver.set("random_seed", limits.seed)
    solver.add(unrolling.initially())
    for depth in range(limits.depth + 1):
        if not _search_depth(watched, unrolling, solver, depth, found, ends):
            return Runs(found, depth - 1)
        if all(goal in found or goal in known for goal in goals):
            return Runs(found, depth)
        solver.add(unrolling.transition(depth))
    return Runs(found, limits.depth)


def _search_depth(
    watched: Watch, unrolling: Unrolling, solver: z3.Solver, depth: int, found: dict[Goal, Trace], ends: Deadline
) -> bool:
    """Adds what is found at this depth; whether the depth was searched completely."""
    while left := [goal for goal in watched.goals if goal not in found]:
        if ends.passed:
            return False
        solver.set("timeout", milliseconds(ends.left))
        solver.push()
        solver.add(z3.Or(*(z3.Not(unrolling.at(goal.good, depth)) for goal in left)))
        answer = solver.check()
        model = solver.model() if answer == z3.sat else None
        solver.pop()
        if model is None:
            return bool(answer == z3.unsat)
        run = run_of(watched, unrolling, model, depth)
        for goal in left:
            if z3.is_false(model.eval(unrolling.at(goal.good, depth), model_completion=True)):
                found[goal] = confirmed(goal, *run, "bmc")
    return True


def happens(system: TransitionSystem, name: str, term: Bool) -> Goal:
    """The goal that some step meets `term`, which is over the state before the step and its inputs."""
    twins = {var: before(var) if isinstance(var, NumVar) else was(var) for var in system.state}
    return observe(system, reachable(name, Substitution(dict(twins)).bool(term)))


def without_assumption(goal: Goal) -> Goal:
    """The same for all inputs in range."""
    return observe(goal.original, replace(goal.prop, unconditional=True))


# ------------------------------------------------------------------ modes and transitions


@dataclass(frozen=True, eq=False)
class _Target:
    """A mode or a transition; `goal` under the assumption, `free` for all inputs in range."""

    name: str
    statement: str
    goal: Goal
    free: Goal
    part: int


def reached(system: TransitionSystem, limits: Limits, recordings: Sequence[Recording] = ()) -> Iterator[Obligation]:
    """Modes and transitions: first under the assumption, found or recorded; what is neither, without it."""
    targets = _targets(system)
    excluded = _impossible(system, targets, limits)
    possible = [target.goal for target in targets if target not in excluded]
    seen = shown(possible, recordings)
    searched = first_runs(possible, limits, seen)
    kept = replace(searched, found={**seen, **searched.found})
    open_ = [target for target in targets if target.goal not in kept.found]
    alone = _by_itself(system, targets, open_, limits)
    dead = _dead_in_the_whole(system, list(alone), limits)
    free = first_runs([target.free for target in open_ if target not in alone], limits)
    for target in targets:
        witness = kept.found.get(target.goal) or free.found.get(target.free)
        if witness is not None:
            verdict: Verdict = Proved(None, "bmc", len(witness.steps), ("interpreter",), witness=witness)
            recorded = target.goal in seen and target.goal not in searched.found
            method = "a recorded run under the assumption" if recorded else _how(target, kept, excluded)
            yield Obligation(target.name, target.statement, verdict, method)
        elif target in dead:
            why = f"the machine by itself comes there ({alone[target].words}), the whole never, whatever its inputs: dead in it"
            yield Obligation(target.name, target.statement, Violated(None, "1-induction", why), "1-induction")
        elif target in alone:
            yield _only_alone(target, alone[target], kept.depth, target in excluded)
        else:
            yield Obligation(target.name, target.statement, _dead(target.free, free.depth, limits), "bounded search")


@dataclass(frozen=True)
class _Alone:
    """A run of a machine by itself, and what it shows."""

    words: str
    run: Trace


def _only_alone(target: _Target, alone: _Alone, depth: int, excluded: bool) -> Obligation:
    """Of the whole no run was found: what is claimed is of the machine by itself, and what is known of the whole is told."""
    whole = "proved impossible in the whole while the assumption is kept" if excluded else _none_of_the_whole(depth)
    verdict = Proved(None, "bmc", len(alone.run.steps), ("interpreter",), witness=alone.run)
    method = f"of the machine by itself, {alone.words}; {whole}"
    return Obligation(target.name, f"{target.statement}, by itself", verdict, method)


def _none_of_the_whole(depth: int) -> str:
    return "the whole was not searched in time" if depth < 0 else f"none of the whole in {depth} steps"


def _by_itself(
    system: TransitionSystem, targets: Sequence[_Target], open_: Container[_Target], limits: Limits
) -> dict[_Target, _Alone]:
    """Of a composition, what no run of the whole was found for, but one of the machine alone; and what that run is."""
    found: dict[_Target, _Alone] = {}
    for number, part in enumerate(system.parts):
        own = [target for target in targets if target.part == number]
        pairs = [(mine, theirs) for mine, theirs in zip(_targets(part.alone), own, strict=True) if theirs in open_]
        lawful = first_runs([mine.goal for mine, _ in pairs], limits).found
        unlawful = first_runs([mine.free for mine, _ in pairs if mine.goal not in lawful], limits).found
        for mine, theirs in pairs:
            if mine.goal in lawful:
                run = lawful[mine.goal]
                found[theirs] = _Alone(f"witness of {len(run.steps)} steps under its assumption", run)
            elif mine.free in unlawful:
                run = unlawful[mine.free]
                found[theirs] = _Alone(f"a defence: witness of {len(run.steps)} steps with its assumption broken", run)
    return found


def _place(src: str) -> str:
    """File name and line, without the folder of whoever runs this."""
    return src.replace("\\", "/").rpartition("/")[2]


def _targets(system: TransitionSystem) -> list[_Target]:
    """Modes and transitions of all machines, in order; those of a part of a composition know its number."""
    if system.parts:
        return [target for number in range(len(system.parts)) for target in _targets_of_part(system, number)]
    machine = system.machines[0]
    return list(_targets_of(system, machine, machine.mode, machine.fired_name))


def _targets_of_part(system: TransitionSystem, number: int) -> Iterator[_Target]:
    part = system.parts[number]
    mode, fired = part.into(part.machine.mode), part.into(part.machine.fired_name)
    assert isinstance(mode, NumVar)
    assert isinstance(fired, NumVar)
    yield from _targets_of(system, part.machine, mode, fired, number)


def _targets_of(
    system: TransitionSystem, machine: Machine, mode: NumVar, fired: NumVar, part: int = 0
) -> Iterator[_Target]:
    for number, label in enumerate(machine.modes):
        goal = observe(system, reachable(f"mode {number} of machine {part}", mode.eq(label)))
        name, text = f"mode {machine.name} {label.label}", f"{machine.name} comes to mode {label.label}"
        yield _Target(name, text, goal, without_assumption(goal), part)
    for number, row in enumerate(machine.transitions, 1):
        goal = observe(system, reachable(f"row {number} of machine {part}", fired.eq(Lit(number, fired.unit))))
        name, text = f"transition {machine.name}: {row.name}", f"{machine.name}: {row.name!r} fires ({_place(row.src)})"
        yield _Target(name, text, goal, without_assumption(goal), part)


def _impossible(system: TransitionSystem, targets: Sequence[_Target], limits: Limits) -> set[_Target]:
    """Targets that the first state is not and that no step under the assumption, with the proved facts, comes to."""
    facts = base(system, seconds=limits.seconds).everything
    watched = watch(system, [target.goal for target in targets])
    goods = {target: target.goal.good for target in targets}
    return set(targets) - set(_comes_to(watched, [environment(system), *facts], goods, limits))


def _dead_in_the_whole(system: TransitionSystem, targets: Sequence[_Target], limits: Limits) -> set[_Target]:
    """The same for all inputs in range, from what is known without the assumption."""
    if not targets:
        return set()
    facts = list(base(system, seconds=limits.seconds).always.values())
    watched = watch(targets[0].free.plain, [target.free for target in targets])
    goods = {target: target.free.good for target in targets}
    return set(targets) - set(_comes_to(watched, [environment(system, assume=False), *facts], goods, limits))


def _comes_to(
    watched: Watch, given: Sequence[Bool], goods: Mapping[_Target, Bool], limits: Limits
) -> Iterable[_Target]:
    """The targets that the first state may be, or that a step may come to from a state that is none."""
    after = Substitution(dict(watched.system.next))
    later = {target: good.implies(after.bool(good)) for target, good in goods.items()}
    start = Query("first", [watched.system.init, in_range(watched.system.state)], dict(goods))
    return {**unproved(start, limits.seconds), **unproved(Query("step", given, later), limits.seconds)}


def _how(target: _Target, kept: Runs, excluded: Container[_Target]) -> str:
    if target.goal in kept.found:
        return "witness under the assumption"
    searched = f"not found in {kept.depth} steps" if kept.depth >= 0 else "not searched in time"
    proved = "proved impossible" if target in excluded else searched
    return f"a defence: witness with the assumption broken, {proved} while it is kept"


def _dead(free: Goal, depth: int, limits: Limits) -> Verdict:
    for engine in (kinduction, spacer):
        never = engine(free, replace(limits, seconds=limits.seconds / 2))
        if isinstance(never, Proved):
            return Violated(None, never.engine, "never occurs, whatever the inputs: dead; remove it or mend its guard")
    return Unknown("no run found that comes there", depth)
