"""Configuration and variables of the route machine."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    BoolVar,
    NumVar,
    Optional,
    boolean,
    choice,
    enumeration,
    members,
    number,
    optional,
)
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.models.route.ghosts import Bounds, Moved, ghosts, moved
from safeloc.models.turn_off import COURSE
from safeloc.models.vocabulary.error_law import WHEEL, ErrorLaw, check_counts_distance
from safeloc.models.vocabulary.measured import Limits
from safeloc.models.vocabulary.measuring_world import Physics
from safeloc.models.vocabulary.odometer import odometer
from safeloc.models.vocabulary.reflectors import MAX_ERROR_MM, MODEL

REASON = members("reason", "NONE", "NO_START", "CONTRADICTION", "TOLERANCE", "SENSOR_FAILURE")
NO_REASON, NO_START, CONTRADICTION, TOLERANCE, SENSOR_FAILURE = REASON


class RouteConfig(Config):
    """Figures of vehicle, radar and line that route recognition depends on."""

    odometer: ErrorLaw = WHEEL
    routes: int = quantity(5, "count", 2, 16, "[S] source l. 284: five routes in the worked example")
    period_ms: int = quantity(100, "ms", 10, 1_000, "[S] SUBSET-041: application cycle up to 100 ms")
    tolerance_mm: int = quantity(30_000, "mm", 2, 500_000, "[S] OCORA 7239: 30 m on main line")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    max_acceleration_mm_s2: int = quantity(2_500, "mm/s2", 1, 10_000, "[M] 2.5 m/s2 with track brake")
    measuring_step_mm: int = quantity(14, "mm", 0, 10_000, "[S] 100 pulses a turn: 13.4 mm")
    gap_limit_cycles: int = quantity(5, "cycles", 0, 1_000, "[D] 0.5 s without any distance")
    length_limit_mm: int = quantity(100_000_000, "mm", 1_000, 1_000_000_000, "[D] 100 km from the common start")
    range_limit_mm: int = quantity(300_000, "mm", 1_000, 2_000_000, "[M] 24/77 GHz radar: 100 to 200 m")
    start_error_mm: int = quantity(13_000, "mm", 1, 100_000, "[D] Q_NVLOCACC 12 m and detection accuracy 1 m")
    checked_distance: bool = False

    @model_validator(mode="after")
    def _can_locate(self) -> RouteConfig:
        check_counts_distance(self.odometer)
        if self.start_error_mm + self.odometer.constant_mm >= self.tolerance_mm:
            raise ValueError(
                f"tolerance_mm {self.tolerance_mm} is not above the start's error and the odometer's one-off constant, "
                f"{self.start_error_mm + self.odometer.constant_mm} mm: nothing can be reported; raise it."
            )
        return self

    @property
    def limits(self) -> Limits:
        """Limits of the odometer, rounded so that its checks are no tighter than physics."""
        return Limits.of(self, self.tolerance_mm, self.length_limit_mm)

    @property
    def physics(self) -> Physics:
        """Limits of the vehicle's movement, for the world."""
        return Physics.of(self)


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One route: whether it is possible, and the place of the vehicle on it.

    low, high   bounds of the true distance less the present wander of the odometer's error, nm
    candidate   input, from the map: this route begins at the start
    reflector   input, from the map: place on this route of its own reflector of the sighted model that is nearest to the
                place where the sighting would put it, mm from the start
    model       input, from the map: that reflector's model
    course      input, from the map: the course of this route at the switch at which a turn was seen
    other_in_view   input, from the map: a reflector of the sighted model that stands beside another track may be in view from this
                route, where the sighting would put it
    """

    number: int
    possible: BoolVar
    low: NumVar
    high: NumVar
    candidate: BoolVar
    reflector: Optional
    model: NumVar
    course: NumVar
    other_in_view: BoolVar


class Parts:
    """The variables of the machine.

    start_error           input: how far the vehicle may be from the common start, mm; absent unless it starts in this cycle
    sighting_range        input: range of a reflector that is recognised in this cycle, mm, with its error and model
    sighting_by_own_track  input: the image stands where reflectors of the own track stand, and none of another track: near, and on its side
    course_taken          input: course taken at a switch, if a turn was seen
    authorised_route      input: number of the route by movement authority; 0: unknown
    refuted         1: the route by movement authority is impossible
    reason          why no route is decided
    """

    def __init__(self, config: RouteConfig, moving: Moved) -> None:
        self.declared = declared = Declared()
        self.config = config
        self.odometer = odometer(config.odometer, config.limits, checked=config.checked_distance).declare(declared)
        self.start_error = declared.sensor(optional("start_error_mm", MM, 0, config.start_error_mm))
        self.sighting_range = declared.sensor(optional("sighting_range_mm", MM, 0, config.range_limit_mm))
        self.sighting_error = declared.sensor(number("sighting_error_mm", MM, 0, MAX_ERROR_MM))
        self.sighting_model = declared.sensor(choice("sighting_model", enumeration(MODEL)))
        self.sighting_by_own_track = declared.sensor(boolean("sighting_by_own_track"))
        self.refuted = declared.state(number("authority_refuted", COUNT, 0, 1), first=0)
        self.reason = declared.state(choice("reason", enumeration(REASON)), first=NO_START)
        self.routes = tuple(_hypothesis(declared, number_, config) for number_ in range(1, config.routes + 1))
        self.course_taken = declared.sensor(choice("course_taken", enumeration(COURSE)))
        self.authorised_route = declared.sensor(number("authorised_route", COUNT, 0, config.routes))
        self.ghosts = ghosts(declared, _bounds(config), moving)

    @property
    def half_nm(self) -> int:
        """Half of the odometer's one-off constant."""
        return self.config.odometer.wander_nm


def parts(config: RouteConfig, *, moving: Moved | None = None) -> Parts:
    """Return fresh variables for one machine; `moving`: the movement, where another machine's world moves the vehicle."""
    return Parts(config, moving or moved(config.physics, config.odometer.wander_nm))


def _bounds(config: RouteConfig) -> Bounds:
    far = config.length_limit_mm + config.range_limit_mm
    return Bounds(config.physics, far + 2 * config.tolerance_mm, far, config.routes, config.checked_distance)


def _hypothesis(declared: Declared, number_: int, config: RouteConfig) -> Hypothesis:
    reach = (config.length_limit_mm + config.tolerance_mm) * NM_PER_MM
    name, farthest = f"route_{number_}", config.length_limit_mm + config.range_limit_mm
    return Hypothesis(
        number_,
        declared.state(boolean(f"{name}_possible"), first=False),
        declared.state(number(f"{name}_low_nm", NM, -reach, reach), first=0),
        declared.state(number(f"{name}_high_nm", NM, -reach, reach), first=0),
        declared.sensor(boolean(f"{name}_candidate")),
        declared.sensor(optional(f"{name}_reflector_mm", MM, 0, farthest)),
        declared.sensor(choice(f"{name}_model", enumeration(MODEL))),
        declared.sensor(choice(f"{name}_course", enumeration(COURSE))),
        declared.sensor(boolean(f"{name}_other_in_view")),
    )
