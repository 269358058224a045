"""The picture of README.md is the run that the code gives, and tells what README.md says of it."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from tests.story_picture import COMMAND, CONFIG, MARKERS_MM, PICTURE, drawn, first, run, withdrawn


def test_the_committed_picture_is_the_one_of_the_run() -> None:
    """Drawn anew it is the same, letter for letter."""
    assert drawn() == PICTURE.read_text(encoding="utf-8"), f"the odometry machine changed: run `{COMMAND}`"


def test_the_run_tells_the_story() -> None:
    """Located at the first marker, always right, narrower at the second, withdrawn once tolerance is passed, for good."""
    cycles = run()
    begin, end = cycles.index(first(cycles)), cycles.index(withdrawn(cycles))
    located = cycles[begin:end]
    assert all(one.interval_mm is None for one in (*cycles[:begin], *cycles[end:]))
    assert MARKERS_MM[0] <= located[0].truth_mm < MARKERS_MM[0] + 5_000
    intervals = [one.interval_mm for one in located if one.interval_mm is not None]
    assert all(low <= 0 <= high for low, high in intervals)
    assert max(max(-low, high) for low, high in intervals) <= CONFIG.tolerance_mm + 5_000
    second = next(number for number, one in enumerate(located) if one.truth_mm > MARKERS_MM[1])
    widths = [high - low for low, high in intervals]
    assert widths[second + 1] < widths[second - 2] / 2
    assert widths[-1] == max(widths) > 1.9 * CONFIG.tolerance_mm


def test_what_it_shows_has_words() -> None:
    """Markers, interval, truth and withdrawal are named in it."""
    texts = " ".join(text.text or "" for text in ET.fromstring(drawn()).iter("{http://www.w3.org/2000/svg}text"))
    for words in ("marker 1", "marker 2", "true position: always inside", "withdrawn", "tolerable: 30 m"):
        assert words in texts
