"""Inputs, state and configuration of the verification of one train."""

from __future__ import annotations

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    BoolVar,
    NumVar,
    boolean,
    choice,
    enumeration,
    members,
    number,
    optional,
)
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM, MM_S, MM_S2, NM, NM_PER_MM, UM, UM_S

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
    """Tolerances of the comparison, and a train's abilities."""

    period_ms: int = quantity(500, "ms", 10, 10_000, "[D] the detector's block")
    axle_limit: int = quantity(1_000, "axles", 2, 100_000, "[D] trains of 250 wagons")
    length_limit_mm: int = quantity(1_500_000, "mm", 10_000, 10_000_000, "[M] longest train")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")
    margin_limit_mm: int = quantity(500_000, "mm", 1, 100_000_000, "[D] a wider interval is of no use")
    max_speed_mm_s: int = quantity(100_000, "mm/s", 1, 138_889, "[M, sure] 350 km/h, rounded up")
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
        """Greatest possible change of speed, um/s: from full speed backwards to full speed forwards."""
        return 2 * self.max_speed_mm_s * 1_000

    @property
    def fastest_run_mm(self) -> int:
        """The run of a cycle at top speed, mm rounded up."""
        return -(-self.max_speed_mm_s * self.period_ms // 1_000)

    @property
    def span_mm(self) -> int:
        """The farthest that two positions may lie apart, mm, each with its margin."""
        return 2 * (self.position_limit_mm + self.margin_limit_mm)

    @property
    def oldest_record_cycles(self) -> int:
        """The greatest age of a record that the machine can be handed, in cycles; a record this old is too old."""
        return 2 * self.reference_age_limit_cycles + 1

    @property
    def possible_mm(self) -> int:
        """The farthest bound of the front by the reference alone, mm: as wide as it may become, or as old as a record may be."""
        widest = max(self.place_doubt_limit_mm, self.oldest_record_cycles * self.fastest_run_mm)
        return self.position_limit_mm + self.fastest_run_mm + widest


class Parts:
    """The variables of the machine.

    due              a reference has to come in this cycle: the train enters, passes a counter, or is handed over
    reference_from           its sender; NOBODY: it did not come
    sound            the record is undisturbed (counter), or the neighbour trusted the train (handover)
    record_...       the record: axles, bounds of length and speed, bounds of the front's place, its age
    associated       a pattern belongs to this train, by order on the track
    seen_...         the fibre's readings of this cycle
    fibre_position, located   the fibre's interval of the front; the front is located
    ends_low, ends_high  bounds of the distance between both ends, where both are located
    fibre_error      an error signal F of the fibre machines
    control_...      data from the train control system
    chain_tested, chain_failed  the test emitter
    leaves           the train has left the area
    kept_...         the stored reference
    possible_...     bounds of the front by the reference and the top speed alone, without the fibre
    last_...         last reading of length, speed, place; `slower_by`, `faster_by` bound the speed's change since
    given_out            a position was reported since the last accepted reference
    by_...           the comparisons on which the present trust rests
    axles            ghost: axles of the train that really makes the pattern, at the moment to which the count refers
    length, truth    ghosts: length and front of that train now (um, nm)
    """

    def __init__(self, config: VerificationConfig, truth: NumVar | None = None) -> None:
        self.config = config
        self.declared = declared = Declared()
        self._read_reference(declared, config)
        self._read_fibre(declared, config)
        self._read_others(declared, config)
        self._keep_reference(declared, config)
        self._keep_readings(declared, config)
        self._keep_trust(declared)
        self._imagine(declared, config, truth)

    def _read_reference(self, declared: Declared, config: VerificationConfig) -> None:
        """Declare the reference of this cycle and its record."""
        axles, long = config.axle_limit, config.length_limit_mm
        limit, fast = config.position_limit_mm, config.max_speed_mm_s
        self.due = declared.sensor(boolean("reference_due"))
        self.reference_from = declared.sensor(choice("reference_from", enumeration(FROM)))
        self.sound = declared.sensor(boolean("record_sound"))
        self.record_axles = declared.sensor(number("record_axles", COUNT, 0, axles))
        self.record_length_low = declared.sensor(number("record_length_low_mm", MM, 0, long))
        self.record_length_high = declared.sensor(number("record_length_high_mm", MM, 0, long))
        self.record_speed_low = declared.sensor(number("record_speed_low_mm_s", MM_S, -fast, fast))
        self.record_speed_high = declared.sensor(number("record_speed_high_mm_s", MM_S, -fast, fast))
        self.record_place_low = declared.sensor(number("record_place_low_mm", MM, -limit, limit))
        self.record_place_high = declared.sensor(number("record_place_high_mm", MM, -limit, limit))
        self.record_age = declared.sensor(number("record_age_cycles", COUNT, 0, config.oldest_record_cycles))
        self.associated = declared.sensor(boolean("associated"))

    def _read_fibre(self, declared: Declared, config: VerificationConfig) -> None:
        """Declare the fibre's readings of this cycle."""
        limit, fast, far = config.position_limit_mm, config.max_speed_mm_s, config.span_mm
        self.fibre_axles = declared.sensor(optional("fibre_axles", COUNT, 0, config.axle_limit))
        self.fibre_length = declared.sensor(optional("fibre_length_mm", MM, 0, config.length_limit_mm))
        self.fibre_speed = declared.sensor(optional("fibre_speed_mm_s", MM_S, -fast, fast))
        self.fibre_position = declared.sensor(optional("fibre_position_mm", MM, -limit, limit))
        self.fibre_margin_above = declared.sensor(number("fibre_margin_above_mm", MM, 0, config.margin_limit_mm))
        self.fibre_margin_below = declared.sensor(number("fibre_margin_below_mm", MM, 0, config.margin_limit_mm))
        self.located = declared.sensor(boolean("fibre_located"))
        self.ends_low = declared.sensor(optional("fibre_ends_low_mm", MM, -far, far))
        self.ends_high = declared.sensor(optional("fibre_ends_high_mm", MM, -far, far))
        self.fibre_error = declared.sensor(boolean("fibre_error"))

    def _read_others(self, declared: Declared, config: VerificationConfig) -> None:
        """Declare what the train control system and the test emitter report, and the train's leaving."""
        self.control_axles = declared.sensor(optional("control_axles", COUNT, 0, config.axle_limit))
        self.control_length = declared.sensor(optional("control_length_mm", MM, 0, config.length_limit_mm))
        self.control_brake = declared.sensor(optional("control_brake_mm_s2", MM_S2, 0, 5_000))
        self.chain_tested = declared.sensor(boolean("chain_tested"))
        self.chain_failed = declared.sensor(boolean("chain_failed"))
        self.leaves = declared.sensor(boolean("train_leaves"))

    def _keep_reference(self, declared: Declared, config: VerificationConfig) -> None:
        """Declare the stored reference, and what follows from it alone."""
        limit, long, possible = config.position_limit_mm, config.length_limit_mm, config.possible_mm
        self.stored_axles = declared.state(number("stored_axles", COUNT, 0, config.axle_limit), first=0)
        self.stored_length_low = declared.state(number("stored_length_low_mm", MM, 0, long), first=0)
        self.stored_length_high = declared.state(number("stored_length_high_mm", MM, 0, long), first=0)
        self.possible_low = declared.state(number("possible_low_mm", MM, -possible, limit), first=0)
        self.possible_high = declared.state(number("possible_high_mm", MM, -limit, possible), first=0)

    def _keep_readings(self, declared: Declared, config: VerificationConfig) -> None:
        """Declare the last readings, the front that was derived from them, and the age of the verification."""
        limit, fast, margin = config.position_limit_mm, config.max_speed_mm_s, config.margin_limit_mm
        self.last_length = declared.state(number("last_length_mm", MM, 0, config.length_limit_mm), first=0)
        self.last_speed = declared.state(number("last_speed_mm_s", MM_S, -fast, fast), first=0)
        self.slower_by = declared.state(number("slower_by_um_s", UM_S, 0, config.change_limit_um_s), first=0)
        self.faster_by = declared.state(number("faster_by_um_s", UM_S, 0, config.change_limit_um_s), first=0)
        self.last_place = declared.state(number("last_place_mm", MM, -limit, limit), first=0)
        self.reach_since = declared.state(number("reach_since_mm", MM, 0, config.span_mm), first=0)
        self.front = declared.state(number("front_mm", MM, -limit, limit), first=0)
        self.front_margin_above = declared.state(number("front_margin_above_mm", MM, 0, margin), first=0)
        self.front_margin_below = declared.state(number("front_margin_below_mm", MM, 0, margin), first=0)
        self.verified_ago = declared.state(number("verified_ago_cycles", COUNT, 0, config.currency_cycles + 1), first=0)

    def _keep_trust(self, declared: Declared) -> None:
        """Declare the flags and the reason."""
        self.by_count = declared.state(boolean("by_count"), first=False)
        self.by_length = declared.state(boolean("by_length"), first=False)
        self.by_speed_at_entry = declared.state(boolean("by_speed_at_entry"), first=False)
        self.by_place_at_entry = declared.state(boolean("by_place_at_entry"), first=False)
        self.by_control_data = declared.state(boolean("by_control_data"), first=False)
        self.by_emitter = declared.state(boolean("by_emitter"), first=False)
        self.length_known = declared.state(boolean("last_length_known"), first=False)
        self.speed_known = declared.state(boolean("last_speed_known"), first=False)
        self.place_known = declared.state(boolean("last_place_known"), first=False)
        self.given_out = declared.state(boolean("given_out"), first=False)
        self.why = declared.state(choice("why", enumeration(REASON)), first=NO_RECORD)

    def _imagine(self, declared: Declared, config: VerificationConfig, truth: NumVar | None) -> None:
        """Declare the ghosts: the train's true axles, length and front, and the world's choices of their next values."""
        longest, farthest = 2_000 * config.length_limit_mm, 4 * config.span_mm * NM_PER_MM
        self.axles = declared.ghost(number("true_axles", COUNT, 0, config.axle_limit), first=ANY)
        self.length = declared.ghost(number("true_length_um", UM, 0, longest), first=ANY)
        if truth is None:
            truth = number("truth_nm", NM, -farthest, farthest)
        self.truth = declared.ghost(truth, first=ANY)
        self.next_axles = declared.choice(number("next_true_axles", COUNT, 0, config.axle_limit))
        self.next_length = declared.choice(number("next_true_length_um", UM, 0, longest))
        self.next_truth = declared.choice(number("next_truth_nm", NM, -farthest, farthest))

    @property
    def flags(self) -> tuple[BoolVar, ...]:
        """The comparisons on which trust rests."""
        return (
            self.by_count,
            self.by_length,
            self.by_speed_at_entry,
            self.by_place_at_entry,
            self.by_control_data,
            self.by_emitter,
        )

    @property
    def numbers(self) -> tuple[NumVar, ...]:
        """The stored numbers, apart from age and reason."""
        course = (self.last_length, self.last_speed, self.slower_by, self.faster_by, self.last_place, self.reach_since)
        kept = (
            self.stored_axles,
            self.stored_length_low,
            self.stored_length_high,
            self.possible_low,
            self.possible_high,
        )
        return (*kept, *course, self.front, self.front_margin_above, self.front_margin_below)

    @property
    def known(self) -> tuple[BoolVar, ...]:
        """Presence of the last readings."""
        return self.length_known, self.speed_known, self.place_known


def parts(config: VerificationConfig, *, truth: NumVar | None = None) -> Parts:
    """Return fresh variables for one train; `truth` is its front if another machine's world moves it."""
    return Parts(config, truth)
