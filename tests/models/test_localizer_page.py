"""The localizer's page: its table of what goes wrong is the catalogue's."""

from __future__ import annotations

from pathlib import Path

from safeloc.models.localizer.simulation.journeys import CASES

PAGE = Path(__file__).parents[2] / "docs" / "localizer.md"


def test_every_case_stands_on_the_page() -> None:
    """One row each, in order, with its outcome, and what cannot be detected, with its reason."""
    page = PAGE.read_text(encoding="utf-8")
    rows = [line for line in page.splitlines() if line.startswith(("| metro:", "| main-line:", "| freight:"))]
    expected = [
        f"| {one.name} | {one.outcome}{' (not detectable at once)' if one.undetectable else ''} |" for one in CASES
    ]
    assert expected == rows
    assert [one.name for one in CASES if one.undetectable not in page or one.remains not in page] == []
