"""Scenes as the recordings that ship: a step stream of the machine, and the data of its picture."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_MM
from safeloc.models.fibre.scenes.ends import Steps, steps_of
from safeloc.models.fibre.scenes.figures import END_SCENES, QUIET_S, EndScene
from safeloc.models.fibre.scenes.order import order_of, places_of, truth_of
from safeloc.models.fibre.scenes.scenarios import AREA_SCENES, ORDER_SCENES, AreaScene, OrderScene
from safeloc.models.fibre.scenes.scene import listen
from safeloc.models.fibre.scenes.stay import first_state, stayed
from safeloc.models.fibre.scenes.waterfall import waterfall
from safeloc.runtime.streams.steps import write_steps

_BLOCKS_PER_S = 2


@dataclass(frozen=True)
class Recording:
    """Content of `NAME.jsonl.gz`, after first values of ghosts, and of `NAME.waterfall.json`."""

    name: str
    machine: str
    steps: Steps
    first: Mapping[str, Value]
    picture: Mapping[str, Any]

    def write(self, folder: Path) -> None:
        """Write both files."""
        write_steps(folder / f"{self.name}.jsonl.gz", self.steps, machine=self.machine, first=self.first, short=True)
        rows = json.dumps(dict(self.picture), indent=1)
        (folder / f"{self.name}.waterfall.json").write_text(rows + "\n", encoding="utf-8")


def recorded_end(made: EndScene) -> Recording:
    """Return the recording of one end of a train, from the moment when the detector has learnt the fibre's quiet."""
    moments, begin = listen(made.scene), QUIET_S * _BLOCKS_PER_S
    on_map = made.scene if made.mapped is None else replace(made.scene, sections=tuple(made.mapped))
    steps = steps_of(on_map, moments[begin:], made.followed, ghosts=made.ghosts)
    first = {"truth_nm": int(steps[0]["truth_mm"]) * NM_PER_MM} if made.ghosts else {}
    picture = {"title": made.title, "says": made.says, **waterfall(made.scene, moments, begin, made.marks)}
    return Recording(f"fibre-{made.name}", "fibre", steps, first, picture)


def recorded_stay(made: AreaScene) -> Recording:
    """Return the recording of a stay in a line area, from shortly before the train enters."""
    moments, begin = listen(made.stay.scene), round(made.from_s * _BLOCKS_PER_S)
    kept = stayed(made.stay, moments, begin)
    first = first_state(made.stay, moments[begin - 1], (made.stay.cuts[made.stay.shown - 1],))
    virtual = [_virtual(cut, states) for cut, states in zip(made.stay.cuts, kept.states, strict=True)]
    picture = {"title": made.title, "says": made.says, **waterfall(made.stay.scene, moments, begin, made.marks)}
    return Recording(f"fibre_area-{made.name}", "fibre_area", kept.steps, first, {**picture, "virtual": virtual})


def recorded_order(made: OrderScene) -> Recording:
    """Return the recording of the patterns of several trains, in their order."""
    moments, begin = listen(made.scene), round(made.from_s * _BLOCKS_PER_S)
    trains = [places_of(moments[begin:], number) for number in range(len(made.scene.trains))]
    ordered = order_of(made.ends, moments[begin:], trains)
    ghosts = truth_of(trains, ordered)
    with_truth = [{**step, **truth} for step, truth in zip(ordered.steps, ghosts, strict=True)]
    first = {name.removeprefix("next_"): int(cell) for name, cell in ghosts[0].items() if name.endswith("_place_um")}
    marks = {"axle counter 1": made.ends.low_mm, "axle counter 2": made.ends.high_mm}
    picture = {"title": made.title, "says": made.says, **waterfall(made.scene, moments, begin, marks)}
    return Recording(f"train_order-{made.name}", "train_order", with_truth, first, picture)


def _virtual(cut: tuple[int, int], states: Sequence[str]) -> dict[str, Any]:
    """Return a virtual section with the steps from which it was in which state."""
    begins = [number for number, state in enumerate(states) if number == 0 or states[number - 1] != state]
    return {"low_mm": cut[0], "high_mm": cut[1], "states": [[number, states[number]] for number in begins]}


def recordings() -> Iterator[Recording]:
    """Yield all recordings, one after the other; this takes minutes."""
    yield from map(recorded_end, END_SCENES)
    yield from map(recorded_order, ORDER_SCENES)
    yield from map(recorded_stay, AREA_SCENES)
