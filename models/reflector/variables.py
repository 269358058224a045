"""Configuration and variables of the reflector machine."""

from __future__ import annotations

from typing import ClassVar

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import boolean, choice, enumeration, members, number, optional
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM, NM_PER_UM
from safeloc.models.reflector.balise_reading import BaliseReading, balise_reading
from safeloc.models.reflector.echo import RadarLaw, slot
from safeloc.models.reflector.ghosts import Moving, ghosts
from safeloc.models.reflector.map_data import next_reflector, target
from safeloc.models.reflector.odometer import ReflectorOdometer
from safeloc.models.reflector.ranging import RADAR, Ranging
from safeloc.models.vocabulary.error_law import WHEEL, ErrorLaw, check_measures
from safeloc.models.vocabulary.interval import StoredInterval
from safeloc.models.vocabulary.measured import max_cycle_distance_mm
from safeloc.models.vocabulary.odometer import most_further_error_nm
from safeloc.models.vocabulary.reflectors import LATERAL_LIMIT_MM, MAX_ERROR_MM

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
    """Everything about vehicle, radar and line that the reflector machine depends on.

    ranging  sources of the laws on ranges; a sensor in place of the radar has its own (`range_sensors`)
    """

    ranging: ClassVar[Ranging] = RADAR
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
    near_range_mm: int = quantity(
        3_000, "mm", 1, 100_000, "[M] nearer, the radar receives its own signal (source l. 209)"
    )
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
    checked_distance: bool = False

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
        check_measures(self.odometer)
        return self

    @model_validator(mode="after")
    def _can_measure(self) -> ReflectorConfig:
        if self.range_limit_mm <= self.near_range_mm:
            raise ValueError(
                f"range_limit_mm {self.range_limit_mm} is not above near_range_mm {self.near_range_mm}: no echo can be used."
            )
        if max(self.frame_latency_ms, self.balise_latency_ms) > self.period_ms:
            raise ValueError("frame_latency_ms and balise_latency_ms must not exceed period_ms: older data is stale.")
        if self.reference_run_mm < self.max_cycle_distance_mm:
            raise ValueError(
                f"reference_run_mm must not be below {self.max_cycle_distance_mm} mm, the distance of one cycle."
            )
        return self

    @property
    def tolerance_nm(self) -> int:
        """The tolerable error, nm."""
        return self.tolerance_mm * NM_PER_MM

    @property
    def accuracy_nm(self) -> int:
        """The greatest distance of a reflector from its place on the map, nm."""
        return self.map_accuracy_mm * NM_PER_MM

    @property
    def max_cycle_distance_mm(self) -> int:
        """The greatest distance that is measured in a cycle, mm."""
        return max_cycle_distance_mm(self.max_speed_mm_s, self.period_ms, self.measuring_step_mm)

    @property
    def blind_nm(self) -> int:
        """The farthest that the vehicle gets in a cycle, nm."""
        return self.max_speed_mm_s * self.period_ms * 1_000

    @property
    def gap_limit(self) -> int:
        """The most cycles without a usable distance."""
        return self.gap_limit_cycles

    @property
    def radar(self) -> RadarLaw:
        """The figures that echoes are judged by."""
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
        """The most of the radar's systematic error that a self-test may fail to exclude, and that margins then include, nm."""
        return self.reference_tolerance_mm * NM_PER_MM

    @property
    def drift_nm(self) -> int:
        """The most by which the radar's systematic error changes in a cycle, nm."""
        return self.radar_drift_mm_s * self.period_ms * NM_PER_UM

    @property
    def reach_nm(self) -> int:
        """The farthest place that end A may have, nm."""
        return (self.position_limit_mm + 2 * self.tolerance_mm + self.range_limit_mm) * NM_PER_MM

    def share_ppm(self, latency_ms: int) -> int:
        """Return a latency as a share of the period, ppm, rounded up."""
        return -(-latency_ms * 1_000_000 // self.period_ms)


class Parts:
    """The variables of the machine.

    odometer     distance measured in the cycle
    frame_present        a radar frame came in the cycle, with an echo in each of the `slots`
    balise       reading of a balise, absent in most cycles
    ahead        the map's next reflector
    contradicted the route machine found the route contradicted
    track        confidence interval of end A
    anchor       in the view zone its first interval, in a self-test what is known without the radar; both run on
    target       the reflector that is searched, tracked, or measured in a self-test
    open_long, open_short  how much too long (too short) the radar may measure every range, nm: what the last self-test
                 that passed left open, and the drift since; 0 where none passed
    reference    prescribed distance from the balise of the self-test to its reflector
    search_from  distance after that balise from which the reflector is searched; 0: by its view zone on the map
    run_since_balise          distance run since that balise
    procedure_balise    the balise that started the last self-test; 0: none
    found        place of the reflector found last; its lowest value: none
    pauses, misses  cycles in a row without a frame, and frames in a row without the target's echo
    recognised_now   the target was recognised in this cycle
    range, measured_error, lateral  the measurement of this cycle, 0 where there is none
    error        why there is no position, or no precise one
    """

    def __init__(self, config: ReflectorConfig, moving: Moving) -> None:
        self.declared = declared = Declared()
        limit, reach, offset = config.position_limit_mm, config.range_limit_mm, config.radar_offset_mm
        anchored = config.tolerance_nm + 2 * config.odometer.wander_nm + config.left_open_nm
        self.config = config
        self.track = _stored(declared, "own", limit, config.tolerance_nm)
        self.anchor = _stored(declared, "anchor", limit, anchored)
        self.target = target(declared, limit, reach, offset)
        self.open_long = declared.state(number("open_long_nm", NM, 0, config.left_open_nm), first=0)
        self.open_short = declared.state(number("open_short_nm", NM, 0, config.left_open_nm), first=0)
        self.odometer = _odometer(declared, config)
        self.reference = declared.state(number("reference_mm", MM, 0, reach), first=0)
        self.search_from = declared.state(number("search_from_mm", MM, 0, reach), first=0)
        self.run_since_balise = declared.state(
            number("run_since_balise_mm", MM, -config.reference_run_mm, config.reference_run_mm), first=0
        )
        self.procedure_balise = declared.state(
            number("procedure_balise", COUNT, 0, config.last_balise_identity), first=0
        )
        self.found = declared.state(number("last_found_mm", MM, -limit - 1, limit), first=-limit - 1)
        self.pauses = declared.state(number("pauses", COUNT, 0, config.pause_limit_cycles), first=0)
        self.misses = declared.state(number("misses", COUNT, 0, config.loss_limit_cycles), first=0)
        self.recognised_now = declared.state(boolean("recognised_now"), first=False)
        self.range = declared.state(number("measured_range_mm", MM, 0, reach), first=0)
        self.measured_error = declared.state(number("measured_error_mm", MM, 0, MAX_ERROR_MM), first=0)
        self.lateral = declared.state(number("measured_lateral_mm", MM, -LATERAL_LIMIT_MM, LATERAL_LIMIT_MM), first=0)
        self.error = declared.state(choice("error", enumeration(ERROR)), first=NO_POSITION)
        self.frame_present = declared.sensor(boolean("frame_present"))
        self.slots = tuple(slot(declared, number_, reach) for number_ in range(1, config.echo_slots + 1))
        self.balise = _balise(declared, config)
        self.ahead = next_reflector(declared, limit, reach, offset)
        self.contradicted = declared.sensor(boolean("route_contradicted"))
        self.ghosts = ghosts(declared, moving, config)


def parts(config: ReflectorConfig) -> Parts:
    """Return fresh variables for one machine; where another machine's world moves the vehicle, use `Parts` with its ghosts."""
    return Parts(config, moving(config))


def moving(config: ReflectorConfig) -> Moving:
    """Return fresh ghosts of the vehicle's movement."""
    reach, most = config.reach_nm, config.odometer.wander_nm
    return Moving(
        truth=number("truth_nm", NM, -reach, reach),
        true_cycle_distance=number("true_cycle_distance_nm", NM, -config.blind_nm, config.blind_nm),
        wander=number("wander_nm", NM, -most, most),
        next_wander=number("next_wander_nm", NM, -most, most),
    )


def _stored(declared: Declared, name: str, limit_mm: int, tolerance_nm: int) -> StoredInterval:
    return StoredInterval(
        declared.state(number(f"{name}_position_mm", MM, -limit_mm, limit_mm), first=0),
        declared.state(number(f"{name}_margin_above_nm", NM, 0, tolerance_nm), first=0),
        declared.state(number(f"{name}_margin_below_nm", NM, 0, tolerance_nm), first=0),
    )


def _odometer(declared: Declared, config: ReflectorConfig) -> ReflectorOdometer:
    reach, most = 2 * config.max_cycle_distance_mm + 1_000, most_further_error_nm(config.max_cycle_distance_mm)
    return ReflectorOdometer(
        config.odometer,
        declared.sensor(optional("distance_mm", MM, -reach, reach)),
        declared.state(number("odometer_gap_cycles", COUNT, 0, config.gap_limit_cycles + 1), first=0),
        config,
        more=declared.sensor(number("distance_more_nm", NM, 0, most)) if config.checked_distance else None,
    )


def _balise(declared: Declared, config: ReflectorConfig) -> BaliseReading:
    return balise_reading(
        declared,
        config.position_limit_mm,
        config.max_cycle_distance_mm,
        config.range_limit_mm,
        config.last_balise_identity,
        accuracy_mm=config.balise_accuracy_mm,
        latency_ppm=config.share_ppm(config.balise_latency_ms),
        law_ppm=config.odometer.rate_ppm,
    )
