"""Pictures of tubes: a few very wide cycles are cut off, and told, so that the others can be seen."""

from __future__ import annotations

from safeloc.report.around import deviation_picture, tube_picture

RECORDED = [10.0 * cycle for cycle in range(101)]


def picture(wide: dict[int, float]) -> str:
    """A tube of ±2 around what was recorded, and wider in some cycles."""
    upper = [at + wide.get(cycle, 2.0) for cycle, at in enumerate(RECORDED)]
    lower = [at - 2.0 for at in RECORDED]
    return deviation_picture("place_mm", "mm", RECORDED, (lower, upper))


def test_an_even_tube_is_drawn_as_it_is() -> None:
    assert "cut off" not in picture({})
    assert "cut off" not in picture({40: 5.9})


def test_single_wide_cycles_are_cut_off_and_told() -> None:
    drawn = picture({40: 5_000.0, 41: 90.0})
    assert "cut off at ±6 mm in 2 cycles; widest in cycle 40: +5000 mm" in drawn
    assert drawn.count("000 mm") == 1


def test_one_that_widens_for_long_is_no_exception() -> None:
    """What a fifth of the cycles reaches is shown."""
    assert "cut off" not in picture(dict.fromkeys(range(80, 101), 500.0))


def test_nothing_known_is_no_picture() -> None:
    nothing: list[float | None] = [None] * 101
    assert deviation_picture("place_mm", "mm", RECORDED, (nothing, nothing)) != ""
    assert tube_picture("place_mm", "mm", nothing, (nothing, nothing)) == ""
