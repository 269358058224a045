"""Configuration and variables of the machine that keeps an unlinked balise group as a reference."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import NumVar, boolean, choice, enumeration, members, number
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM, MS, NM, NM_PER_MM, PPM_PER_ONE
from safeloc.models.balise.linking import LARGEST_ACCURACY_MM, national
from safeloc.models.balise.telegram import ORIENTATION, UNKNOWN, Reader, check_telegram_age, reading
from safeloc.models.vocabulary.error_law import WHEEL, ErrorLaw, check_counts_distance, check_measures
from safeloc.models.vocabulary.interval import StoredInterval
from safeloc.models.vocabulary.measured import Limits, max_cycle_distance_mm
from safeloc.models.vocabulary.odometer import Heading, odometer

READ = members(
    "unlinked_reading",
    "NONE",
    "TAKEN",
    "MALFORMED",
    "CORRUPTED",
    "STALE",
    "REVERSING",
    "LINKED",
    "SINGLE",
    "INCOMPLETE",
)
NONE, TAKEN, MALFORMED, CORRUPTED, STALE, REVERSING, MARKED_LINKED, SINGLE, INCOMPLETE = READ
WHY = members("no_reference", "NONE", "NO_GROUP", "TOLERANCE", "SENSOR_FAILURE", "REVERSED")
HELD, NO_GROUP, TOLERANCE, SENSOR_FAILURE, REVERSED = WHY
LONGEST_AGE_MS = 10**9
"""The age of a reference is counted up to this: eleven days."""
LINE_MM = 2_000_000_000
"""No vehicle gets farther than this from a group: two thousand kilometres of line."""


class UnlinkedGroupConfig(Config):
    """Vehicle and odometer of the machine: figures of the same names as those of the balise machine beside it."""

    odometer: ErrorLaw = WHEEL
    period_ms: int = quantity(100, "ms", 10, 1_000, "[S] SUBSET-041: application cycle up to 100 ms")
    tolerance_mm: int = quantity(200_000, "mm", 2, 20_000_000, "[D] 5 % of 4 km: as far as a restriction is told ahead")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    max_acceleration_mm_s2: int = quantity(2_500, "mm/s2", 1, 10_000, "[M] 2.5 m/s2 with track brake")
    measuring_step_mm: int = quantity(14, "mm", 0, 10_000, "[S] 100 pulses a turn: 13.4 mm")
    gap_limit_cycles: int = quantity(5, "cycles", 0, 1_000, "[D] 0.5 s without any distance")
    reversal_mm: int = quantity(2_000, "mm", 0, 100_000, "[S] D_NVROLL 2 m")
    antenna_mm: int = quantity(3_000, "mm", 0, 100_000, "[M] balise antenna behind the front end")
    detection_mm: int = quantity(1_000, "mm", 0, 10_000, "[M, sure] safety-related detection accuracy 1 m")
    default_accuracy_mm: int = quantity(12_000, "mm", 0, LARGEST_ACCURACY_MM, "[M] Q_NVLOCACC 12 m")
    telegram_age_limit_ms: int = quantity(1_000, "ms", 1, 10_000, "[S] EUG 22E126: no data older than 1 s")
    last_group_identity: int = quantity(16_777_216, "count", 1, 1_000_000_000, "[S] NID_C 10 bits, NID_BG 14 bits")
    reach_mm: int = quantity(
        327_660_000, "mm", 1_000, 1_000_000_000, "[S] SUBSET-026 7.5: distances of packets have 15 bits, 10 m at most"
    )

    @model_validator(mode="after")
    def _can_measure(self) -> UnlinkedGroupConfig:
        check_measures(self.odometer)
        check_counts_distance(self.odometer)
        check_telegram_age(self.telegram_age_limit_ms, self.period_ms)
        if self.first_margin_mm > self.tolerance_mm:
            raise ValueError(
                f"tolerance_mm {self.tolerance_mm} is below {self.first_margin_mm} mm, the widest margin right after a reading: "
                "detection accuracy, the odometer's one-off constant, and the error of the run since the reading; raise it."
            )
        if self.antenna_mm + 10 * self.max_cycle_distance_mm > self.reach_mm:
            raise ValueError(
                f"reach_mm {self.reach_mm} is below {self.antenna_mm + 10 * self.max_cycle_distance_mm} mm, the farthest distance right "
                "after a reading: antenna, and ten cycles at the highest speed; raise it."
            )
        return self

    @property
    def first_margin_mm(self) -> int:
        """The widest margin right after a reading, mm, rounded up."""
        counted = -(-10 * self.max_cycle_distance_mm * self.odometer.rate_ppm // PPM_PER_ONE)
        unmeasured = -(-self.max_speed_mm_s * self.telegram_age_limit_ms // 1_000) + self.measuring_step_mm
        return self.detection_mm + self.odometer.constant_mm + max(counted, unmeasured)

    @property
    def max_cycle_distance_mm(self) -> int:
        """The greatest distance that is measured in a cycle at the highest speed, mm."""
        return max_cycle_distance_mm(self.max_speed_mm_s, self.period_ms, self.measuring_step_mm)

    @property
    def limits(self) -> Limits:
        """Limits of the odometer, rounded so that the checks are no tighter than physics."""
        return Limits.of(self, self.tolerance_mm, self.reach_mm)

    @property
    def reader(self) -> Reader:
        """The antenna, and the errors of a reading."""
        return Reader.of(self)


@dataclass(frozen=True, eq=False)
class Memory:
    """State: the last reference, which is reported only while it is held, and the outcome of the last cycle.

    group, passed  identity of the group, and the orientation in which it was passed
    accuracy       location accuracy of the group: the national value, or its default, when the group was read
    age            time since the reading
    verdict, reason   of the cycle: on the reading, and why there is no reference
    """

    group: NumVar
    passed: NumVar
    accuracy: NumVar
    age: NumVar
    verdict: NumVar
    reason: NumVar


class Ghosts:
    """The variables of the world; nm.

    distance             the true distance of the front end beyond balise 1 of the last unlinked group that can be a reference
    wander, next_wander  the one-off part of the odometer's error, before the cycle and, freely chosen, after it
    last_delivered, silent  the last distance of the odometer that the vehicle can have run, mm, and the cycles since then
    backwards, rolled    the direction of running as measured, and the distance run against it without a break, mm
    national_accuracy_sent             the national location accuracy, as last received, mm
    true_cycle_distance            the true run of the cycle
    read_beyond             how far the antenna was beyond balise 1 when it reported to stand over it
    true_since           the true run of the vehicle since the reading
    reading_wander       the one-off part of the odometer's error at the reading
    """

    def __init__(self, declared: Declared, config: UnlinkedGroupConfig) -> None:
        limits, half, line = config.limits, config.odometer.wander_nm, LINE_MM * NM_PER_MM
        since = (
            20 * limits.max_cycle_distance_mm * NM_PER_MM
            + 10 * config.telegram_age_limit_ms * config.max_speed_mm_s * 1_000
        )
        off = 2 * config.detection_mm * NM_PER_MM
        self.distance = declared.ghost(number("true_distance_nm", NM, -line, line), first=ANY)
        self.wander = declared.ghost(number("odometer_wander_nm", NM, -half, half), first=ANY)
        self.last_delivered = declared.ghost(
            number("odometer_last_delivered_mm", MM, -limits.max_cycle_distance_mm, limits.max_cycle_distance_mm),
            first=0,
        )
        self.silent = declared.ghost(
            number("odometer_silent_cycles", COUNT, 0, limits.gap_limit + 1), first=limits.gap_limit + 1
        )
        self.backwards = declared.ghost(boolean("truly_backwards"), first=False)
        self.rolled = declared.ghost(number("truly_rolled_mm", MM, 0, config.reversal_mm), first=0)
        told = number("national_accuracy_sent_mm", MM, 0, LARGEST_ACCURACY_MM)
        self.national_accuracy_sent = declared.ghost(told, first=config.default_accuracy_mm)
        self.true_cycle_distance = declared.choice(
            number("true_cycle_distance_nm", NM, -limits.blind_nm, limits.blind_nm)
        )
        self.next_wander = declared.choice(number("odometer_next_wander_nm", NM, -half, half))
        self.read_beyond = declared.choice(number("read_beyond_nm", NM, -off, off))
        self.true_since = declared.choice(number("true_since_nm", NM, -since, since))
        self.reading_wander = declared.choice(number("reading_wander_nm", NM, -half, half))


class Parts:
    """The variables of the machine and its world; properties read them by name.

    held                the interval of the distance of the front end beyond balise 1 of the group
    odometer, heading   the measured distance, and the direction of running
    read                inputs: the group reading of the cycle
    national            the national location accuracy
    memory              state: the reference, and the outcome of the cycle
    world               ghosts
    """

    def __init__(self, config: UnlinkedGroupConfig) -> None:
        self.declared = declared = Declared()
        self.config, limits = config, config.limits
        self.held = _held(declared, config)
        self.odometer = odometer(config.odometer, limits).declare(declared)
        self.heading = Heading(
            declared.state(boolean("backwards"), first=False),
            declared.state(number("rolled_mm", MM, 0, config.reversal_mm), first=0),
            config.reversal_mm,
        )
        self.read = reading(
            declared,
            last_identity=config.last_group_identity,
            max_cycle_distance_mm=limits.max_cycle_distance_mm,
            age_limit_ms=config.telegram_age_limit_ms,
        )
        self.national = national(declared, config.default_accuracy_mm)
        self.memory = _memory(declared, config)
        self.world = Ghosts(declared, config)


def parts(config: UnlinkedGroupConfig) -> Parts:
    """Declare the variables of one machine."""
    return Parts(config)


def _held(declared: Declared, config: UnlinkedGroupConfig) -> StoredInterval:
    reach, most = config.reach_mm, config.limits.tolerance_nm
    return StoredInterval(
        declared.state(number("distance_run_mm", MM, -reach, reach), first=0),
        declared.state(number("under_reading_nm", NM, 0, most), first=0),
        declared.state(number("over_reading_nm", NM, 0, most), first=0),
    )


def _memory(declared: Declared, config: UnlinkedGroupConfig) -> Memory:
    return Memory(
        group=declared.state(number("reference_group", COUNT, 0, config.last_group_identity), first=0),
        passed=declared.state(choice("reference_passed", enumeration(ORIENTATION)), first=UNKNOWN),
        accuracy=declared.state(number("reference_accuracy_mm", MM, 0, LARGEST_ACCURACY_MM), first=0),
        age=declared.state(number("reference_age_ms", MS, 0, LONGEST_AGE_MS), first=0),
        verdict=declared.state(choice("telegram_last_verdict", enumeration(READ)), first=NONE),
        reason=declared.state(choice("reason", enumeration(WHY)), first=NO_GROUP),
    )
