"""Witness functions: from one state with lawful inputs to terms that are lawful in many states."""

from __future__ import annotations

import pytest

from safeloc.language.expr import (
    Bool,
    Expr,
    NumVar,
    between,
    boolean,
    floor_div,
    ite,
    maximum,
    minimum,
    number,
    optional,
)
from safeloc.language.interpret import evaluate, holds
from safeloc.language.nodes import Value
from safeloc.language.system import in_range
from safeloc.language.terms import Substitution
from safeloc.language.units import COUNT
from safeloc.language.verdict import Proved
from safeloc.proof.provers.cover import Cover, Group, Learned, cover_facts
from safeloc.proof.provers.dead_ends import lasts
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.witness_functions import Generalisation, at_rest
from tests.proof.provers.seeded_dead_ends import SEEDS

S, T = number("s", COUNT, -50, 50), number("t", COUNT, -50, 50)
X, Y, ON = number("x", COUNT, -90, 90), number("y", COUNT, 3, 90), boolean("on")


def rule(condition: Bool, state: dict[NumVar, int], inputs: dict[Expr, Value]) -> dict[Expr, Expr]:
    """The witness function made from lawful inputs in one state."""
    free = [X, Y, ON]
    made = Generalisation(condition, free).witness(dict(state), {**at_rest(free), **inputs}, eager=True)  # type: ignore[dict-item]
    return dict(made)


def test_at_rest_nothing_is_told_and_numbers_are_near_zero() -> None:
    """Optional inputs are absent, and three is the value of the range nearest to zero."""
    assert {X: 0, Y: 3, ON: False} == at_rest([X, Y, ON])


CASES = {
    "equation": (X.eq(S + 3), {X: 4}, lambda s: s + 3),
    "equation with a factor": ((X * 2).eq(S * 2 + 6), {X: 4}, lambda s: s + 3),
    "bound from above": (X <= S - 1, {X: 0}, lambda s: min(0, s - 1)),
    "bounds with factors": (between(S, X * 3, S + 2), {X: 1}, lambda s: -(-s // 3)),
    "rounded down": (floor_div(X, 4).eq(S), {X: 4}, lambda s: max(min(0, 4 * s + 3), 4 * s)),
    "the greater one": (X >= maximum(S, 5), {X: 5}, lambda s: max(s, 5)),
    "the smaller one": (minimum(X, X + 1) >= S, {X: 1}, lambda s: max(s, 0)),
    "one of two branches": (X.eq(ite(S > 0, S, S - 1)), {X: 1}, lambda s: s if s > 0 else s - 1),
    "through another input": (X.eq(Y + 1) & (Y >= S), {X: 4, Y: 3}, lambda s: max(s, 3) + 1),
}


@pytest.mark.parametrize("name", CASES)
def test_an_input_is_solved_for(name: str) -> None:
    """From the state s = 1 alone, for every s: equations give the value, bounds the one nearest to rest."""
    condition, inputs, wanted = CASES[name]
    made = rule(condition & in_range([X, Y]), {S: 1, T: 0}, dict(inputs))
    for s in range(-20, 21):
        assert [wanted(s)] == evaluate([made[X]], {S: s, T: 0}), s


def test_an_input_that_was_at_rest_stays_there_if_asked() -> None:
    """Then the other one alone follows the state: fewer states are served, by a term that reads less."""
    general = Generalisation((X + Y).eq(S + 4) & (Y >= S) & in_range([X, Y]), [X, Y])
    resting, every = (
        general.witness({S: 1, T: 0}, {X: 2, Y: 3}, eager=True, resting=resting) for resting in (True, False)
    )
    assert [evaluate([resting[X], resting[Y]], {S: s, T: 0}) for s in (1, 3, 9)] == [[2, 3], [4, 3], [10, 3]]
    assert [evaluate([every[X], every[Y]], {S: s, T: 0}) for s in (1, 3, 9)] == [[2, 3], [4, 3], [4, 9]]


def test_what_is_broken_by_a_rule_is_seen_by_the_cover() -> None:
    """If a witness function is not lawful in a state, another one is learned; if no inputs are, the result says so."""
    group = Group([X, Y, ON], X.eq(ite(S > T, S, T)) & in_range([X, Y]) & (ON | (S < 40)))
    for s, t in ((1, 2), (2, 1), (45, 1)):
        assert group.learn({S: s, T: t}, 10) is Learned.COVERED
        assert holds(group.covered, {S: s, T: t})
    impossible = Group([ON], ON & ~ON & (S < 3) | (S >= 3))
    assert impossible.learn({S: 4}, 10) is Learned.COVERED
    assert impossible.learn({S: 2}, 10) is Learned.DEAD


def test_an_absent_input_has_the_value_of_absence() -> None:
    """An absent input gets no other value."""
    told = optional("o", COUNT, 2, 9)
    group = Group([told.value, told.present], (told.present | told.value.eq(2)) & (~told.present | (told.value >= S)))
    assert group.learn({S: 5}, 10) is Learned.COVERED
    [first] = group.met
    assert [True] == evaluate([first], {S: 5})


@pytest.mark.parametrize("name", ["window", "rounded", "third_mode"])
def test_few_rules_serve_many_states(name: str) -> None:
    """A machine of a hundred states needs three witness functions at most."""
    system = SEEDS[name].make(True)
    cover = Cover(system)
    facts = [in_range(system.state)]
    for group in cover.groups:
        assert cover_facts(group, facts, deadline(30), 0) is Learned.COVERED
        assert 3 >= len(group.met)


def test_a_certificate_says_what_it_is_of_and_speaks_of_state_only() -> None:
    """Its terms read no input."""
    system = SEEDS["window"].make(True)
    verdict = lasts(system, Limits(seconds=30))
    assert isinstance(verdict, Proved)
    [text] = [text for text in verdict.certificates.values() if "; rule: lasts" in text]
    assert "|x|" in text
    assert "|k|" not in text


def test_rules_are_put_in_the_place_of_inputs() -> None:
    """The goal of each group is its condition under one of its witness functions."""
    condition = (X >= S) & in_range([X])
    group = Group([X], condition)
    assert group.learn({S: 7}, 10) is Learned.COVERED
    assert 2 == len(group.met)
    for s in (-3, 0, 7, 40):
        lawful = holds(Substitution({X: S}).bool(condition), {S: s})
        assert lawful == holds(group.met[1], {S: s})
