"""Outputs that are absent in some states: what stands in for them, what a wire hears, and what a reader is told."""

from __future__ import annotations

import re

import pytest

from safeloc.errors import ModelError
from safeloc.language.absence import (
    NO_BOUND,
    NO_PLACE,
    shown_if,
    stand_in_of,
    stand_ins,
    value_while_present,
    without_absent,
    zero_while_absent,
)
from safeloc.language.expr import FALSE, TRUE, Lit, boolean, ite, number
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import INT64_MAX, INT64_MIN
from safeloc.language.system import lower
from safeloc.language.units import MM

NM_PER_MM = 1_000_000
VALID, PLACE = boolean("valid"), number("place_mm", MM, -9, 9)
(ON,) = modes("ON")
KEPT, KNOWN = number("kept_mm", MM, -9, 9), boolean("known")
GATE = lower(
    Machine(
        name="gate",
        modes=[ON],
        inputs=[VALID, PLACE],
        state={KEPT: 0, KNOWN: False},
        outputs={"position_mm": shown_if(KNOWN, KEPT, NO_PLACE), "age_mm": ite(KNOWN, KEPT, 0), "known_now": KNOWN},
        transitions=[Transition("take", ON, ON, set={KEPT: PLACE, KNOWN: VALID})],
    )
)


def test_a_stand_in_stands_in_while_the_output_is_absent() -> None:
    """Its own value otherwise, also where that is 0."""
    steps = run(GATE, [{"valid": False, "place_mm": 4}, {"valid": True, "place_mm": 0}]).steps
    assert [NO_PLACE, 0] == [step.outputs["position_mm"] for step in steps]


def test_a_reader_is_told_that_it_is_absent() -> None:
    """None for what is absent, and for nothing else."""
    absent, there = run(GATE, [{"valid": False, "place_mm": 4}, {"valid": True, "place_mm": 4}]).steps
    assert {"position_mm": NO_PLACE} == stand_ins(GATE)
    assert {"position_mm": None, "age_mm": 0, "known_now": False} == without_absent(absent.outputs, stand_ins(GATE))
    assert there.outputs == without_absent(there.outputs, stand_ins(GATE))


def test_a_wire_hears_nothing_as_0() -> None:
    """An output that is always there is heard as it is."""
    shown = shown_if(VALID, PLACE, NO_PLACE)
    assert repr(ite(VALID, PLACE, 0)) == repr(zero_while_absent(shown))
    assert PLACE is zero_while_absent(PLACE)
    assert repr(Lit(0, MM)) == repr(zero_while_absent(shown_if(FALSE, PLACE, NO_PLACE)))
    assert PLACE is value_while_present(shown) is value_while_present(PLACE)


def test_what_may_be_absent_is_known_by_what_stands_in() -> None:
    """No other choice is taken for an output that may be absent; one that always is, is."""
    assert stand_in_of(ite(VALID, PLACE, 0)) is None
    assert stand_in_of(PLACE) is stand_in_of(VALID) is None
    assert [NO_BOUND, NO_PLACE] == [
        stand_in_of(shown_if(VALID, PLACE, NO_BOUND)),
        stand_in_of(shown_if(FALSE, PLACE, NO_PLACE)),
    ]
    assert stand_in_of(shown_if(TRUE, PLACE, NO_PLACE)) is None


@pytest.mark.parametrize(
    ("low", "high", "stand_in", "message"),
    [
        (-9, 9, 0, "0 is no stand-in number; use one of [-2000000000000, 4000000000000]."),
        (
            NO_PLACE, 0, NO_PLACE,
            "-2000000000000 stands in for an absent output, but this output may have that value itself "
            "(-2000000000000..0); narrow the ranges of the variables it reads.",
        ),
    ],
)  # fmt: skip
def test_a_stand_in_that_could_be_a_value_is_refused(low: int, high: int, stand_in: int, message: str) -> None:
    """With file and line."""
    with pytest.raises(ModelError, match=rf"^\S*test_absence\.py:\d+: {re.escape(message)}$"):
        shown_if(VALID, number("far_mm", MM, low, high), stand_in)


def test_together_they_are_an_interval_that_holds_everything() -> None:
    """Whoever forgets to ask gets no place of a line, no tolerable margin, no interval that excludes one, no overflow in nm."""
    farthest_mm = 10_000_000_000  # the greatest position limit of any configuration
    assert NO_PLACE < -farthest_mm
    assert NO_PLACE - NO_BOUND < -farthest_mm < farthest_mm < NO_PLACE + NO_BOUND
    assert INT64_MIN < (NO_PLACE - NO_BOUND) * NM_PER_MM < (NO_PLACE + NO_BOUND) * NM_PER_MM < INT64_MAX
