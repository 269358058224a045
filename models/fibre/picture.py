"""Pictures of a run of one end of a train, drawn over the loudness of its fibre where a recording has it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from safeloc.railway.pictures import (
    LoudFibre,
    NamedInterval,
    SectionState,
    Stretch,
    TrueEnds,
    VirtualSection,
    Waterfall,
)
from safeloc.reported import Reported

MODELS = Path(__file__).parents[1]


def picture() -> Waterfall:
    """Return the picture of position signals, the reported interval and the mode."""
    return Waterfall("Fibre", loud, (NamedInterval("interval", Reported()),), signals=("position_signal",))


def area_picture(sections: int) -> Waterfall:
    """Return the picture of a train in a line area: reported front, both ends, modes, and virtual sections."""
    ends = [NamedInterval(f"{end} located", _reported(end, "valid")) for end in ("front", "rear")]
    numbers = range(1, sections + 1)
    names = ("axle_section", "train_order", "front", "rear", "emitter", "verification")
    return Waterfall(
        "Fibre area",
        loud,
        (NamedInterval("front, reported", _reported("verification", "trusted")), *ends),
        tuple(
            SectionState(f"section {n}", f"section_{n}.from_mm", f"section_{n}.to_mm", f"section_{n}.mode")
            for n in numbers
        ),
        ("front.position_signal",),
        {name: f"{name}.mode" for name in names},
    )


def order_picture() -> Waterfall:
    """Return the picture of the known order and of the association of patterns with trains."""
    return Waterfall("Order of trains", loud, (), modes={"order": "mode", "told apart": "associated"})


def _reported(machine: str, valid: str) -> Reported:
    return Reported(
        f"{machine}.position_mm", f"{machine}.margin_below_mm", f"{machine}.margin_above_mm", f"{machine}.{valid}"
    )


def loud(recording: str) -> LoudFibre | None:
    """Return the loudness of the fibre in a shipped recording; None for any other."""
    machine = recording.partition("-")[0]
    path = MODELS / machine / "recordings" / f"{recording}.waterfall.json"
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
        virtual=tuple(_virtual(one) for one in data.get("virtual", ())),
    )


def _virtual(data: Mapping[str, Any]) -> VirtualSection:
    return VirtualSection(data["low_mm"], data["high_mm"], tuple((step, state) for step, state in data["states"]))
