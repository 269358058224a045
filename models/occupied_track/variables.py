"""Configuration and variables of the occupied track."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import NumVar, boolean, choice, enumeration, members, number, optional
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.models.occupied_track.ghosts import Ghosts, ghosts
from safeloc.models.turn_off import COURSE

REASON = members("track_reason", "NO_REASON", "NO_START", "NO_POSITION", "NOT_ALL_CARRIED", "CONTRADICTION")
NO_REASON, NO_START, NO_POSITION, NOT_ALL_CARRIED, CONTRADICTION = REASON
POINTS = members("points", "NOT_KNOWN", "FIRST", "SECOND")
NOT_KNOWN, FIRST, SECOND = POINTS
NO_EDGE = 0
"""The number of no edge; the edges of a map are counted from 1."""


class OccupiedTrackConfig(Config):
    """Figures of vehicle and map on which the occupied track depends."""

    tracks: int = quantity(4, "count", 2, 8, "[D] tracks carried at most; with more no position is given")
    edges: int = quantity(
        1_000_000, "count", 2, 100_000_000, "[D] edges of a map, each counted once for each direction"
    )
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")
    shortest_edge_mm: int = quantity(10_000, "mm", 1, 1_000_000, "[D] between two switches, or a switch and a crossing")
    longest_edge_mm: int = quantity(100_000_000, "mm", 1_000, 1_000_000_000, "[D] 100 km without a switch")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    period_ms: int = quantity(100, "ms", 10, 1_000, "[S] SUBSET-041: application cycle up to 100 ms")

    @model_validator(mode="after")
    def _one_joint(self) -> OccupiedTrackConfig:
        run_mm = -(-self.max_speed_mm_s * self.period_ms // 1_000)
        if self.shortest_edge_mm < run_mm:
            raise ValueError(
                f"shortest_edge_mm {self.shortest_edge_mm} is below {run_mm}, which the vehicle runs in a cycle: it could pass "
                "a whole edge unseen; raise it, or shorten the cycle."
            )
        if self.longest_edge_mm < self.shortest_edge_mm:
            raise ValueError("longest_edge_mm must not be below shortest_edge_mm.")
        return self


@dataclass(frozen=True, eq=False)
class Slot:
    """A track that is carried: the number of its edge (0: none), the coordinate at which the edge begins, and its length, mm."""

    number: int
    edge: NumVar
    origin: NumVar
    length: NumVar


@dataclass(frozen=True, eq=False)
class Joint:
    """The map beyond one end of an edge: at most two edges (0: none), and which of them the points lead to, if that is known."""

    first: NumVar
    second: NumVar
    points: NumVar


@dataclass(frozen=True, eq=False)
class Entry:
    """The map's entry for a track that was carried until now: its edge, and what joins it ahead and behind."""

    edge: NumVar
    ahead: Joint
    behind: Joint


@dataclass(frozen=True, eq=False)
class Offer:
    """A track for which the map has a slot in this cycle, with its course at the switch at which a turn may be seen."""

    edge: NumVar
    origin: NumVar
    length: NumVar
    course: NumVar


class Parts:
    """The variables of the machine. Lengths in mm; coordinates are those of the localizer.

    located, low, high   inputs: the localizer gives a position, and the ends of its interval (min and max safe front end)
    surely_not_ahead, surely_not_back  inputs: in this cycle the vehicle surely did not run ahead, or back
    start_given, start_edge    inputs: a start is given, and the edge on which the vehicle then surely is, with its origin and length
    group_edge                input: the edge of a balise group that was read, with the place of the front end on it, and the error
    course_taken               input: the course taken at a switch, if a turn was seen
    entries              inputs: the map for each track that was carried until now
    offers               inputs: the tracks to be carried from now on; the machine takes those that follow from the others
    slots                the tracks that are carried
    given_low, given_high  the interval in which the vehicle is
    reason               why no track is carried
    """

    def __init__(self, config: OccupiedTrackConfig, truth: NumVar) -> None:
        self.config = config
        self.declared = declared = Declared()
        limit = config.position_limit_mm
        self.located = declared.sensor(boolean("located"))
        self.low = declared.sensor(number("front_low_mm", MM, -limit, limit))
        self.high = declared.sensor(number("front_high_mm", MM, -limit, limit))
        self.surely_not_ahead = declared.sensor(boolean("surely_not_ahead"))
        self.surely_not_back = declared.sensor(boolean("surely_not_back"))
        self.start_given = declared.sensor(boolean("start_given"))
        self.start_edge = declared.sensor(number("start_edge", COUNT, 1, config.edges))
        self.start_origin = declared.sensor(self._origin("start_origin_mm"))
        self.start_length = declared.sensor(self._length("start_length_mm"))
        self.group_edge = declared.sensor(optional("group_edge", COUNT, 1, config.edges))
        self.group_place = declared.sensor(number("group_place_mm", MM, 0, config.longest_edge_mm))
        self.group_error = declared.sensor(number("group_error_mm", MM, 0, config.longest_edge_mm))
        self.course_taken = declared.sensor(choice("course_taken", enumeration(COURSE)))
        numbers = range(1, config.tracks + 1)
        self.entries = tuple(self._entry(declared, f"track_{one}") for one in numbers)
        self.offers = tuple(self._offer(declared, f"next_{one}") for one in numbers)
        self.slots = tuple(self._slot(declared, one) for one in numbers)
        self.given_low = declared.state(number("given_low_mm", MM, -limit, limit), first=0)
        self.given_high = declared.state(number("given_high_mm", MM, -limit, limit), first=0)
        self.reason = declared.state(choice("reason", enumeration(REASON)), first=NO_START)
        reach = limit + config.longest_edge_mm
        origin = number("true_origin_mm", MM, -reach - config.longest_edge_mm, reach)
        self.ghosts: Ghosts = ghosts(declared, config.edges, origin, self._length, truth)

    def _edge(self, name: str) -> NumVar:
        return number(name, COUNT, NO_EDGE, self.config.edges)

    def _origin(self, name: str) -> NumVar:
        farthest = self.config.position_limit_mm + self.config.longest_edge_mm
        return number(name, MM, -farthest, farthest)

    def _length(self, name: str) -> NumVar:
        return number(name, MM, self.config.shortest_edge_mm, self.config.longest_edge_mm)

    def _joint(self, declared: Declared, name: str) -> Joint:
        return Joint(
            declared.sensor(self._edge(f"{name}_1_edge")),
            declared.sensor(self._edge(f"{name}_2_edge")),
            declared.sensor(choice(f"{name}_points", enumeration(POINTS))),
        )

    def _entry(self, declared: Declared, name: str) -> Entry:
        edge = declared.sensor(self._edge(f"{name}_of_edge"))
        return Entry(edge, self._joint(declared, f"{name}_ahead"), self._joint(declared, f"{name}_behind"))

    def _offer(self, declared: Declared, name: str) -> Offer:
        return Offer(
            declared.sensor(self._edge(f"{name}_edge")),
            declared.sensor(self._origin(f"{name}_origin_mm")),
            declared.sensor(self._length(f"{name}_length_mm")),
            declared.sensor(choice(f"{name}_course", enumeration(COURSE))),
        )

    def _slot(self, declared: Declared, one: int) -> Slot:
        shortest = self.config.shortest_edge_mm
        return Slot(
            one,
            declared.state(self._edge(f"carried_{one}_edge"), first=NO_EDGE),
            declared.state(self._origin(f"carried_{one}_origin_mm"), first=0),
            declared.state(self._length(f"carried_{one}_length_mm"), first=shortest),
        )


def parts(config: OccupiedTrackConfig) -> Parts:
    """Return fresh variables for one machine; where another machine's world moves the vehicle, use `Parts` with that machine's truth."""
    reach = (config.position_limit_mm + config.longest_edge_mm) * NM_PER_MM
    return Parts(config, number("truth_nm", NM, -reach, reach))
