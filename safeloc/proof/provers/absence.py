"""Check that the value of an absent optional input is never read.

In most terms the value disappears once the presence flag is set to false. For each of the others a solver proves that
two copies of a step that differ only in the value end alike, in every reachable state. In a composition the check
covers each machine alone, and the terms of the wires.

The laws of the world are checked like the machine: an absent input is stored as a number (`canonical`), so a law that reads it
would say of a silent sensor that it measures that number, and would prove a machine that takes silence for a measurement.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import Bool, BoolVar, Expr, Num, NumVar, Optional, Var, all_of, as_num, ite
from safeloc.language.folding import Folding
from safeloc.language.nodes import FALSE
from safeloc.language.system import TransitionSystem, in_range
from safeloc.language.terms import Substitution, variables
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Unknown, Verdict, Violated
from safeloc.proof.provers.facts import about
from safeloc.proof.provers.implication import Refuted, Undecided, unproved
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.never import none_happens
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.proved_base import Base, base
from safeloc.proof.provers.reachable_targets import happens, without_assumption
from safeloc.proof.provers.recheck import UNCONFIRMED, confirmed_by
from safeloc.proof.provers.settle import settled

NAMED = 3  # undecided readings that the verdict names; it only counts the others
Reading = tuple[str, str]
"""The names of an input and of the term that reads it."""
_LAW = "the law "


@dataclass
class _Found:
    """The results for all machines: the number of readings, the number of solver queries, and the answers."""

    held: int = 0
    asked: int = 0
    read: dict[Reading, Violated] = field(default_factory=dict)
    failed: dict[Reading, Undecided] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)


def absence(system: TransitionSystem, limits: Limits) -> Iterator[Obligation]:
    """Yield one obligation for all optional inputs; none if there are no optional inputs."""
    if not system.optionals and not any(part.alone.optionals for part in system.parts):
        return
    found = _Found()
    for one in [part.alone for part in system.parts] or [system]:
        _look(one, {**dict(_on_board(one)), **dict(_in_the_world(one))}, limits, found)
    if system.parts:
        _look(system, dict(_through_wires(system)), limits, found)
    settled_by_folding = (
        f"{found.held - found.asked} of {found.held} readings disappear when the presence flag is set to false"
    )
    method = f"{settled_by_folding}; {found.asked} checked by two copies of a step"
    yield Obligation(
        "absence", "the value of an absent input is never read", _verdict(found, settled_by_folding), method
    )


def _look(system: TransitionSystem, terms: Mapping[str, Expr], limits: Limits, found: _Found) -> None:
    known, ends = base(system, seconds=limits.seconds), deadline(limits.seconds)
    holds = {name: frozenset(variables([term])) for name, term in terms.items()}
    for option in system.optionals:
        held = {name: term for name, term in terms.items() if option.value in holds[name]}
        left = dict(_still_held(held, option))
        found.held, found.asked = found.held + len(held), found.asked + len(left)
        if left:
            _ask(system, option, left, known, replace(limits, seconds=max(0.001, ends.left)), found)


def _ask(
    system: TransitionSystem, option: Optional, terms: Mapping[str, Expr], known: Base, limits: Limits, found: _Found
) -> None:
    other = replace(option.value, name=f"{option.value.name} (other)")
    swap = Substitution({option.value: other})
    alike = {(option.value.name, name): _same(term, swap(term)) for name, term in terms.items()}
    hypotheses = [in_range([*system.inputs, other]), ~option.present, *known.always.values()]
    head, ends = about(system, "absence", of=option.value.name), deadline(limits.seconds)
    query = Query(
        f"{system.name} absence of {option.value.name}", hypotheses, {option.value.name: all_of(alike.values())}, head
    )
    answer = settled(query, ends, list(known.certificates))  # one query for all: they share the hard terms
    found.texts |= {**known.certificates, **answer.texts}
    if not answer.failed:
        return
    each = unproved(Query(query.name, hypotheses, alike), ends.left)
    found.failed |= {key: why for key, why in each.items() if isinstance(why, Undecided)}
    if not each:
        found.failed |= dict.fromkeys(alike, Undecided(UNCONFIRMED))
    read = {key: ~alike[key] for key, why in each.items() if isinstance(why, Refuted)}
    if read:
        _look_for_runs(system, option, other, read, limits, found)


def _look_for_runs(
    system: TransitionSystem,
    option: Optional,
    other: NumVar,
    read: Mapping[Reading, Bool],
    limits: Limits,
    found: _Found,
) -> None:
    """Search for runs that reach a difference between the copies: a single step may start in an unreachable state."""
    both = replace(system, inputs=(*system.inputs, other), optionals=())
    goals = {
        without_assumption(happens(both, f"reading {number}", term & ~option.present)): key
        for number, (key, term) in enumerate(read.items(), 1)
    }
    for goal, verdict in none_happens(dict.fromkeys(goals, "the copies differ"), limits).items():
        if isinstance(verdict, Violated):
            found.read[goals[goal]] = verdict
        elif isinstance(verdict, Proved):
            found.texts |= verdict.certificates
        else:
            found.failed[goals[goal]] = Undecided(
                "the copies differ in some state, but it is not known if a run reaches that state"
            )


def _on_board(system: TransitionSystem) -> Iterator[tuple[str, Expr]]:
    """Yield the on-board terms of a step: next states and fired transitions."""
    yield from ((var.name, term) for var, term in system.next.items() if var not in system.ghosts)
    yield from ((var.name, term) for var, term in system.fired.items())


def _in_the_world(system: TransitionSystem) -> Iterator[tuple[str, Expr]]:
    """Yield the clauses of the worlds, and the moves of ghosts."""
    for machine in system.machines:
        yield from ((f"{_LAW}{name!r}", term) for name, term in machine.world.terms.items())
    yield from ((f"the move of {var.name}", term) for var, term in system.next.items() if var in system.ghosts)


def _through_wires(system: TransitionSystem) -> Iterator[tuple[str, Expr]]:
    """Yield the term of each wire; a wire to an optional input counts only while that input is present."""
    for part in system.parts:
        present: dict[Var, BoolVar] = {option.value: option.present for option in part.alone.optionals}
        for var in part.alone.inputs:
            wired = part.into(var)
            if not isinstance(wired, Var):
                term = _where(part.into.bool(present[var]), wired) if var in present else wired
                yield f"{part.name}.{var.name}", term


def _where(present: Bool, term: Expr) -> Expr:
    """Return the term while the input is present, and a constant otherwise."""
    if isinstance(term, Num):
        return ite(present, term, as_num(0, term.unit))
    assert isinstance(term, Bool)
    return present & term


def _still_held(terms: Mapping[str, Expr], option: Optional) -> Iterator[tuple[str, Expr]]:
    """Yield the terms that hold the input's value even after its presence flag is set to false."""
    absent = Folding({option.present: FALSE})
    for name, term in terms.items():
        if option.value in set(variables([absent(term)])):
            yield name, term


def _verdict(found: _Found, by_folding: str) -> Verdict:
    if found.read:
        readings = [f"{value} by {name}{_shown(verdict.trace)}" for (value, name), verdict in found.read.items()]
        return Violated(None, "bmc", f"read although absent: {'; '.join(readings)}{_remedy(found)}")
    if found.failed:
        open_ = [f"{value} by {name}: {why}" for (value, name), why in found.failed.items()]
        more = f"; and {len(open_) - NAMED} more" if len(open_) > NAMED else ""
        return Unknown("; ".join(open_[:NAMED]) + more)
    if not found.asked:
        return Proved(None, "folding", by_construction=by_folding)
    return Proved(None, "z3", 1, confirmed_by(found.texts), found.texts, by_construction=by_folding)


def _remedy(found: _Found) -> str:
    """Return the remedy for a law that says something of a silent sensor; nothing if only the machine reads."""
    option = next((value for value, name in found.read if name.startswith(_LAW)), "")
    return f". A law says nothing of a silent sensor: {option}.present.implies(...)" if option else ""


def _shown(run: Trace | None) -> str:
    """Describe the length of the run and its last step."""
    if run is None or not run.steps:
        return ""
    values = ", ".join(f"{name} = {value}" for name, value in run.steps[-1].inputs.items())
    return f" in a run of {len(run.steps)} steps, the last with {values}"


def _same(left: Expr, right: Expr) -> Bool:
    if isinstance(left, Num) and isinstance(right, Num):
        return left.eq(right)
    assert isinstance(left, Bool)
    assert isinstance(right, Bool)
    return left.iff(right)
