"""The world of a vehicle's movement: its true position, and the laws of its two units.

    the lawful unit   delivers a distance that obeys its error law, or one that no vehicle can have run, or nothing; it is
                      unknown which of the two units this is
    the other unit    delivers anything
    standing          where the odometer measures nothing and the check unit no more than its floor, the vehicle stays between
                      two pulses of the odometer, or creeps on no faster than configured; by configuration no such law holds

Without a check unit this world assumes nothing of the odometer: the machines that use its distances assume its law.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    FALSE,
    Bool,
    Expr,
    Num,
    NumVar,
    Var,
    all_of,
    as_num,
    between,
    choice,
    enumeration,
    ite,
    members,
    number,
)
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.language.world import Law, World
from safeloc.models.motion.unmeasured import Unmeasured
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.measuring_world import THOUSAND, Measuring, Physics
from safeloc.models.vocabulary.odometer import Odometer
from safeloc.models.vocabulary.vehicle_world import ON_THE_LINE, SPEED, line_law, speed_law

LAWFUL = members("lawful_unit", "ODOMETER", "CHECK")
ODOMETER_LAWFUL, CHECK_LAWFUL = LAWFUL
_STAYS = "a vehicle that measures nothing stays between two pulses"
_FIELDS = ("odometer", "check")
"""Fields of the configuration with the figures of both units, in their order."""
_OF_A_UNIT = ("constant_mm", "rate_ppm", "floor_mm_s", "knee_mm_s")


@dataclass(frozen=True, eq=False)
class UnitGhosts:
    """The last distance that a unit delivered and the vehicle can have run, and the cycles since then."""

    last_delivered: NumVar
    silent: NumVar


@dataclass(frozen=True, eq=False)
class CheckGhosts:
    """Ghosts of two units that check each other.

    lawful_unit                     the unit that keeps its law; the other one may deliver anything
    wander, next_wander        the one-off part of the lawful unit's error, before the cycle and, freely chosen, after it
    reported, next_reported    the one-off part of the error of the reported distance (safeloc.models.motion.reported_error)
    odometer, check            the distances of either unit
    between_pulses, next_between_pulses    the place between two pulses of the odometer at which the vehicle stands or last stood, from
                               their middle: followed while it counts as standing, anywhere at the beginning of a stop; None where
                               no vehicle counts as standing
    """

    lawful_unit: NumVar
    wander: NumVar
    next_wander: NumVar
    reported: NumVar
    next_reported: NumVar
    odometer: UnitGhosts
    check: UnitGhosts
    between_pulses: NumVar | None
    next_between_pulses: NumVar | None


@dataclass(frozen=True, eq=False)
class Ghosts:
    """The world's variables: place of the front end and its run in the cycle, nm; and those of two units that check each other."""

    truth: NumVar
    true_cycle_distance: NumVar
    units: CheckGhosts | None


def ghosts(
    declared: Declared,
    physics: Physics,
    line_mm: int,
    laws: tuple[ErrorLaw, ErrorLaw] | None,
    reported: ErrorLaw,
    unmeasured: Unmeasured | None,
) -> Ghosts:
    """Declare the world's variables; `laws` are those of odometer and check unit, if there is one."""
    line = line_mm * NM_PER_MM
    return Ghosts(
        declared.ghost(number("truth_nm", NM, -line, line), first=ANY),
        declared.choice(number("true_cycle_distance_nm", NM, -physics.farthest_nm, physics.farthest_nm)),
        None if laws is None else _units(declared, physics, laws, reported, unmeasured),
    )


def _units(
    declared: Declared,
    physics: Physics,
    laws: tuple[ErrorLaw, ErrorLaw],
    reported: ErrorLaw,
    unmeasured: Unmeasured | None,
) -> CheckGhosts:
    most, of_reported = (
        max(constants) * NM_PER_MM // 2 for constants in ([one.constant_mm for one in laws], [reported.constant_mm])
    )
    half = None if unmeasured is None else _half_between_pulses_nm(unmeasured)
    place = None if half is None else declared.ghost(number("between_pulses_nm", NM, -half, half), first=0)
    next_place = None if half is None else declared.choice(number("next_between_pulses_nm", NM, -half, half))
    return CheckGhosts(
        lawful_unit=declared.ghost(choice("lawful_unit", enumeration(LAWFUL)), first=ANY),
        wander=declared.ghost(number("lawful_wander_nm", NM, -most, most), first=ANY),
        next_wander=declared.choice(number("lawful_next_wander_nm", NM, -most, most)),
        odometer=_unit(declared, physics, "odometer"),
        check=_unit(declared, physics, "check"),
        reported=declared.ghost(number("odometer_wander_nm", NM, -of_reported, of_reported), first=ANY),
        next_reported=declared.choice(number("odometer_next_wander_nm", NM, -of_reported, of_reported)),
        between_pulses=place,
        next_between_pulses=next_place,
    )


def _unit(declared: Declared, physics: Physics, name: str) -> UnitGhosts:
    farthest = physics.farthest_mm
    silent = number(f"{name}_silent_cycles", COUNT, 0, physics.longest_cycles)
    return UnitGhosts(
        declared.ghost(number(f"{name}_last_delivered_mm", MM, -farthest, farthest), first=0),
        declared.ghost(silent, first=physics.gap_limit_cycles + 1),
    )


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The ghosts with the raw inputs and figures that the world reads.

    `unmeasured`: what a vehicle may run whose units measure nothing; None where no law holds of that.
    """

    ghosts: Ghosts
    physics: Physics
    odometer: Odometer
    check: Odometer | None
    unmeasured: Unmeasured | None

    @property
    def units(self) -> tuple[Measuring, Measuring]:
        """The world's view of odometer and check unit."""
        seen = self.ghosts.units
        assert seen is not None and self.check is not None
        of_odometer, of_check = seen.odometer, seen.check
        return (
            Measuring(
                self.odometer.law, self.odometer.measured, of_odometer.last_delivered, of_odometer.silent, self.physics
            ),
            Measuring(self.check.law, self.check.measured, of_check.last_delivered, of_check.silent, self.physics),
        )

    @property
    def wander_after(self) -> Num:
        """The one-off part of the lawful unit's error after the cycle: it rests where that unit measures nothing."""
        seen, (odometer, check) = self.ghosts.units, self.units
        assert seen is not None
        measures = ite(seen.lawful_unit.eq(ODOMETER_LAWFUL), odometer.can_be_run, check.can_be_run)
        return ite(measures, seen.next_wander, seen.wander)

    @property
    def still(self) -> Bool:
        """The odometer measures nothing, and the check unit no more than its floor; where such a vehicle counts as standing."""
        if self.unmeasured is None:
            return FALSE
        odometer, check = self.units
        within = self._within_floor(check.measured.value)
        return all_of([odometer.can_be_run, check.can_be_run, odometer.measured.value.eq(0), within])

    @property
    def was_still(self) -> Bool:
        """The same of the cycle before."""
        odometer, check = self.units
        heard = odometer.silent.eq(0) & check.silent.eq(0)
        return all_of([heard, odometer.last_delivered.eq(0), self._within_floor(check.last_delivered)])

    def _within_floor(self, distance: Num) -> Bool:
        floor = self.units[1].law.floor_mm_s * self.physics.period_ms // THOUSAND
        return (distance <= floor) & (distance >= -floor)

    @property
    def between_pulses(self) -> Num:
        """The place between two pulses at which the vehicle last stood, nm; 0 where none counts as standing."""
        seen = self.ghosts.units
        return as_num(0, NM) if seen is None or seen.between_pulses is None else seen.between_pulses

    @property
    def between_pulses_after(self) -> Num:
        """The same after the cycle."""
        seen = self.ghosts.units
        if seen is None or seen.next_between_pulses is None:
            return as_num(0, NM)
        return ite(self.still, seen.next_between_pulses, self.between_pulses)


def world(declared: Declared, own: Surroundings) -> World:
    """Make the world: the true movement, and the laws of the vehicle and of the lawful unit."""
    seen = own.ghosts
    moves: dict[Var, Expr] = {seen.truth: seen.truth + seen.true_cycle_distance}
    laws = _vehicle_laws(own)
    if seen.units is not None:
        moves |= {seen.units.lawful_unit: seen.units.lawful_unit, seen.units.wander: own.wander_after}
        for unit in own.units:
            moves |= unit.moves()
        if seen.units.between_pulses is not None:
            moves[seen.units.between_pulses] = own.between_pulses_after
        laws |= _unit_laws(own, seen.units)
    return declared.world(moves, laws)


def initially(own: Surroundings) -> Bool:
    """Return the condition of the first state: the lawful unit's one-off error is within its constant, and the reported
    distance has the same one-off error.
    """
    seen = own.ghosts.units
    if seen is None:
        return as_num(0, NM).eq(0)
    halves = [_half(own, lawful) for lawful in LAWFUL]
    within = [
        seen.lawful_unit.eq(lawful).implies(between(-half, seen.wander, half))
        for lawful, half in zip(LAWFUL, halves, strict=True)
    ]
    return all_of([*within, seen.reported.eq(seen.wander)])


def _half(own: Surroundings, lawful: object) -> int:
    law = own.units[0].law if lawful is ODOMETER_LAWFUL else own.units[1].law
    return law.constant_mm * NM_PER_MM // 2


def _vehicle_laws(own: Surroundings) -> dict[str, Law]:
    seen, farthest = own.ghosts, own.physics.farthest_nm
    return {
        SPEED: speed_law(seen.true_cycle_distance, farthest),
        ON_THE_LINE: line_law(seen.truth, seen.truth + seen.true_cycle_distance),
    }


def _unit_laws(own: Surroundings, seen: CheckGhosts) -> dict[str, Law]:
    laws = {
        f"the {name}, if it is the lawful unit, obeys its error law": _keeps(own, seen, unit, lawful, name, field)
        for name, unit, lawful, field in zip(("odometer", "check unit"), own.units, LAWFUL, _FIELDS, strict=True)
    }
    if own.unmeasured is None or seen.next_between_pulses is None:
        return laws
    return {**laws, _STAYS: _standing(own, seen, own.unmeasured, seen.next_between_pulses)}


def _keeps(own: Surroundings, seen: CheckGhosts, unit: Measuring, lawful: object, name: str, field: str) -> Law:
    error = unit.error(own.ghosts.true_cycle_distance, seen.wander, seen.next_wander)
    half = _half(own, lawful)
    kept = unit.allows(error) & between(-half, seen.next_wander, half)
    judged = unit.can_be_run if lawful is ODOMETER_LAWFUL else unit.can_be_run & ~own.still
    return Law(
        (seen.lawful_unit.eq(lawful) & judged).implies(kept),  # type: ignore[arg-type]
        f"One unit keeps its law for good, nobody knows which. Where it is the {name}: what it measures in a cycle is wrong by "
        "no more than rate and floor of the MEASURED distance allow, and by the change of a one-off part within half its "
        "constant; or no vehicle can have run it.",
        (*(f"{field}.{figure}" for figure in _OF_A_UNIT), "max_speed_mm_s", "max_acceleration_mm_s2"),
        "[S] SUBSET-041: 5 m + 5 % of every measured distance, speed accuracy",
        "supplier",
        "the other unit; no common cause (adhesion on two wheels, snow on two radars) may break both",
    )


def _half_between_pulses_nm(unmeasured: Unmeasured) -> int:
    """Return how far a place between two pulses is from their middle at most; from the figure, and not as the machine has it."""
    return unmeasured.between_pulses_mm * NM_PER_MM // 2


def _standing(own: Surroundings, seen: CheckGhosts, unmeasured: Unmeasured, next_place: Num) -> Law:
    creep = unmeasured.creep_mm_s * own.physics.period_ms * NM_PER_MM // THOUSAND
    half = _half_between_pulses_nm(unmeasured)
    ran = own.ghosts.true_cycle_distance - next_place
    goes_on = between(-creep, ran + own.between_pulses, creep)
    begins = between(-creep - half, ran, creep + half)
    stays = (own.was_still.implies(goes_on)) & (own.was_still | begins) & seen.next_wander.eq(seen.wander)
    return Law(
        (own.still & seen.lawful_unit.eq(CHECK_LAWFUL)).implies(stays),
        "Where the odometer measures nothing and the check unit no more than its floor, the vehicle stays between two pulses of the "
        "odometer: in all such cycles that follow each other it gets no farther than between_pulses_mm, or creeps on no faster than "
        "configured, even if the odometer is the unit that may fail. The check unit's one-off error rests, and its law is not "
        "asked for. A vehicle that creeps on with a locked wheel, slower than the floor (2 km/h for a radar), breaks this law, and "
        "no error is added for what it creeps beyond.",
        ("check.floor_mm_s", "between_pulses_mm", "creep_mm_s"),
        "[S] 100 pulses a turn: 13.4 mm; [M] a wheel that stands while the vehicle creeps for long is noticed by brake and wheel "
        "slide protection",
        "supplier",
        "wheel slide protection; cold movement detection while parked",
    )
