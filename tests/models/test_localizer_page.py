"""The localizer's page: its table of what goes wrong is the catalogue's."""

from __future__ import annotations

import gzip
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

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


@pytest.mark.thorough
def test_the_reports_on_the_page_are_those_of_the_recording() -> None:
    """The lines that stand there, of `localizer_track-other-branch`: interval, edge told, and edges possible."""
    shown = re.findall(
        r'^\{"cycle": (\d+), \.\.\. "interval_mm": (.*?), "track": (.*), \.\.\.$',
        PAGE.read_text(encoding="utf-8"),
        re.M,
    )
    assert len(shown) == 5
    recording = PAGE.parents[1] / "models/localizer_track/recordings/localizer_track-other-branch.jsonl.gz"
    command = [sys.executable, "-m", "safeloc", "run", "localizer_track", "--inputs"]
    ran = subprocess.run(command, input=gzip.decompress(recording.read_bytes()), capture_output=True, check=True)
    reports = {one["cycle"]: one for one in map(json.loads, ran.stdout.splitlines()) if "cycle" in one}
    for cycle, interval, track in shown:
        report = reports[int(cycle)]
        assert (report["interval_mm"], report["track"]) == (json.loads(interval), json.loads(track)), cycle
