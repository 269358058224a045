"""Configuration and variables of the reflector machine."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.expr import BoolVar, Num, NumVar, boolean, choice, enumeration, members, number, optional
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM, NM_PER_UM
from safeloc.models.reflector.balise_reading import BaliseReading, balise_reading
from safeloc.models.reflector.dead_reckoning import Odometer, Track, track
from safeloc.models.reflector.echo import RadarLaw, Slot, slot
from safeloc.models.reflector.map_data import NextReflector, Target, next_reflector, target
from safeloc.models.vocabulary.error_law import MOST_RATE_PPM, WHEEL, ErrorLaw
from safeloc.models.vocabulary.odometer import most_told_nm
from safeloc.models.vocabulary.reflectors import LATERAL_LIMIT_MM, MAX_ERROR_MM, MODEL

SOURCE = members("source", "NONE", "ODOMETRY", "REFLECTOR")
NO_SOURCE, BY_ODOMETRY, BY_REFLECTOR = SOURCE
MODES = ("DELOCALIZED", "NOT_READY", "REFERENCE", "ODOMETRY", "SEARCH", "VIEW", "COAST", "PASSING")
ERROR = members(
    "reflector_error",
    "NONE",
    "NO_POSITION",
    "TOLERANCE",
    "SENSOR_FAILURE",
    "BALISE_CONTRADICTS",
    "ECHOES_CONTRADICT",
    "DRIFT",
    "ROUTE_CONTRADICTED",
    "NO_SELF_TEST",
    "MISMATCH",
    "NOT_FOUND",
)
(
    NO_ERROR,
    NO_POSITION,
    TOLERANCE,
    SENSOR_FAILURE,
    BALISE_CONTRADICTS,
    ECHOES_CONTRADICT,
    DRIFT,
    ROUTE_CONTRADICTED,
    NO_SELF_TEST,
    MISMATCH,
    NOT_FOUND,
) = ERROR


class ReflectorConfig(Config):
    """Everything about vehicle, radar and line that the reflector machine depends on."""

    odometer: ErrorLaw = WHEEL
    echo_slots: int = quantity(2, "count", 1, 8, "[D] the target and one reflector in an overlapping view zone")
    period_ms: int = quantity(100, "ms", 10, 1_000, "[S] SUBSET-041: application cycle up to 100 ms")
    tolerance_mm: int = quantity(30_000, "mm", 1, 500_000, "[S] OCORA 7239: 30 m on main line")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    measuring_step_mm: int = quantity(14, "mm", 0, 10_000, "[S] 100 pulses a turn: 13.4 mm")
    gap_limit_cycles: int = quantity(5, "cycles", 0, 1_000, "[D] 0.5 s without any distance")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")
    radar_offset_mm: int = quantity(0, "mm behind end A", 0, 500_000, "[D] radar at the front end")
    range_limit_mm: int = quantity(300_000, "mm", 1_000, 2_000_000, "[M] 24/77 GHz radar: 100 to 200 m")
    near_range_mm: int = quantity(3_000, "mm", 1, 100_000, "[M] nearer, the radar hears itself (source l. 209)")
    minimum_intensity_cdb: int = quantity(-8_500, "0.01 dB", -20_000, 5_000, "[D] 20 dB over noise, full scale 105")
    map_accuracy_mm: int = quantity(50, "mm", 0, 10_000, "[M] surveying of one place against another")
    frame_latency_ms: int = quantity(50, "ms", 0, 1_000, "[M] one frame at 20 Hz")
    radar_drift_mm_s: int = quantity(1, "mm/s", 0, 100_000, "[M] delays of filters and cables: 2 mm/K, 30 K a minute")
    radar_scale_ppm: int = quantity(100, "ppm of range", 0, 500_000, "[M] clock of the chirp: 20 to 50 ppm, and ageing")
    strong_range_mm: int = quantity(200_000, "mm", 1_000, 2_000_000, "[M] minimum intensity up to 100 to 200 m")
    reference_tolerance_mm: int = quantity(
        20_000, "mm", 0, 100_000, "[D] both ways: balise 1.3 m, radar and map 0.3 m, odometer 5 m + 5 % of 50 m"
    )
    reference_distance_mm: int = quantity(0, "mm, 0: none", 0, 300_000, "[S] source l. 205: a variable of the system")
    reference_run_mm: int = quantity(500_000, "mm", 1, 10_000_000, "[D] the self-test ends here at the latest")
    search_run_mm: int = quantity(20_000, "mm", 0, 300_000, "[D] into the view zone; the tolerance is added")
    pause_limit_cycles: int = quantity(20, "cycles", 1, 10_000, "[D] 2 s without a radar frame")
    loss_limit_cycles: int = quantity(5, "cycles", 1, 10_000, "[D] 0.5 s of frames without the echo")
    balise_accuracy_mm: int = quantity(12_000, "mm", 0, 63_000, "[M] Q_NVLOCACC 12 m; overridden per balise")
    balise_latency_ms: int = quantity(12, "ms", 0, 1_000, "[S] balise reader 10 +- 2 ms")
    last_balise_identity: int = quantity(1_000_000, "count", 1, 1_000_000_000, "[D] identities of one line")
    told_distance: bool = False

    @model_validator(mode="after")
    def _can_locate(self) -> ReflectorConfig:
        if self.odometer.constant_mm >= self.tolerance_mm:
            raise ValueError(
                f"tolerance_mm {self.tolerance_mm} is not above the odometer's one-off constant "
                f"{self.odometer.constant_mm} mm: no distance can be run within it; raise it or use a better odometer."
            )
        if self.odometer.drift_mm_s2:
            raise ValueError(
                "odometer.drift_mm_s2 must be 0: a unit that integrates acceleration drifts with the time since a "
                "reference; use it as one unit of the odometry machine, beside one that measures distance."
            )
        if self.odometer.rate_ppm > MOST_RATE_PPM:
            raise ValueError(
                f"odometer.rate_ppm must not exceed {MOST_RATE_PPM}: such an odometer measures no distance."
            )
        return self

    @model_validator(mode="after")
    def _can_measure(self) -> ReflectorConfig:
        if self.range_limit_mm <= self.near_range_mm:
            raise ValueError(
                f"range_limit_mm {self.range_limit_mm} is not above near_range_mm {self.near_range_mm}: no echo can be used."
            )
        if max(self.frame_latency_ms, self.balise_latency_ms) > self.period_ms:
            raise ValueError("frame_latency_ms and balise_latency_ms must not exceed period_ms: older data is stale.")
        if self.reference_run_mm < self.max_step_mm:
            raise ValueError(f"reference_run_mm must not be below {self.max_step_mm} mm, the distance of one cycle.")
        return self

    @property
    def tolerance_nm(self) -> int:
        """The tolerable error."""
        return self.tolerance_mm * NM_PER_MM

    @property
    def accuracy_nm(self) -> int:
        """How far a reflector may stand from where the map has it."""
        return self.map_accuracy_mm * NM_PER_MM

    @property
    def max_step_mm(self) -> int:
        """The greatest distance of one cycle, measured."""
        return -(-self.max_speed_mm_s * self.period_ms // 1_000) + self.measuring_step_mm

    @property
    def blind_nm(self) -> int:
        """The farthest the vehicle gets in one cycle."""
        return self.max_speed_mm_s * self.period_ms * 1_000

    @property
    def radar(self) -> RadarLaw:
        """What judging an echo depends on."""
        return RadarLaw(
            minimum_intensity_cdb=self.minimum_intensity_cdb,
            near_mm=self.near_range_mm,
            accuracy_nm=self.accuracy_nm,
            tolerance_nm=self.tolerance_nm,
            limit_mm=self.position_limit_mm,
            scale_ppm=self.radar_scale_ppm,
            strong_nm=self.strong_range_mm * NM_PER_MM,
            left_open_nm=self.left_open_nm,
        )

    @property
    def left_open_nm(self) -> int:
        """The most of the radar's systematic error that a self-test may leave open, and that is charged."""
        return self.reference_tolerance_mm * NM_PER_MM

    @property
    def drift_nm(self) -> int:
        """The most by which the radar's systematic error changes in one cycle."""
        return self.radar_drift_mm_s * self.period_ms * NM_PER_UM

    def share_ppm(self, latency_ms: int) -> int:
        """A latency as share of the period, rounded up."""
        return -(-latency_ms * 1_000_000 // self.period_ms)


@dataclass(frozen=True, eq=False)
class Entry:
    """What the map tells of a reflector: where it stands, its model, and how far the next one of that model is away."""

    position: Num
    model: Num
    clear: Num

    @property
    def figures(self) -> tuple[Num, Num, Num]:
        """All of it, in order."""
        return (self.position, self.model, self.clear)


@dataclass(frozen=True, eq=False)
class Ghosts:
    """The world: where end A is, the wander of the odometer's error, and of each echo where it comes from.

    reflector  per slot: the echo comes from a reflector, be it the target or any other one of the line
    origin     per slot: where along the track it was reflected, nm
    bias       by how much the radar measures every range too long, nm: its systematic error, of any size
    scaled     per slot: what is wrong in proportion to the range, nm, positive where it is measured too long
    told       what the map told last
    sought     what the map told of the reflector that the machine names as its target, if that is another one
    """

    truth: NumVar
    true_step: NumVar
    wander: NumVar
    next_wander: NumVar
    reflector: tuple[BoolVar, ...]
    origin: tuple[NumVar, ...]
    bias: NumVar
    next_bias: NumVar
    scaled: tuple[NumVar, ...]
    told: Entry
    sought: Entry


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables the machine is made of; properties read them by name.

    open_long, open_short  how much too long (too short) the radar may measure every range, nm: what the last self-test
                           that passed left open, and what may have changed since; 0 where none passed
    """

    config: ReflectorConfig
    odometer: Odometer
    slots: tuple[Slot, ...]
    balise: BaliseReading
    ahead: NextReflector
    target: Target
    frame: BoolVar
    contradicted: BoolVar
    track: Track
    anchor: Track
    open_long: NumVar
    open_short: NumVar
    reference: NumVar
    search_from: NumVar
    run: NumVar
    procedure: NumVar
    found: NumVar
    pauses: NumVar
    misses: NumVar
    recognised: BoolVar
    range: NumVar
    range_error: NumVar
    lateral: NumVar
    error: NumVar
    ghosts: Ghosts


def parts(config: ReflectorConfig) -> Parts:
    """Fresh variables for one machine."""
    limit, reach, tolerance = config.position_limit_mm, config.range_limit_mm, config.tolerance_nm
    return Parts(
        config=config,
        odometer=_odometer(config),
        slots=tuple(slot(number_, reach) for number_ in range(1, config.echo_slots + 1)),
        balise=_balise(config),
        ahead=next_reflector(limit, reach, config.radar_offset_mm),
        target=target(limit, reach, config.radar_offset_mm),
        frame=boolean("frame_present"),
        contradicted=boolean("route_contradicted"),
        track=track("own_", "own_", limit, tolerance),
        anchor=track("anchor_", "anchor_", limit, tolerance + 2 * config.odometer.wander_nm + config.left_open_nm),
        open_long=number("open_long_nm", NM, 0, config.left_open_nm),
        open_short=number("open_short_nm", NM, 0, config.left_open_nm),
        reference=number("reference_mm", MM, 0, reach),
        search_from=number("search_from_mm", MM, 0, reach),
        run=number("run_since_balise_mm", MM, -config.reference_run_mm, config.reference_run_mm),
        procedure=number("procedure_balise", COUNT, 0, config.last_balise_identity),
        found=number("last_found_mm", MM, -limit - 1, limit),
        pauses=number("pauses", COUNT, 0, config.pause_limit_cycles),
        misses=number("misses", COUNT, 0, config.loss_limit_cycles),
        recognised=boolean("recognised_now"),
        range=number("measured_range_mm", MM, 0, reach),
        range_error=number("measured_error_mm", MM, 0, MAX_ERROR_MM),
        lateral=number("measured_lateral_mm", MM, -LATERAL_LIMIT_MM, LATERAL_LIMIT_MM),
        error=choice("error", enumeration(ERROR)),
        ghosts=_ghosts(config),
    )


def _odometer(config: ReflectorConfig) -> Odometer:
    reach = 2 * config.max_step_mm + 1_000
    return Odometer(
        optional("step_mm", MM, -reach, reach),
        number("odometer_gap_cycles", COUNT, 0, config.gap_limit_cycles + 1),
        config.odometer,
        config.period_ms,
        config.max_step_mm,
        config.blind_nm,
        config.gap_limit_cycles,
        number("step_more_nm", NM, 0, most_told_nm(config.max_step_mm)) if config.told_distance else None,
    )


def _balise(config: ReflectorConfig) -> BaliseReading:
    return balise_reading(
        config.position_limit_mm,
        config.max_step_mm,
        config.range_limit_mm,
        config.last_balise_identity,
        accuracy_mm=config.balise_accuracy_mm,
        latency_ppm=config.share_ppm(config.balise_latency_ms),
        law_ppm=config.odometer.rate_ppm,
    )


def _ghosts(config: ReflectorConfig) -> Ghosts:
    reach = (config.position_limit_mm + 2 * config.tolerance_mm + config.range_limit_mm) * NM_PER_MM
    most, slots = config.odometer.wander_nm, range(1, config.echo_slots + 1)
    scaled = config.range_limit_mm * config.radar_scale_ppm
    return Ghosts(
        number("truth_nm", NM, -reach, reach),
        number("true_step_nm", NM, -config.blind_nm, config.blind_nm),
        number("wander_nm", NM, -most, most),
        number("next_wander_nm", NM, -most, most),
        tuple(boolean(f"echo_{number_}_from_reflector") for number_ in slots),
        tuple(number(f"echo_{number_}_origin_nm", NM, -2 * reach, 2 * reach) for number_ in slots),
        number("radar_bias_nm", NM, -reach, reach),
        number("next_radar_bias_nm", NM, -reach, reach),
        tuple(number(f"echo_{number_}_scaled_nm", NM, -scaled, scaled) for number_ in slots),
        _entry("told", config),
        _entry("sought", config),
    )


def _entry(name: str, config: ReflectorConfig) -> Entry:
    limit = config.position_limit_mm
    return Entry(
        number(f"{name}_reflector_mm", MM, -limit, limit),
        choice(f"{name}_reflector_model", enumeration(MODEL)),
        number(f"{name}_reflector_clear_mm", MM, 0, limit),
    )
