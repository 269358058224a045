"""Laws that several worlds state alike: the highest speed, the line, and what a stated interval holds, to the last unit."""

from __future__ import annotations

import pytest

from safeloc.catalogue import load_target
from safeloc.language.expr import number
from safeloc.language.interpret import holds
from safeloc.language.units import MM, NM
from safeloc.models.vocabulary.vehicle_world import (
    SPEED,
    line_law,
    speed_law,
    stated_interval_holds,
)

RAN, TRUTH = number("ran_nm", NM, -10_000, 10_000), number("truth_nm", NM, -5_000, 5_000)
WITH_SPEED = ("odometry", "route", "transmission", "localizer")


@pytest.mark.parametrize("name", WITH_SPEED)
def test_the_highest_speed_is_one_law(name: str) -> None:
    """Sentence, source and owner are those of the shared law in every machine that has it."""
    found = [
        law for machine in load_target(name).machines for law in [machine.world.laws.get(SPEED)] if law is not None
    ]
    expected = speed_law(RAN, 10)
    assert found
    for law in found:
        assert (law.statement, law.source, law.owner, law.check) == (
            expected.statement,
            expected.source,
            expected.owner,
            expected.check,
        )


@pytest.mark.parametrize(("ran", "lawful"), [(-11, False), (-10, True), (0, True), (10, True), (11, False)])
def test_no_faster_than_the_highest_speed(ran: int, lawful: bool) -> None:
    """The run at the highest speed is allowed, either way; one nanometre more is not."""
    assert holds(speed_law(RAN, 10).term, {RAN: ran}) is lawful


@pytest.mark.parametrize(("after", "lawful"), [(-5_001, False), (-5_000, True), (5_000, True), (5_001, False)])
def test_no_farther_than_the_line(after: int, lawful: bool) -> None:
    """The coordinates end where the range of the true place ends."""
    assert holds(line_law(TRUTH, RAN).term, {RAN: after}) is lawful


@pytest.mark.parametrize(
    ("truth_nm", "inside"), [(7_999_999, False), (8_000_000, True), (13_000_000, True), (13_000_001, False)]
)
def test_a_stated_interval_holds_what_lies_between_its_ends(truth_nm: int, inside: bool) -> None:
    """10 mm, 2 mm below and 3 mm above: from 8 mm to 13 mm, ends included, to the nanometre."""
    place, below, above = (number(name, MM, 0, 100) for name in ("place_mm", "below_mm", "above_mm"))
    truth = number("true_place_nm", NM, -(10**9), 10**9)
    term = stated_interval_holds(place, below, above, truth)
    assert holds(term, {place: 10, below: 2, above: 3, truth: truth_nm}) is inside
