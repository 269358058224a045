"""The occupied track on board of a vehicle on fig. 3, with the map's answers: what it tells, by the names of the edges."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.language.system import lower, without_ghosts
from safeloc.models.occupied_track import OccupiedTrackConfig, machine
from safeloc.models.occupied_track.look_up import LookUp
from safeloc.models.occupied_track.variables import REASON
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Run, Topology
from safeloc.runtime.streams.steps import Cell

ERROR_MM = 10_000
Told = tuple[str, set[str]]
"""The edge that is told (nothing: none), or the reason for which none is carried; and the carried edges."""


@cache
def _compiled(tracks: int) -> Compiled:
    return compile_system(without_ghosts(lower(machine(OccupiedTrackConfig(tracks=tracks)))))


class Board:
    """A vehicle that begins on track 301, whose coordinate is 0 at its western end."""

    def __init__(self, tracks: int = 4) -> None:
        self.config = OccupiedTrackConfig(tracks=tracks)
        self.map = LookUp(Topology(find_line("fig3")), self.config)
        self.board = _compiled(tracks)
        self.state = self.board.first()

    @property
    def outputs(self) -> dict[str, int | bool]:
        """What the host is told."""
        return self.board.named_outputs(self.state)

    def number(self, edge: str) -> int:
        """The number of an edge in the direction of growing coordinates."""
        return self.map.number(Run(edge, "increasing"))

    def start(self, edge: str = "301", origin_mm: int = 0, place_mm: int = 100_000) -> Told:
        """A cycle at whose end the vehicle is at a place of an edge that a start names."""
        length = self.map.topology.edges[edge].length_mm
        given: dict[str, Cell] = {
            "start_given": True,
            "start_edge": self.number(edge),
            "start_origin_mm": origin_mm,
            "start_length_mm": length,
        }
        return self.at(origin_mm + place_mm, given)

    def at(
        self,
        place_mm: int,
        told: Mapping[str, Cell] | None = None,
        *,
        error_mm: int = ERROR_MM,
        points: dict[str, str] | None = None,
        watched: str = "",
        left_out: str = "",
        **more: Cell,
    ) -> Told:
        """A cycle at whose end the front end is within the error of a coordinate; what is told, by name.

        left_out  an edge that the map does not offer
        """
        low, high = place_mm - error_mm, place_mm + error_mm
        answer = self.map.answer(self.map.carried(self.outputs), low, high, points=points, watched=watched)
        for slot in range(1, self.config.tracks + 1):
            if left_out and answer[f"next_{slot}_edge"] == self.number(left_out):
                answer[f"next_{slot}_edge"] = 0
        quiet: dict[str, Cell] = {
            "located": True, "front_low_mm": low, "front_high_mm": high, "surely_not_ahead": False, "surely_not_back": False,
            "course_taken": "UNDECIDED", "start_given": False, "start_edge": 1, "start_origin_mm": 0, "start_length_mm": self.config.shortest_edge_mm,
            "group_place_mm": 0, "group_error_mm": 0,
        }  # fmt: skip
        self.state, _ = self.board.step(self.state, self.board.read(quiet | answer | dict(told or {}) | more))
        return self.told

    def group(self, edge: str, place_mm: int, error_mm: int = 2_000) -> dict[str, Cell]:
        """A group that is read, on an edge."""
        return {"group_edge": self.number(edge), "group_place_mm": place_mm, "group_error_mm": error_mm}

    @property
    def told(self) -> Told:
        """What is told after the last cycle."""
        outputs = self.outputs
        slots = range(1, self.config.tracks + 1)
        carried = {
            self.map.run(int(outputs[f"track_{slot}_edge"])).edge for slot in slots if outputs[f"track_{slot}_edge"]
        }
        edge = self.map.run(int(outputs["edge"])).edge if outputs["valid"] else ""
        return edge or ("" if carried else REASON[int(outputs["reason"])].label), carried
