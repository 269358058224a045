"""An undecided property: the state from which a good step leads to a bad one, and lemmas that exclude it."""

from __future__ import annotations

from safeloc.explain.induction import escape
from safeloc.explain.lemma_candidates import tried_lemmas
from safeloc.language.interpret import holds, step
from safeloc.language.render import infix
from safeloc.language.spec import observe
from safeloc.proof.provers.limits import Limits
from tests.explain.pump import KEPT, LATE, OPEN, target


def test_a_good_state_is_followed_by_a_bad_one() -> None:
    """The run is one of the machine's own steps: the interpreter made it, from a state that keeps the property."""
    goal = observe(target().system, OPEN)
    found = escape(goal, Limits())
    assert found is not None
    assert found.good_steps == len(found.run.steps) == Limits().induction
    state = {var: found.run.initial[var.name] for var in goal.original.state}
    goods = [holds(goal.good, state)]
    for one in found.run.steps:
        state, _ = step(goal.original, state, {var: one.inputs[var.name] for var in goal.original.inputs})
        goods.append(holds(goal.good, state))
    assert goods == [True, True, True, False]
    assert found.row == "count"


def test_nothing_leads_out_of_what_is_inductive() -> None:
    """There is no counterexample to the induction of a property that is proved by it."""
    assert escape(observe(target().system, KEPT), Limits()) is None


def test_the_lemma_that_is_missing_is_found() -> None:
    """Both numbers count the same; one bound from the other is enough, and nothing else is named."""
    tried = tried_lemmas(observe(target().system, OPEN), Limits())
    assert tried.needed is not None
    assert [infix(one) for one in tried.needed] in (["counted ≤ strokes"], ["counted = strokes"], ["strokes = counted"])
    assert tried.held >= tried.inductive >= 1


def test_no_lemma_proves_what_does_not_hold() -> None:
    """The candidates are inductive, but the property is violated."""
    tried = tried_lemmas(observe(target().system, LATE), Limits(seconds=5))
    assert tried.needed is None
    assert tried.inductive > 0
