"""k-induction: unbounded proofs, with the system's proved base as hypotheses.

For k = 1 the invariant is inductive over one step. For k > 1 the certificates are the start queries of 1 to k and the step
query; the start query of k alone says nothing about shorter runs. The second solver re-checks every text before the verdict is Proved.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import inf

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import Bool, BoolVar, Expr, NumVar, Var, all_of
from safeloc.language.spec import Goal
from safeloc.language.system import environment, in_range
from safeloc.language.terms import Substitution, conjuncts
from safeloc.language.verdict import Proved, Unknown, Verdict
from safeloc.proof.provers.facts import about
from safeloc.proof.provers.further_assumption import nothing_begins
from safeloc.proof.provers.implication import Failure, Refuted, Undecided, unproved
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.proved_base import Base, base
from safeloc.proof.provers.recheck import INDUCTION_OF_ONE_GOAL, UNCONFIRMED, certify, confirmed_by
from safeloc.proof.provers.relevance import relevance

_SHOWN = 12
"""Variables of a counterexample to induction that are named; those that are 0 or false are left out."""
_NOTHING = ("0", "false")
_SOON_S = 1.0
"""Seconds of effort for a question of a composition with what is known of the machines alone that the claim reads: it suffices for most."""


def kinduction(goal: Goal, limits: Limits) -> Verdict:
    """Return Proved, Vacuous or Unknown; this engine finds no violations.

    The invariant is the base and the goal; for k > 1 it is inductive over k steps, not over one. The re-check gets the same
    time limit again.
    """
    known, ends = base(goal.original, seconds=limits.seconds), deadline(limits.seconds)
    for asked, seconds in _of_composition(goal, known) if goal.original.parts else ():
        if not any(unproved(one, min(seconds, ends.left), limits.seed) for one in asked):
            return _proved(goal, known, 1, asked, limits.recheck_seconds)
    starts: list[Query[str]] = []
    failed: dict[str, Failure] = {}
    for k in range(1, limits.induction + 1):
        start, later = queries(goal, known, k)
        starts.append(start)
        failed = unproved(start, ends.left, limits.seed)
        if failed:
            return Unknown(f"k = {k}, start: {next(iter(failed.values()))}", k - 2)
        failed = unproved(later, ends.left, limits.seed)
        if not failed:
            return _proved(goal, known, k, (*starts, later), limits.recheck_seconds)
        undecided = [str(why) for why in failed.values() if isinstance(why, Undecided)]
        if undecided:
            return Unknown(f"k = {k}: {undecided[0]}", k - 1)
    why = f"not {limits.induction}-inductive with the proved ranges and lemmas{_for_example(goal, failed)}"
    return Unknown(why, limits.induction - 1)


def _of_composition(goal: Goal, known: Base) -> Iterator[tuple[tuple[Query[str], ...], float]]:
    """Yield questions of which each is a proof, with the seconds of effort for it: what is known of few machines suffices for most claims."""
    head = about(goal.original, "implied", property=goal.prop.name)
    name = f"{goal.original.name} {goal.prop.name} of every state"
    implied = Query(name, given_facts(goal, known), {"good": goal.good}, head)
    if not goal.observers:
        yield (_relevant(goal, implied),), _SOON_S
    start, later = queries(goal, known, 1)
    yield (_relevant(goal, start), _relevant(goal, later)), _SOON_S
    if not goal.observers:
        yield (implied,), inf


def _relevant(goal: Goal, query: Query[str]) -> Query[str]:
    """Return the query with the hypotheses alone that read no other machines of a composition than its goals do."""
    return replace(query, hypotheses=relevance(goal.original).select(query.hypotheses, query.goals.values()))


def _for_example(goal: Goal, failed: Mapping[str, Failure]) -> str:
    """Return words on a counterexample to induction: a state that keeps all that is proved, some good steps before a bad one."""
    example = next((why.example for why in failed.values() if isinstance(why, Refuted)), None)
    if example is None:
        return ""
    shown = {var.name: example[var.name] for var in goal.original.state if example.get(var.name, "0") not in _NOTHING}
    most = list(shown.items())[:_SHOWN]
    more = f" and {len(shown) - len(most)} more" if len(shown) > len(most) else ""
    values = ", ".join(f"{name} = {value}" for name, value in most) or "all 0 or false"
    return (
        f": good steps from a state with {values}{more} lead to a bad one. If no run comes to such a state, a lemma that "
        "excludes it makes the proof; if one does, a search with more --depth or --seconds finds it"
    )


def _proved(goal: Goal, known: Base, k: int, texts_of: tuple[Query[str], ...], seconds: float) -> Verdict:
    empty = nothing_begins(goal, seconds)
    if empty is not None:
        return empty
    before = list(known.certificates)
    made = [certify(query, seconds=seconds, relies_on=before, one_goal=INDUCTION_OF_ONE_GOAL) for query in texts_of]
    if any(one.undecided for one in made):
        return Unknown(f"proved by {k}-induction in z3, but {UNCONFIRMED}", k - 1)
    texts = {**known.certificates, **{one.file: one.text for one in made}}
    invariant = all_of([*given_facts(goal, known), _wanted(goal)])
    return Proved(invariant, f"{k}-induction", k, confirmed_by(texts), texts)


def given_facts(goal: Goal, known: Base) -> list[Bool]:
    """Return the usable facts of the base: all, or only those without assumption for an unconditional property."""
    return list(known.always.values()) if goal.prop.unconditional else known.everything


def _wanted(goal: Goal) -> Bool:
    return all_of([goal.good, goal.helper, in_range(goal.observers)])


def queries(goal: Goal, known: Base, k: int) -> tuple[Query[str], Query[str]]:
    """Return the start query and the step query, with one goal for each conjunct.

    start  `good` holds in the first k states
    step   k good states are followed by a good one
    """
    name = f"{goal.original.name} {goal.prop.name}"
    kept = [] if goal.prop.unconditional else list(known.kept.values())
    states, allowed = _unrolled(goal, kept, k)
    hold = [state.bool(_wanted(goal)) for state in states]
    given = given_facts(goal, known)
    facts = [state.bool(term) for state in states[:-1] for term in given]
    first = [goal.system.init, in_range(goal.system.state), *given, *allowed[:-1]]
    early = {key: part for step in range(k) for key, part in _parts(f"good after {step} steps", hold[step])}
    late = dict(_parts("good after the last step", hold[k]))
    later = [*facts, *allowed, *hold[:k]]
    start, step = (
        about(goal.original, f"induction {when}", property=goal.prop.name, k=k) for when in ("start", "step")
    )
    return Query(f"{name} start", first, early, start), Query(f"{name} step", later, late, step)


def _parts(name: str, term: Bool) -> list[tuple[str, Bool]]:
    parts = list(conjuncts(term))
    return [(name if len(parts) == 1 else f"{name}, part {number}", part) for number, part in enumerate(parts, 1)]


def _unrolled(goal: Goal, kept: Sequence[Bool], k: int) -> tuple[list[Substitution], list[Bool]]:
    """Return states 0 to k as substitutions over state 0 and the inputs, and the condition on each step."""
    system = goal.system
    environment_ = all_of([environment(system), *kept])
    now: dict[Var, Expr] = {}
    states, allowed = [Substitution(now)], []
    for number in range(k):
        inputs: dict[Var, Expr] = {var: numbered_input(var, number) for var in system.inputs} if number else {}
        step = Substitution({**now, **inputs})
        allowed.append(step.bool(environment_))
        now = {var: step(term) for var, term in system.next.items()}
        states.append(Substitution(now))
    return states, allowed


def numbered_input(var: Var, number: int) -> NumVar | BoolVar:
    """Return the variable of a query that stands for an input in step `number`, from 1; that of step 0 is the input itself."""
    return replace(var, name=f"{var.name}@{number}")
