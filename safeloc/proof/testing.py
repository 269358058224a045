"""Property tests for any machine: Hypothesis drives whole runs, exactly as the interpreter would run them.

    TestOdometer = state_machine_test(system, properties)     a unittest class for pytest
    run_tests(system, properties, ...) -> list[Finding]       the same, for the command line and the report

Hypothesis draws only rules (safeloc.proof.drawn_runs.profiles), lengths and seeds, since it would need nearly all the time to draw every
value. Half of the runs satisfy the assumption to the end; the others have faulty stretches. `target()` steers runs towards a
violation of each property. A run that breaks one is shortened by exact replays, not by Hypothesis.
"""

from __future__ import annotations

import time
import unittest
from collections.abc import Mapping, Sequence
from dataclasses import replace

import hypothesis
from hypothesis import Phase
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    precondition,
    rule,
    run_state_machine_as_test,
)

from safeloc.language.antecedents import cases
from safeloc.language.monitor import NEVER
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, first_without_the_world
from safeloc.language.trace import Trace
from safeloc.language.verdict import Held, Result, Unknown, Vacuous, Violated
from safeloc.proof.drawn_runs.driver import Driver, Statistics
from safeloc.proof.drawn_runs.lawful import NoFirstStateError, begins
from safeloc.proof.drawn_runs.profiles import FAULTY, PLAUSIBLE
from safeloc.proof.results import Finding

STRETCHES = 8
PHASES = (Phase.explicit, Phase.generate, Phase.target)
_DRAWN_TO_PREPARE = 100
"""Numbers of which each is drawn from the constants with a probability of 0.05: at least one is, by the seed."""


class _Run(RuleBasedStateMachine):  # type: ignore[misc, unused-ignore]
    """One run, stretch after stretch; `state_machine` adds the rules whose choices depend on the system and its known runs."""

    driver: Driver
    statistics: Statistics
    faults: bool = False
    lean: int | None = None

    def follow(self, which: int, percent: int) -> None:
        """Begin in a first state or along a known run; a known run that breaks a property is followed at once."""
        if self.driver.breaking is not None:
            self.driver.follow(self.driver.breaking)
        elif which < 0:
            self.driver.reset()
        else:
            self.driver.follow(which, percent / 100)
        self.look()

    @precondition(lambda self: self.faults)
    @rule(kind=st.sampled_from(FAULTY), length=st.integers(1, 5), seed=st.integers(0, 2**16))
    def run_with_faults(self, kind: str, length: int, seed: int) -> None:
        """Run a stretch with any inputs in range."""
        self.driver.drive(kind, length, seed, faulty=True)
        self.look()

    def teardown(self) -> None:
        """Tell Hypothesis how far the run went and how near it came to violating each property."""
        hypothesis.target(float(self.driver.steps), label="steps")
        for name, edge in self.driver.edges().items():
            hypothesis.target(edge, label=f"edge of {name}")

    def look(self) -> None:
        """Raise PropertyBroken if a property is broken by now."""
        if self.driver.broken is not None:
            raise PropertyBroken(self.driver.broken, self.driver.trace())


def _state_machine(
    system: TransitionSystem, properties: Sequence[Property], *, steps: int = 60, corpus: Sequence[Trace] = ()
) -> type[RuleBasedStateMachine]:
    """Return a Hypothesis state machine for the system.

    steps    greatest length of a stretch; a run has up to as many stretches as the settings' stateful_step_count
    corpus   runs to start from, at any point along them (reachability witnesses, simulated or recorded streams); a
             property that one of them breaks is found without searching. A run whose first state the environment
             excludes counts for unconditional properties only
    """
    on_board = replace(system, init=first_without_the_world(system))
    corpus = [run for run in corpus if begins(on_board, run.initial)]
    known = Driver(system, properties, corpus)
    lengths = sorted({steps, -(-steps // 2), -(-steps // 10), 1}, reverse=True)

    class Run(_Run):
        driver = known
        statistics = known.statistics

        @initialize(
            which=st.integers(-1, len(corpus) - 1),
            percent=st.integers(0, 100),
            faults=st.booleans(),
            lean=st.none() | st.integers(0, 2**16),
        )
        def begin(self, which: int, percent: int, faults: bool, lean: int | None) -> None:
            self.faults, self.lean = faults, lean
            self.follow(which, percent)

        @rule(kind=st.sampled_from(PLAUSIBLE), length=st.sampled_from(lengths), seed=st.integers(0, 2**16))
        def run_plausibly(self, kind: str, length: int, seed: int) -> None:
            """Run a stretch that satisfies the assumption."""
            self.driver.drive(kind, length, seed, lean=self.lean)
            self.look()

    Run.__name__ = "".join(letter if letter.isalnum() else "_" for letter in system.name)
    return Run


class PropertyBroken(AssertionError):
    """A property failed in a run; the message shows the run."""

    def __init__(self, prop: Property, trace: Trace) -> None:
        super().__init__(f"{prop.name}: {prop.statement}\n{trace.table()}")
        self.prop, self.trace = prop, trace


def prepare() -> None:
    """Let Hypothesis read the constants in all loaded modules once, for every process that is forked from this one.

    It draws some of them in place of a number, and reads the modules as soon as it first does so.
    """

    @hypothesis.seed(0)
    @hypothesis.settings(database=None, deadline=None, max_examples=_DRAWN_TO_PREPARE, phases=(Phase.generate,))
    @hypothesis.given(st.integers(0, 2**16))
    def drawn(_: int) -> None:
        pass

    drawn()


def state_machine_test(
    system: TransitionSystem,
    properties: Sequence[Property],
    *,
    settings: hypothesis.settings | None = None,
    steps: int = 60,
    corpus: Sequence[Trace] = (),
) -> type[unittest.TestCase]:
    """Return a unittest class that pytest collects: it checks every property on many runs.

    PropertyBroken shows a shortened run.

    settings   any Hypothesis settings; by default those of the active profile, without Hypothesis's shrinking
    """
    run = _state_machine(system, properties, steps=steps, corpus=corpus)
    case: type[unittest.TestCase] = run.TestCase
    case.settings = settings or hypothesis.settings(phases=PHASES)  # type: ignore[attr-defined]
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
    """Return one Finding per property: Held with statistics, or Violated with a shortened trace.

    Vacuous if one of its cases never occurred; for a property that a composition inherits from a machine, a note says so instead.
    Unknown if no step required the property, or if no first state was found.
    """
    started = time.monotonic()
    asked = [prop for prop in properties if prop.kind != "reachable"]
    try:
        results = _results(system, properties, examples, steps, seed, corpus)
    except NoFirstStateError as error:
        results = dict.fromkeys(asked, Unknown(str(error), -1))
    seconds = time.monotonic() - started
    return [_finding(system, prop, results[prop], seconds) for prop in asked]


def _results(
    system: TransitionSystem,
    properties: Sequence[Property],
    examples: int,
    steps: int,
    seed: int,
    corpus: Sequence[Trace],
) -> Mapping[Property, Result]:
    left, broken = list(properties), dict[Property, Result]()
    while True:
        run = _state_machine(system, left, steps=steps, corpus=corpus)
        caught = _caught(run, examples, seed)
        if caught is None:
            break
        broken[caught.prop] = Violated(caught.trace, "Hypothesis")
        left = [prop for prop in left if prop is not caught.prop]
    statistics = run.statistics  # type: ignore[attr-defined]
    names = [t.name for machine in system.machines for t in machine.transitions]
    held = Held("Hypothesis", statistics.runs, statistics.steps, statistics.notes(names))
    return {prop: _held(prop, held, statistics) for prop in left} | broken


def _held(prop: Property, held: Held, statistics: Statistics) -> Result:
    """Return Held, unless no step satisfied the property's assumptions, or one of its cases never occurred."""
    if statistics.steps and not statistics.admitted[prop]:
        return Unknown("no step satisfied the property's further assumption and the machine's: nothing was tested", 0)
    never = [one.words for place, one in enumerate(cases(prop)) if not statistics.occurred[prop, place]]
    if never and prop.kept_by is not None:  # the machine alone reaches it; a note says that the composition did not
        return replace(held, notes={**held.notes, NEVER: "; ".join(never)})
    if never:
        return Vacuous(f"{'; '.join(never)} never occurred in {statistics.steps} steps: nothing was tested of it")
    return held


def _caught(run: type[RuleBasedStateMachine], examples: int, seed: int) -> PropertyBroken | None:
    settings = hypothesis.settings(
        max_examples=examples,
        stateful_step_count=STRETCHES,
        phases=PHASES,
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
        prop.requirements,
        prop.relies_on,
    )
