"""Configuration and variables of the balise machine."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.expr import (
    Bool,
    BoolVar,
    Expr,
    Num,
    NumVar,
    Optional,
    Var,
    as_num,
    boolean,
    choice,
    enumeration,
    exact_to,
    ite,
    members,
    number,
)
from safeloc.language.machine import Initial
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.models.balise.linking import (
    LARGEST_ACCURACY_MM,
    NO_REACTION,
    REACTION,
    Linking,
    National,
    linking,
    national,
)
from safeloc.models.balise.telegram import Reader, Telegram, telegram
from safeloc.models.vocabulary.error_law import MOST_RATE_PPM, WHEEL, ErrorLaw
from safeloc.models.vocabulary.interval import StoredInterval
from safeloc.models.vocabulary.measured import Limits
from safeloc.models.vocabulary.odometer import Heading, Odometer, odometer
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
"""Where the count of measured distance ends: a million kilometres."""
DIRECTION = members("direction", "UNKNOWN", "ALONG")
DIRECTION_UNKNOWN, ALONG = DIRECTION


class BaliseConfig(Config):
    """Everything about vehicle, odometer and line that the balise machine depends on."""

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
    last_group_identity: int = quantity(16_777_216, "count", 1, 1_000_000_000, "[S] NID_C 10 bits, NID_BG 14 bits")
    trust_first_group: bool = False
    free_references: bool = False
    told_distance: bool = False

    @model_validator(mode="after")
    def _can_locate(self) -> BaliseConfig:
        least = self.odometer.constant_mm + self.detection_mm + self.measuring_step_mm
        if least >= self.tolerance_mm:
            raise ValueError(
                f"tolerance_mm {self.tolerance_mm} is not above the odometer's one-off constant, the detection accuracy and "
                f"one measuring step, {least} mm together: no group can locate within it; raise the tolerance."
            )
        if self.odometer.rate_ppm > MOST_RATE_PPM:
            raise ValueError(
                f"odometer.rate_ppm must not exceed {MOST_RATE_PPM}: such an odometer measures no distance."
            )
        if 10 * self.telegram_age_limit_ms <= self.period_ms:
            raise ValueError(
                f"telegram_age_limit_ms {self.telegram_age_limit_ms} must be above a tenth of period_ms {self.period_ms}: "
                "a telegram read within a cycle is up to that cycle old at its end."
            )
        if self.odometer.drift_mm_s2:
            raise ValueError("odometer.drift_mm_s2 must be 0: this machine takes a unit that counts distance.")
        return self

    @property
    def limits(self) -> Limits:
        """What the odometer needs, rounded so that gates are no tighter than physics."""
        step = -(-self.max_speed_mm_s * self.period_ms // 1_000) + self.measuring_step_mm
        change = -(-self.max_acceleration_mm_s2 * self.period_ms**2 // 1_000_000) + 2 * self.measuring_step_mm
        gap = self.gap_limit_cycles
        return Limits(
            self.period_ms, self.tolerance_mm, self.max_speed_mm_s, step, change, gap, gap, 0, self.position_limit_mm, False
        )  # fmt: skip

    @property
    def reader(self) -> Reader:
        """What is charged for a reading."""
        return Reader(
            self.antenna_mm,
            self.detection_mm,
            2 * self.odometer.wander_nm,
            self.odometer.rate_ppm,
            self.period_ms,
            self.max_speed_mm_s,
            self.measuring_step_mm,
        )


@dataclass(frozen=True, eq=False)
class Memory:
    """What is remembered of groups, and what the last cycle did.

    group, place     the last group that counted (accepted, or the candidate); 0: none
    given_up         the last announced group whose expectation ended without it being accepted; 0: none
    missed           announced groups in a row that were given up, at most 2
    ended            announced groups given up in this cycle
    accuracy         location accuracy that the last group that counted was charged with
    run              distance measured since that group
    measured         that is the whole way: the group came with a latched counter, and no distance was missing since
    """

    group: NumVar
    place: NumVar
    given_up: NumVar
    missed: NumVar
    ended: NumVar
    accuracy: NumVar
    run: NumVar
    measured: BoolVar
    direction: NumVar
    verdict: NumVar
    reaction: NumVar
    reason: NumVar

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values: nothing was read."""
        zeros = (self.group, self.place, self.given_up, self.missed, self.ended, self.accuracy, self.run)
        counts: dict[Var, Initial] = dict.fromkeys(zeros, 0)
        said: dict[Var, Initial] = {self.verdict: NONE, self.reaction: NO_REACTION, self.reason: NO_REFERENCE}
        return {**counts, self.measured: False, self.direction: DIRECTION_UNKNOWN, **said}


@dataclass(frozen=True, eq=False)
class Ahead:
    """What the last accepted telegram says of the next reflector (RFL-9): its place, and from where to search."""

    known: BoolVar
    place: NumVar

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values: nothing is known."""
        return {self.known: False, self.place: 0}

    def become(self, known: Bool, place: Num) -> dict[Var, Expr]:
        """Updates; an unknown place holds 0."""
        return {self.known: known, self.place: ite(known, place, as_num(0, MM))}

    def keep(self, passed: Num) -> dict[Var, Expr]:
        """Updates of a cycle without a telegram; forgotten once the min safe front end (`passed`, nm) is beyond it."""
        return self.become(self.known & (passed <= exact_to(self.place, NM)), self.place)


@dataclass(frozen=True, eq=False)
class World:
    """The environment: where the front end really is, and what the errors really are; nm.

    truth, true_step        the front end, and how far it runs in the cycle
    wander, next_wander     the one-off part of the odometer's error, before the cycle and, freely chosen, after it
    heard, silent           the last distance that the odometer delivered and that can have been run, mm, and the cycles since
    backwards, rolled       which way the vehicle runs as measured, and how far it has run against that without a break, mm
    national                the national location accuracy, as last received, mm
    doubted                 the identity of the last group that was not where it was to be, while no other one served; 0: none
    spot                    where balise 1 of the group that is read really lies
    true_since              how far the vehicle has really run since the reading
    reading_wander          the one-off part of the odometer's error at the reading
    """

    truth: NumVar
    true_step: NumVar
    wander: NumVar
    next_wander: NumVar
    heard: NumVar
    silent: NumVar
    backwards: BoolVar
    rolled: NumVar
    national: NumVar
    doubted: NumVar
    spot: NumVar
    true_since: NumVar
    reading_wander: NumVar


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables the machine is made of; properties read them by name."""

    config: BaliseConfig
    odometer: Odometer
    heading: Heading
    held: StoredInterval
    read: Telegram
    linking: Linking
    national: National
    memory: Memory
    reflector: Ahead
    search: Ahead
    world: World

    @property
    def inputs(self) -> list[Var | Optional]:
        """All inputs; each may be absent, but for what a judged distance is charged."""
        offered = self.linking.offered.inputs
        return [*self.odometer.inputs, *self.read.inputs, *offered, self.national.received]

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values."""
        state: dict[Var, Initial] = {}
        for part in (
            self.held,
            self.odometer,
            self.heading,
            self.linking,
            self.national,
            self.memory,
            self.reflector,
            self.search,
        ):
            state |= part.state()
        return state


def parts(config: BaliseConfig) -> Parts:
    """Fresh variables for one machine."""
    limits = config.limits
    lines = {"last_identity": config.last_group_identity, "position_limit_mm": config.position_limit_mm}
    return Parts(
        config,
        odometer(config.odometer, limits, told=config.told_distance),
        Heading(boolean("backwards"), number("rolled_mm", MM, 0, config.reversal_mm), config.reversal_mm),
        _held(config),
        telegram(
            **lines,
            max_step_mm=limits.max_step_mm,
            age_limit_ms=config.telegram_age_limit_ms,
            reflector_reach_mm=config.reflector_reach_mm,
        ),
        linking(config.announced_groups, **lines),
        national(config.default_accuracy_mm),
        _memory(config),
        _ahead("reflector", config),
        _ahead("search", config),
        _world(config),
    )


def _held(config: BaliseConfig) -> StoredInterval:
    place, tolerance = config.position_limit_mm * NM_PER_MM, config.limits.tolerance_nm
    return StoredInterval(
        number("position_nm", NM, -place, place),
        number("margin_above_nm", NM, 0, tolerance),
        number("margin_below_nm", NM, 0, tolerance),
    )


def _memory(config: BaliseConfig) -> Memory:
    place, identities = config.position_limit_mm, config.last_group_identity
    return Memory(
        group=number("last_group", COUNT, 0, identities),
        place=number("last_group_position_mm", MM, -place, place),
        given_up=number("given_up_group", COUNT, 0, identities),
        missed=number("missed_in_row", COUNT, 0, 2),
        ended=number("given_up_now", COUNT, 0, config.announced_groups),
        accuracy=number("charged_accuracy_mm", MM, 0, LARGEST_ACCURACY_MM),
        run=number("run_mm", MM, 0, FARTHEST_MM),
        measured=boolean("whole_run_measured"),
        direction=choice("known_direction", enumeration(DIRECTION)),
        verdict=choice("telegram_judged", enumeration(READ)),
        reaction=choice("linking_reaction_now", enumeration(REACTION)),
        reason=choice("reason", enumeration(REASON)),
    )


def _ahead(name: str, config: BaliseConfig) -> Ahead:
    reach = config.position_limit_mm + config.reflector_reach_mm
    return Ahead(boolean(f"{name}_told"), number(f"{name}_place_mm", MM, -reach, reach))


def _world(config: BaliseConfig) -> World:
    limits, half = config.limits, config.odometer.wander_nm
    line = (config.position_limit_mm + 2 * config.tolerance_mm) * NM_PER_MM
    since = 20 * limits.max_step_mm * NM_PER_MM + 10 * config.telegram_age_limit_ms * config.max_speed_mm_s * 1_000
    apart = line + since + (config.antenna_mm + config.detection_mm) * NM_PER_MM
    return World(
        number("truth_nm", NM, -line, line),
        number("true_step_nm", NM, -limits.blind_nm, limits.blind_nm),
        number("odometer_wander_nm", NM, -half, half),
        number("odometer_next_wander_nm", NM, -half, half),
        number("odometer_heard_mm", MM, -limits.max_step_mm, limits.max_step_mm),
        number("odometer_silent_cycles", COUNT, 0, config.gap_limit_cycles + 1),
        boolean("truly_backwards"),
        number("truly_rolled_mm", MM, 0, config.reversal_mm),
        number("national_accuracy_told_mm", MM, 0, LARGEST_ACCURACY_MM),
        number("doubted_group", COUNT, 0, config.last_group_identity),
        number("read_place_nm", NM, -apart, apart),
        number("true_since_nm", NM, -since, since),
        number("reading_wander_nm", NM, -half, half),
    )
