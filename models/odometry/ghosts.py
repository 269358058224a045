"""What no device of the vehicle can read: where it really is, what its units really did, and where markers really lie."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.language.expr import BoolVar, NumVar, boolean, choice, enumeration, members, number
from safeloc.language.units import COUNT, MM, MS, NM, NM_PER_MM
from safeloc.models.vocabulary.error_law import ErrorLaw

READERS = ("front_marker", "rear_marker")


@dataclass(frozen=True, eq=False)
class UnitGhosts:
    """Of one measuring unit.

    wander, next_wander   the one-off part of its error: before the cycle and, freely chosen, after it, nm
    heard, silent         the last distance it delivered that the vehicle can have run, and the cycles since then
    unset                 of a unit that drifts: the time since a reader that sets it passed a marker
    """

    wander: NumVar
    next_wander: NumVar
    heard: NumVar
    silent: NumVar
    unset: NumVar | None


@dataclass(frozen=True, eq=False)
class ReaderGhosts:
    """Of one reader: where the marker that it reads really lies, and whether it reads one that is not under it."""

    spot: NumVar
    stray: BoolVar


@dataclass(frozen=True, eq=False)
class Ghosts:
    """The world's variables.

    truth, true_step   end A along the line, and what it really runs in the cycle, nm
    length             how far end B really is behind end A in the cycle
    since_stray        the time since a reader last read a marker that was not under it
    faulty             the unit that may break its law, or NONE; where there is such a unit
    unseen             per device, what a fault too small to be seen may have added; where that is not charged
    """

    truth: NumVar
    true_step: NumVar
    length: NumVar
    units: tuple[UnitGhosts, ...]
    readers: tuple[ReaderGhosts, ReaderGhosts]
    since_stray: NumVar
    faulty: NumVar | None = None
    unseen: tuple[NumVar, ...] = ()


@dataclass(frozen=True)
class Bounds:
    """Figures of the configuration that bound the ghosts: mm, ms, mm/s, cycles."""

    period_ms: int
    max_speed_mm_s: int
    line_mm: int
    longest_mm: int
    lone_limit_cycles: int
    age_limit_ms: int

    @property
    def farthest_nm(self) -> int:
        """What the vehicle runs in a cycle at its highest speed."""
        return self.max_speed_mm_s * self.period_ms * 1_000


def ghosts(bounds: Bounds, units: Sequence[tuple[str, ErrorLaw, NumVar]]) -> Ghosts:
    """Fresh variables; `units` are names, laws and measured distances."""
    line_nm, longest_nm = bounds.line_mm * NM_PER_MM, bounds.longest_mm * NM_PER_MM
    front, rear = (
        ReaderGhosts(
            number(f"{name}_spot_nm", NM, -line_nm - longest_nm, line_nm + longest_nm), boolean(f"{name}_stray")
        )
        for name in READERS
    )
    return Ghosts(
        number("truth_nm", NM, -line_nm, line_nm),
        number("true_step_nm", NM, -bounds.farthest_nm, bounds.farthest_nm),
        number("true_length_nm", NM, 0, longest_nm),
        tuple(_of_unit(bounds, name, law, step) for name, law, step in units),
        (front, rear),
        number("since_stray_ms", MS, 0, bounds.age_limit_ms + bounds.period_ms),
    )


def _of_unit(bounds: Bounds, name: str, law: ErrorLaw, step: NumVar) -> UnitGhosts:
    most = law.constant_mm * NM_PER_MM // 2
    return UnitGhosts(
        number(f"{name}_wander_nm", NM, -most, most),
        number(f"{name}_next_wander_nm", NM, -most, most),
        number(f"{name}_heard_mm", MM, step.low, step.high),
        number(f"{name}_silent_cycles", COUNT, 0, bounds.lone_limit_cycles + 1),
        number(f"{name}_unset_ms", MS, 0, bounds.age_limit_ms + bounds.period_ms) if law.drift_mm_s2 else None,
    )


def faulty_unit(names: Sequence[str]) -> NumVar:
    """The unit that may break its law, or NONE."""
    return choice("faulty_unit", enumeration(members("faulty", "NONE", *names)))
