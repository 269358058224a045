"""A proof about no run is not called a proof: contradictory further assumptions, assumptions that end, wrong
declarations.
"""

from __future__ import annotations

import pytest

from safeloc.errors import PropertyError, UnitError
from safeloc.language.expr import FALSE, Bool, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import NO_ASSUMPTION, Property, always, never
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Held, Proved, Unknown, Vacuous, Violated
from safeloc.language.world import World
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.testing import run_tests

A, B = modes("A", "B")
X, N = number("x", COUNT, 0, 10), number("n", COUNT, 0, 20)
GATE = Machine("gate", (A, B), [X], {}, {}, [Transition("go", A, B, X > 5), Transition("back", B, A, X < 3)])
NEVER_B = GATE.mode.eq(B)


@pytest.mark.parametrize("further", [(X > 5) & (X < 5), FALSE], ids=["contradiction", "false"])
def test_a_contradictory_further_assumption_proves_nothing(further: Bool) -> None:
    """Steps that cannot exist give neither a proof nor a test."""
    prop = never("b", NEVER_B, further_assumption=further)
    (proof,) = prove(lower(GATE), [prop], Limits())
    assert isinstance(proof.result, Vacuous)
    assert "no run satisfies the further assumption" in proof.result.reason
    (tested,) = run_tests(lower(GATE), [prop], examples=5, steps=10, seed=0)
    assert isinstance(tested.result, Unknown)
    assert "nothing was tested" in tested.result.reason


def test_a_further_assumption_is_reported() -> None:
    """The reported assumption is never `none` if the property relies on one."""
    assert NO_ASSUMPTION == never("b", NEVER_B, unconditional=True).relies_on
    free = never("b", NEVER_B, further_assumption=X <= 5, unconditional=True)
    assert "further assumption in every step: (<= x 5)" == free.relies_on
    assert (
        "dry rails; further assumption in every step: (<= x 5)"
        == never("b", NEVER_B, further_assumption=X <= 5, assumption="dry rails").relies_on
    )
    (proof,) = prove(lower(GATE), [free], Limits())
    (tested,) = run_tests(lower(GATE), [free], examples=5, steps=10, seed=0)
    assert isinstance(proof.result, Proved)
    assert isinstance(tested.result, Held)
    assert free.relies_on == proof.assumption == tested.assumption


def _counting(limit: int) -> Machine:
    moves = [Transition("up", A, A, N < 20, {N: N + 1})]
    return Machine(
        "counting",
        (A, B),
        [X],
        {N: 0},
        {},
        moves,
        world=World(clauses={"assumption": N < limit}, reads_machine="the test asks it"),
    )


def test_an_assumption_that_ends_is_found() -> None:
    """A run without any lawful next step is shown: no proof covers what comes after it."""
    (last,) = [f for f in obligations(lower(_counting(7)), Limits()) if f.id.endswith("assumption lasts")]
    assert isinstance(last.result, Violated)
    assert last.result.trace is not None
    assert 7 == len(last.result.trace.steps)
    assert "after these 7 steps no inputs satisfy the assumption" in last.result.reason
    (lasting,) = [f for f in obligations(lower(_counting(21)), Limits()) if f.id.endswith("assumption lasts")]
    assert isinstance(lasting.result, Proved)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"name": ""}, "a name has 1 to 120 printable characters"),
        ({"name": "two\nlines"}, "a name has 1 to 120 printable characters"),
        ({"name": "n" * 121}, "a name has 1 to 120 printable characters"),
        ({"kind": "allways"}, "kind 'allways' is none of always, within, reachable"),
        ({"term": True}, "its term is True, not a truth-valued term"),
        ({"further_assumption": 1}, "its further assumption is 1, not a truth-valued term"),
        ({"steps": -3}, "steps is -3; give a whole number, 0 or more"),
        ({"steps": 1.5}, r"steps is 1\.5; give a whole number"),
    ],
)
def test_misdeclared_properties_are_refused(wrong: dict[str, object], message: str) -> None:
    """Every way to make a property refuses a wrong declaration, with its place."""
    fields: dict[str, object] = {"name": "p", "kind": "within", "term": NEVER_B, **wrong}
    with pytest.raises(PropertyError, match=rf"test_empty\.py:\d+: property .*: .*{message}"):
        Property(**fields)  # type: ignore[arg-type]


def test_a_bare_truth_value_is_refused_by_name() -> None:
    """The messages for `always("p", True)` and `never("p", True)` say what to write instead."""
    for make in (always, never):
        with pytest.raises(
            PropertyError, match="its term is True, not a truth-valued term; write TRUE or FALSE for a constant"
        ):
            make("p", True)  # type: ignore[arg-type]


def test_numbers_that_are_no_member_are_refused() -> None:
    """A comparison with a number outside the enumeration is a mistake, and is refused."""
    with pytest.raises(UnitError, match=r"7 is no member of enumeration mode: A, B\."):
        GATE.mode.eq(7)


def test_no_name_of_a_property_is_taken_by_the_base() -> None:
    """Certificates are named by their content, so a property may have the name of a part of the base."""
    [finding] = prove(lower(GATE), [never("always", NEVER_B, further_assumption=X <= 5)], Limits())
    assert isinstance(finding.result, Proved)
    assert len(finding.result.certificates) == 6  # base and property, start and step; that it lasts, and by what inputs
