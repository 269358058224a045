"""Scenes as the recordings that ship: a step stream of the machine, and the data of its picture beside it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from safeloc.models.fibre_parts.variables import NM_PER_MM
from safeloc.models.fibre_scenes.ends import Steps, steps_of
from safeloc.models.fibre_scenes.figures import END_SCENES, QUIET_S, EndScene
from safeloc.models.fibre_scenes.scene import listen
from safeloc.models.fibre_scenes.waterfall import waterfall
from safeloc.nodes import Value
from safeloc.streams.steps import write_steps

BLOCKS_PER_S = 2


@dataclass(frozen=True)
class Recording:
    """What stands in `NAME.jsonl`, after values of ghosts at first, and in `NAME.waterfall.json`."""

    name: str
    machine: str
    steps: Steps
    first: Mapping[str, Value]
    picture: Mapping[str, Any]

    def write(self, folder: Path) -> None:
        """Both files."""
        write_steps(folder / f"{self.name}.jsonl", self.steps, machine=self.machine, first=self.first)
        rows = json.dumps(dict(self.picture), indent=1)
        (folder / f"{self.name}.waterfall.json").write_text(rows + "\n", encoding="utf-8")


def recorded_end(made: EndScene) -> Recording:
    """One end of a train, from when the fibre's quiet is learnt."""
    moments, begin = listen(made.scene), QUIET_S * BLOCKS_PER_S
    on_map = made.scene if made.mapped is None else replace(made.scene, sections=tuple(made.mapped))
    steps = steps_of(on_map, moments[begin:], made.followed, ghosts=made.ghosts)
    first = {"truth_nm": int(steps[0]["truth_mm"]) * NM_PER_MM} if made.ghosts else {}
    picture = {"title": made.title, "says": made.says, **waterfall(made.scene, moments, begin, made.marks)}
    return Recording(f"fibre-{made.name}", "fibre", steps, first, picture)


def recordings() -> Iterator[Recording]:
    """All of them, one after the other; minutes."""
    yield from map(recorded_end, END_SCENES)
