"""Terms of one cycle of the verification of a train: matches, mismatches, and missing data."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import (
    Bool,
    Lit,
    Num,
    abs_,
    any_of,
    as_num,
    between,
    ceil_to,
    exact_to,
    ite,
    maximum,
    minimum,
    with_unit,
)
from safeloc.language.units import COUNT, MM, MM_S2, MS, MS_PER_S, UM_PER_MM, UM_S, Unit
from safeloc.models.verification import variables as v
from safeloc.models.verification.variables import Parts
from safeloc.models.vocabulary.first_of import first_of


def judge(own: Parts, known: Bool, refused: Bool) -> Judgement:
    """Return the terms of one cycle; `known`: a reference is stored and believed, `refused`: a mismatch is latched."""
    return Judgement(own, known, refused)


@dataclass(frozen=True, eq=False)
class Judgement:
    """Terms over the inputs of a cycle and the state before it."""

    own: Parts
    known: Bool
    refused: Bool

    # -------------------------------------------------------------- the reference

    @cached_property
    def usable(self) -> Bool:
        """The reference is sound and recent, has axles, and its bounds are in order."""
        own = self.own
        recent = own.record_age <= own.config.reference_age_limit_cycles
        in_order = (
            (own.record_length_low <= own.record_length_high)
            & (own.record_place_low <= own.record_place_high)
            & (own.record_speed_low <= own.record_speed_high)
        )
        return own.sound & recent & (own.record_axles > 0) & in_order

    @cached_property
    def contradicts(self) -> Bool:
        """Another record of the same stay contradicts the stored one."""
        own = self.own
        apart = (own.record_length_high < own.stored_length_low) | (own.record_length_low > own.stored_length_high)
        return self.known & (own.record_axles.ne(own.stored_axles) | apart)

    @cached_property
    def reference(self) -> tuple[Num, Num, Num]:
        """Count and bounds of the length, mm, for the comparison: of the record that is due, or else of the stored one."""
        own = self.own
        pairs = (
            (own.record_axles, own.stored_axles),
            (own.record_length_low, own.stored_length_low),
            (own.record_length_high, own.stored_length_high),
        )
        count, low, high = (ite(own.due, new, old) for new, old in pairs)
        return count, low, high

    @cached_property
    def accepted(self) -> Bool:
        """The machine accepts a reference in this cycle: no mismatch."""
        return self.own.due & self.own.reference_from.ne(v.NOBODY) & self.usable & ~self.mismatch

    # -------------------------------------------------------------- parameters that do not change

    @cached_property
    def count_matches(self) -> Bool:
        """The fibre's count is that of the reference."""
        seen = self.own.fibre_axles
        return self.own.associated & seen.present & seen.value.eq(self.reference[0])

    @cached_property
    def length_matches(self) -> Bool:
        """The fibre's length agrees with the reference within both tolerances."""
        seen = self.own.fibre_length
        return self.own.associated & seen.present & self._fits(seen.value)

    def _fits(self, length: Num) -> Bool:
        _, low, high = self.reference
        tolerance = self.own.config.length_tolerance_mm
        return between(low - tolerance, length, high + tolerance)

    @cached_property
    def verified(self) -> Bool:
        """At least one parameter that does not change was determined in this cycle, and matches."""
        return self.count_matches | self.length_matches

    @cached_property
    def controlled(self) -> Bool:
        """Train control reports count or length, and they match. Silence is no success."""
        count, length = self.own.control_axles, self.own.control_length
        return (count.present | length.present) & ~self._control_count_differs & ~self._control_length_differs

    @cached_property
    def _control_count_differs(self) -> Bool:
        return self.own.control_axles.present & self.own.control_axles.value.ne(self.reference[0])

    @cached_property
    def _control_length_differs(self) -> Bool:
        return self.own.control_length.present & ~self._fits(self.own.control_length.value)

    # -------------------------------------------------------------- at the place of the reference

    @cached_property
    def _at_counter(self) -> Bool:
        return self.own.due & self.own.reference_from.eq(v.AXLE_COUNTER) & self.own.associated

    @cached_property
    def speed_compared(self) -> Bool:
        """The speed can be compared: the train is at the counter."""
        return self._at_counter & self.own.fibre_speed.present

    @cached_property
    def speed_fits(self) -> Bool:
        """The fibre's speed is the counter's, within the tolerance and the possible change since the record."""
        own, config = self.own, self.own.config
        change = -(-max(config.traction_mm_s2, config.brake_mm_s2) * config.period_ms // MS_PER_S)
        slack = _scaled(own.record_age, change, own.fibre_speed.value) + config.speed_tolerance_mm_s
        return between(own.record_speed_low - slack, own.fibre_speed.value, own.record_speed_high + slack)

    @cached_property
    def place_compared(self) -> Bool:
        """The place can be compared: the train is at the counter."""
        return self._at_counter & self.placed

    @cached_property
    def place_fits(self) -> Bool:
        """The fibre's interval overlaps the counter's, within the tolerance and the possible run since the record."""
        own, config = self.own, self.own.config
        slack = _scaled(own.record_age, config.fastest_run_mm, own.fibre_position.value) + config.place_tolerance_mm
        low, high = own.fibre_position.value - own.fibre_margin_below, own.fibre_position.value + own.fibre_margin_above
        return (low <= own.record_place_high + slack) & (high >= own.record_place_low - slack)

    # -------------------------------------------------------------- possible places of the front, without the fibre

    @cached_property
    def possible(self) -> tuple[Num, Num]:
        """Bounds of the front by the reference and the top speed alone, mm; they grow no further once they are too wide to be used."""
        own, run = self.own, self.own.config.fastest_run_mm
        since, widens = _scaled(own.record_age, run, own.record_place_low), ite(self._was_doubtful, 0, Lit(run, MM))
        low = ite(own.due, own.record_place_low - since, own.possible_low - widens)
        return low, ite(own.due, own.record_place_high + since, own.possible_high + widens)

    @cached_property
    def _was_doubtful(self) -> Bool:
        return self.own.possible_high - self.own.possible_low > self.own.config.place_doubt_limit_mm

    @cached_property
    def doubtful(self) -> Bool:
        """The last record is so old that it leaves more places open than permitted."""
        low, high = self.possible
        return high - low > self.own.config.place_doubt_limit_mm

    @cached_property
    def out_of_reach(self) -> Bool:
        """The fibre's interval lies beyond the places possible by the last record; not in the cycle of a counter's record."""
        own, tolerance, (low, high) = self.own, self.own.config.place_tolerance_mm, self.possible
        beyond, short = (
            own.fibre_position.value - own.fibre_margin_below - high,
            low - own.fibre_position.value - own.fibre_margin_above,
        )
        later = ~(own.due & own.reference_from.eq(v.AXLE_COUNTER)) & ~self.doubtful
        return self.placed & later & ((beyond > tolerance) | (short > tolerance))

    # -------------------------------------------------------------- course over time

    @cached_property
    def placed(self) -> Bool:
        """The fibre located this train's front."""
        return self.own.associated & self.own.located & self.own.fibre_position.present

    @cached_property
    def abilities(self) -> tuple[Num, Num]:
        """Greatest decrease and increase of the speed since the last reading, um/s."""
        own, period = self.own, Lit(self.own.config.period_ms, MS)
        braking = _braking(own) * period
        traction = Lit(own.config.traction_mm_s2, MM_S2) * period
        either = maximum(braking, traction)
        last = exact_to(own.last_speed, UM_S)
        forwards, backwards = last - own.slower_by - either >= 0, last + own.faster_by + either <= 0
        slower = ite(forwards, braking, ite(backwards, traction, either))
        faster = ite(forwards, traction, ite(backwards, braking, either))
        most = own.config.change_limit_um_s
        return minimum(own.slower_by + slower, most), minimum(own.faster_by + faster, most)

    @cached_property
    def speed_changed(self) -> Bool:
        """The speed changed by more than traction and brakes allow."""
        own = self.own
        slower, faster = self.abilities
        slack = 2 * own.config.speed_tolerance_mm_s * UM_PER_MM
        change = exact_to(own.fibre_speed.value, UM_S) - exact_to(own.last_speed, UM_S)
        seen = own.associated & own.fibre_speed.present & own.speed_known
        return seen & ~between(-slower - slack, change, faster + slack)

    @cached_property
    def length_changed(self) -> Bool:
        """The length differs from the last reading."""
        own = self.own
        seen = own.associated & own.fibre_length.present & own.length_known
        return seen & (abs_(own.fibre_length.value - own.last_length) > own.config.length_change_mm)

    @cached_property
    def reach(self) -> Num:
        """Greatest distance of the front from its last place, mm."""
        own = self.own
        fastest = own.config.max_speed_mm_s * UM_PER_MM
        last, slack = exact_to(own.last_speed, UM_S), own.config.speed_tolerance_mm_s * UM_PER_MM
        slower, faster = self.abilities
        bound = minimum(maximum(last + faster, slower - last) + slack, fastest)
        speed = ite(own.speed_known, bound, fastest)
        return minimum(own.reach_since + ceil_to(speed * Lit(own.config.period_ms, MS), MM), own.reach_since.high)

    @cached_property
    def jumped(self) -> Bool:
        """The front is farther from its last place than the train can have run, even with both intervals taken into account."""
        own = self.own
        run, reach = own.fibre_position.value - own.last_place, self.reach + own.config.jump_mm
        above = run > reach + own.front_margin_above + own.fibre_margin_below
        below = -run > reach + own.front_margin_below + own.fibre_margin_above
        return self.placed & own.place_known & (above | below)

    @cached_property
    def ends_apart(self) -> Bool:
        """Both ends are located, and the distance between them fits no length that the reference allows."""
        own, tolerance = self.own, self.own.config.length_tolerance_mm
        _, low, high = self.reference
        near, far = own.ends_low.value, own.ends_high.value
        crossed = own.ends_low.present & own.ends_high.present & (near > far)
        too_long = own.ends_low.present & (near > high + tolerance)
        return crossed | too_long | (own.ends_high.present & (far < low - tolerance))

    # -------------------------------------------------------------- the verdict

    @cached_property
    def flaws(self) -> list[tuple[Bool, Lit]]:
        """Every mismatch with its reason; the first that holds is reported."""
        own = self.own
        seen_count = own.associated & own.fibre_axles.present
        seen_length = own.associated & own.fibre_length.present
        given = own.due & own.reference_from.ne(v.NOBODY)
        always_on = [
            (own.due & own.reference_from.eq(v.NOBODY), v.REFERENCE_LOST),
            (given & ~self.usable, v.REFERENCE_REFUSED),
            (given & self.contradicts, v.REFERENCE_CONTRADICTS),
            (own.fibre_error, v.FIBRE_ERROR),
            (seen_count & ~self.count_matches, v.COUNT_DIFFERS),
            (seen_length & ~self.length_matches, v.LENGTH_DIFFERS),
            (self.ends_apart, v.ENDS_APART),
            (self.speed_compared & ~self.speed_fits, v.SPEED_AT_ENTRY),
            (self.place_compared & ~self.place_fits, v.PLACE_AT_ENTRY),
            (self.length_changed, v.LENGTH_CHANGED),
            (self.speed_changed, v.SPEED_CHANGED),
            (self.jumped, v.JUMP),
            (self._control_count_differs, v.CONTROL_COUNT),
            (self._control_length_differs, v.CONTROL_LENGTH),
            (self.out_of_reach, v.OUT_OF_REACH),
        ]
        return [*always_on, (own.chain_failed, v.CHAIN_FAILED)] if own.config.needs_emitter else always_on

    @cached_property
    def mismatch(self) -> Bool:
        """Some parameter does not match, while there is a reference to compare with."""
        return (self.own.due | self.known) & any_of(flaw for flaw, _ in self.flaws)

    @cached_property
    def flaw(self) -> Num:
        """The reason of the mismatch; a latched reason stays."""
        return ite(self.refused, self.own.why, first_of(*self.flaws, default=v.NOT_VERIFIED))

    @cached_property
    def lacks(self) -> list[tuple[Bool, Lit]]:
        """Missing data with their reasons: they withhold the position and are not latched."""
        own, config = self.own, self.own.config
        lacks = [(~own.associated, v.NOT_ASSOCIATED), (~self.placed, v.NOT_LOCATED), (self.doubtful, v.PLACE_DOUBTFUL)]
        if config.needs_control_data:
            lacks.append((~self.controlled, v.CONTROL_DATA_MISSING))
        if config.needs_emitter:
            lacks.append((~own.chain_tested, v.CHAIN_UNTESTED))
        return lacks

    @cached_property
    def missing(self) -> Bool:
        """Some data are missing without which no position is reported."""
        return any_of(lack for lack, _ in self.lacks)

    @cached_property
    def lack(self) -> Num:
        """The first reason for which data are missing."""
        return first_of(*self.lacks, default=v.NOT_VERIFIED)

    @cached_property
    def age(self) -> Num:
        """Cycles since the last verification, after this one."""
        own = self.own
        return ite(self.verified, as_num(0, COUNT), minimum(own.verified_ago + 1, own.verified_ago.high))

    @cached_property
    def current(self) -> Bool:
        """The last verification is recent enough."""
        return self.age <= self.own.config.currency_cycles


def _braking(own: Parts) -> Num:
    """Return the configured braking ability, or less if train control reports less."""
    brake = own.control_brake
    most = Lit(own.config.brake_mm_s2, MM_S2)
    return ite(brake.present, minimum(brake.value, most), most)


def _scaled(cycles: Num, per_cycle: int, like: Num) -> Num:
    """Return `per_cycle` for each cycle, in the unit of `like`."""
    assert isinstance(like.unit, Unit)
    return with_unit(cycles * per_cycle, like.unit)
