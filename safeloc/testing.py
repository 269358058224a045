"""Property tests for any machine: Hypothesis drives whole runs, exactly as the interpreter would run them.

    TestOdometer = state_machine_test(system, properties)     a unittest class for pytest
    run_tests(system, properties, ...) -> list[Finding]       the same, for the command line and the report

A run is made of a few big draws: a rule (steady, ramp, ends of ranges, standstill, reversal, a fault), a length and a
seed. Each step's inputs follow the rule, and what the environment may choose freely is then repaired until the
assumption holds, at the ends of what it allows. A faulty stretch gives the assumption up; from there on only
properties without an assumption are required. `target()` pulls runs towards the edge of every property.
"""

from __future__ import annotations

import random
import time
import unittest
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import hypothesis
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, rule, run_state_machine_as_test

from safeloc.backends.compiled import Row, compile_system
from safeloc.expr import BoolVar, Expr, NumVar, Var
from safeloc.lawful import Repair, first_state, slack
from safeloc.nodes import Value
from safeloc.provers.evidence import replayed
from safeloc.results import Finding
from safeloc.spec import NO_ASSUMPTION, Property, observe, watch
from safeloc.system import TransitionSystem, canonical, environment
from safeloc.trace import Trace
from safeloc.verdict import Held, Result, Violated

RULES = ("steady", "ramp", "ends", "standstill", "reversal", "random")


@dataclass
class Statistics:
    """What the runs did: how far they went, what fired, how often a step had to be given up."""

    runs: int = 0
    steps: int = 0
    deepest: int = 0
    refused: int = 0
    seconds: float = 0.0
    fired: Counter[str] = field(default_factory=Counter)

    def notes(self, transitions: Sequence[str]) -> dict[str, str]:
        """For a report."""
        never = [name for name in transitions if not self.fired[name]]
        return {
            "runs": str(self.runs),
            "steps": str(self.steps),
            "deepest run": str(self.deepest),
            "steps per second": f"{self.steps / self.seconds:.0f}" if self.seconds else "",
            "steps given up": str(self.refused),
            "transitions fired": ", ".join(f"{name} {count}" for name, count in self.fired.most_common()),
            "never fired": ", ".join(never),
        }


class Driver:
    """One run of a system under the observers of its properties."""

    def __init__(self, system: TransitionSystem, properties: Sequence[Property]) -> None:
        self.properties = [prop for prop in properties if prop.kind != "reachable"]
        self.goals = [observe(system, prop) for prop in self.properties]
        watched = watch(system, self.goals)
        self._allowed = BoolVar("allowed")
        allowed = environment(system)
        outputs: dict[str, Expr] = {f"good {n}": goal.good for n, goal in enumerate(self.goals)}
        state = (*watched.system.state, self._allowed)
        moves = {**watched.system.next, self._allowed: allowed}
        initial = {**watched.system.initial, self._allowed: True}
        whole = replace(watched.system, state=state, next=moves, initial=initial, outputs=outputs)
        self.system, self.code = system, compile_system(whole)
        self._repair = Repair(system)
        self._whole = whole
        self.statistics = Statistics()
        self.reset(first_state(system, random.Random(0)))

    def reset(self, first: Mapping[str, Value]) -> None:
        """Start a new run."""
        self.first = dict(first)
        self._state: Row = self.code.first(dict(first))
        self.stream: list[dict[str, Value]] = []
        self.kept = True
        self.broken: Property | None = None
        self.statistics.runs += 1

    def follow(self, trace: Trace) -> None:
        """Start a new run that first repeats a known one."""
        self.reset(dict(trace.initial))
        for record in trace.steps:
            inputs = {var: record.inputs[var.name] for var in self.system.inputs}
            self._step(inputs, faulty=True, draw=random.Random(0))

    def drive(self, kind: str, length: int, seed: int, *, faulty: bool) -> None:
        """Several steps by one rule."""
        profile = _Profile(self.system, kind, random.Random(seed))
        for number in range(length):
            if self.broken is not None:
                return
            self._step(profile.inputs(number), faulty=faulty, draw=profile.draw)

    def _step(self, inputs: dict[Var, Value], *, faulty: bool, draw: random.Random) -> None:
        if self.kept and not faulty:
            repaired = self._repair.mend(self._values(), inputs, draw)
            if repaired is None:
                self.statistics.refused += 1
                return
            inputs = repaired
        started = time.perf_counter()
        row = tuple(inputs[var] for var in self.system.inputs)
        self._state, fired = self.code.step(self._state, row)
        self.stream.append({var.name: inputs[var] for var in self.system.inputs})
        self.kept = self.kept and bool(self._state[-1])
        self._judge()
        self._count(fired, time.perf_counter() - started)

    def _values(self) -> dict[Var, Value]:
        return dict(zip(self._whole.state, self._state, strict=True))

    def _judge(self) -> None:
        for prop, good in zip(self.properties, self.code.outputs(self._state), strict=True):
            if not good and (self.kept or prop.unconditional):
                self.broken = prop
                return

    def _count(self, fired: Sequence[int], seconds: float) -> None:
        done = self.statistics
        done.steps += 1
        done.seconds += seconds
        done.deepest = max(done.deepest, len(self.stream))
        done.fired.update(self.code.fired(fired).values())

    def edge(self) -> float:
        """How near the run is to violating some numeric property: greater is nearer."""
        values = self._values()
        found = [slack(goal.good, values) for goal in self.goals]
        return -min((value for value in found if value != float("inf")), default=0.0)

    def trace(self) -> Trace | None:
        """The run that broke a property, replayed by the interpreter."""
        if self.broken is None:
            return None
        goal = next(goal for goal in self.goals if goal.prop is self.broken)
        return replayed(goal, self.first, self.stream)


# ------------------------------------------------------------------ inputs by rule


class _Profile:
    """Inputs over the steps of one stretch. Inputs of one unit and range move together, as sensors of one train do."""

    def __init__(self, system: TransitionSystem, kind: str, draw: random.Random) -> None:
        self._system, self._kind, self.draw = system, kind, draw
        self._level: dict[tuple[int, int, str], float] = {}
        self._change: dict[tuple[int, int, str], float] = {}
        self._missing = {option.value.name: draw.choice((0.0, 0.02, 0.9)) for option in system.optionals}
        self._together = draw.random() < 0.9

    def inputs(self, number: int) -> dict[Var, Value]:
        """The inputs of one step; absent optional inputs hold their canonical value."""
        values: dict[Var, Value] = {}
        for var in self._system.inputs:
            values[var] = self.draw.random() < 0.5 if isinstance(var, BoolVar) else self._number(var, number)
        for option in self._system.optionals:
            absent = self.draw.random() < self._missing[option.value.name]
            values[option.present] = not absent
            if absent:
                values[option.value] = canonical(option.value)
        return values

    def _number(self, var: NumVar, number: int) -> int:
        draw = self.draw
        key = (var.low, var.high, "" if self._together else var.name)
        if key not in self._level:
            share = draw.choice((0.001, 0.01, 0.05, 0.2, 0.5, 1.0))
            self._level[key] = draw.uniform(var.low, var.high) * share
            self._change[key] = draw.uniform(-1, 1) * (var.high - var.low) / 200
        level = self._level[key]
        match self._kind:
            case "steady":
                value = level
            case "ramp":
                value = level + number * self._change[key]
            case "ends":
                value = draw.choice((var.low, var.high, canonical(var)))
            case "standstill":
                value = canonical(var)
            case "reversal":
                value = level if number % 20 < 10 else -level
            case _:
                value = draw.uniform(var.low, var.high)
        return min(max(round(value), var.low), var.high)


# ------------------------------------------------------------------ Hypothesis


def state_machine(
    system: TransitionSystem, properties: Sequence[Property], *, steps: int = 60, corpus: Sequence[Trace] = ()
) -> type[RuleBasedStateMachine]:
    """A Hypothesis state machine for the system. `corpus` holds runs to start from (such as reachability witnesses)."""
    driver = Driver(system, properties)

    class Run(RuleBasedStateMachine):  # type: ignore[misc, unused-ignore]
        statistics = driver.statistics

        @initialize(which=st.integers(-1, len(corpus) - 1))
        def begin(self, which: int) -> None:
            """From the first state, or after a known run."""
            if which < 0:
                driver.reset(first_state(system, random.Random(0)))
            else:
                driver.follow(corpus[which])

        @rule(kind=st.sampled_from(RULES), length=st.integers(1, steps), seed=st.integers(0, 2**16))
        def run_plausibly(self, kind: str, length: int, seed: int) -> None:
            """A stretch that keeps the assumption."""
            driver.drive(kind, length, seed, faulty=False)
            self._look()

        @rule(kind=st.sampled_from(RULES), length=st.integers(1, 5), seed=st.integers(0, 2**16))
        def run_with_faults(self, kind: str, length: int, seed: int) -> None:
            """A stretch with any inputs in range."""
            driver.drive(kind, length, seed, faulty=True)
            self._look()

        def teardown(self) -> None:
            """Tell Hypothesis how far the run went and how near it came."""
            hypothesis.target(float(len(driver.stream)), label="steps")
            edge = driver.edge()
            if abs(edge) != float("inf"):
                hypothesis.target(edge, label="edge of a property")

        def _look(self) -> None:
            if driver.broken is not None:
                raise PropertyBroken(driver)

    Run.__name__ = "".join(letter if letter.isalnum() else "_" for letter in system.name)
    return Run


class PropertyBroken(AssertionError):
    """A property failed in a run; the message shows the run."""

    def __init__(self, driver: Driver) -> None:
        assert driver.broken is not None
        trace = driver.trace()
        table = "" if trace is None else trace.table()
        super().__init__(f"{driver.broken.name}: {driver.broken.statement}\n{table}")
        self.prop, self.trace = driver.broken, trace


def state_machine_test(
    system: TransitionSystem,
    properties: Sequence[Property],
    *,
    settings: hypothesis.settings | None = None,
    steps: int = 60,
    corpus: Sequence[Trace] = (),
) -> type[unittest.TestCase]:
    """A unittest class that pytest collects: every property on many runs. PropertyBroken shows the shrunk run."""
    run = state_machine(system, properties, steps=steps, corpus=corpus)
    case: type[unittest.TestCase] = run.TestCase
    if settings is not None:
        case.settings = settings  # type: ignore[attr-defined]
    return case


def run_tests(
    system: TransitionSystem,
    properties: Sequence[Property],
    *,
    examples: int,
    steps: int,
    seed: int,
    corpus: Sequence[Trace] = (),
) -> list[Finding]:
    """One Finding a property: Held with statistics, or Violated with a shrunk trace."""
    started = time.monotonic()
    left, findings, broken = list(properties), list[Finding](), dict[str, Violated]()
    while True:
        run = state_machine(system, left, steps=steps, corpus=corpus)
        caught = _caught(run, examples, seed)
        if caught is None:
            break
        broken[caught.prop.name] = Violated(caught.trace, "Hypothesis")
        left = [prop for prop in left if prop is not caught.prop]
    statistics: Statistics = run.statistics  # type: ignore[attr-defined]
    names = [t.name for machine in system.machines for t in machine.transitions]
    for prop in properties:
        if prop.kind == "reachable":
            continue
        held = Held("Hypothesis", statistics.runs, statistics.steps, statistics.notes(names))
        result: Result = broken.get(prop.name, held)
        findings.append(_finding(system, prop, result, time.monotonic() - started))
    return findings


def _caught(run: type[RuleBasedStateMachine], examples: int, seed: int) -> PropertyBroken | None:
    settings = hypothesis.settings(
        max_examples=examples,
        stateful_step_count=8,
        deadline=None,
        database=None,
        suppress_health_check=(
            hypothesis.HealthCheck.too_slow,
            hypothesis.HealthCheck.filter_too_much,
            hypothesis.HealthCheck.data_too_large,
        ),
        print_blob=False,
    )
    seeded = hypothesis.seed(seed)(run)
    try:
        run_state_machine_as_test(seeded, settings=settings)
    except PropertyBroken as error:
        return error
    return None


def _finding(system: TransitionSystem, prop: Property, result: Result, seconds: float) -> Finding:
    return Finding(
        f"{system.name}/test/{prop.name}",
        system.name,
        "test",
        prop.statement,
        result,
        "Hypothesis, plausible and faulty streams",
        seconds,
        prop.trace,
        NO_ASSUMPTION if prop.unconditional else prop.assumption,
    )
