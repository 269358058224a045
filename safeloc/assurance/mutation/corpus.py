"""Runs of the unchanged machine, along which mutants are run: its recordings, runs in which its rows fire, and drawn ones."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from safeloc.language.expr import NumVar, Var
from safeloc.language.interpret import read_inputs
from safeloc.language.nodes import Value
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, canonical
from safeloc.language.trace import Trace
from safeloc.language.units import Enumeration
from safeloc.language.verdict import Proved
from safeloc.proof.drawn_runs.driver import Driver
from safeloc.proof.drawn_runs.lawful import NoFirstStateError
from safeloc.proof.drawn_runs.profiles import FAULTY, PLAUSIBLE
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.reachability import reached
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.proof.verification.replay import run_with_truth
from safeloc.runtime.streams.gzipped import name_of
from safeloc.runtime.streams.steps import read_steps
from safeloc.target import Target

_LONGEST = 600
"""Greatest number of steps of a run that are used."""
_DRAWN, STRETCHES, STRETCH = 60, 4, 12
"""Number of drawn runs, of stretches in each, and greatest number of steps of a stretch."""
_Row = tuple[Value, ...]


@dataclass(frozen=True)
class Run:
    """A run: values for the first state, and a row of inputs for each step.

    first     values by name; only those that the declaration leaves open are used
    recorded  the run ships with the machine: other outputs along it are evidence against a mutant
    has_ghosts  the run has the ghosts, so that claims can be judged on it
    """

    name: str
    first: Mapping[str, Value]
    rows: tuple[_Row, ...]
    recorded: bool = False
    has_ghosts: bool = True


def corpus(target: Target, system: TransitionSystem, limits: Limits, seed: int, *, searched: bool = True) -> list[Run]:
    """Return all runs: witnesses and drawn runs in order of length, then the recordings; the first run to find a fault is short.

    searched  search for runs in which rows fire; without recordings this takes minutes
    """
    properties = [prop for prop in target.properties if prop.kind != "reachable"]
    shipped = [run for path in target.streams if (run := run_with_truth(target, path)) is not None]
    witnesses = _witnesses(target, system, limits) if searched else []
    known = [*witnesses, *shipped]
    runs = [run_of(system, f"witness {number}", trace) for number, trace in enumerate(witnesses, 1)]
    with suppress(NoFirstStateError):
        runs += _drawn(system, properties, known, seed)
    return [*sorted(runs, key=lambda run: len(run.rows)), *recorded(target, system)]


def run_of(system: TransitionSystem, name: str, trace: Trace, *, recorded: bool = False) -> Run:
    """Return a trace as a run, cut to the greatest number of steps."""
    rows = tuple(tuple(step.inputs[var.name] for var in system.inputs) for step in trace.steps[:_LONGEST])
    return Run(name, trace.initial, rows, recorded)


def recorded(target: Target, system: TransitionSystem) -> Iterator[Run]:
    """Return the recordings that ship with a target, as runs."""
    for path in target.streams:
        trace = run_with_truth(target, path)
        if trace is not None:
            yield run_of(system, name_of(path), trace, recorded=True)
        else:
            yield _on_board(system, path)


def _on_board(system: TransitionSystem, path: Path) -> Run:
    """Return a recording without ghosts as a run; its ghosts get neutral values, and no claim is judged on it."""
    stream, names = read_steps(path), {var.name for var in system.inputs}
    ghosts = {var.name: _rest(var) for var in system.inputs if var in system.ghosts}
    steps = [{**ghosts, **{name: value for name, value in step.items() if name in names}} for step in stream.steps]
    rows = tuple(tuple(read_inputs(system, step)[var] for var in system.inputs) for step in steps[:_LONGEST])
    first = {var.name: _rest(var) for var in system.state if var in system.ghosts}
    known = {var.name for var in system.state}
    first |= {name: value for name, value in stream.first.items() if name in known}
    return Run(name_of(path), first, rows, recorded=True, has_ghosts=False)


def _rest(var: Var) -> Value:
    if not isinstance(var, NumVar):
        return False
    return var.low if isinstance(var.unit, Enumeration) else canonical(var)


def _witnesses(target: Target, system: TransitionSystem, limits: Limits) -> list[Trace]:
    """Return the runs that show that modes are reached and rows fire; of runs with equal inputs only one."""
    recordings = [Recording(stream.first, stream.steps) for stream in map(read_steps, target.streams)]
    shown = [one.verdict.witness for one in reached(system, limits, recordings) if isinstance(one.verdict, Proved)]
    kept = {str([step.inputs for step in trace.steps]): trace for trace in shown if trace is not None}
    return list(kept.values())


def _drawn(system: TransitionSystem, properties: Sequence[Property], known: Sequence[Trace], seed: int) -> list[Run]:
    """Return drawn runs, from the beginning or from a point of a known run; every fifth ends with a faulty stretch."""
    driver, draw, runs = Driver(system, properties, known), random.Random(seed), list[Run]()
    for number in range(_DRAWN):
        if known and number % 3:
            driver.follow(draw.randrange(len(known)), draw.random())
        else:
            driver.reset()
        for stretch in range(STRETCHES):
            faulty = number % 5 == 4 and stretch == STRETCHES - 1
            kind = draw.choice(FAULTY if faulty else PLAUSIBLE)
            driver.drive(kind, draw.randint(1, STRETCH), draw.randrange(2**16), faulty=faulty)
        rows = tuple(tuple(step[var.name] for var in system.inputs) for step in driver.stream[:_LONGEST])
        runs.append(Run(f"drawn {number}", dict(driver.first), rows))
    return runs
