"""What the verification of one train hears and keeps, and its configuration."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.config import Config, quantity
from safeloc.language.expr import (
    BoolVar,
    NumVar,
    Optional,
    Var,
    boolean,
    choice,
    enumeration,
    members,
    number,
    optional,
)
from safeloc.language.machine import Initial
from safeloc.language.units import COUNT, MM, MM_S, MM_S2, NM, UM, UM_S

REASON = members(
    "verification_reason",
    "VERIFIED", "NO_RECORD", "NOT_VERIFIED", "NOT_ASSOCIATED", "NOT_LOCATED", "CONTROL_DATA_MISSING", "CHAIN_UNTESTED",
    "REFERENCE_LOST", "REFERENCE_REFUSED", "REFERENCE_CONTRADICTS", "COUNT", "LENGTH", "SPEED_AT_ENTRY",
    "PLACE_AT_ENTRY", "LENGTH_CHANGED", "SPEED_CHANGED", "JUMP", "CONTROL_COUNT", "CONTROL_LENGTH", "CHAIN_FAILED",
    "FIBRE_ERROR", "ENDS_APART", "OUT_OF_REACH", "PLACE_DOUBTFUL",
)  # fmt: skip
(
    VERIFIED, NO_RECORD, NOT_VERIFIED, NOT_ASSOCIATED, NOT_LOCATED, CONTROL_DATA_MISSING, CHAIN_UNTESTED,
    REFERENCE_LOST, REFERENCE_REFUSED, REFERENCE_CONTRADICTS, COUNT_DIFFERS, LENGTH_DIFFERS, SPEED_AT_ENTRY,
    PLACE_AT_ENTRY, LENGTH_CHANGED, SPEED_CHANGED, JUMP, CONTROL_COUNT, CONTROL_LENGTH, CHAIN_FAILED,
    FIBRE_ERROR, ENDS_APART, OUT_OF_REACH, PLACE_DOUBTFUL,
) = REASON  # fmt: skip
FROM = members("reference_from", "NOBODY", "AXLE_COUNTER", "NEIGHBOUR")
NOBODY, AXLE_COUNTER, NEIGHBOUR = FROM


class VerificationConfig(Config):
    """Tolerances of the comparison, and what a train can do."""

    period_ms: int = quantity(500, "ms", 10, 10_000, "[D] the detector's block")
    axle_limit: int = quantity(1_000, "axles", 2, 100_000, "[D] trains of 250 wagons")
    length_limit_mm: int = quantity(1_500_000, "mm", 10_000, 10_000_000, "[M] longest train")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")
    margin_limit_mm: int = quantity(500_000, "mm", 1, 100_000_000, "[D] wider tells nothing")
    max_speed_mm_s: int = quantity(100_000, "mm/s", 1, 138_889, "[M, sure] 350 km/h")
    length_tolerance_mm: int = quantity(
        40_000, "mm", 0, 200_000, "[D] of the front end, measured; [S] l. 160: 10 to 20 m"
    )
    length_change_mm: int = quantity(80_000, "mm", 0, 400_000, "[D] two readings, each within its tolerance")
    speed_tolerance_mm_s: int = quantity(1_400, "mm/s", 0, 20_000, "[S] Kowarik 2020: 5 km/h from one channel")
    place_tolerance_mm: int = quantity(30_000, "mm", 0, 1_000_000, "[D] counter to first axle, and fibre edge")
    traction_mm_s2: int = quantity(1_300, "mm/s2", 1, 5_000, "[M, fairly sure] metro: 1.0 to 1.3")
    brake_mm_s2: int = quantity(1_500, "mm/s2", 1, 5_000, "[M, fairly sure]; 2 500 with track brake")
    jump_mm: int = quantity(10_000, "mm", 0, 1_000_000, "[M] besides what both intervals leave open")
    reference_age_limit_cycles: int = quantity(4, "cycles", 0, 10_000, "[D] 2 s from counter to safe computer")
    place_doubt_limit_mm: int = quantity(
        100_000_000,
        "mm",
        1,
        10_000_000_000,
        "[D] of the front by the last record alone: 500 s at 100 m/s; 40 km at 80 m/s",
    )
    currency_cycles: int = quantity(10, "cycles", 0, 100_000, "[D] 5 s; 0: verified in the very cycle")
    record_hazard_rate: int = quantity(
        10, "1e-9/h", 1, 1_000_000, "[M, sure] EN 50129: SIL 4 is a tolerable hazard rate below 1e-8 an hour"
    )
    needs_control_data: bool = False
    needs_emitter: bool = True

    @property
    def change_limit_um_s(self) -> int:
        """Greatest change of speed that is reckoned with: from full speed backwards to full speed forwards."""
        return 2 * self.max_speed_mm_s * 1_000

    @property
    def fastest_run_mm(self) -> int:
        """The run of a cycle at top speed, rounded up."""
        return -(-self.max_speed_mm_s * self.period_ms // 1_000)


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine.

    due              a reference has to come in this cycle: the train enters, passes a counter, or is handed over
    source           who gave it; NOBODY: it did not come
    sound            the record is undisturbed (counter), or the neighbour trusted the train (handover)
    record_...       the record: axles, bounds of length and speed, bounds of the front's place, its age
    associated       a pattern belongs to this train, by order on the track
    seen_...         what the fibre determined in this cycle
    place, located   the fibre's interval of the front, and whether it is located
    ends_low, ends_high  bounds of the distance of both ends, where both are located
    fibre_error      an error signal F of the fibre machines
    control_...      what the train control system says of the train
    chain_tested, chain_failed  the test emitter
    leaves           the train has left the area
    kept_...         the stored reference
    possible_...     where the front can be by the reference and its top speed alone, whatever the fibre tells
    last_...         last reading of length, speed, place; `slower`, `faster` bound the speed's change since
    given            the position was given out since the last accepted reference
    by_...           what the present trust rests on
    axles            ghost: of the train that the pattern really belongs to, at the moment that the count tells of
    length, truth    ghosts: of that train now (um, nm)
    """

    config: VerificationConfig
    due: BoolVar
    source: NumVar
    sound: BoolVar
    record_count: NumVar
    record_low: NumVar
    record_high: NumVar
    record_speed_low: NumVar
    record_speed_high: NumVar
    record_place_low: NumVar
    record_place_high: NumVar
    record_age: NumVar
    associated: BoolVar
    seen_count: Optional
    seen_length: Optional
    seen_speed: Optional
    place: Optional
    place_above: NumVar
    place_below: NumVar
    located: BoolVar
    ends_low: Optional
    ends_high: Optional
    fibre_error: BoolVar
    control_count: Optional
    control_length: Optional
    control_brake: Optional
    chain_tested: BoolVar
    chain_failed: BoolVar
    leaves: BoolVar
    kept_count: NumVar
    kept_low: NumVar
    kept_high: NumVar
    possible_low: NumVar
    possible_high: NumVar
    length_known: BoolVar
    last_length: NumVar
    speed_known: BoolVar
    last_speed: NumVar
    slower: NumVar
    faster: NumVar
    place_known: BoolVar
    last_place: NumVar
    reach: NumVar
    front: NumVar
    front_above: NumVar
    front_below: NumVar
    age: NumVar
    by_count: BoolVar
    by_length: BoolVar
    by_speed: BoolVar
    by_place: BoolVar
    by_control: BoolVar
    by_emitter: BoolVar
    given: BoolVar
    reason: NumVar
    axles: NumVar
    next_axles: NumVar
    length: NumVar
    next_length: NumVar
    truth: NumVar
    next_truth: NumVar

    @property
    def inputs(self) -> list[Var | Optional]:
        """What is heard in a cycle."""
        record = [self.record_count, self.record_low, self.record_high, self.record_speed_low, self.record_speed_high]
        reference: list[Var | Optional] = [self.due, self.source, self.sound, *record]
        reference += [self.record_place_low, self.record_place_high, self.record_age]
        seen: list[Var | Optional] = [self.associated, self.seen_count, self.seen_length, self.seen_speed, self.place]
        seen += [self.place_above, self.place_below, self.located, self.ends_low, self.ends_high, self.fibre_error]
        control: list[Var | Optional] = [self.control_count, self.control_length, self.control_brake]
        return [*reference, *seen, *control, self.chain_tested, self.chain_failed, self.leaves]

    @property
    def flags(self) -> tuple[BoolVar, ...]:
        """What the trust rests on, as a list of yes and no."""
        return self.by_count, self.by_length, self.by_speed, self.by_place, self.by_control, self.by_emitter

    @property
    def numbers(self) -> tuple[NumVar, ...]:
        """The stored numbers, apart from age and reason."""
        course = (self.last_length, self.last_speed, self.slower, self.faster, self.last_place, self.reach)
        kept = (self.kept_count, self.kept_low, self.kept_high, self.possible_low, self.possible_high)
        return (*kept, *course, self.front, self.front_above, self.front_below)

    @property
    def known(self) -> tuple[BoolVar, ...]:
        """Which last readings there are."""
        return self.length_known, self.speed_known, self.place_known

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values: no train."""
        state: dict[Var, Initial] = dict.fromkeys((*self.numbers, self.age), 0)
        return {**state, **dict.fromkeys((*self.flags, *self.known, self.given), False), self.reason: NO_RECORD}


def parts(config: VerificationConfig) -> Parts:
    """Fresh variables for one train."""
    limit, long, axles, fast = (
        config.position_limit_mm, config.length_limit_mm, config.axle_limit, config.max_speed_mm_s
    )  # fmt: skip
    margin, change, ages = config.margin_limit_mm, config.change_limit_um_s, config.currency_cycles + 1
    far, oldest = 2 * (limit + margin), 2 * config.reference_age_limit_cycles + 1
    possible = limit + config.fastest_run_mm + max(config.place_doubt_limit_mm, oldest * config.fastest_run_mm)
    return Parts(
        config=config,
        due=boolean("reference_due"),
        source=choice("reference_from", enumeration(FROM)),
        sound=boolean("record_sound"),
        record_count=number("record_axles", COUNT, 0, axles),
        record_low=number("record_length_low_mm", MM, 0, long),
        record_high=number("record_length_high_mm", MM, 0, long),
        record_speed_low=number("record_speed_low_mm_s", MM_S, -fast, fast),
        record_speed_high=number("record_speed_high_mm_s", MM_S, -fast, fast),
        record_place_low=number("record_place_low_mm", MM, -limit, limit),
        record_place_high=number("record_place_high_mm", MM, -limit, limit),
        record_age=number("record_age_cycles", COUNT, 0, oldest),
        associated=boolean("associated"),
        seen_count=optional("fibre_axles", COUNT, 0, axles),
        seen_length=optional("fibre_length_mm", MM, 0, long),
        seen_speed=optional("fibre_speed_mm_s", MM_S, -fast, fast),
        place=optional("fibre_position_mm", MM, -limit, limit),
        place_above=number("fibre_margin_above_mm", MM, 0, margin),
        place_below=number("fibre_margin_below_mm", MM, 0, margin),
        located=boolean("fibre_located"),
        ends_low=optional("fibre_ends_low_mm", MM, -far, far),
        ends_high=optional("fibre_ends_high_mm", MM, -far, far),
        fibre_error=boolean("fibre_error"),
        control_count=optional("control_axles", COUNT, 0, axles),
        control_length=optional("control_length_mm", MM, 0, long),
        control_brake=optional("control_brake_mm_s2", MM_S2, 0, 5_000),
        chain_tested=boolean("chain_tested"),
        chain_failed=boolean("chain_failed"),
        leaves=boolean("train_leaves"),
        kept_count=number("kept_axles", COUNT, 0, axles),
        kept_low=number("kept_length_low_mm", MM, 0, long),
        kept_high=number("kept_length_high_mm", MM, 0, long),
        possible_low=number("possible_low_mm", MM, -possible, limit),
        possible_high=number("possible_high_mm", MM, -limit, possible),
        length_known=boolean("last_length_known"),
        last_length=number("last_length_mm", MM, 0, long),
        speed_known=boolean("last_speed_known"),
        last_speed=number("last_speed_mm_s", MM_S, -fast, fast),
        slower=number("slower_by_um_s", UM_S, 0, change),
        faster=number("faster_by_um_s", UM_S, 0, change),
        place_known=boolean("last_place_known"),
        last_place=number("last_place_mm", MM, -limit, limit),
        reach=number("reach_since_mm", MM, 0, far),
        front=number("front_mm", MM, -limit, limit),
        front_above=number("front_margin_above_mm", MM, 0, margin),
        front_below=number("front_margin_below_mm", MM, 0, margin),
        age=number("verified_ago_cycles", COUNT, 0, ages),
        by_count=boolean("by_count"),
        by_length=boolean("by_length"),
        by_speed=boolean("by_speed_at_entry"),
        by_place=boolean("by_place_at_entry"),
        by_control=boolean("by_control_data"),
        by_emitter=boolean("by_emitter"),
        given=boolean("given_out"),
        reason=choice("why", enumeration(REASON)),
        axles=number("true_axles", COUNT, 0, axles),
        next_axles=number("next_true_axles", COUNT, 0, axles),
        length=number("true_length_um", UM, 0, 2_000 * long),
        next_length=number("next_true_length_um", UM, 0, 2_000 * long),
        truth=number("truth_nm", NM, -4 * far * 10**6, 4 * far * 10**6),
        next_truth=number("next_truth_nm", NM, -4 * far * 10**6, 4 * far * 10**6),
    )
