"""What every machine owes, without anybody writing a property.

ranges       every state variable stays in its declared range, for ALL inputs in range
overflow     no intermediate term leaves 64 bits
division     every divisor is a positive constant
overlap      two transitions of one rank are never enabled together
absence      the value of an absent optional input is never read
reachable    every mode and every transition occurs in some run (witness kept), with the assumption and without
assumption   the environment's assumption can be kept, step after step (witness kept)
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import z3

from safeloc.backends.smt import Unrolling
from safeloc.backends.smtlib import Query
from safeloc.expr import (
    INT64_MAX,
    INT64_MIN,
    TRUE,
    Bool,
    BoolVar,
    Expr,
    FloorDiv,
    Lit,
    Num,
    NumVar,
    Substitution,
    all_of,
    between,
    in_order,
    variables,
)
from safeloc.machine import Machine, Transition
from safeloc.provers.base import base
from safeloc.provers.bmc import run_of
from safeloc.provers.evidence import confirmed
from safeloc.provers.implication import unproved
from safeloc.provers.limits import Limits
from safeloc.ranges import beyond_int64
from safeloc.results import Finding
from safeloc.spec import Goal, observe, reachable, watch
from safeloc.system import TransitionSystem, environment, in_range
from safeloc.trace import Trace
from safeloc.verdict import Proved, Unknown, Verdict, Violated


def obligations(system: TransitionSystem, limits: Limits) -> list[Finding]:
    """All free obligations of a system, one Finding each."""
    checks = (_ranges, _overflow, _division, _overlap, _absence, _reached, _assumption)
    return [finding for check in checks for finding in check(system, limits)]


def _finding(
    system: TransitionSystem,
    name: str,
    statement: str,
    verdict: Verdict,
    method: str,
    started: float,
    assumption: str = "",
) -> Finding:
    seconds = time.monotonic() - started
    return Finding(
        f"{system.name}/obligation/{name}",
        system.name,
        "obligation",
        statement,
        verdict,
        method,
        seconds,
        (),
        assumption,
    )


def _ranges(system: TransitionSystem, limits: Limits) -> Iterator[Finding]:
    started = time.monotonic()
    known = base(system, seconds=limits.seconds)
    bad = {name: why for name, why in known.refuted.items() if name.startswith("range of ")}
    statement = "every state variable stays in its declared range"
    if not bad:
        verdict: Verdict = Proved(all_of(known.everything), "1-induction", 1, ("cvc5",), known.certificates)
        yield _finding(system, "ranges", statement, verdict, "1-induction, re-checked by cvc5", started)
    for name in bad:
        var = system.variable(name.removeprefix("range of "))
        goal = _without_assumption(observe(system, reachable(name, ~in_range([var]))))
        yield _finding(system, name, f"{var.name} stays in its range", _escape(goal, limits), "bounded search", started)


def _escape(goal: Goal, limits: Limits) -> Verdict:
    found = _witnesses([goal], limits)
    if goal.prop.name in found:
        return Violated(found[goal.prop.name], "bmc", "a run leaves the range")
    return Unknown("not inductive, and no run found that leaves it; a lemma may be missing", limits.depth)


def _overflow(system: TransitionSystem, limits: Limits) -> Iterator[Finding]:
    started = time.monotonic()
    known = base(system, seconds=limits.seconds)
    terms = _computed(system)
    statement = "no intermediate term leaves 64 bits"
    wide = beyond_int64(terms)
    method = f"interval analysis of {len(in_order(terms))} terms"
    if wide:
        goals = {f"term {number}": between(INT64_MIN, term, INT64_MAX) for number, term in enumerate(wide)}
        given = [environment(system, assume=False), *known.always.values()]
        failed = unproved(Query("overflow", given, goals), limits.seconds)
        method += f", {len(wide)} of them by z3"
        if failed:
            names = ", ".join(repr(wide[int(name.split()[1])]) for name in failed)
            yield _finding(system, "overflow", statement, Unknown(f"may leave 64 bits: {names}"), method, started)
            return
    yield _finding(system, "overflow", statement, Proved(None, "intervals", 0, ("interval analysis",)), method, started)


def _computed(system: TransitionSystem) -> list[Expr]:
    """What runs on board: next states, fired transitions and outputs, ghosts apart."""
    own = [term for var, term in system.next.items() if var not in system.ghosts]
    return [*own, *system.fired.values(), *system.outputs.values()]


def _division(system: TransitionSystem, limits: Limits) -> Iterator[Finding]:
    started = time.monotonic()
    divisions = [node for node in in_order(_computed(system)) if isinstance(node, FloorDiv)]
    assert all(node.divisor > 0 for node in divisions)
    method = f"{len(divisions)} divisions, each by a positive constant"
    yield _finding(
        system, "division", "no division by zero", Proved(None, "construction", 0, ("construction",)), method, started
    )


# ------------------------------------------------------------------ overlap and absence


def _overlap(system: TransitionSystem, limits: Limits) -> Iterator[Finding]:
    started = time.monotonic()
    statement = "transitions of one rank exclude each other"
    pairs = [pair for machine in system.machines for pair in _pairs(machine)] if len(system.machines) == 1 else []
    if len(system.machines) > 1:
        return
    known = base(system, seconds=limits.seconds)
    goals = {f"{a.name} / {b.name}": ~(_enabled(system, a) & _enabled(system, b)) for a, b in pairs}
    failed = unproved(
        Query("overlap", [environment(system, assume=False), *known.always.values()], goals), limits.seconds
    )
    if not failed:
        verdict: Verdict = Proved(None, "z3", 1, ("one query a pair",))
        yield _finding(system, "overlap", statement, verdict, f"{len(goals)} pairs", started)
    for name in failed:
        both = all_of(_enabled(system, t) for pair in pairs for t in pair if f"{pair[0].name} / {pair[1].name}" == name)
        reason = f"both enabled, for example when {_example(system, both, known.always.values())}; give them ranks"
        yield _finding(system, f"overlap {name}", statement, Violated(None, "z3", reason), "z3", started)


def _pairs(machine: Machine) -> Iterator[tuple[Transition, Transition]]:
    table = list(machine.transitions)
    for index, first in enumerate(table):
        for second in table[index + 1 :]:
            if first.rank == second.rank and set(first.sources) & set(second.sources):
                yield first, second


def _enabled(system: TransitionSystem, transition: Transition) -> Bool:
    return system.machines[0].mode.one_of(*transition.sources) & transition.when


def _example(system: TransitionSystem, term: Bool, facts: Sequence[Bool] | object) -> str:
    unrolling, solver = Unrolling(system, assume=False), z3.Solver()
    solver.add(unrolling.in_range(0), unrolling.transition(0), unrolling.at(term, 0))
    if solver.check() != z3.sat:
        return "(no example within the limits)"
    values = unrolling.values(solver.model(), 0, [v for v in variables([term]) if isinstance(v, (NumVar, BoolVar))])
    return ", ".join(f"{name} = {value}" for name, value in values.items())


def _absence(system: TransitionSystem, limits: Limits) -> Iterator[Finding]:
    if not system.optionals:
        return
    started = time.monotonic()
    known = base(system, seconds=limits.seconds)
    goals: dict[str, Bool] = {}
    for option in system.optionals:
        other = replace(option.value, name=f"{option.value.name}@other")
        swap = Substitution({option.value: other})
        for var in system.state:
            term = system.next[var]
            if var not in system.ghosts and option.value in set(variables([term])):
                goals[f"{var.name} without {option.value.name}"] = (
                    option.present | ~between(other.low, other, other.high) | _same(term, swap(term))
                )
    failed = unproved(Query("absence", [in_range(system.inputs), *known.always.values()], goals), limits.seconds)
    statement = "the value of an absent input is never read"
    if failed:
        reason = "read although absent: " + "; ".join(failed)
        verdict: Verdict = Violated(None, "z3", reason)
    else:
        verdict = Proved(None, "z3", 1, ("two copies of a step",))
    yield _finding(system, "absence", statement, verdict, f"{len(goals)} one-step queries", started)


def _same(left: Expr, right: Expr) -> Bool:
    if isinstance(left, Num) and isinstance(right, Num):
        return left.eq(right)
    assert isinstance(left, Bool) and isinstance(right, Bool)
    return left.iff(right)


# ------------------------------------------------------------------ reachability


@dataclass(frozen=True, eq=False)
class _Target:
    name: str
    statement: str
    goal: Goal


def _reached(system: TransitionSystem, limits: Limits) -> Iterator[Finding]:
    """Modes and transitions: first under the assumption; what cannot occur under it, without it."""
    started = time.monotonic()
    targets = list(_targets(system))
    defences = {target.name for target in targets if _impossible(target.goal, base(system).everything, limits)}
    kept = _witnesses([target.goal for target in targets if target.name not in defences], limits)
    missing = [_without_assumption(target.goal) for target in targets if target.name not in kept]
    free = _witnesses(missing, limits)
    for target in targets:
        found = kept.get(target.name) or free.get(target.name)
        if found is None:
            yield _finding(system, target.name, target.statement, _dead(target.goal, limits), "bounded search", started)
            continue
        verdict = Proved(None, "bmc", len(found.steps), ("interpreter",), witness=found)
        yield _finding(system, target.name, target.statement, verdict, _how(target.name, kept, defences), started)


def _how(name: str, kept: Mapping[str, Trace], defences: set[str]) -> str:
    if name in kept:
        return "witness under the assumption"
    proved = "proved impossible" if name in defences else "not found"
    return f"a defence: witness with the assumption broken, {proved} while it is kept"


def _impossible(goal: Goal, facts: Sequence[Bool], limits: Limits) -> bool:
    """Whether no step from a state with these facts comes to the goal."""
    after = Substitution({var: term for var, term in goal.system.next.items()})
    given = [environment(goal.system), *facts, goal.good]
    first = Query("first", [goal.system.init, in_range(goal.system.state)], {"not at first": goal.good})
    never = Query("never", given, {"never": after.bool(goal.good)})
    return not unproved(first, limits.seconds) and not unproved(never, limits.seconds)


def _dead(goal: Goal, limits: Limits) -> Verdict:
    if _impossible(_without_assumption(goal), list(base(goal.original).always.values()), limits):
        return Violated(None, "1-induction", "never occurs, whatever the inputs: dead")
    return Unknown("no run found that comes there", limits.depth)


def _targets(system: TransitionSystem) -> Iterator[_Target]:
    for machine in system.machines:
        for var in system.state:
            if isinstance(var, NumVar) and var.unit is machine.mode.unit:
                for mode in machine.modes:
                    name = f"mode {machine.name} {mode.label}"
                    goal = observe(system, reachable(name, var.eq(mode)))
                    yield _Target(name, f"{machine.name} comes to mode {mode.label}", goal)
        for fired in system.fired:
            if fired.unit == machine.fired_name.unit:
                for number, transition in enumerate(machine.transitions, 1):
                    name = f"transition {machine.name}: {transition.name}"
                    goal = observe(system, reachable(name, fired.eq(Lit(number, fired.unit))))
                    yield _Target(name, f"{machine.name}: {transition.name!r} fires ({transition.src})", goal)


def _without_assumption(goal: Goal) -> Goal:
    return replace(goal, system=replace(goal.system, assume=TRUE))


def _witnesses(goals: Sequence[Goal], limits: Limits) -> dict[str, Trace]:
    """Shortest runs to as many goals as the limits allow, all in one incremental search."""
    if not goals:
        return {}
    merged = watch(replace(goals[0].original, assume=goals[0].system.assume), goals)
    unrolling, solver, found = Unrolling(merged.system), z3.Solver(), dict[str, Trace]()
    ends = time.monotonic() + limits.seconds
    solver.add(unrolling.initially())
    for depth in range(limits.depth + 1):
        left = [goal for goal in goals if goal.prop.name not in found]
        while left and time.monotonic() < ends:
            solver.push()
            solver.set("timeout", max(1, int((ends - time.monotonic()) * 1000)))
            solver.add(z3.Or(*(z3.Not(unrolling.at(goal.good, depth)) for goal in left)))
            answer = solver.check()
            model = solver.model() if answer == z3.sat else None
            solver.pop()
            if model is None:
                break
            run = run_of(merged, unrolling, model, depth)
            for goal in left:
                if z3.is_false(model.eval(unrolling.at(goal.good, depth), model_completion=True)):
                    found[goal.prop.name] = confirmed(goal, *run, "bmc")
            left = [goal for goal in left if goal.prop.name not in found]
        if not left or time.monotonic() >= ends:
            break
        solver.add(unrolling.transition(depth))
    return found


def _assumption(system: TransitionSystem, limits: Limits) -> Iterator[Finding]:
    """A run of several steps that keeps the assumption, with the machine in some other mode than at the start."""
    started = time.monotonic()
    unrolling, solver, length = Unrolling(system), z3.Solver(), 5
    solver.set("timeout", limits.milliseconds)
    solver.add(unrolling.initially(), *(unrolling.transition(number) for number in range(length)))
    answer = solver.check()
    statement = f"the assumption can be kept for {length} steps from the start"
    if answer == z3.sat:
        verdict: Verdict = Proved(None, "z3", length, ("model",))
    elif answer == z3.unsat:
        verdict = Violated(None, "z3", "no run keeps the assumption: every proof under it would be empty")
    else:
        verdict = Unknown(f"solver: {solver.reason_unknown()}")
    yield _finding(system, "assumption", statement, verdict, "z3", started)
