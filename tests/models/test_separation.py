"""The achieved separation: what it is made of, what smaller sections bring, and that reports show it."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.config import figures
from safeloc.models.area import AreaConfig
from safeloc.models.area.separation import Following, headway_ms, separation_mm
from safeloc.models.sections import SectionsConfig

AREA = AreaConfig()
BARE = Following(section_mm=0, accuracy_mm=0, delivery_ms=0, reaction_ms=0)


def test_every_part_is_in_it() -> None:
    """Braking, the cycle and the age of a report always; each other figure by what it says."""
    braking = -(-(44_445**2) // 1_400)
    assert braking + 44_445 + 2 * 44_445 == separation_mm(AREA, BARE)
    assert 44_445 == separation_mm(AREA, BARE.model_copy(update={"delivery_ms": 1_000})) - separation_mm(AREA, BARE)
    for figure in ("section_mm", "accuracy_mm"):
        longer = BARE.model_copy(update={figure: 7_000})
        assert 7_000 == separation_mm(AREA, longer) - separation_mm(AREA, BARE)
    fresh = AREA.model_copy(update={"report_age_limit_ms": 0})
    assert 2 * 44_445 == separation_mm(AREA, BARE) - separation_mm(fresh, BARE)


@pytest.mark.parametrize("change", [{"speed_mm_s": 10_000}, {"brake_mm_s2": 1_400}, {"reaction_ms": 0}])
def test_slower_better_braked_and_quicker_trains_come_closer(change: dict[str, int]) -> None:
    """Each by itself."""
    usual = Following()
    assert separation_mm(AREA, usual.model_copy(update=change)) < separation_mm(AREA, usual)


def test_nothing_is_rounded_down() -> None:
    """One millimetre a second and one millisecond still count."""
    slow = BARE.model_copy(update={"speed_mm_s": 1})
    area = AREA.model_copy(update={"period_ms": 10, "report_age_limit_ms": 0})
    assert 2 == separation_mm(area, slow)
    assert headway_ms(area, slow) == (2 + slow.train_mm) * 1_000


def test_small_sections_approach_moving_block() -> None:
    """What is left is what the sections do not make."""
    config = SectionsConfig(following=Following(section_mm=100_000))
    assert 100_000 == config.separation_mm - config.moving_block_separation_mm
    assert config.headway_ms == headway_ms(config.area, config.following)


def test_reports_show_it_with_its_unit() -> None:
    """Beside the figures that it follows from."""
    shown = {row["name"]: row for row in figures(SectionsConfig())}
    assert ("2262086", "mm") == (shown["separation_mm"]["value"], shown["separation_mm"]["unit"])
    assert shown["headway_ms"]["source"].startswith("follows from the figures above: [D]")
    assert "following.section_mm" in shown


@pytest.mark.parametrize(
    ("told_mm", "section_mm"),
    [("2 km", 2_000_000), ("500 m", 500_000), ("100 m", 100_000), ("10 m", 10_000), ("0:", 0)],
)
def test_the_documented_table_is_computed(told_mm: str, section_mm: int) -> None:
    """Rounded to metres and tenths of seconds."""
    page = (Path(__file__).parents[2] / "docs" / "sections.md").read_text(encoding="utf-8")
    (row,) = [line for line in page.splitlines() if line.startswith(f"| {told_mm}")]
    config = SectionsConfig(following=Following(section_mm=section_mm))
    _, separation, headway = row.strip("| ").split(" | ")
    assert f"{config.separation_mm / 1_000:,.0f} m".replace(",", " ") == separation
    assert f"{config.headway_ms / 1_000:.1f} s" == headway
