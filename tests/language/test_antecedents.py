"""The cases that properties speak of: which there are, and in which steps they occur."""

from __future__ import annotations

import pytest

from safeloc.language.antecedents import antecedents, cases, occurs
from safeloc.language.expr import TRUE, Bool, before, boolean, number
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.monitor import NEVER, check_all
from safeloc.language.spec import Property, always, never, once, reachable, within
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Held
from safeloc.language.world import World
from safeloc.proof.provers.replayed_evidence import replayed

A, B = modes("A", "B")
X, P, Q = number("x", COUNT, 0, 10), boolean("p"), boolean("q")
GATE = Machine("gate", (A, B), [X, P, Q], {}, {}, [Transition("go", A, B, X > 5), Transition("back", B, A, X < 3)])
IN_A, IN_B = GATE.mode.eq(A), GATE.mode.eq(B)


def told(term: Bool) -> list[str]:
    """The cases of what always holds, written out."""
    return [repr(case) for case in antecedents(always("it", term))]


@pytest.mark.parametrize(
    ("term", "expected"),
    [
        (P.implies(Q), ["p"]),
        ((~P).implies(Q), ["(not p)"]),
        (P | Q, ["(not p)"]),
        (P.implies(Q) & X.eq(1).implies(P), ["p", "(== x 1)"]),
        (P.implies(Q) & (Q & (Q.implies(P) & P)), ["p", "q"]),
        (P & Q, []),
        (~(P & Q), []),
        (TRUE, []),
        (P.iff(Q), []),
        ((~P).iff(Q), []),
        (GATE.mode.one_of(A, B), []),
        (IN_A | X.eq(1), ["(not (== mode A))"]),
    ],
)
def test_what_stands_before_implies(term: Bool, expected: list[str]) -> None:
    """Of every disjunction in a conjunction the case that its first part does not hold; of `iff` and `one_of` none."""
    assert expected == told(term)


def test_triggers() -> None:
    """Of `within` the trigger; of `never` and `reachable` nothing, but of `never` what it denies of an implication."""
    assert [P] == antecedents(within("w", 3, P, Q))
    assert [] == antecedents(reachable("r", P.implies(Q)))
    assert [] == antecedents(never("n", P))
    assert ["p"] == [repr(case) for case in antecedents(never("n", ~P.implies(Q)))]


def test_a_deep_conjunction_is_no_recursion() -> None:
    """Tens of thousands of levels are walked."""
    term = P.implies(Q)
    for _ in range(30_000):
        term = term & P
    assert ["p"] == told(term)


@pytest.mark.parametrize(
    ("prop", "steps"),
    [
        (always("state", IN_A.implies(GATE.mode.ne(B))), 0),
        (always("step", IN_A.implies(P | Q | ~P)), 1),
        (within("trigger", 1, IN_A, IN_B | P), 1),
        (always("before", before(GATE.mode).eq(B).implies(P | ~P)), 2),
        (always("past", once(X > 7).implies(P | ~P)), 2),
    ],
    ids=lambda value: value.name if isinstance(value, Property) else str(value),
)
def test_where_a_case_occurs(prop: Property, steps: int) -> None:
    """A property of states sees the first one; one of steps, and `within`, only what a step comes to."""
    system = lower(GATE)
    low, high = ({"x": x, "p": False, "q": False} for x in (1, 8))
    stream = [high, high] if prop.name == "before" else [low, high]
    trace = replayed(occurs(system, cases(prop)[0], "case"), {}, stream)
    assert trace is not None
    assert steps == len(trace.steps)


def test_what_never_happened_on_a_recording_is_told() -> None:
    """What held on it stays held, with the cases that did not occur; what was seen is not named."""
    trace = run(lower(GATE), [{"x": 4, "p": True, "q": True}] * 3)
    props = [always("comes", IN_B.implies(X > 5)), always("p", P.implies(Q)), within("answer", 2, IN_B, IN_A)]
    comes, p, answer = check_all(trace, props)
    assert isinstance(comes, Held)
    assert {NEVER: "the case (mode = B)"} == comes.notes
    assert isinstance(p, Held)
    assert {} == p.notes
    assert isinstance(answer, Held)
    assert {NEVER: "its trigger (mode = B)"} == answer.notes


def test_a_case_counts_only_while_what_is_relied_on_is_kept() -> None:
    """Cases after a violation of the assumption do not count for a property that relies on it."""
    table = Machine(
        "table",
        (A, B),
        [X],
        {},
        {},
        GATE.transitions,
        world=World(clauses={"assumption": X < 9}, reads_machine="the test asks it"),
    )
    relies, free = (
        always(name, IN_B.implies(GATE.mode.ne(A)), unconditional=unconditional)
        for name, unconditional in (("relies", False), ("free", True))
    )
    assert replayed(occurs(lower(table), cases(relies)[0], "case"), {}, [{"x": 9}]) is None
    assert replayed(occurs(lower(table), cases(free)[0], "case"), {}, [{"x": 9}]) is not None
