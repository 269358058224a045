"""The world of a vehicle's movement: where it really is, and which of its two units keeps its law.

    the lawful unit   delivers a distance that keeps its error law, or one that no vehicle can have run, or nothing; nobody
                      knows which of the two it is
    the other unit    does as it likes
    standing          where the odometer measures nothing and the check unit no more than its floor, the vehicle stands, or
                      creeps no faster than configured; or nothing is said of that

Without a check unit nothing is assumed of the odometer here: who uses its distances assumes that it keeps its law.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import (  # fmt: skip
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
    exact_to,
    ite,
    members,
    number,
)
from safeloc.language.machine import ANY, Initial
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.language.world import Law, World
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.measuring_world import THOUSAND, Measuring, Physics
from safeloc.models.vocabulary.odometer import Odometer

LAWFUL = members("lawful_unit", "ODOMETER", "CHECK")
ODOMETER_LAWFUL, CHECK_LAWFUL = LAWFUL
FIGURES = ("constant_mm", "rate_ppm", "floor_mm_s", "knee_mm_s", "max_speed_mm_s", "max_acceleration_mm_s2")


@dataclass(frozen=True, eq=False)
class UnitGhosts:
    """The last distance that was delivered and can have been run, and the cycles since then."""

    heard: NumVar
    silent: NumVar


@dataclass(frozen=True, eq=False)
class CheckGhosts:
    """Of two units that check each other.

    lawful                     the unit that keeps its law; the other one may do as it likes
    wander, next_wander        the one-off part of the lawful unit's error, before the cycle and, freely chosen, after it
    told, next_told            the one-off part of the error of what is told (safeloc.models.motion.told_error)
    odometer, check            what each of them delivered
    """

    lawful: NumVar
    wander: NumVar
    next_wander: NumVar
    told: NumVar
    next_told: NumVar
    odometer: UnitGhosts
    check: UnitGhosts


@dataclass(frozen=True, eq=False)
class Ghosts:
    """The world's variables: where the front end is, how far it runs in the cycle, nm; and of two units what they keep."""

    truth: NumVar
    true_step: NumVar
    units: CheckGhosts | None


def ghosts(physics: Physics, line_mm: int, laws: tuple[ErrorLaw, ErrorLaw] | None, told: ErrorLaw) -> Ghosts:
    """Fresh variables; `laws` are those of odometer and check unit, if there is one."""
    line = line_mm * NM_PER_MM
    return Ghosts(
        number("truth_nm", NM, -line, line),
        number("true_step_nm", NM, -physics.farthest_nm, physics.farthest_nm),
        None if laws is None else _units(physics, laws, told),
    )


def _units(physics: Physics, laws: tuple[ErrorLaw, ErrorLaw], told: ErrorLaw) -> CheckGhosts:
    most, of_told = (
        max(constants) * NM_PER_MM // 2 for constants in ([one.constant_mm for one in laws], [told.constant_mm])
    )
    return CheckGhosts(
        choice("lawful_unit", enumeration(LAWFUL)),
        number("lawful_wander_nm", NM, -most, most),
        number("lawful_next_wander_nm", NM, -most, most),
        number("odometer_wander_nm", NM, -of_told, of_told),
        number("odometer_next_wander_nm", NM, -of_told, of_told),
        *(
            UnitGhosts(
                number(f"{name}_heard_mm", MM, -physics.farthest_mm, physics.farthest_mm),
                number(f"{name}_silent_cycles", COUNT, 0, physics.longest_cycles),
            )
            for name in ("odometer", "check")
        ),
    )


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The ghosts with the raw inputs and figures that the world knows.

    `creep_mm_s`: the fastest that a vehicle creeps while its units measure nothing; None where nothing is said of that.
    """

    ghosts: Ghosts
    physics: Physics
    odometer: Odometer
    check: Odometer | None
    creep_mm_s: int | None

    @property
    def units(self) -> tuple[Measuring, Measuring]:
        """Odometer and check unit as the world has them."""
        seen = self.ghosts.units
        assert seen is not None and self.check is not None
        of_odometer, of_check = seen.odometer, seen.check
        return (
            Measuring(self.odometer.law, self.odometer.step, of_odometer.heard, of_odometer.silent, self.physics),
            Measuring(self.check.law, self.check.step, of_check.heard, of_check.silent, self.physics),
        )

    @property
    def wander_after(self) -> Num:
        """The one-off part of the lawful unit's error after the cycle: it rests where that unit measures nothing."""
        seen, (odometer, check) = self.ghosts.units, self.units
        assert seen is not None
        measures = ite(seen.lawful.eq(ODOMETER_LAWFUL), odometer.can_be_run, check.can_be_run)
        return ite(measures, seen.next_wander, seen.wander)


def world(own: Surroundings) -> World:
    """The true movement, and what the lawful unit and the vehicle keep."""
    seen = own.ghosts
    moves: dict[Var, Expr] = {seen.truth: seen.truth + seen.true_step}
    first: dict[Var, Initial] = {seen.truth: ANY}
    choices: list[Var] = [seen.true_step]
    laws = _vehicle_laws(own)
    if seen.units is not None:
        first |= {seen.units.lawful: ANY, seen.units.wander: ANY}
        moves |= {seen.units.lawful: seen.units.lawful, seen.units.wander: own.wander_after}
        for unit in own.units:
            first |= unit.first()
            moves |= unit.moves()
        choices.append(seen.units.next_wander)
        laws |= _unit_laws(own, seen.units)
    return World(first, choices, moves, laws)


def initially(own: Surroundings) -> Bool:
    """The lawful unit's one-off error is within its constant from the start, and what is told has that of the unit."""
    seen = own.ghosts.units
    if seen is None:
        return as_num(0, NM).eq(0)
    halves = [_half(own, lawful) for lawful in LAWFUL]
    within = [
        seen.lawful.eq(lawful).implies(between(-half, seen.wander, half))
        for lawful, half in zip(LAWFUL, halves, strict=True)
    ]
    return all_of([*within, seen.told.eq(seen.wander)])


def _half(own: Surroundings, lawful: object) -> int:
    law = own.units[0].law if lawful is ODOMETER_LAWFUL else own.units[1].law
    return law.constant_mm * NM_PER_MM // 2


def _vehicle_laws(own: Surroundings) -> dict[str, Law]:
    seen, farthest = own.ghosts, own.physics.farthest_nm
    line = between(seen.truth.low, seen.truth + seen.true_step, seen.truth.high)
    return {
        "the vehicle keeps to its highest speed": Law(
            between(-farthest, seen.true_step, farthest),
            "The vehicle runs no faster than its highest speed, either way.",
            ("max_speed_mm_s", "period_ms"),
            "[D] 160 km/h",
            "operator",
            "speed supervision",
        ),
        "the vehicle stays on the line": Law(
            line,
            "The vehicle does not leave the coordinates of the line.",
            ("position_limit_mm",),
            "[D] 1 000 km of line",
            "operator",
            "route setting",
        ),
    }


def _unit_laws(own: Surroundings, seen: CheckGhosts) -> dict[str, Law]:
    laws = {
        f"the {name}, where it is the lawful unit, keeps its law": _keeps(own, seen, unit, lawful, name)
        for name, unit, lawful in zip(("odometer", "check unit"), own.units, LAWFUL, strict=True)
    }
    if own.creep_mm_s is None:
        return laws
    return {**laws, "a vehicle that measures nothing stands": _standing(own, seen, own.creep_mm_s)}


def _keeps(own: Surroundings, seen: CheckGhosts, unit: Measuring, lawful: object, name: str) -> Law:
    error = own.ghosts.true_step - exact_to(unit.step.value, NM) - (seen.next_wander - seen.wander)
    half = _half(own, lawful)
    kept = unit.allows(error) & between(-half, seen.next_wander, half)
    return Law(
        (seen.lawful.eq(lawful) & unit.can_be_run).implies(kept),  # type: ignore[arg-type]
        f"One unit keeps its law for good, nobody knows which. Where it is the {name}: what it measures in a cycle is wrong by "
        "no more than rate and floor of the MEASURED distance allow, and by the change of a one-off part within half its "
        "constant; or no vehicle can have run it.",
        FIGURES,
        "[S] SUBSET-041: 5 m + 5 % of every measured distance, speed accuracy",
        "supplier",
        "the other unit; no common cause (adhesion on two wheels, snow on two radars) may break both",
    )


def _standing(own: Surroundings, seen: CheckGhosts, creep_mm_s: int) -> Law:
    odometer, check = own.units
    floor = check.law.floor_mm_s * own.physics.period_ms // THOUSAND
    nothing = all_of([odometer.can_be_run, check.can_be_run, odometer.step.value.eq(0)])
    still = nothing & (check.step.value <= floor) & (check.step.value >= -floor)
    creep = creep_mm_s * own.physics.period_ms * (NM_PER_MM // THOUSAND)
    stands = between(-creep, own.ghosts.true_step, creep) & seen.next_wander.eq(seen.wander)
    return Law(
        (still & seen.lawful.eq(CHECK_LAWFUL)).implies(stands),
        "Where the odometer measures nothing and the check unit no more than its floor, the vehicle stands, or creeps no faster "
        "than configured, even if the odometer is the unit that may fail: a vehicle that creeps faster with a locked wheel, and "
        "slower than the floor (2 km/h for a radar), breaks this law, and no error is added for what it creeps beyond.",
        ("floor_mm_s", "creep_mm_s"),
        "[M] a wheel that stands while the vehicle creeps for long is noticed by brake and wheel slide protection",
        "supplier",
        "wheel slide protection; cold movement detection while parked",
    )
