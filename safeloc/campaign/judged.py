"""Outcomes of many runs: the machine runs on them, and each vehicle-cycle is counted by law and by interval.

    law kept     every clause of the world has held in the run so far: the proofs speak of the cycle
    law broken   some clause has been broken in this cycle or before it: no proof speaks of it
    contained    the reported interval holds the truth;  silent: nothing is reported;  wrong: the interval misses the truth

A wrong interval with the law broken is hazardous and unnoticed; one with the law kept would contradict a proof.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from safeloc.codegen.batch import Prepared, compile_batch, simulate
from safeloc.codegen.batch_lanes import compile_lanes
from safeloc.codegen.c99_build import compiler
from safeloc.errors import EngineError, InputError
from safeloc.language.expr import TRUE, Bool, BoolVar, Expr, Num, NumVar, Var, all_of, between
from safeloc.language.system import TransitionSystem
from safeloc.language.units import NM_PER_MM, Enumeration
from safeloc.proof.cache.store import Store, usual_folder
from safeloc.reported import Reported
from safeloc.simulation.many_runs import ManyRuns, through_border
from safeloc.target import Target

IN_RANGE = "the variables of the world stay in their ranges"
_FLAG = "campaign.law "
NEVER = -1

Flags = NDArray[np.bool_]
Whole = NDArray[np.int64]


def _clauses_of(system: TransitionSystem) -> dict[str, Bool]:
    """Return the clauses that the proofs assume, by name, over state before the step and inputs."""
    if system.parts:
        assumed = {f"{part.name}: {name}": term for part in system.parts for name, term in part.assumed.items()}
    else:
        assumed = dict(system.machines[0].world.terms)
    return {
        **assumed,
        IN_RANGE: all_of(_in_range(system, var) for var in sorted(system.ghosts, key=lambda var: var.name)),
    }


def _in_range(system: TransitionSystem, var: Var) -> Bool:
    """Return whether a number of the world is in its range after the step; what is chosen from a list stays in it."""
    value = system.next.get(var, var)
    if not isinstance(var, NumVar) or not isinstance(value, Num) or isinstance(var.unit, Enumeration):
        return TRUE
    return between(var.low, value, var.high)


@dataclass(frozen=True, eq=False)
class Judge:
    """A machine with its world as code for many runs, which also tells which clauses hold in each cycle."""

    target: Target
    reported: Reported
    clauses: tuple[str, ...]
    code: Prepared

    def outcome(self, runs: ManyRuns) -> Outcome:
        """Run the machine; return what became of every vehicle-cycle."""
        inputs, refused = through_border(self.code.system, runs.inputs)
        kept = simulate(self.code, inputs, start_state=runs.first).kept
        held = np.stack([kept[f"{_FLAG}{number}"] for number in range(len(self.clauses))])
        one = self.reported
        place = kept[one.position]
        return Outcome(
            told=kept[one.valid] == one.valid_is,
            low_mm=place - kept[one.below],
            high_mm=place + kept[one.above],
            position_mm=place,
            truth_nm=kept[one.truth],
            held=held,
            refused=refused,
        )


def judge_of(target: Target, *, compiled: bool = True) -> Judge:
    """Return the judge of a machine: in C where there is a compiler, else in numpy; both give the same numbers.

    InputError for a machine that reports no interval, or whose truth its world does not know.
    """
    reported = target.reported
    if reported is None or reported.truth not in {var.name for var in target.system.ghosts}:
        raise InputError(
            f"{target.name} reports no interval whose truth its world knows; a campaign has nothing to ask."
        )
    clauses = _clauses_of(target.system)
    flags: dict[Var, Expr] = {BoolVar(f"{_FLAG}{number}"): term for number, term in enumerate(clauses.values())}
    system = replace(
        target.system,
        state=(*target.system.state, *flags),
        next={**target.system.next, **flags},
        initial={**target.system.initial, **dict.fromkeys(flags, True)},
    )
    keep = [*reported.outputs, reported.truth, *(flag.name for flag in flags)]
    return Judge(target, reported, tuple(clauses), _code(system, keep, compiled=compiled))


def _code(system: TransitionSystem, keep: list[str], *, compiled: bool) -> Prepared:
    if compiled:
        try:
            cc = compiler()
        except EngineError:  # without a compiler numpy gives the same numbers, more slowly
            return compile_batch(system, keep)
        return compile_lanes(system, keep, threads=1, folder=libraries(), cc=cc)
    return compile_batch(system, keep)


def libraries() -> Path:
    """Return the folder for compiled machines."""
    return Store(Path(os.environ.get("SAFELOC_CACHE") or usual_folder())).libraries


@dataclass(frozen=True, eq=False)
class Outcome:
    """The outcome of every vehicle-cycle: arrays [cycle, vehicle].

    told     an interval is reported
    held     clause by clause: whether it holds; array [clause, cycle, vehicle]
    refused  values beyond their ranges, of each vehicle
    """

    told: Flags
    low_mm: Whole
    high_mm: Whole
    position_mm: Whole
    truth_nm: Whole
    held: Flags
    refused: Whole

    @property
    def broken(self) -> Flags:
        """A clause has been broken in the cycle or before it."""
        return np.logical_or.accumulate(~self.held.all(axis=0), axis=0)

    @property
    def margin_nm(self) -> Whole:
        """The distance of the truth from the nearer end of the interval, below 0 outside; meant for cycles with a report."""
        below, above = self.truth_nm - self.low_mm * NM_PER_MM, self.high_mm * NM_PER_MM - self.truth_nm
        return np.asarray(np.minimum(below, above), dtype=np.int64)

    @property
    def width_mm(self) -> Whole:
        """The width of the interval; meant for cycles with a report."""
        return self.high_mm - self.low_mm


def first_of(flags: Flags) -> Whole:
    """Return the first cycle of each vehicle in which a flag is set; NEVER without one."""
    return np.where(flags.any(axis=0), flags.argmax(axis=0), NEVER)


def cycles_until_silent(told: Flags, since: Whole) -> Whole:
    """Return the number of cycles from `since` to the first cycle without a report: NEVER until the end.

    NEVER - 1 where nothing was reported in the cycle before, or `since` is NEVER: then nothing can be withdrawn.
    """
    cycles, vehicles = told.shape
    before = np.maximum(since - 1, 0)
    meant = (since >= 0) & told[before, np.arange(vehicles)]
    silent = ~told & (np.arange(cycles)[:, None] >= np.maximum(since, 0))
    first = first_of(silent)
    return np.where(meant, np.where(first == NEVER, NEVER, first - since), NEVER - 1)
