"""Spacer (property-directed reachability): finds an inductive invariant by itself.

The system's proved base serves as hypotheses. The invariant found is translated back into our own terms. New z3 queries,
and the second solver from text written from our terms, then decide three questions: it holds in the first state, every step preserves
it, and it implies the property.
"""

from __future__ import annotations

from collections.abc import Sequence

import z3

from safeloc.codegen.smt import Terms, constant
from safeloc.codegen.smtlib import Query
from safeloc.errors import EngineError
from safeloc.language.expr import TRUE, Bool, all_of
from safeloc.language.spec import Goal
from safeloc.language.system import environment, in_range
from safeloc.language.terms import Substitution
from safeloc.language.verdict import Proved, Unknown, Verdict
from safeloc.proof.provers.asking import WRAPS, counted, units
from safeloc.proof.provers.facts import about
from safeloc.proof.provers.further_assumption import nothing_begins
from safeloc.proof.provers.implication import unproved
from safeloc.proof.provers.kinduction import given_facts
from safeloc.proof.provers.limits import Deadline, Limits, clock_multiple, deadline, milliseconds, spend
from safeloc.proof.provers.proved_base import Base, base
from safeloc.proof.provers.recheck import UNCONFIRMED, certify, confirmed_by
from safeloc.proof.provers.z3_to_terms import UnreadableError, read_bool

CLAIMED = "spacer claims a violation; bounded search has to show it"
"""The reason where Spacer is sure that some run, however long, breaks the property."""
UNITS_PER_SECOND = 1_000_000
"""Units of z3's resource count in one second of Spacer's effort: 0.9 to 1.2 million on an idle processor."""


def spacer(goal: Goal, limits: Limits) -> Verdict:
    """Return Proved, Vacuous or Unknown; a violation that Spacer claims is left to bounded search, which gives the
    trace.

    The re-check gets the same time limit again.
    """
    known = base(goal.original, seconds=limits.seconds)
    facts = given_facts(goal, known)
    enough = not unproved(Query("the base alone", facts, {"good": goal.good}), limits.seconds)
    found = TRUE if enough else _invariant(goal, facts, limits)
    if isinstance(found, Unknown):
        return found
    return _confirmed(goal, known, found, deadline(limits.seconds))


def _invariant(goal: Goal, facts: Sequence[Bool], limits: Limits) -> Bool | Unknown:
    system = goal.system
    now = Terms({var: constant(var) for var in (*system.state, *system.inputs)})
    later = Terms({var: constant(var, "'") for var in system.state})
    state, after = [now(var) for var in system.state], [later(var) for var in system.state]
    reached = z3.Function("reached", *(term.sort() for term in state), z3.BoolSort())
    engine = _engine(limits)
    engine.register_relation(reached)
    engine.declare_var(*state, *after, *(now(var) for var in system.inputs))
    known = [now.bool(fact) for fact in facts]
    first = [now.bool(system.init), now.bool(in_range(system.state))]
    moves = [later(var) == now(term) for var, term in system.next.items()]
    engine.rule(reached(*state), [*first, *known])
    engine.rule(reached(*after), [reached(*state), *known, now.bool(environment(system)), *moves])
    before = counted(engine)
    try:
        answer = engine.query(z3.And(reached(*state), *known, z3.Not(now.bool(goal.good))))
    except z3.Z3Exception as error:
        return Unknown(f"spacer: {_text(error.value)}")
    finally:
        spend((counted(engine) - before) % WRAPS / UNITS_PER_SECOND)
    if answer == z3.sat:
        return Unknown(CLAIMED)
    if answer != z3.unsat:
        return Unknown(f"spacer: {_text(engine.reason_unknown())}")
    return _read(engine.get_answer(), state, goal)


def _text(reason: str | bytes) -> str:
    """Return z3's reason as text: z3 gives bytes, and `canceled` if its time is up."""
    return (reason.decode() if isinstance(reason, bytes) else reason).replace("canceled", "time limit") or "undecided"


def _engine(limits: Limits) -> z3.Fixedpoint:
    engine = z3.Fixedpoint()
    engine.set(
        engine="spacer",
        timeout=milliseconds(clock_multiple() * limits.seconds),
        rlimit=units(limits.seconds, UNITS_PER_SECOND),
    )
    engine.set("spacer.random_seed", limits.seed)
    return engine


def _read(answer: z3.ExprRef, state: list[z3.ExprRef], goal: Goal) -> Bool | Unknown:
    try:
        return read_bool(_body(answer, state), {var.name: var for var in goal.system.state})
    except UnreadableError as error:
        return Unknown(f"spacer: its invariant cannot be read back: {error}")


def _body(answer: z3.ExprRef, state: list[z3.ExprRef]) -> z3.ExprRef:
    """Return the invariant over the state constants, from `forall s. reached(s) = body(s)`."""
    if not isinstance(answer, z3.QuantifierRef):
        raise EngineError(f"spacer: its answer is no quantified equation: {answer.sexpr()[:200]}")
    equation = answer.body()
    left, body = (equation.arg(0), equation.arg(1)) if z3.is_eq(equation) else (equation, z3.BoolVal(True))
    slots = {z3.get_var_index(left.arg(index)): constant_ for index, constant_ in enumerate(state)}
    return z3.substitute_vars(body, *(slots[index] for index in range(len(slots))))


def _confirmed(goal: Goal, known: Base, invariant: Bool, ends: Deadline) -> Verdict:
    """Decide the three queries on the invariant by both solvers."""
    empty = nothing_begins(goal, ends.left)
    if empty is not None:
        return empty
    certificates = dict(known.certificates)
    for query in queries(goal, given_facts(goal, known), invariant):
        failed = unproved(query, ends.left)
        if failed:
            return Unknown(f"spacer: its invariant fails {query.name!r}: {next(iter(failed.values()))}")
        certificate = certify(query, seconds=ends.left, relies_on=list(known.certificates))
        if certificate.undecided:
            return Unknown(f"proved by spacer, but {UNCONFIRMED}")
        certificates[certificate.file] = certificate.text
    proved = all_of([*given_facts(goal, known), invariant])
    return Proved(proved, "spacer", 0, confirmed_by(certificates), certificates)


def queries(goal: Goal, facts: Sequence[Bool], invariant: Bool) -> tuple[Query[str], Query[str], Query[str]]:
    """Return the queries for initiation, for consecution, and for the property as a consequence."""
    system, name = goal.system, f"{goal.original.name} {goal.prop.name} spacer"
    after = Substitution(dict(system.next)).bool(invariant)
    first = [system.init, in_range(system.state), *facts]
    return (
        Query(f"{name} start", first, {"invariant": invariant}, _about(goal, "start")),
        Query(
            f"{name} step",
            [environment(system), *facts, invariant],
            {"invariant after it": after},
            _about(goal, "step"),
        ),
        Query(f"{name} implies", [*facts, invariant], {"good": goal.good}, _about(goal, "implies")),
    )


def _about(goal: Goal, what: str) -> dict[str, str]:
    return about(goal.original, f"invariant {what}", property=goal.prop.name)
