"""Units: the same only where dimension and scale agree; products carry theirs."""

from __future__ import annotations

from fractions import Fraction

import pytest

from safeloc.language.units import (
    CM,
    COUNT,
    MM,
    MM_PER_M,
    MM_S,
    MM_S2,
    MS,
    NAMED_UNITS,
    NM,
    NM_PER_UM,
    ONE,
    PER_MILLE,
    PPM,
    UM,
    US_PER_MS,
    US_PER_S,
    Enumeration,
    M,
    S,
    Unit,
    per,
)


@pytest.mark.parametrize(
    ("left", "right", "product"),
    [
        (MM_S, S, MM),
        (MM_S, MS, UM),
        (MM_S2, S, MM_S),
        (MM, PPM, NM),
        (MM, ONE, MM),
        (M, PER_MILLE, MM),
        (ONE, ONE, ONE),
    ],
    ids=lambda unit: str(unit.name),
)
def test_a_product_gets_its_name(left: Unit, right: Unit, product: Unit) -> None:
    """A product has the table's unit of its dimension and scale, if there is one, in either order of the factors."""
    assert left.times(right) is product
    assert right.times(left) is product


def test_a_product_without_a_name_is_exact() -> None:
    """An area in square millimetres is no unit of the table; dimension and scale are kept."""
    area = MM.times(MM)
    assert (area.name, area.dimension, area.scale) == ("mm*mm", (2, 0, 0), Fraction(1, 10**6))
    assert area not in NAMED_UNITS


def test_the_table_holds_distinct_units() -> None:
    """No two named units are the same, so no two names mean one quantity."""
    for number, unit in enumerate(NAMED_UNITS):
        assert [other.name for other in NAMED_UNITS[number + 1 :] if unit.same(other)] == []
    assert len({unit.name for unit in NAMED_UNITS}) == len(NAMED_UNITS)


def test_scale_and_dimension_both_count() -> None:
    """mm is not cm, a count is not a plain number, and the name plays no part."""
    assert not MM.same(CM)
    assert not COUNT.same(ONE)
    assert Unit("millimetre", length=1, scale=Fraction(1, 1000)).same(MM)


def test_enumerations_are_compared_by_name_and_members() -> None:
    """The same name with other members is another enumeration; a unit is none."""
    colours = Enumeration("colour", ("red", "green"))
    assert colours.same(Enumeration("colour", ("red", "green")))
    assert not colours.same(Enumeration("colour", ("green", "red")))
    assert not colours.same(ONE)
    assert not ONE.same(colours)
    assert colours.index("green") == 1
    with pytest.raises(ValueError, match=r"blue|not in tuple"):
        colours.index("blue")


def test_how_many_of_a_unit_make_a_larger_one() -> None:
    """Exact, by their scales; what is no whole number, or of another dimension, is refused."""
    assert (1_000_000, 1_000, 1_000) == (per(NM, MM), per(UM, MM), per(MS, S))
    assert (NM_PER_UM, MM_PER_M, US_PER_MS, US_PER_S) == (1_000, 1_000, 1_000, 1_000_000)
    for small, large in ((MM, NM), (MM, S), (CM, MM_S)):
        with pytest.raises(ValueError, match=f"one {large.name} is no whole number of {small.name}$"):
            per(small, large)
