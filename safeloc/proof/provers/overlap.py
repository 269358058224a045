"""Check that transitions of one rank exclude each other; otherwise their order in the table would decide unnoticed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import Bool
from safeloc.language.machine import Machine, Transition
from safeloc.language.system import TransitionSystem, environment
from safeloc.language.verdict import Proved, Verdict, Violated
from safeloc.proof.provers.facts import about
from safeloc.proof.provers.implication import Failure, Refuted
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.never import never
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.proved_base import base
from safeloc.proof.provers.reachable_targets import happens, without_assumption
from safeloc.proof.provers.recheck import confirmed_by
from safeloc.proof.provers.settle import settled_but

Rows = tuple[int, int]
"""Numbers of two rows of a table, from 1."""


def overlap(system: TransitionSystem, limits: Limits) -> Iterator[Obligation]:
    """Check that transitions of one rank and mode are never enabled together, for all inputs; each machine separately."""
    for one in [part.alone for part in system.parts] or [system]:
        yield from _overlap(one, one.machines[0], limits)


def _overlap(system: TransitionSystem, machine: Machine, limits: Limits) -> Iterator[Obligation]:
    known, both = base(system, seconds=limits.seconds), _enabled_together(machine)
    hypotheses = [environment(system, assume=False), *known.always.values()]
    head = about(system, "overlap", machine=machine.name)
    query = Query(f"{system.name} overlap", hypotheses, {rows: ~term for rows, term in both.items()}, head)
    asked, rest = settled_but(query, deadline(limits.seconds), list(known.certificates))
    statement = f"transitions of one rank of {machine.name} exclude each other"
    if not both:
        nothing = Proved(None, "construction", by_construction="no two transitions have one rank and mode")
        yield Obligation(f"overlap {machine.name}", statement, nothing, nothing.by_construction)
    elif rest:
        texts = {**known.certificates, **asked.texts}
        verdict = Proved(None, "z3", 1, confirmed_by(texts), texts)
        others = ", except for pairs with an obligation of their own" if asked.failed else ""
        yield Obligation(f"overlap {machine.name}", statement + others, verdict, f"{len(rest)} pairs, one query each")
    for rows, why in asked.failed.items():
        names = " and ".join(repr(machine.transitions[row - 1].name) for row in rows)
        verdict_ = _overlapping(system, rows, both[rows], why, limits)
        name = f"overlap {machine.name}: rows {rows[0]} and {rows[1]}"
        yield Obligation(name, f"{statement}: {names}", verdict_, "one query, then bounded search and induction")


def _overlapping(system: TransitionSystem, rows: Rows, both: Bool, why: Failure, limits: Limits) -> Verdict:
    goal = without_assumption(happens(system, f"overlap of rows {rows[0]} and {rows[1]}", both))
    seen = f"both are enabled when {why.values}" if isinstance(why, Refuted) else str(why)
    verdict = never(goal, f"{seen}; give them different ranks, or correct a guard", limits)
    if not (system.composition and isinstance(verdict, (Violated, Proved))):
        return verdict
    return _of_a_part(verdict, system)


def _of_a_part(verdict: Violated | Proved, system: TransitionSystem) -> Verdict:
    """Turn a machine's own verdict into one of the composition: the evidence is over the machine's variables."""
    if isinstance(verdict, Proved):
        return Proved(
            None,
            f"{verdict.engine} of {system.machines[0].name} by itself",
            verdict.depth,
            verdict.rechecked,
            verdict.certificates,
        )
    run = "" if verdict.trace is None else f"; a run of the machine alone that enables both:\n{verdict.trace.table()}"
    return Violated(None, verdict.engine, verdict.reason + run)


def _enabled_together(machine: Machine) -> Mapping[Rows, Bool]:
    rows = list(enumerate(machine.transitions, 1))
    return {
        (number, other): _enabled(machine, first) & _enabled(machine, second)
        for (number, first), (other, second) in combinations(rows, 2)
        if first.rank == second.rank and set(first.sources) & set(second.sources)
    }


def _enabled(machine: Machine, transition: Transition) -> Bool:
    return machine.mode.one_of(*transition.sources) & transition.when
