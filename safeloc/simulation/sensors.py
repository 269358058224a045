"""Simulates distance sensors and marker readers of a train, which keep a declared error law, and their faults.

A distance sensor measures, in every cycle,   true = measured + change of wander + drift   with

    |wander| <= half the one-off constant      (quantisation, a wheel that slips and grips again)
    |drift|  <= floor x period + rate x (measured distance above the knee)

The wander is returned, so that the law can be checked exactly (`law_check`). Faults break it on purpose.

The wander moves slowly (a wheel that slips a little), so two distances that follow each other are ones that the vehicle can have run. In a
silence longer than `_SLIPS_ON` cycles it rests: a unit that counts nothing counts no slip, which else would come at once with the
first distance after it, and no vehicle can have run that distance.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from safeloc.errors import InputError
from safeloc.language.units import NM_PER_MM
from safeloc.simulation.faults import Fault, Kinds, plain
from safeloc.simulation.motion import Motion

FOREIGN = 900_000
"""Identities from here on belong to other lines."""
SEVERITY = 0.9
"""Share of the allowed error that a unit uses, unless another one is asked for."""
_SLIPS_ON = 3
"""Cycles of a silence in which a wheel slips on: shorter ones are single distances that were lost, and the unit counts on."""
_EPISODE = 100
"""Cycles in which the wander moves towards one value."""
KINDS = Kinds(
    "a distance sensor",
    {**plain("stuck", "runaway", "drop-out", "slip", "slide", "freeze"), "jump": {"by_mm": 50_000}},
)
"""Faults by name of the sensor, in cycles. A jump adds `by_mm` in its first cycle."""


class ErrorFigures(Protocol):
    """Figures of a unit's error law, as the machines declare them (`ErrorLaw`). Drift is not simulated."""

    @property
    def constant_mm(self) -> int:
        """One-off part of the error: it does not add up."""
        ...

    @property
    def rate_ppm(self) -> int:
        """Part of the error in proportion to the distance above the knee."""
        ...

    @property
    def floor_mm_s(self) -> int:
        """Part of the error that grows with time."""
        ...

    @property
    def knee_mm_s(self) -> int:
        """Speed up to which the rate adds nothing."""
        ...


@dataclass(frozen=True)
class Distances:
    """Measurements of a unit: mm in each cycle, whether present, and the wander (nm) after each cycle.

    Shapes [cycle], or [cycle, run] for the units of many runs.

    more_nm   for a distance checked by another unit: error added in each cycle beyond the unit's law
    """

    name: str
    distance_mm: NDArray[np.int64]
    present: NDArray[np.bool_]
    wander_nm: NDArray[np.int64]
    more_nm: NDArray[np.int64] | None = None

    def more(self, cycle: int) -> int:
        """Return the error added in a cycle beyond the law, nm; 0 if none is given."""
        return 0 if self.more_nm is None else int(self.more_nm[cycle])

    @property
    def as_column(self) -> Distances:
        """The measurements of one run as those of many."""
        more = None if self.more_nm is None else self.more_nm[:, None]
        return Distances(self.name, self.distance_mm[:, None], self.present[:, None], self.wander_nm[:, None], more)

    def of(self, run: int) -> Distances:
        """Return the measurements of one of many runs."""
        more = None if self.more_nm is None else self.more_nm[:, run]
        return Distances(self.name, self.distance_mm[:, run], self.present[:, run], self.wander_nm[:, run], more)


@dataclass(frozen=True)
class Reading:
    """One marker reading at one end. `place_mm` is None for a marker that the map does not have.

    spot_nm  where the marker truly lies; None: where the run since then puts it
    """

    cycle: int
    end: int
    marker: int
    place_mm: int | None
    accuracy_mm: int
    since_mm: int
    spot_nm: int | None = None


def measure(
    name: str,
    motion: Motion,
    law: ErrorFigures,
    rng: np.random.Generator,
    *,
    dropout: float = 0.0,
    severity: float = SEVERITY,
    faults: Sequence[Fault] = (),
) -> Distances:
    """Simulate the distances of one unit.

    severity  share of the allowed error that is used; 1: up to the limits of the law
    faults    of `KINDS`; a drop-out keeps the law, since a silent unit measures nothing wrong

    InputError for a fault that no unit has.
    """
    true = motion.distance_nm[:, None]
    return measure_many(
        name, true, motion.period_ms, law, [rng], dropout=[dropout], severity=[severity], faults=[faults]
    ).of(0)


def measure_many(
    name: str,
    true_nm: NDArray[np.int64],
    period_ms: int,
    law: ErrorFigures,
    rngs: Sequence[np.random.Generator],
    *,
    dropout: Sequence[float],
    severity: Sequence[float],
    faults: Sequence[Sequence[Fault]],
) -> Distances:
    """Simulate the distances of one unit in many runs, as `measure` does in each: run by run the same draws, and the same figures.

    true_nm   true distances, array [cycle, run]; of one column if all runs drive alike
    """
    cycles, runs = len(true_nm), len(rngs)
    bias, wanted, present = draws_of(rngs, cycles, dropout)
    for run in range(runs):
        KINDS.require(faults[run])
        present[:, run] &= ~_silenced(name, cycles, faults[run])
    step, wander = measured(true_nm, period_ms, law, np.array(severity, dtype=np.float64), bias, wanted, present)
    _check_wander(name, law, wander)
    for run in range(runs):
        if faults[run]:
            step[:, run] = faulty(name, step[:, run], faults[run])
    return Distances(name, step, present, wander)


def draws_of(
    rngs: Sequence[np.random.Generator], cycles: int, dropout: Sequence[float]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Return, of each run: the share of the drift in each cycle, the wander wanted in each episode, and whether a cycle is measured."""
    bias, wanted = np.empty((len(rngs), cycles)), np.empty((len(rngs), cycles // _EPISODE + 1))
    present = np.empty((len(rngs), cycles), dtype=np.bool_)
    for run, (rng, share) in enumerate(zip(rngs, dropout, strict=True)):
        bias[run] = rng.uniform(-1, 1) * np.ones(cycles) + rng.normal(0, 0.05, cycles)
        wanted[run] = rng.uniform(-1, 1, cycles // _EPISODE + 1)
        present[run] = rng.random(cycles) >= share
    bias, wanted = (np.ascontiguousarray(one.T) for one in (bias, wanted))
    return bias, wanted, np.ascontiguousarray(present.T)


def measured(
    true_nm: NDArray[np.int64],
    period_ms: int,
    law: ErrorFigures,
    severity: NDArray[np.float64],
    bias: NDArray[np.float64],
    wanted: NDArray[np.float64],
    present: NDArray[np.bool_],
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return what units of many runs measure, mm in each cycle, and their wander, nm: arrays [cycle, run] as the arguments.

    severity  of each run, as in `measure`
    bias      share of the allowed drift, -1 to 1, that a unit has in a cycle
    wanted    share of the wander, -1 to 1, to which it moves in each 100 cycles
    """
    drift = (np.clip(bias, -1, 1) * severity * _drift_nm(law, true_nm, period_ms)).astype(np.int64)
    run = np.cumsum(np.where(present, true_nm - drift, 0), axis=0)
    numbers = np.arange(1, len(true_nm) + 1)[:, None]
    counted = np.maximum.accumulate(np.where(present, numbers, 0), axis=0)
    slipping = _episodes(wanted, numbers - counted <= _SLIPS_ON, _slip_nm(law, severity)).astype(np.int64)
    told = np.where(present, np.rint((run - slipping) / NM_PER_MM).astype(np.int64), 0)
    before_first = np.vstack([np.zeros((1, told.shape[1]), dtype=np.int64), told])
    told = np.take_along_axis(before_first, counted, axis=0)
    step = np.diff(told, axis=0, prepend=0)
    return step, run - told * NM_PER_MM


def _silenced(name: str, cycles: int, faults: Sequence[Fault]) -> NDArray[np.bool_]:
    silent = np.zeros(cycles, dtype=np.bool_)
    for fault in faults:
        if fault.strikes(name) and fault.kind == "drop-out":
            silent[fault.span] = True
    return silent


def _slip_nm(law: ErrorFigures, severity: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the share of the constant for slip, after rounding to whole mm."""
    most = (law.constant_mm - 1) * NM_PER_MM / 2 - 1_000
    return np.maximum(0.0, np.minimum(law.constant_mm * NM_PER_MM * 0.4 * severity, most))


def _drift_nm(law: ErrorFigures, true_nm: NDArray[np.int64], period_ms: int) -> NDArray[np.int64]:
    """Return the drift that a cycle may have, computed from a distance certainly below the measured one."""
    floor = law.floor_mm_s * period_ms * 1000
    least = abs(true_nm) // NM_PER_MM * (1_000_000 - law.rate_ppm) // 1_000_000 - 2 - floor // NM_PER_MM
    wander_change = law.constant_mm // 50
    above = np.maximum(0, least - wander_change - law.knee_mm_s * period_ms // 1000)
    return np.asarray(floor + above * law.rate_ppm, dtype=np.int64)


def _episodes(
    wanted: NDArray[np.float64], moving: NDArray[np.bool_], most_nm: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return a wander that at times moves slowly (at most 1/500 of its range in a cycle), and otherwise rests.

    moving  whether it may move in a cycle, array [cycle, run]
    """
    path = np.zeros(moving.shape)
    most_change = most_nm / 500
    for begin in range(0, len(moving), _EPISODE):
        block = slice(begin, begin + _EPISODE)
        before = path[begin - 1] if begin else path[0]
        goal = wanted[begin // _EPISODE] * most_nm
        upward = goal >= before
        steps = np.where(moving[block], np.where(upward, most_change, -most_change), 0.0)
        if not begin:
            steps[0] = 0.0
        steps[0] += before
        moved = np.add.accumulate(steps, axis=0)
        path[block] = np.where(upward, np.minimum(moved, goal), np.maximum(moved, goal))
    return path


def _check_wander(name: str, law: ErrorFigures, wander: NDArray[np.int64]) -> None:
    if wander.size and int(np.abs(wander).max()) > law.constant_mm * NM_PER_MM // 2:
        raise InputError(
            f"{name}: a constant of {law.constant_mm} mm cannot hold the rounding to whole mm; make it >= 2 mm."
        )


def faulty(name: str, step: NDArray[np.int64], faults: Sequence[Fault]) -> NDArray[np.int64]:
    """Return what the unit of this name tells in each cycle with its faults."""
    step = step.copy()
    for fault in faults:
        if not fault.strikes(name):
            continue
        part = fault.span
        match fault.kind:
            case "stuck":
                step[part] = 0
            case "runaway":
                step[part] += 1_000
            case "jump":
                step[fault.begin] += KINDS.figure(fault, "by_mm")
            case "slip":
                step[part] = step[part] * 5 // 4
            case "slide":
                step[part] = step[part] * 3 // 4
            case "freeze":
                step[part] = step[fault.begin]
            case _:
                pass  # a drop-out was applied when the distances were measured
    return step


def read_markers(
    motion: Motion,
    end: int,
    offset_mm: int,
    markers: Sequence[tuple[int, int]],
    accuracy_mm: int | Mapping[int, int],
    rng: np.random.Generator,
    *,
    missed: float = 0.0,
    foreign: float = 0.0,
    own_share: float = 0.9,
    beside_mm: Sequence[float] = (),
) -> list[Reading]:
    """Return readings of the reader `offset_mm` behind end A.

    markers      (identity, place in mm) in order of place
    own_share    how far each marker lies from its place at most, as a share of its accuracy, where each has one
    beside_mm    how far each lies from it beside that; none without any
    accuracy_mm  errors reach nine tenths of it. One for all markers: the distance since the reading is wrong by that much. One
                 for each marker: the marker lies that far from its mapped place
    foreign      share of cycles with a marker of another track, whose identity the map does not have
    """
    known = None if isinstance(accuracy_mm, int) else accuracy_mm
    shifts = {} if known is None else {m: rng.uniform(-own_share, own_share) * known[m] for m, _ in markers}
    for (marker, _), beside in zip(markers, beside_mm, strict=False):
        shifts[marker] += beside
    places = motion.position_nm - offset_mm * NM_PER_MM
    met = _met(places, motion.start_nm - offset_mm * NM_PER_MM, [(p + shifts.get(m, 0.0)) for m, p in markers])
    readings: list[Reading] = []
    done = 0

    def strange(end_cycle: int) -> None:
        """Draw for each cycle from the last one drawn for whether it brings a marker of another track."""
        cycles = done + np.flatnonzero(rng.random(max(0, end_cycle - done)) < foreign)
        readings.extend(Reading(int(cycle), end, FOREIGN + int(cycle) % 1000, None, 0, 0) for cycle in cycles)

    for cycle, number in met.items():
        strange(cycle)
        done = cycle
        if rng.random() >= missed:
            marker, spot = markers[number]
            bound_mm = accuracy_mm if isinstance(accuracy_mm, int) else accuracy_mm[marker]
            error = float(rng.uniform(-0.9, 0.9)) * bound_mm if marker not in shifts else -shifts[marker]
            readings.append(
                Reading(cycle, end, marker, spot, bound_mm, round(places[cycle] / NM_PER_MM - spot + error))
            )
            done += 1
    strange(len(places))
    return readings


def _met(places: NDArray[np.int64], start_nm: int, spots_mm: Sequence[float]) -> dict[int, int]:
    """Return the cycles in which a reader passes a place, in order, each with the number of the last place that it passes there."""
    spots = np.array(spots_mm, dtype=np.float64) * NM_PER_MM
    before = np.concatenate([[start_nm], places[:-1]])
    found: dict[int, int] = {}
    if (before <= places).all():  # a run that never turns back passes each place once
        met = (spots > start_nm) & (spots <= places[-1]) if len(places) else np.zeros(len(spots), dtype=np.bool_)
        for number, cycle in zip(
            np.flatnonzero(met).tolist(), np.searchsorted(places, spots[met]).tolist(), strict=True
        ):
            found[cycle] = number
        return dict(sorted(found.items()))
    low, high = np.minimum(before, places), np.maximum(before, places)
    for number, true in enumerate(spots.tolist()):
        found |= dict.fromkeys(np.flatnonzero((low < true) & (true <= high)).tolist(), number)
    return dict(sorted(found.items()))


def passages(
    position_nm: NDArray[np.int64],
    start_nm: int,
    end: int,
    offset_mm: int,
    markers: Sequence[tuple[int, int]],
    shifts_mm: NDArray[np.float64],
    accuracy_mm: Mapping[int, int],
) -> list[Reading]:
    """Return the readings of `read_markers` for a run that never turns back, on which every marker lies `shifts_mm` from its place."""
    places = position_nm - offset_mm * NM_PER_MM
    spots = (np.array([place for _, place in markers], dtype=np.int64) + shifts_mm) * NM_PER_MM
    cycles = np.searchsorted(places, spots, side="left")
    read: dict[int, Reading] = {}  # of several markers in one cycle the reader tells the last one
    for (marker, spot), at, shift, true in zip(markers, cycles, shifts_mm, spots, strict=True):
        cycle = int(at)
        if true > start_nm - offset_mm * NM_PER_MM and cycle < len(places):
            since = round(int(places[cycle]) / NM_PER_MM - spot + -shift)
            read[cycle] = Reading(cycle, end, marker, spot, accuracy_mm[marker], since)
    return [read[cycle] for cycle in sorted(read)]
