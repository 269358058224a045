"""Configuration and variables of the balise machine."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    Bool,
    BoolVar,
    Num,
    NumVar,
    boolean,
    choice,
    enumeration,
    exact_to,
    members,
    number,
)
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.models.balise.linking import (
    LARGEST_ACCURACY_MM,
    NO_REACTION,
    REACTION,
    linking,
    national,
)
from safeloc.models.balise.telegram import Reader, check_telegram_age, telegram
from safeloc.models.vocabulary.error_law import WHEEL, ErrorLaw, check_counts_distance, check_measures
from safeloc.models.vocabulary.interval import StoredInterval
from safeloc.models.vocabulary.measured import Limits
from safeloc.models.vocabulary.odometer import Heading, odometer
from safeloc.models.vocabulary.reasons import NO_REFERENCE, REASON

READ = members(
    "read",
    "NONE",
    "ACCEPTED",
    "CANDIDATE",
    "MALFORMED",
    "CORRUPTED",
    "STALE",
    "REVERSING",
    "INCOMPLETE",
    "WRONG_DIRECTION",
    "MISMATCH",
    "TOO_EARLY",
    "TOO_LATE",
    "CONTRADICTED",
    "REPEATED",
    "UNLINKED",
    "NOT_ANNOUNCED",
    "NO_PLACE",
    "SINGLE",
    "OUT_OF_PLACE",
    "TOO_COARSE",
)
(
    NONE,
    ACCEPTED,
    CANDIDATE,
    MALFORMED,
    CORRUPTED,
    STALE,
    REVERSING,
    INCOMPLETE,
    WRONG_DIRECTION,
    MISMATCH,
    TOO_EARLY,
    TOO_LATE,
    CONTRADICTED,
    REPEATED,
    UNLINKED,
    NOT_ANNOUNCED,
    NO_PLACE,
    SINGLE,
    OUT_OF_PLACE,
    TOO_COARSE,
) = READ
FARTHEST_MM = 10**12
"""Upper limit of the count of measured distance: a million kilometres."""
DIRECTION = members("direction", "UNKNOWN", "ALONG")
DIRECTION_UNKNOWN, ALONG = DIRECTION


class BaliseConfig(Config):
    """Vehicle, odometer and line of a balise machine."""

    odometer: ErrorLaw = WHEEL
    period_ms: int = quantity(100, "ms", 10, 1_000, "[S] SUBSET-041: application cycle up to 100 ms")
    tolerance_mm: int = quantity(30_000, "mm", 2, 500_000, "[S] OCORA 7239: 30 m on main line")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    max_acceleration_mm_s2: int = quantity(2_500, "mm/s2", 1, 10_000, "[M] 2.5 m/s2 with track brake")
    measuring_step_mm: int = quantity(14, "mm", 0, 10_000, "[S] 100 pulses a turn: 13.4 mm")
    gap_limit_cycles: int = quantity(5, "cycles", 0, 1_000, "[D] 0.5 s without any distance")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")
    reversal_mm: int = quantity(2_000, "mm", 0, 100_000, "[S] D_NVROLL 2 m")
    antenna_mm: int = quantity(3_000, "mm", 0, 100_000, "[M] balise antenna behind the front end")
    detection_mm: int = quantity(1_000, "mm", 0, 10_000, "[M, sure] safety-related detection accuracy 1 m")
    default_accuracy_mm: int = quantity(12_000, "mm", 0, LARGEST_ACCURACY_MM, "[M] Q_NVLOCACC 12 m")
    telegram_age_limit_ms: int = quantity(1_000, "ms", 1, 10_000, "[S] EUG 22E126: no data older than 1 s")
    reflector_reach_mm: int = quantity(10_000_000, "mm", 1, 100_000_000, "[D] a reflector within 10 km of its balise")
    announced_groups: int = quantity(2, "count", 2, 8, "[D] the expected group and the one after it")
    refusal_limit_groups: int = quantity(
        3, "count", 1, 100, "[D] two false groups in a row are rare; a third speaks against the position"
    )
    last_group_identity: int = quantity(16_777_216, "count", 1, 1_000_000_000, "[S] NID_C 10 bits, NID_BG 14 bits")
    trust_first_group: bool = False
    free_references: bool = False
    checked_distance: bool = False

    @model_validator(mode="after")
    def _can_locate(self) -> BaliseConfig:
        least = self.odometer.constant_mm + self.detection_mm + self.measuring_step_mm
        if least >= self.tolerance_mm:
            raise ValueError(
                f"tolerance_mm {self.tolerance_mm} is not above the odometer's one-off constant, the detection accuracy and "
                f"one measuring step, {least} mm together: no group can locate within it; raise the tolerance."
            )
        check_measures(self.odometer)
        check_telegram_age(self.telegram_age_limit_ms, self.period_ms)
        check_counts_distance(self.odometer)
        return self

    @property
    def limits(self) -> Limits:
        """Limits of the odometer, rounded so that the checks are no tighter than physics."""
        return Limits.of(self, self.tolerance_mm, self.position_limit_mm)

    @property
    def reader(self) -> Reader:
        """The antenna, and the errors of a reading."""
        return Reader.of(self)


@dataclass(frozen=True, eq=False)
class Memory:
    """State: what the machine remembers of groups, and the outcome of the last cycle.

    group, last_group_position     the last group that set the interval (accepted, or the candidate); 0: none
    given_up_group         the last announced group whose expectation ended without acceptance; 0: none
    missed_in_row           announced groups in a row that were given up, at most 2
    given_up_now            announced groups given up in this cycle
    refused_in_row          announced groups in a row that were read whole, but not where or as announced; 0 after an accepted one
    accuracy         location accuracy of the last group that set the interval
    run              distance measured since that group
    measured         `run` is the whole way: the group came with a latched counter, and no distance was missing since
    direction        ALONG once groups have shown that the vehicle runs along the route
    verdict, linking_reaction_now, reason   of the cycle: on the telegram, of linking, and why no position is reported
    """

    group: NumVar
    last_group_position: NumVar
    given_up_group: NumVar
    missed_in_row: NumVar
    given_up_now: NumVar
    refused_in_row: NumVar
    accuracy: NumVar
    run: NumVar
    measured: BoolVar
    direction: NumVar
    verdict: NumVar
    linking_reaction_now: NumVar
    reason: NumVar


@dataclass(frozen=True, eq=False)
class Ahead:
    """State: a place that the last accepted telegram gave (RFL-9); 0 while it is not `known`."""

    known: BoolVar
    place: NumVar

    def lies_ahead(self, passed_nm: Num) -> Bool:
        """Return whether the place is known and the min safe front end is not beyond it."""
        return self.known & (passed_nm <= exact_to(self.place, NM))


@dataclass(frozen=True, eq=False)
class Movement:
    """The true movement of a vehicle and its odometer's one-off error, each with its value after the cycle; nm."""

    truth: NumVar
    true_cycle_distance: NumVar
    wander: NumVar
    next_wander: NumVar


def movement(config: BaliseConfig) -> Movement:
    """Make the variables of a movement; a machine that follows another one's movement takes that one's."""
    limits, half = config.limits, config.odometer.wander_nm
    line = _line_nm(config)
    return Movement(
        number("truth_nm", NM, -line, line),
        number("true_cycle_distance_nm", NM, -limits.blind_nm, limits.blind_nm),
        number("odometer_wander_nm", NM, -half, half),
        number("odometer_next_wander_nm", NM, -half, half),
    )


def _line_nm(config: BaliseConfig) -> int:
    return (config.position_limit_mm + 2 * config.tolerance_mm) * NM_PER_MM


class Ghosts:
    """The variables of the world: the true place of the front end, and the true errors; nm.

    truth, true_cycle_distance        the front end, and its run in the cycle
    wander, next_wander     the one-off part of the odometer's error, before the cycle and, freely chosen, after it
    last_delivered, silent  the last distance of the odometer that the vehicle can have run, mm, and the cycles since then
    backwards, rolled       the direction of running as measured, and the distance run against it without a break, mm
    national_accuracy_sent                the national location accuracy, as last received, mm
    doubted_group                 the identity of the last group that lay far from its place, until another group serves; 0: none
    read_place                    the true place of balise 1 of the group that is read
    true_since              the true run of the vehicle since the reading
    reading_wander          the one-off part of the odometer's error at the reading
    """

    def __init__(self, declared: Declared, config: BaliseConfig, moved: Movement) -> None:
        limits, half, most = config.limits, config.odometer.wander_nm, LARGEST_ACCURACY_MM
        self.truth = declared.ghost(moved.truth, first=ANY)
        self.wander = declared.ghost(moved.wander, first=ANY)
        received = number("national_accuracy_sent_mm", MM, 0, most)
        self.national_accuracy_sent = declared.ghost(received, first=config.default_accuracy_mm)
        self.doubted_group = declared.ghost(number("doubted_group", COUNT, 0, config.last_group_identity), first=0)
        self.backwards = declared.ghost(boolean("truly_backwards"), first=False)
        self.rolled = declared.ghost(number("truly_rolled_mm", MM, 0, config.reversal_mm), first=0)
        self.last_delivered = number(
            "odometer_last_delivered_mm", MM, -limits.max_cycle_distance_mm, limits.max_cycle_distance_mm
        )
        self.silent = number("odometer_silent_cycles", COUNT, 0, config.gap_limit_cycles + 1)
        if not config.checked_distance:
            declared.ghost(self.last_delivered, first=0)
            declared.ghost(self.silent, first=config.gap_limit_cycles + 1)
        since = (
            20 * limits.max_cycle_distance_mm * NM_PER_MM
            + 10 * config.telegram_age_limit_ms * config.max_speed_mm_s * 1_000
        )
        apart = _line_nm(config) + since + (config.antenna_mm + config.detection_mm) * NM_PER_MM
        self.true_cycle_distance = declared.choice(moved.true_cycle_distance)
        self.next_wander = declared.choice(moved.next_wander)
        self.read_place = declared.choice(number("read_place_nm", NM, -apart, apart))
        self.true_since = declared.choice(number("true_since_nm", NM, -since, since))
        self.reading_wander = declared.choice(number("reading_wander_nm", NM, -half, half))


class Parts:
    """The variables of the machine and its world; properties read them by name.

    held                the interval of the front end
    odometer, heading   the measured distance, and the direction of running
    read                inputs: the group reading of the cycle
    linking, national   the announced groups, and the national location accuracy
    memory              state: groups read before, and the outcome of the cycle
    reflector, search   state: place of the next reflector, and place where its search may begin
    world               ghosts
    """

    def __init__(self, config: BaliseConfig, moved: Movement | None = None) -> None:
        self.declared = declared = Declared()
        self.config, limits = config, config.limits
        lines = {"last_identity": config.last_group_identity, "position_limit_mm": config.position_limit_mm}
        self.held = _held(declared, config)
        self.odometer = odometer(config.odometer, config.limits, checked=config.checked_distance).declare(declared)
        self.heading = Heading(
            declared.state(boolean("backwards"), first=False),
            declared.state(number("rolled_mm", MM, 0, config.reversal_mm), first=0),
            config.reversal_mm,
        )
        self.read = telegram(
            declared,
            **lines,
            max_cycle_distance_mm=limits.max_cycle_distance_mm,
            age_limit_ms=config.telegram_age_limit_ms,
            reflector_reach_mm=config.reflector_reach_mm,
        )
        self.linking = linking(declared, config.announced_groups, **lines)
        self.national = national(declared, config.default_accuracy_mm)
        self.memory = _memory(declared, config)
        self.reflector = _ahead(declared, "reflector", config)
        self.search = _ahead(declared, "search", config)
        self.world = Ghosts(declared, config, moved or movement(config))


def parts(config: BaliseConfig, *, moved: Movement | None = None) -> Parts:
    """Declare the variables of one machine; `moved`: the true movement, where another machine's world moves the vehicle."""
    return Parts(config, moved)


def _held(declared: Declared, config: BaliseConfig) -> StoredInterval:
    place, tolerance = config.position_limit_mm * NM_PER_MM, config.limits.tolerance_nm
    return StoredInterval(
        declared.state(number("position_nm", NM, -place, place), first=0),
        declared.state(number("margin_above_nm", NM, 0, tolerance), first=0),
        declared.state(number("margin_below_nm", NM, 0, tolerance), first=0),
    )


def _memory(declared: Declared, config: BaliseConfig) -> Memory:
    place, identities = config.position_limit_mm, config.last_group_identity
    return Memory(
        group=declared.state(number("last_group", COUNT, 0, identities), first=0),
        last_group_position=declared.state(number("last_group_position_mm", MM, -place, place), first=0),
        given_up_group=declared.state(number("given_up_group", COUNT, 0, identities), first=0),
        missed_in_row=declared.state(number("missed_in_row", COUNT, 0, 2), first=0),
        given_up_now=declared.state(number("given_up_now", COUNT, 0, config.announced_groups), first=0),
        refused_in_row=declared.state(number("refused_in_row", COUNT, 0, config.refusal_limit_groups), first=0),
        accuracy=declared.state(number("added_accuracy_mm", MM, 0, LARGEST_ACCURACY_MM), first=0),
        run=declared.state(number("run_mm", MM, 0, FARTHEST_MM), first=0),
        measured=declared.state(boolean("complete_run_measured"), first=False),
        direction=declared.state(choice("known_direction", enumeration(DIRECTION)), first=DIRECTION_UNKNOWN),
        verdict=declared.state(choice("telegram_last_verdict", enumeration(READ)), first=NONE),
        linking_reaction_now=declared.state(choice("linking_reaction_now", enumeration(REACTION)), first=NO_REACTION),
        reason=declared.state(choice("reason", enumeration(REASON)), first=NO_REFERENCE),
    )


def _ahead(declared: Declared, name: str, config: BaliseConfig) -> Ahead:
    reach = config.position_limit_mm + config.reflector_reach_mm
    return Ahead(
        declared.state(boolean(f"{name}_place_known"), first=False),
        declared.state(number(f"{name}_place_mm", MM, -reach, reach), first=0),
    )
