"""Variables of the odometry machine's world, which no device reads: the true movement, the units' true errors, the true markers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import BoolVar, NumVar, boolean, choice, enumeration, members, number
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM, MS, NM, NM_PER_MM
from safeloc.models.odometry.distance_device import Device, Unit
from safeloc.models.odometry.hidden_faults import unseen, unseen_at_reading_nm

READERS = ("front_marker", "rear_marker")


@dataclass(frozen=True, eq=False)
class UnitGhosts:
    """Ghosts of one measuring unit.

    wander, next_wander   the one-off part of its error: before the cycle and, freely chosen, after it, nm
    last_delivered, silent  the last distance it delivered that the vehicle can have run, and the cycles since then
    unset                 of a unit that drifts: the time since a reader that sets it passed a marker
    """

    wander: NumVar
    next_wander: NumVar
    last_delivered: NumVar
    silent: NumVar
    unset: NumVar | None


@dataclass(frozen=True, eq=False)
class ReaderGhosts:
    """Ghosts of one reader: the true place of the marker that it reads, and the flag that this marker is not under it."""

    spot: NumVar
    stray: BoolVar


@dataclass(frozen=True)
class Bounds:
    """Figures of the configuration that bound the ghosts: mm, ms, mm/s, cycles."""

    period_ms: int
    max_speed_mm_s: int
    line_mm: int
    longest_mm: int
    gap_limit_cycles: int
    lone_limit_cycles: int
    age_limit_ms: int

    @property
    def farthest_nm(self) -> int:
        """The run of a cycle at the highest speed."""
        return self.max_speed_mm_s * self.period_ms * 1_000


@dataclass(frozen=True, eq=False)
class Movement:
    """The true movement of a vehicle: end A along the line, and its run in the cycle, nm."""

    truth: NumVar
    true_cycle_distance: NumVar


def movement(bounds: Bounds) -> Movement:
    """Make the variables of a movement; a machine that follows another one's movement takes that one's."""
    line_nm = bounds.line_mm * NM_PER_MM
    return Movement(
        number("truth_nm", NM, -line_nm, line_nm),
        number("true_cycle_distance_nm", NM, -bounds.farthest_nm, bounds.farthest_nm),
    )


class Ghosts:
    """The world's variables.

    truth, true_cycle_distance   end A along the line, and its true run in the cycle, nm
    length             the true distance from end B to end A in the cycle
    since_stray        the time since a reader last read a marker that was not under it
    faulty_unit             the unit that may break its law, or NONE; only with a possible fault
    unseen             for each device, what an undetectably small fault may have added; only where the margins do not cover it
    """

    def __init__(
        self,
        declared: Declared,
        bounds: Bounds,
        devices: Sequence[Device],
        moved: Movement,
        *,
        with_fault: bool,
        covered: bool,
    ) -> None:
        longest_nm = bounds.longest_mm * NM_PER_MM
        units = [unit for device in devices for unit in device.units]
        self.truth = declared.ghost(moved.truth, first=ANY)
        self.true_cycle_distance = declared.choice(moved.true_cycle_distance)
        self.length = declared.choice(number("true_length_nm", NM, 0, longest_nm))
        since_stray = number("since_stray_ms", MS, 0, bounds.age_limit_ms + bounds.period_ms)
        self.since_stray = declared.ghost(since_stray, first=ANY)
        self.units = tuple(_of_unit(declared, bounds, unit) for unit in units)
        self.readers = tuple(_of_reader(declared, bounds, name) for name in READERS)
        self.faulty_unit: NumVar | None = None
        self.unseen: tuple[NumVar, ...] = ()
        if with_fault:
            names = enumeration(members("faulty", "NONE", *(unit.name for unit in units)))
            self.faulty_unit = declared.ghost(choice("faulty_unit", names), first=ANY)
        if with_fault and not covered:
            self.unseen = tuple(
                declared.ghost(unseen(device), first=unseen_at_reading_nm(device)) for device in devices
            )


def _of_reader(declared: Declared, bounds: Bounds, name: str) -> ReaderGhosts:
    farthest_nm = (bounds.line_mm + bounds.longest_mm) * NM_PER_MM
    return ReaderGhosts(
        declared.choice(number(f"{name}_spot_nm", NM, -farthest_nm, farthest_nm)),
        declared.choice(boolean(f"{name}_stray")),
    )


def _of_unit(declared: Declared, bounds: Bounds, unit: Unit) -> UnitGhosts:
    most, name, step = unit.law.constant_mm * NM_PER_MM // 2, unit.name, unit.measured.value
    wander = declared.ghost(number(f"{name}_wander_nm", NM, -most, most), first=ANY)
    next_wander = declared.choice(number(f"{name}_next_wander_nm", NM, -most, most))
    last_delivered = declared.ghost(number(f"{name}_last_delivered_mm", MM, step.low, step.high), first=0)
    silent = number(f"{name}_silent_cycles", COUNT, 0, bounds.lone_limit_cycles + 1)
    declared.ghost(silent, first=bounds.gap_limit_cycles + 1)
    if not unit.law.drift_mm_s2:
        return UnitGhosts(wander, next_wander, last_delivered, silent, None)
    unset = number(f"{name}_unset_ms", MS, 0, bounds.age_limit_ms + bounds.period_ms)
    return UnitGhosts(wander, next_wander, last_delivered, silent, declared.ghost(unset, first=ANY))
