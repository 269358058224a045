"""Obligations of arithmetic: ranges of state variables, 64 bits for every intermediate term, no division by zero."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import Bool, Expr, Num, NumVar, all_of, between
from safeloc.language.nodes import INT64_MAX, INT64_MIN, FloorDiv, Mul
from safeloc.language.ranges import beyond_int64
from safeloc.language.render import infix
from safeloc.language.spec import Goal, observe, reachable
from safeloc.language.system import TransitionSystem, environment, in_range
from safeloc.language.terms import in_order
from safeloc.language.verdict import Proved, Unknown, Verdict, Violated
from safeloc.proof.provers.facts import about, range_of
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.never import none_happens
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.proved_base import Base, base
from safeloc.proof.provers.reachable_targets import happens, without_assumption
from safeloc.proof.provers.recheck import confirmed_by, rechecked_in_words
from safeloc.proof.provers.settle import settled, settled_but
from safeloc.proof.provers.without_lemmas import search_limits

# ------------------------------------------------------------------ ranges


def ranges(system: TransitionSystem, limits: Limits) -> Iterator[Obligation]:
    """Yield one obligation for all ranges that are inductive together, and one for each of the others."""
    known = base(system, seconds=limits.seconds)
    numeric = [var for var in system.state if isinstance(var, NumVar)]
    kept = [var for var in numeric if range_of(var) not in known.refuted]
    if kept:
        statement = f"{len(kept)} of {len(numeric)} state variables stay in their declared ranges"
        by = confirmed_by(known.certificates)
        verdict = Proved(all_of(known.everything), "1-induction", 1, by, known.certificates)
        yield Obligation("ranges", statement, verdict, rechecked_in_words("1-induction", by))
    lost = [var for var in numeric if range_of(var) in known.refuted]
    verdicts = _verdicts_on_ranges(system, lost, known, limits)
    for var in lost:
        stays = f"{var.name} stays in {var.low}..{var.high}"
        yield Obligation(str(range_of(var)), stays, verdicts[var], "bounded search, then induction")


def _verdicts_on_ranges(
    system: TransitionSystem, lost: Sequence[NumVar], known: Base, limits: Limits
) -> dict[NumVar, Verdict]:
    """Return of each variable whether a run leaves its range: for all inputs, and of ghosts under the assumption."""
    found: dict[NumVar, Verdict] = {}
    for ghosts in (False, True):
        asked = {
            var: observe(system, reachable(f"{var.name} leaves its range", ~in_range([var])))
            for var in lost
            if (var in system.ghosts) == ghosts
        }
        goals = {var: goal if ghosts else without_assumption(goal) for var, goal in asked.items()}
        why = {goal: known.refuted[range_of(var)] for var, goal in goals.items()}
        verdicts = none_happens(why, search_limits(system, limits)) if goals else {}
        found |= {var: verdicts[goal] for var, goal in goals.items()}
    return found


# ------------------------------------------------------------------ 64 bits


@dataclass(frozen=True, eq=False)
class _Computed:
    """Terms that a back end computes in 64 bits, and the facts that hold there.

    unsure  variables whose ranges the result needs, but which are not proved
    lawful  true if the facts hold under the assumption only
    """

    name: str
    terms: Sequence[Expr]
    hypotheses: Sequence[Bool]
    unsure: Sequence[NumVar]
    lawful: bool


def overflow(system: TransitionSystem, limits: Limits) -> Iterator[Obligation]:
    """Check 64 bits: on-board terms for all inputs, ghosts (only simulation computes them) under the assumption, first
    values.
    """
    known = base(system, seconds=limits.seconds)
    free = [environment(system, assume=False), *known.always.values()]
    board = _Computed("overflow", computed(system), free, _not_proved(system, known, ghosts=False), lawful=False)
    yield from _overflow(system, board, known, limits)
    if system.ghosts:
        moves = [*(system.next[var] for var in system.state if var in system.ghosts), system.assume]
        lawful, unsure = [environment(system), *known.everything], _not_proved(system, known, ghosts=True)
        ghosts = _Computed("overflow of ghosts", moves, lawful, unsure, lawful=True)
        yield from _overflow(system, ghosts, known, limits)
    yield from _overflow_at_first(system, limits)


def computed(system: TransitionSystem) -> list[Expr]:
    """Return the on-board terms: next states, fired transitions and outputs, without ghosts."""
    next_terms = [term for var, term in system.next.items() if var not in system.ghosts]
    return [*next_terms, *system.fired.values(), *system.outputs.values()]


def _not_proved(system: TransitionSystem, known: Base, *, ghosts: bool) -> list[NumVar]:
    """Return the variables whose declared range is not proved for this case, so that no proof may use it."""
    numeric = [var for var in system.state if isinstance(var, NumVar) and (ghosts or var not in system.ghosts)]
    proved = {*known.always, *known.facts} if ghosts else set(known.always)
    return [var for var in numeric if range_of(var) not in proved]


FITS = "no intermediate term leaves 64 bits"


def _overflow(system: TransitionSystem, what: _Computed, known: Base, limits: Limits) -> Iterator[Obligation]:
    wide = dict(enumerate(beyond_int64(what.terms), 1))
    every = len(in_order(what.terms))
    by_bounds = f"{every - len(wide)} of {every} terms stay within 64 bits by the bounds of their parts"
    query = Query(f"{system.name} {what.name}", what.hypotheses, _within(wide), about(system, what.name))
    asked, rest = settled_but(query, deadline(limits.seconds), list(known.certificates))
    texts = {**known.certificates, **asked.texts} if rest else {}
    by_solvers = rechecked_in_words(f"{by_bounds}; {len(wide)} by z3", confirmed_by(asked.texts))
    method = by_solvers if wide else by_bounds
    goals = {number: _left(system, f"{what.name} {number}", ~query.goals[number], what) for number in asked.failed}
    found = none_happens({goal: asked.failed[number] for number, goal in goals.items()}, limits)
    for number, goal in goals.items():
        yield Obligation(goal.prop.name, f"{FITS}: {infix(wide[number])}", found[goal], method)
    if what.unsure:
        names = ", ".join(var.name for var in what.unsure)
        yield Obligation(what.name, FITS, Unknown(f"it rests on ranges that are not proved: {names}"), method)
    elif rest or not wide:
        engine = "z3" if wide else "intervals"
        yield Obligation(
            what.name,
            f"{FITS}, except in terms with an obligation of their own" if asked.failed else FITS,
            Proved(None, engine, len(texts) and 1, confirmed_by(texts), texts, by_construction=by_bounds),
            method,
        )


def _left(system: TransitionSystem, name: str, term: Bool, what: _Computed) -> Goal:
    goal = happens(system, name, term)
    return goal if what.lawful else without_assumption(goal)


def _within(wide: Mapping[int, Num]) -> dict[int, Bool]:
    return {number: between(INT64_MIN, term, INT64_MAX) for number, term in wide.items()}


def _overflow_at_first(system: TransitionSystem, limits: Limits) -> Iterator[Obligation]:
    """Check `initially` for overflow: it is evaluated on any first values that are in range."""
    wide = dict(enumerate(beyond_int64([system.init]), 1))
    if not wide:
        return
    head = about(system, "overflow of first values")
    query = Query(f"{system.name} overflow of first values", [in_range(system.state)], _within(wide), head)
    asked = settled(query, deadline(limits.seconds))
    statement, method = "`initially` is computed within 64 bits, whatever first values are chosen", "one query a term"
    verdict: Verdict = Proved(None, "z3", 0, confirmed_by(asked.texts), asked.texts)
    if asked.failed:
        number, why = next(iter(asked.failed.items()))
        reason = f"{infix(wide[number])}: {why}; narrow the ranges, or bound each value in `initially`"
        verdict = Violated(None, "z3", reason)
    yield Obligation("overflow of first values", statement, verdict, method)


# ------------------------------------------------------------------ division


def division(system: TransitionSystem, _: Limits) -> Iterator[Obligation]:
    """Check that divisors are positive constants by construction; count products of two variables for the reader."""
    nodes = in_order(computed(system))
    divisors = [node.divisor for node in nodes if isinstance(node, FloorDiv)]
    products = [node for node in nodes if isinstance(node, Mul) and not node.by_constant]
    why = f"{len(divisors)} divisions, each by a positive constant"
    verdict: Verdict = Proved(None, "construction", by_construction=why)
    if any(divisor <= 0 for divisor in divisors):
        verdict = Violated(None, "construction", f"divisors {sorted(set(divisors))}")
    yield Obligation("division", "no division by zero", verdict, f"{why}; {len(products)} products of two variables")
