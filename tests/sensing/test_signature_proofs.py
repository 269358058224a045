"""Shapes of models, proved for all measured places: two corners of a reflector never stand for two of another model (RFL-10)."""

from __future__ import annotations

from itertools import combinations, permutations

import pytest

from safeloc.codegen.smtlib import Query, to_smtlib
from safeloc.language.expr import FALSE, Bool, Num, abs_, all_of, any_of, number
from safeloc.language.units import MM
from safeloc.proof.provers.implication import Refuted, unproved
from safeloc.proof.provers.recheck import recheck
from safeloc.sensing.signature import MARKS, Model
from tests.sensing.scenes import CONFIG

UNIT, TOLERANCE = CONFIG.reflectors.unit_mm, CONFIG.reflectors.mark_tolerance_mm
MOST_WRONG = (UNIT - 2 * TOLERANCE) // 2 - 1
"""The greatest error of a corner's measured place along the track, mm, with which no two corners can be mistaken."""
PLACES = [number(f"measured_{corner}_mm", MM, -(10**9), 10**9) for corner in range(3)]
FIRST = number("first_corner_mm", MM, -(10**9), 10**9)


def taken_for(model: Model) -> Bool:
    """The three measured places have the shape of the model, as the front end judges it: each from the nearest one."""
    nearest, *farther = PLACES
    marks = zip(farther, MARKS[model][1:], strict=True)
    return all_of(abs_(place - (nearest + mark * UNIT)) <= TOLERANCE for place, mark in marks)


def comes_from(place: Num, model: Model, corner: int, wrong_mm: int) -> Bool:
    """The measured place is that of a corner of a reflector of the model, the first corner of which stands at `FIRST`."""
    return abs_(place - (FIRST + MARKS[model][corner] * UNIT)) <= wrong_mm


def two_of(model: Model, wrong_mm: int) -> Bool:
    """Two of the three measured places are those of two corners of one reflector of the model, whichever."""
    return any_of(
        comes_from(PLACES[one], model, left, wrong_mm) & comes_from(PLACES[other], model, right, wrong_mm)
        for one, other in combinations(range(3), 2)
        for left, right in permutations(range(3), 2)
    )


OTHERS = list(permutations(MARKS, 2))
"""A model that stands there, and another one."""


@pytest.mark.parametrize(("there", "shown"), OTHERS, ids=str)
def test_two_corners_of_a_reflector_make_no_other_model(there: Model, shown: Model) -> None:
    """For all places and errors up to the greatest: proved by z3, confirmed by a second solver. So two corners have to be wrong."""
    query = Query("two corners", [two_of(there, MOST_WRONG), taken_for(shown)], {"impossible": FALSE})
    assert {} == unproved(query, 30)
    assert ["unsat"] == recheck("corners.smt2", to_smtlib(query), 1)


@pytest.mark.parametrize("model", MARKS)
def test_a_reflector_can_show_its_own_model(model: Model) -> None:
    """What is assumed can be met: with the same errors its own three corners may have its shape."""
    own = all_of(comes_from(place, model, corner, MOST_WRONG) for corner, place in enumerate(PLACES))
    assert isinstance(unproved(Query("own", [own, taken_for(model)], {"impossible": FALSE}), 30)["impossible"], Refuted)


def test_the_greatest_error_is_no_smaller_than_it_seems() -> None:
    """2 mm more, and two corners of some reflector may have the shape of another model."""
    farther = [two_of(there, MOST_WRONG + 2) & taken_for(shown) for there, shown in OTHERS]
    assert isinstance(unproved(Query("farther", [any_of(farther)], {"impossible": FALSE}), 30)["impossible"], Refuted)


def test_one_corner_alone_may_be_any_models() -> None:
    """Of one corner nothing is claimed: with two foreign echoes it may look like any model."""
    for there, shown in OTHERS:
        one = any_of(comes_from(place, there, corner, 0) for place in PLACES for corner in range(3))
        assert isinstance(
            unproved(Query("one", [one, taken_for(shown)], {"impossible": FALSE}), 30)["impossible"], Refuted
        )
