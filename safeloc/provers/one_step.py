"""Obligations that a look at one step decides: ranges, overflow, division, overlapping guards, absent inputs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from safeloc.backends.known import Known
from safeloc.backends.smtlib import Query
from safeloc.expr import Bool, BoolVar, Expr, Lit, Num, NumVar, Optional, Var, all_of, as_num, between, ite
from safeloc.machine import Machine, Transition
from safeloc.nodes import FALSE, INT64_MAX, INT64_MIN, FloorDiv, Mul
from safeloc.provers.base import base, range_name
from safeloc.provers.implication import Failure, Refuted, unproved
from safeloc.provers.limits import Limits
from safeloc.provers.obligation import Obligation
from safeloc.provers.reachability import first_runs, happens, without_assumption
from safeloc.provers.recheck import ENGINE
from safeloc.ranges import beyond_int64
from safeloc.spec import Goal, observe, reachable
from safeloc.system import TransitionSystem, environment, in_range, lower
from safeloc.terms import Substitution, in_order, variables
from safeloc.verdict import Proved, Unknown, Verdict, Violated

# ------------------------------------------------------------------ ranges


def ranges(system: TransitionSystem, limits: Limits) -> Iterator[Obligation]:
    """All ranges that are inductive, as one obligation; each of the others on its own."""
    known = base(system, seconds=limits.seconds)
    numeric = [var for var in system.state if isinstance(var, NumVar)]
    kept = [var for var in numeric if range_name(var) not in known.refuted]
    statement = f"{len(kept)} of {len(numeric)} state variables stay in their declared ranges"
    verdict = Proved(all_of(known.everything), "1-induction", 1, (ENGINE,), known.certificates)
    yield Obligation("ranges", statement, verdict, f"1-induction, re-checked by {ENGINE}")
    for var in numeric:
        if range_name(var) in known.refuted:
            goal = observe(system, reachable(range_name(var), ~in_range([var])))
            goal = goal if var in system.ghosts else without_assumption(goal)
            verdict_ = _run_or_unknown(goal, str(known.refuted[range_name(var)]), limits)
            yield Obligation(range_name(var), f"{var.name} stays in {var.low}..{var.high}", verdict_, "bounded search")


def _run_or_unknown(goal: Goal, why: str, limits: Limits) -> Verdict:
    runs = first_runs([goal], limits)
    if goal.prop.name in runs.found:
        return Violated(runs.found[goal.prop.name], "bmc", why)
    return Unknown(f"not shown for every state ({why}), and no run breaks it; a lemma may be missing", runs.depth)


# ------------------------------------------------------------------ arithmetic


def overflow(system: TransitionSystem, limits: Limits) -> Iterator[Obligation]:
    """On board for all inputs; ghosts, which only simulation computes, under the assumption."""
    known = base(system, seconds=limits.seconds)
    given = [environment(system, assume=False), *known.always.values()]
    yield from _overflow(system, "overflow", computed(system), given, limits)
    if system.ghosts:
        moves = [*(system.next[var] for var in system.state if var in system.ghosts), system.assume]
        yield from _overflow(system, "overflow of ghosts", moves, [environment(system), *known.everything], limits)


def computed(system: TransitionSystem) -> list[Expr]:
    """What runs on board: next states, fired transitions and outputs, ghosts apart."""
    own = [term for var, term in system.next.items() if var not in system.ghosts]
    return [*own, *system.fired.values(), *system.outputs.values()]


def _overflow(
    system: TransitionSystem, name: str, terms: Sequence[Expr], given: Sequence[Bool], limits: Limits
) -> Iterator[Obligation]:
    statement = "no intermediate term leaves 64 bits"
    wide = beyond_int64(terms)
    method = f"interval analysis of {len(in_order(terms))} terms" + (f", {len(wide)} of them by z3" if wide else "")
    goals = {repr(term): between(INT64_MIN, term, INT64_MAX) for term in wide}
    failed = unproved(Query(name, given, goals), limits.seconds)
    if not failed:
        yield Obligation(name, statement, Proved(None, "intervals", 0, ("interval analysis",)), method)
    for term, why in failed.items():
        goal = without_assumption(happens(system, f"{name} of {term}", ~goals[term]))
        yield Obligation(goal.prop.name, statement, _run_or_unknown(goal, str(why), limits), method)


def division(system: TransitionSystem, _: Limits) -> Iterator[Obligation]:
    """Divisors are positive constants by construction; products of two variables are counted for the reader."""
    nodes = in_order(computed(system))
    divisors = [node.divisor for node in nodes if isinstance(node, FloorDiv)]
    products = [node for node in nodes if isinstance(node, Mul) and not _by_constant(node)]
    verdict: Verdict = Proved(None, "construction", 0, ("construction",))
    if any(divisor <= 0 for divisor in divisors):
        verdict = Violated(None, "construction", f"divisors {sorted(set(divisors))}")
    method = f"{len(divisors)} divisions, each by a positive constant; {len(products)} products of two variables"
    yield Obligation("division", "no division by zero", verdict, method)


def _by_constant(node: Mul) -> bool:
    return isinstance(node.left, Lit) or isinstance(node.right, Lit)


# ------------------------------------------------------------------ overlap


def overlap(system: TransitionSystem, limits: Limits) -> Iterator[Obligation]:
    """Transitions of one rank and mode are never enabled together, for all inputs; machines of a composition apart."""
    for machine in system.machines:
        alone = system if len(system.machines) == 1 else lower(machine)
        both = {f"{a.name} / {b.name}": _enabled(machine, a) & _enabled(machine, b) for a, b in _pairs(machine)}
        yield from _overlap(alone, machine, both, limits)


def _overlap(
    system: TransitionSystem, machine: Machine, both: Mapping[str, Bool], limits: Limits
) -> Iterator[Obligation]:
    statement = f"transitions of one rank of {machine.name} exclude each other"
    known = base(system, seconds=limits.seconds)
    goals = {name: ~term for name, term in both.items()}
    given = [environment(system, assume=False), *known.always.values()]
    failed = unproved(Query("overlap", given, goals), limits.seconds)
    if not failed:
        verdict: Verdict = Proved(None, "z3", 1, ("one query a pair",))
        yield Obligation(f"overlap {machine.name}", statement, verdict, f"{len(goals)} pairs, one query each")
    for name, why in failed.items():
        goal = without_assumption(happens(system, f"overlap {machine.name}: {name}", both[name]))
        verdict = _overlapping(goal, why, limits)
        yield Obligation(goal.prop.name, statement, verdict, "one query, then bounded search")


def _overlapping(goal: Goal, why: Failure, limits: Limits) -> Verdict:
    if not isinstance(why, Refuted):
        return Unknown(str(why))
    reason = f"both are enabled when {why.values}; give them different ranks, or mend a guard"
    runs = first_runs([goal], limits)
    return Violated(runs.found.get(goal.prop.name), "z3", reason)


def _pairs(machine: Machine) -> Iterator[tuple[Transition, Transition]]:
    table = list(machine.transitions)
    for index, first in enumerate(table):
        for second in table[index + 1 :]:
            if first.rank == second.rank and set(first.sources) & set(second.sources):
                yield first, second


def _enabled(machine: Machine, transition: Transition) -> Bool:
    return machine.mode.one_of(*transition.sources) & transition.when


# ------------------------------------------------------------------ absence


def absence(system: TransitionSystem, limits: Limits) -> Iterator[Obligation]:
    """Where an input is absent, what is computed does not hold its value; else two copies that differ in it end alike.

    Of a composition: of each machine by itself, and of what goes through the wires.
    """
    if not system.optionals:
        return
    asked, failed = 0, dict[str, Failure]()
    for one in [part.alone for part in system.parts] or [system]:
        more, wrong = _read_though_absent(one, list(_on_board(one)), one.optionals, limits)
        asked, failed = asked + more, failed | wrong
    if system.parts:
        more, wrong = _read_though_absent(system, list(_through_wires(system)), system.optionals, limits)
        asked, failed = asked + more, failed | wrong
    method = f"folded where absent, {asked} queries over two copies of a step for what is left"
    yield Obligation("absence", "the value of an absent input is never read", _read(failed), method)


Terms = Sequence[tuple[str, Expr, frozenset[Var]]]


def _read_though_absent(
    system: TransitionSystem, terms: Terms, optionals: Iterable[Optional], limits: Limits
) -> tuple[int, dict[str, Failure]]:
    """How many questions were left for the solver, and what speaks against them."""
    asked, failed = 0, dict[str, Failure]()
    for option in optionals:
        goals = dict(_still_held(terms, option))
        if goals:
            facts = base(system, seconds=limits.seconds).always.values()
            asked, failed = (
                asked + len(goals),
                failed | unproved(_two_copies(system, option, goals, facts), limits.seconds),
            )
    return asked, failed


def _through_wires(system: TransitionSystem) -> Iterator[tuple[str, Expr, frozenset[Var]]]:
    """What each wire tells; where it leads to an input that may be absent, only while that is present."""
    for part in system.parts:
        present: dict[Var, BoolVar] = {option.value: option.present for option in part.alone.optionals}
        for var in part.alone.inputs:
            told = part.into(var)
            if not isinstance(told, Var):
                heard = _where(part.into.bool(present[var]), told) if var in present else told
                yield f"{part.name}.{var.name}", heard, frozenset(variables([heard]))


def _where(present: Bool, told: Expr) -> Expr:
    """The term while it is present, and a constant otherwise."""
    if isinstance(told, Num):
        return ite(present, told, as_num(0, told.unit))
    assert isinstance(told, Bool)
    return present & told


def _on_board(system: TransitionSystem) -> Iterator[tuple[str, Expr, frozenset[Var]]]:
    """What is computed on board in a step, with the variables that it reads."""
    moves = {var.name: term for var, term in system.next.items() if var not in system.ghosts}
    for name, term in {**moves, **{var.name: term for var, term in system.fired.items()}}.items():
        yield name, term, frozenset(variables([term]))


def _still_held(terms: Terms, option: Optional) -> Iterator[tuple[str, Expr]]:
    """Of the terms that hold the input's value, those that still do when all is folded that its absence decides."""
    absent = Known({option.present: FALSE})
    for name, term, held in terms:
        if option.value in held and option.value in set(variables([absent(term)])):
            yield name, term


def _two_copies(system: TransitionSystem, option: Optional, terms: Mapping[str, Expr], facts: Iterable[Bool]) -> Query:
    other = replace(option.value, name=f"{option.value.name} (other)")
    swap = Substitution({option.value: other})
    goals = {f"{option.value.name} by {name}": _same(term, swap(term)) for name, term in terms.items()}
    return Query("absence", [in_range([*system.inputs, other]), ~option.present, *facts], goals)


def _read(failed: Mapping[str, Failure]) -> Verdict:
    read = [f"{name}, when {why.values}" for name, why in failed.items() if isinstance(why, Refuted)]
    if read:
        return Violated(None, "z3", f"read although absent: {'; '.join(read)}")
    if failed:
        return Unknown("; ".join(f"{name}: {why}" for name, why in failed.items()))
    return Proved(None, "folding, z3", 1, ("two copies of a step",))


def _same(left: Expr, right: Expr) -> Bool:
    if isinstance(left, Num) and isinstance(right, Num):
        return left.eq(right)
    assert isinstance(left, Bool)
    assert isinstance(right, Bool)
    return left.iff(right)
