"""A confidence interval: worked figures, on both sides of each limit, since claims and machines share these terms."""

from __future__ import annotations

import pytest

from safeloc.language.expr import Bool, Num, as_num
from safeloc.language.interpret import evaluate
from safeloc.language.units import MM, NM
from safeloc.models.vocabulary.interval import Interval

MM_NM = 1_000_000


def nm(position_nm: int, above_nm: int, below_nm: int) -> Interval:
    """An interval with a position in nm."""
    return Interval(as_num(position_nm, NM), as_num(above_nm, NM), as_num(below_nm, NM))


def mm(position_mm: int, above_nm: int, below_nm: int) -> Interval:
    """An interval with a position in mm."""
    return Interval(as_num(position_mm, MM), as_num(above_nm, NM), as_num(below_nm, NM))


def value(term: Num | Bool) -> int | bool:
    """The value of a term of constants."""
    [found] = evaluate([term], {})
    return found


def figures(interval: Interval) -> tuple[int, int, int]:
    """Position and margins."""
    position, above, below = evaluate([interval.position, interval.above, interval.below], {})
    return int(position), int(above), int(below)


@pytest.mark.parametrize("interval", [nm(5 * MM_NM, 30, 20), mm(5, 30, 20)], ids=["nm", "mm"])
def test_its_ends(interval: Interval) -> None:
    """The upper end is the position and the margin above, the lower end the position less the margin below."""
    ends = [value(term) for term in (interval.low, interval.high, interval.margin, interval.width)]
    assert [4_999_980, 5_000_030, 30, 50] == ends


@pytest.mark.parametrize(
    ("position_nm", "meets", "overlap_nm"),
    [(149, True, 1), (150, True, 0), (151, False, -1), (50, True, 0), (49, False, -1), (100, True, 50)],
)
def test_intervals_meet_where_they_touch(position_nm: int, meets: bool, overlap_nm: int) -> None:
    """[80, 130] and one that reaches from 20 below its position to 30 above: a gap of one nanometre is a gap."""
    one, other = nm(100, 30, 20), nm(position_nm, 30, 20)
    assert overlap_nm == value(one.overlap(other))
    assert (meets, meets) == (value(one.meets(other)), value(other.meets(one)))


@pytest.mark.parametrize(("truth_nm", "held"), [(79, False), (80, True), (130, True), (131, False)])
def test_both_ends_belong_to_it(truth_nm: int, held: bool) -> None:
    """The truth may be at an end."""
    assert held is value(nm(100, 30, 20).holds(as_num(truth_nm, NM)))


@pytest.mark.parametrize(
    ("position_mm", "above_nm", "below_nm", "within"),
    [
        (9, 500, 500, True),
        (9, 501, 500, False),
        (9, 500, 501, False),
        (10, 0, 0, True),
        (11, 0, 0, False),
        (-10, 0, 0, True),
        (-11, 0, 0, False),
    ],
)
def test_each_margin_is_within_the_tolerance(position_mm: int, above_nm: int, below_nm: int, within: bool) -> None:
    """Both margins up to the tolerance, and the position up to the end of the line on either side."""
    assert within is value(mm(position_mm, above_nm, below_nm).within(500, 10))


@pytest.mark.parametrize(
    ("position_nm", "margin_nm", "usable"),
    [
        (0, 4 * MM_NM, True),
        (0, 4 * MM_NM + 1, False),
        (10 * MM_NM, 0, True),
        (10 * MM_NM + 1, 0, False),
        (-10 * MM_NM - 1, 0, False),
    ],
)
def test_a_usable_margin_leaves_one_millimetre_for_rounding(position_nm: int, margin_nm: int, usable: bool) -> None:
    """Of a tolerance of 5 mm the rounding of the position takes one; the greater margin counts."""
    for interval in (nm(position_nm, margin_nm, 0), nm(position_nm, 0, margin_nm)):
        assert usable is value(interval.usable(5, 10))


def test_it_is_carried() -> None:
    """A measured distance moves the estimate, and its error widens both margins."""
    assert (100, 37, 27) == figures(nm(100, 30, 20).widened(7))
    assert (3_000_100, 37, 27) == figures(nm(100, 30, 20).moved(as_num(3, MM), as_num(7, NM)))
    assert (8, 37, 27) == figures(mm(5, 30, 20).moved(as_num(3, MM), as_num(7, NM)))


@pytest.mark.parametrize(
    ("fix", "narrowed"),
    [
        ((120, 5, 5), (120, 5, 5)),  # inside: the fix
        ((135, 25, 25), (130, 0, 20)),  # [80, 130] and [110, 160]: both estimates have their greater margin below
        ((100, 99, 99), (100, 30, 20)),  # all around: the interval itself
        ((60, 25, 25), (80, 5, 0)),  # [80, 130] and [35, 85]
    ],
)
def test_what_two_intervals_have_in_common(fix: tuple[int, int, int], narrowed: tuple[int, int, int]) -> None:
    """Neither end moves outward; the estimate is the one that has the smaller margin in what is left."""
    assert narrowed == figures(nm(100, 30, 20).narrowed(nm(*fix)))
