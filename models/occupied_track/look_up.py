"""The map's answers to the occupied track: what joins the tracks that are carried, and the tracks to be carried from now on.

A host asks in each cycle, with the machine's tracks of the cycle before and the localizer's interval of this one:

    look_up = LookUp(Topology(find_line("fig3")), OccupiedTrackConfig())
    inputs = look_up.answer(look_up.carried(outputs), low_mm, high_mm)
    look_up.run(outputs["edge"])          # the edge that is told, with the direction in which the coordinate grows

The machine believes none of the offers without the entries, and no entry for an edge that it does not carry.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from safeloc.errors import InputError
from safeloc.language.nodes import Value
from safeloc.models.occupied_track.variables import NO_EDGE, OccupiedTrackConfig
from safeloc.railway.map.topology import Run, Topology
from safeloc.runtime.streams.steps import Cell


@dataclass(frozen=True)
class Track:
    """A track that is carried: an edge with a direction, and the coordinate at which it begins."""

    run: Run
    origin_mm: int


class LookUp:
    """The map on board. Its edges are numbered from 1, each direction of travel by itself, in the order of their names.

    InputError for a map that the machine cannot take: too many edges, one of a length out of range, a joint of more than two ways.
    """

    def __init__(self, topology: Topology, config: OccupiedTrackConfig) -> None:
        self.topology = topology
        self._runs = sorted(topology.graph)
        self._numbers = {run: number for number, run in enumerate(self._runs, NO_EDGE + 1)}
        self._tracks = config.tracks
        self._refuse(config)

    def _refuse(self, config: OccupiedTrackConfig) -> None:
        if len(self._runs) > config.edges:
            raise InputError(
                f"the map has {len(self._runs)} edges, counted by direction; edges is {config.edges}: raise it."
            )
        for run in self._runs:
            length = self.topology.length_mm(run)
            if not config.shortest_edge_mm <= length <= config.longest_edge_mm:
                raise InputError(
                    f"edge {run.edge!r} is {length} mm long, not {config.shortest_edge_mm} to {config.longest_edge_mm} "
                    "(shortest_edge_mm, longest_edge_mm): join it with the next one, or change the figure."
                )
            for ways, words in (
                (self.topology.after(run), "leads into"),
                (self.topology.before(run), "is reached from"),
            ):
                if len(ways) > 2:
                    names = ", ".join(one.edge for one in ways)
                    raise InputError(
                        f"edge {run.edge!r}, {run.direction}, {words} {names}: a joint has two ways at most; write "
                        "a three-way switch as two switches."
                    )

    def number(self, run: Run) -> int:
        """Return the number of an edge in a direction."""
        return self._numbers[run]

    def run(self, number: int) -> Run:
        """Return the edge with its direction. InputError for a number that is not on the map."""
        if not NO_EDGE < number <= len(self._runs):
            raise InputError(f"edge {number} is not on the map, which has {len(self._runs)}.")
        return self._runs[number - 1]

    def carried(self, outputs: Mapping[str, Value]) -> list[Track | None]:
        """Return the carried tracks from the machine's outputs, by slot."""
        return [self._slot(outputs, f"track_{number}") for number in range(1, self._tracks + 1)]

    def _slot(self, outputs: Mapping[str, Value], name: str) -> Track | None:
        number = int(outputs[f"{name}_edge"])
        return None if number == NO_EDGE else Track(self.run(number), int(outputs[f"{name}_origin_mm"]))

    def answer(
        self,
        carried: Sequence[Track | None],
        low_mm: int,
        high_mm: int,
        *,
        points: Mapping[str, str] | None = None,
        watched: str = "",
    ) -> dict[str, Cell]:
        """Return the inputs of the map for one cycle.

        points   node of a switch -> the branch to which its points are stated to lead
        watched  node of the switch at which a turn was seen
        """
        inputs: dict[str, Cell] = {}
        for number, track in enumerate(carried, 1):
            inputs |= self._entry(f"track_{number}", track, points or {})
        found = dict.fromkeys(
            one for track in carried if track for one in self._reached(track, low_mm, high_mm, points or {})
        )
        offers = [*list(found)[: self._tracks], *[None] * (self._tracks - len(found))]
        for number, offer in enumerate(offers, 1):
            inputs |= self._offer(f"next_{number}", offer, watched)
        return inputs

    def _reached(self, track: Track, low_mm: int, high_mm: int, points: Mapping[str, str]) -> Iterator[Track]:
        """Yield where a vehicle may be that was on a track: still there, or on what joins it, where the points lead."""
        end_mm = track.origin_mm + self.topology.length_mm(track.run)
        if low_mm <= end_mm and high_mm >= track.origin_mm:
            yield track
        if high_mm > end_mm:
            for run in self._led(
                self.topology.after(track.run), self._stated(track.run, self.topology.end(track.run), points)
            ):
                yield Track(run, end_mm)
        if low_mm < track.origin_mm:
            for run in self._led(
                self.topology.before(track.run), self._stated(track.run, self.topology.start(track.run), points)
            ):
                yield Track(run, track.origin_mm - self.topology.length_mm(run))

    def _stated(self, run: Run, node: str, points: Mapping[str, str]) -> str:
        """Return the branch to which the points at an end of an edge lead, for one who comes from the stem; nothing: not known."""
        switch = self.topology.switches.get(node)
        return points.get(node, "") if switch is not None and switch.stem == run.edge else ""

    def _led(self, runs: Sequence[Run], branch: str) -> list[Run]:
        return [run for run in runs if branch in ("", run.edge)]

    def _entry(self, name: str, track: Track | None, points: Mapping[str, str]) -> dict[str, Cell]:
        if track is None:
            return {
                f"{name}_of_edge": NO_EDGE,
                **self._joint(f"{name}_ahead", [], ""),
                **self._joint(f"{name}_behind", [], ""),
            }
        run, topology = track.run, self.topology
        ahead, behind = (self._stated(run, node, points) for node in (topology.end(run), topology.start(run)))
        return {
            f"{name}_of_edge": self.number(run),
            **self._joint(f"{name}_ahead", topology.after(run), ahead),
            **self._joint(f"{name}_behind", topology.before(run), behind),
        }

    def _joint(self, name: str, runs: Sequence[Run], branch: str) -> dict[str, Cell]:
        first, second = [*map(self.number, runs), NO_EDGE, NO_EDGE][:2]
        led = [run.edge for run in runs].index(branch) if branch else None
        stated = "NOT_KNOWN" if led is None else ("FIRST", "SECOND")[led]
        return {f"{name}_1_edge": first, f"{name}_2_edge": second, f"{name}_points": stated}

    def _offer(self, name: str, track: Track | None, watched: str) -> dict[str, Cell]:
        if track is None:
            edge, origin, length, course = NO_EDGE, 0, self.topology.length_mm(self._runs[0]), "UNDECIDED"
        else:
            edge, origin, length = self.number(track.run), track.origin_mm, self.topology.length_mm(track.run)
            course = self._course(track.run, watched)
        return {
            f"{name}_edge": edge,
            f"{name}_origin_mm": origin,
            f"{name}_length_mm": length,
            f"{name}_course": course,
        }

    def _course(self, run: Run, watched: str) -> str:
        """Return the course by which an edge leaves the watched switch; UNDECIDED for one that does not begin there."""
        switch = self.topology.switches.get(watched)
        if switch is None or self.topology.start(run) != watched or run.edge == switch.stem:
            return "UNDECIDED"
        [stem] = self.topology.before(run)
        passage = self.topology.passage(stem, run)
        return "UNDECIDED" if passage is None else self.topology.course(passage)
