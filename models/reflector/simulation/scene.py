"""The surroundings of a vehicle with the reflector machine: balises and reflectors along its route, and faults of radar and odometer."""

from __future__ import annotations

from dataclasses import dataclass, field

from safeloc.simulation.faults import Fault, Kinds, plain

NOWHERE = "NONE"


@dataclass(frozen=True)
class OtherVehicle:
    """Another vehicle, on this track or beside it: the place of its end towards this one in each cycle, mm along the route.

    While it is ahead it sends a strong echo that shows no model, and hides the reflectors behind that end.
    """

    ends_mm: tuple[int, ...]


@dataclass(frozen=True)
class Reflector:
    """A reflector of the line; lengths in mm along the route.

    clear_mm  distance to the nearest other one of its model on any track; None: computed from the reflectors of this route
    """

    position_mm: int
    model: str
    view_from_mm: int = 120_000
    view_to_mm: int = 5_000
    clear_mm: int | None = None


@dataclass(frozen=True)
class Balise:
    """A balise; `reference`: its first reflector serves the self-test."""

    identity: int
    position_mm: int
    accuracy_mm: int = 1_000
    reference: bool = True
    search_from_mm: int | None = None


@dataclass(frozen=True)
class Route:
    """Balises and reflectors along one route, on the map and on the track.

    missing  positions of reflectors that are on the map, but not on the track
    beside   reflectors of other tracks that the radar sees from this one, at their places along this route
    """

    balises: tuple[Balise, ...]
    reflectors: tuple[Reflector, ...]
    missing: frozenset[int] = frozenset()
    beside: tuple[Reflector, ...] = ()

    def clear_mm(self, one: Reflector) -> int:
        """Return the distance to the nearest other reflector of the same model; the whole line's length if there is none."""
        if one.clear_mm is not None:
            return one.clear_mm
        others = [abs(other.position_mm - one.position_mm) for other in self.reflectors
                  if other is not one and other.model == one.model]  # fmt: skip
        return min(others, default=1_000_000)

    def ahead(self, position_mm: int) -> Reflector | None:
        """Return the first reflector beyond a position."""
        return min((r for r in self.reflectors if r.position_mm > position_mm), key=_position, default=None)


def _position(one: Reflector) -> int:
    return one.position_mm


FIGURE_1 = Route((Balise(106, 100_000),), (Reflector(180_000, "A", 100_000), Reflector(600_000, "B", 150_000)))
"""Source fig. 1, 100 m from the start: balise 106, reflectors 109 (model A) and 111 (model B)."""
FIGURE_2 = Route(
    (Balise(202, 100_000),),
    (Reflector(180_000, "A", 100_000), Reflector(360_000, "B"), Reflector(410_000, "C")),
)
"""Source fig. 2, 100 m from the start: balise 202, reflector 204, and 205 and 208 of the stop points 207 and 210."""
STOPS_MM = (350_000, 400_000)
"""Places of end A at the stop points 207 and 210: 10 m before their reflectors."""


KINDS = Kinds(
    "the radar",
    {
        **plain("pause", "blind", "weak"),
        "shift": {"by_mm": 0},
        "drift": {"by_mm": 0},
        "scale": {"by_ppm": 0},
        "decoy": {"by_mm": 0, "model": "A"},
    },
)
"""Of the only radar, in cycles.

pause     no radar frames                 blind   frames without any reflector
weak      all echoes 20 dB weaker         shift   the radar measures `by_mm` too far
drift     the radar's error grows by `by_mm` every cycle, as long as it lasts
scale     the radar measures `by_ppm` of the range too far
decoy     a strong echo of model `model` at `by_mm` ahead (breaks the law on clutter)
"""


@dataclass(frozen=True)
class Scene:
    """The conditions of one run: `disturbances` of the radar (`KINDS`), `sensor_faults` of the odometer `wheel`.

    The assumption still holds with a drop-out, with a shift of the radar from the first cycle to the last, and with a drift and
    a scale within the figures of the configuration.
    """

    route: Route = FIGURE_1
    error_mm: int = 200
    clutter: float = 0.3
    pauses: float = 0.02
    dropout: float = 0.005
    others: tuple[OtherVehicle, ...] = ()
    disturbances: tuple[Fault, ...] = field(default=())
    sensor_faults: tuple[Fault, ...] = ()
