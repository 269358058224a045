"""How a run of one end of a train is drawn: over the loudness of its fibre, where that was kept."""

from __future__ import annotations

import json
from pathlib import Path

from safeloc.pictures import Interval, LoudFibre, Stretch, TrueEnds, Waterfall
from safeloc.reported import Reported

STREAMS = Path(__file__).parents[1] / "streams"


def picture() -> Waterfall:
    """Position signals, the reported interval and the mode."""
    return Waterfall("Fibre", loud, (Interval("interval", Reported()),), signals=("position_signal",))


def loud(recording: str) -> LoudFibre | None:
    """What was heard in a shipped recording; None for any other."""
    path = STREAMS / f"{recording}.waterfall.json"
    if not path.is_file():
        return None
    data = json.loads(path.read_text(encoding="utf-8"))
    return LoudFibre(
        title=data["title"],
        says=data["says"],
        first_ms=data["first_ms"],
        step_ms=data["step_ms"],
        steps_per_column=data["steps_per_column"],
        row_mm=data["row_mm"],
        level_cdb=data["level_cdb"],
        rows=tuple(data["rows"]),
        trains=tuple(TrueEnds(tuple(one["low_mm"]), tuple(one["high_mm"])) for one in data["trains"]),
        sections=tuple(Stretch(one["low_mm"], one["high_mm"], one["name"]) for one in data["sections"]),
        marks=data["marks"],
    )
