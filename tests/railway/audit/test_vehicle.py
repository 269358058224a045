"""The vehicle's figures: from shipped vehicles and files, with clear errors."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.errors import InputError
from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.layout_rules.marker_readers import MarkerReaders
from safeloc.railway.audit.vehicle import find_layout


def test_shipped_vehicles_have_figures() -> None:
    """Each one for itself; what it does not say is the default."""
    assert (10_000, 30_000) == (find_layout("metro").tolerance_mm, find_layout("freight-v90").tolerance_mm)
    assert LayoutConfig() == find_layout("desiro-br642")


WRONG = {
    "[localization]\ntolerance_mm = 5\n": r"v\.toml:1: localization: tolerance_mm 5 is not above odometry_constant_mm 5000",
    "[localization]\n\ntolerance = 5\n": r"v\.toml:3: localization\.tolerance: Extra inputs are not permitted \(got 5\)\.$",
    "[localization]\ntolerance_mm = '5'\n": r"v\.toml:2: localization\.tolerance_mm: Input should be a valid integer \(got '5'\)\.$",
    "length_mm = 5\n": r"v\.toml: has no table \[localization\] with the figures for the audit",
    "length_mm = \n": r"v\.toml: cannot be read: Invalid value",
}


@pytest.mark.parametrize("text", WRONG)
def test_wrong_files_are_refused(text: str, tmp_path: Path) -> None:
    """File, line and key."""
    path = tmp_path / "v.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=WRONG[text]):
        find_layout(str(path))


def test_unknown_vehicles_are_refused() -> None:
    """The message tells which there are."""
    with pytest.raises(InputError, match=r"^x: no such file, and no shipped vehicle; shipped are .*metro"):
        find_layout("x")


@pytest.mark.parametrize(
    ("figures", "told"),
    [
        (
            "vehicle_length_mm = 4_000",
            r"3: localization\.markers\.vehicle_length_mm|2: localization\.markers: vehicle_length_mm 4000",
        ),
        ("length = 4_000", r"3: localization\.markers\.length: Extra inputs are not permitted \(got 4000\)"),
        (
            "pending_markers = 9",
            r"3: localization\.markers\.pending_markers: Input should be less than or equal to 8 \(got 9\)",
        ),
    ],
)
def test_wrong_figures_of_marker_readers_are_named(tmp_path: Path, figures: str, told: str) -> None:
    """With file, line and key; the table alone gives the defaults."""
    path = tmp_path / "reader.toml"
    path.write_text("[localization]\n[localization.markers]\n", encoding="utf-8")
    assert MarkerReaders() == find_layout(str(path)).markers
    path.write_text(f"[localization]\n[localization.markers]\n{figures}\n", encoding="utf-8")
    with pytest.raises(InputError, match=rf"reader\.toml:({told})"):
        find_layout(str(path))
