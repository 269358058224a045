"""The one-off error of a unit that explains what it measured, if any does: so a law counts as broken only where nothing explains it.

    true = measured + change of wander + error        |wander| <= half        |error| <= growth

The wander is the world's to choose. In every cycle the possible wanders are a stretch, which the next distance moves and widens, and which
the law cuts at either end. Where nothing is left of it, the law is broken in that cycle; from there on it begins anew at the end that
is nearest. Backwards from the last cycle, one wander of each stretch is then taken.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import NM_PER_MM
from safeloc.simulation.sensors import ErrorFigures

Whole = NDArray[np.int64]
Flags = NDArray[np.bool_]


class Limits(Protocol):
    """Limits of a vehicle's movement, as its world has them."""

    @property
    def farthest_mm(self) -> int:
        """The greatest distance of a cycle."""
        ...

    @property
    def change_mm(self) -> int:
        """The most by which two distances of successive cycles differ."""
        ...

    @property
    def gap_limit_cycles(self) -> int:
        """Cycles of silence after which the last distance counts for nothing."""
        ...


def can_be_run(told_mm: Whole, present: Flags, limits: Limits) -> Flags:
    """Return which distances a vehicle can have run, by its speed and by the change since the last such distance: [cycle, vehicle]."""
    found = np.zeros(present.shape, dtype=np.bool_)
    last = np.zeros(present.shape[1], dtype=np.int64)
    silent = np.full(present.shape[1], limits.gap_limit_cycles + 1)
    for cycle, told in enumerate(told_mm):
        near = np.abs(told - last) <= (silent + 1) * limits.change_mm
        counts = present[cycle] & (np.abs(told) <= limits.farthest_mm) & (near | (silent > limits.gap_limit_cycles))
        last, silent = np.where(counts, told, last), np.where(counts, 0, silent + 1)
        found[cycle] = counts
    return found


def growth_nm(law: ErrorFigures, told_mm: Whole, period_ms: int) -> Whole:
    """Return the error that the law allows each distance beside its one-off part, nm, rounded down."""
    above = np.maximum(np.abs(told_mm) * 1_000 - law.knee_mm_s * period_ms, 0)
    return np.asarray(above * law.rate_ppm // 1_000 + law.floor_mm_s * period_ms * 1_000, dtype=np.int64)


def lawful_wander(
    true_nm: Whole, told_mm: Whole, counts: Flags, law: ErrorFigures, period_ms: int
) -> tuple[Whole, Flags]:
    """Return the wander after each cycle, nm, 0 before the first; and in which cycles none is lawful: arrays [cycle, vehicle].

    counts  as of `can_be_run`: of other cycles the law says nothing, and the wander rests
    """
    half = law.constant_mm * NM_PER_MM // 2
    off = np.where(counts, true_nm - told_mm * NM_PER_MM, 0)
    slack = np.where(counts, growth_nm(law, told_mm, period_ms), 0)
    return wander_within(off, slack, half)


def wander_within(off: Whole, slack: Whole, half: int) -> tuple[Whole, Flags]:
    """Return a wander within half to either side that changes by `off` in each cycle, give or take `slack`; and where there is none."""
    low, high, broken = _stretches(off, slack, half)
    found = np.empty_like(off)
    now = np.minimum(np.maximum(0, low[-1]), high[-1]) if len(off) else low
    for cycle in range(len(off) - 1, -1, -1):
        found[cycle] = now
        if cycle:
            before, least, most = now - off[cycle], low[cycle - 1], high[cycle - 1]
            least = np.where(broken[cycle], least, np.maximum(least, before - slack[cycle]))
            most = np.where(broken[cycle], most, np.minimum(most, before + slack[cycle]))
            now = np.minimum(np.maximum(before, least), most)
    return found, broken


def first_breach(broken: Flags) -> Whole:
    """Return the first cycle of each vehicle in which a law is broken; the number of cycles where it never is."""
    return np.where(broken.any(axis=0), broken.argmax(axis=0), len(broken))


def _stretches(off: Whole, slack: Whole, half: int) -> tuple[Whole, Whole, Flags]:
    """Return the least and the greatest possible wander after each cycle, and where there is none."""
    low, high, broken = np.empty_like(off), np.empty_like(off), np.empty(off.shape, dtype=np.bool_)
    least = most = np.zeros(off.shape[1], dtype=np.int64)
    for cycle, (error, grows) in enumerate(zip(off, slack, strict=True)):
        least, most = least + error - grows, most + error + grows
        broken[cycle] = (least > half) | (most < -half)
        least, most = np.minimum(np.maximum(least, -half), half), np.maximum(np.minimum(most, half), -half)
        low[cycle], high[cycle] = least, most
    return low, high, broken
