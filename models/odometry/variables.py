"""Configuration and variables of the odometry machine."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import Bool, Lit, Num, NumVar, boolean, choice, enumeration, number
from safeloc.language.units import COUNT, MM
from safeloc.models.odometry.distance_device import Device, Unit, device
from safeloc.models.odometry.ghosts import Bounds, Ghosts, Movement, movement
from safeloc.models.odometry.marker_reading import Reader, pending, reader
from safeloc.models.odometry.satellite_reading import SatelliteReader, satellite_reader
from safeloc.models.vocabulary.error_law import RADAR, WHEEL, ErrorLaw
from safeloc.models.vocabulary.measured import Limits, max_cycle_distance_change_mm, max_cycle_distance_mm
from safeloc.models.vocabulary.reasons import NO_REFERENCE, REASON


class OdometryConfig(Config):
    """Vehicle, sensors and line of an odometry machine."""

    devices: Literal[1, 2] = 2
    first_unit: ErrorLaw = WHEEL
    second_unit: ErrorLaw = RADAR
    period_ms: int = quantity(100, "ms", 10, 1_000, "[S] SUBSET-041: application cycle up to 100 ms")
    tolerance_mm: int = quantity(
        30_000,
        "mm",
        1,
        500_000,
        "[S] OCORA 7239: 30 m on main line; bounds each margin, so an interval is up to twice as wide",
    )
    vehicle_length_mm: int = quantity(204_700, "mm", 0, 2_000_000, "[S] V90 + 10 Facs 124")
    vehicle_length_tolerance_mm: int = quantity(300, "mm", 0, 50_000, "[S] OCORA: up to + 0.30 m")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    max_acceleration_mm_s2: int = quantity(2_500, "mm/s2", 1, 10_000, "[M] 2.5 m/s2 with track brake")
    measuring_step_mm: int = quantity(14, "mm", 0, 10_000, "[S] 100 pulses a turn: 13.4 mm")
    gap_limit_cycles: int = quantity(
        5,
        "cycles",
        0,
        1_000,
        "[D] 0.5 s without any distance; each such cycle adds the farthest run to both margins, so tolerance_mm may withdraw the "
        "position earlier",
    )
    lone_limit_cycles: int = quantity(100, "cycles", 0, 1_000_000, "[M] 10 s without the cross-check")
    age_limit_ms: int = quantity(
        86_400_000, "ms", 1_000, 259_200_000, "[D] one day, below 72 h of cold movement detection"
    )
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")
    marker_accuracy_mm: int = quantity(12_000, "mm", 0, 63_000, "[M] Q_NVLOCACC 12 m; overridden per marker")
    reader_latency_ms: int = quantity(12, "ms", 0, 1_000, "[S] balise reader 10 +- 2 ms")
    reversal_mm: int = quantity(2_000, "mm", 0, 100_000, "[S] D_NVROLL 2 m")
    pending_markers: int = quantity(4, "count", 1, 8, "[D] markers under one vehicle")
    last_marker_identity: int = quantity(1_000_000, "count", 1, 1_000_000_000, "[D] identities of one line")
    trust_first_marker: bool = False
    satellite_markers: bool = Field(
        default=False,
        description="positions of satellites set the device at end A, as markers do; what gives them has checked them",
    )
    single_fault_safe: bool = False

    @model_validator(mode="after")
    def _can_locate(self) -> OdometryConfig:
        if self.first_unit.kind == self.second_unit.kind:
            raise ValueError(
                f"first_unit and second_unit are both of kind {self.first_unit.kind!r}: units are named by what measures, and "
                "two of one kind fail alike; give them different kinds."
            )
        least = min(self.first_unit.constant_mm, self.second_unit.constant_mm)
        if least >= self.tolerance_mm:
            raise ValueError(
                f"tolerance_mm {self.tolerance_mm} is not above the units' one-off constant {least} mm: no distance can be "
                "run within it; raise the tolerance or use better units."
            )
        if self.lone_limit_cycles < self.gap_limit_cycles:
            raise ValueError(
                "lone_limit_cycles must not be below gap_limit_cycles: losing both units is the worse fault."
            )
        if self.reader_latency_ms > self.period_ms:
            raise ValueError(
                "reader_latency_ms must not exceed period_ms; an older reading is stale and must be dropped."
            )
        return self

    def unsteady_nm(self, window_ms: int) -> int:
        """Return the run that a change of speed adds to that share of the cycle's run which falls into the window, nm, rounded up."""
        return -(-self.max_acceleration_mm_s2 * self.period_ms * window_ms // 2)

    @property
    def limits(self) -> Limits:
        """Limits of the devices, rounded so that the checks are no tighter than physics."""
        step = max_cycle_distance_mm(self.max_speed_mm_s, self.period_ms, self.measuring_step_mm)
        change = max_cycle_distance_change_mm(self.max_acceleration_mm_s2, self.period_ms, self.measuring_step_mm)
        return Limits(
            self.period_ms, self.tolerance_mm, self.max_speed_mm_s, step, change, self.gap_limit_cycles,
            self.lone_limit_cycles, self.age_limit_ms, self.position_limit_mm, self.single_fault_safe,
        )  # fmt: skip


class Parts:
    """The variables of the machine and its world; properties read them by name.

    devices       one distance device for each reader, or one for both
    readers       at end A and at end B
    satellites    what gives positions of satellites; None where markers alone are read
    pending       identities that wait for their trailing reading
    backwards     the vehicle runs towards end B; rolled: distance run against that without a break
    last_marker, last_marker_position   the marker that the leading reader read last; 0: none
    length        input: the vehicle length, where it is not configured
    ghosts        of the world
    """

    def __init__(
        self,
        config: OdometryConfig,
        *,
        length: NumVar | None = None,
        with_fault: bool = False,
        moved: Movement | None = None,
    ) -> None:
        self.declared = declared = Declared()
        self.config, self.length = config, length
        limits, identities, place = config.limits, config.last_marker_identity, config.position_limit_mm
        laws, names = (config.first_unit, config.second_unit), ("front", "rear")[: config.devices]
        offset = Lit(config.vehicle_length_mm, MM) if length is None else length
        self.devices = tuple(device(declared, name, laws, limits) for name in names)
        self.readers = (
            _reader(declared, config, "front", Lit(0, MM), 0),
            _reader(declared, config, "rear", offset, config.vehicle_length_tolerance_mm),
        )
        if length is not None:
            declared.sensor(length)
        self.satellites: SatelliteReader | None = None
        if config.satellite_markers:
            self.satellites = satellite_reader(declared, place, trusted=config.trust_first_marker)
        self.pending = pending(declared, config.pending_markers, identities)
        self.backwards = declared.state(boolean("backwards"), first=False)
        self.rolled = declared.state(number("rolled_mm", MM, 0, config.reversal_mm), first=0)
        self.last_marker = declared.state(number("last_marker", COUNT, 0, identities), first=0)
        self.last_marker_position = declared.state(number("last_marker_position_mm", MM, -place, place), first=0)
        self.reason = declared.state(choice("reason", enumeration(REASON)), first=NO_REFERENCE)
        bounds = _bounds(config, config.vehicle_length_mm if length is None else length.high)
        self.ghosts = Ghosts(
            declared,
            bounds,
            self.devices,
            moved or movement(bounds),
            with_fault=with_fault,
            covered=config.single_fault_safe,
        )

    @property
    def units(self) -> tuple[Unit, ...]:
        """All measuring units."""
        return tuple(unit for device in self.devices for unit in device.units)

    def partner(self, unit: Unit) -> tuple[Device, Unit]:
        """Return the unit's device, and the other unit of it."""
        device = next(one for one in self.devices if unit in one.units)
        return device, device.units[1 - device.units.index(unit)]

    def set_by(self, end: int) -> Device:
        """Return the device that the reader at end 0 (A, front) or 1 (B, rear) sets."""
        return self.devices[min(end, len(self.devices) - 1)]

    def leads(self, end: int) -> Bool:
        """Return whether the reader at that end is the leading one."""
        return self.backwards if end else ~self.backwards


def parts(
    config: OdometryConfig, *, length: NumVar | None = None, with_fault: bool = False, moved: Movement | None = None
) -> Parts:
    """Declare the variables of one machine.

    length      the vehicle length as an input in mm, instead of the configured one
    with_fault  one unit, unknown which, may break its error law: a ghost names it
    moved       the true movement, where another machine's world moves the vehicle
    """
    return Parts(config, length=length, with_fault=with_fault, moved=moved)


def _bounds(config: OdometryConfig, longest_mm: int) -> Bounds:
    line_mm = config.position_limit_mm + 2 * config.tolerance_mm + longest_mm
    return Bounds(
        config.period_ms, config.max_speed_mm_s, line_mm, longest_mm + config.vehicle_length_tolerance_mm,
        config.gap_limit_cycles, config.lone_limit_cycles, config.age_limit_ms,
    )  # fmt: skip


def _reader(declared: Declared, config: OdometryConfig, name: str, offset: Num, tolerance_mm: int) -> Reader:
    return reader(
        declared,
        name,
        offset=offset,
        offset_tolerance_mm=tolerance_mm,
        accuracy_mm=config.marker_accuracy_mm,
        latency_ppm=-(-config.reader_latency_ms * 1_000_000 // config.period_ms),
        since_ppm=max(config.first_unit.rate_ppm, config.second_unit.rate_ppm),
        unsteady_nm=(config.unsteady_nm(config.reader_latency_ms), config.unsteady_nm(config.period_ms)),
        position_limit_mm=config.position_limit_mm,
        max_cycle_distance_mm=config.limits.max_cycle_distance_mm,
        last_identity=config.last_marker_identity,
    )
