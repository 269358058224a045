"""Driver of runs: it runs a system with the observers of its properties, exactly as the interpreter would.

A run consists of stretches of inputs (safeloc.proof.drawn_runs.profiles). Plausible stretches are repaired step by step so that the
assumption holds. A faulty stretch is used unchanged; once it has broken the assumption, only unconditional properties are
still required.

Hypothesis varies one choice of a run at a time, so half of all stretches have been made before, from the same place. They are
not made again: the driver remembers where they led to.
"""

from __future__ import annotations

import math
import random
import time
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from safeloc.codegen.compiled import Row, compile_terms
from safeloc.language.expr import BoolVar, Expr, Var
from safeloc.language.interpret import fired_names, start
from safeloc.language.nodes import Value
from safeloc.language.spec import Property, observe, watch
from safeloc.language.system import TransitionSystem, environment, first_without_the_world
from safeloc.language.trace import Trace
from safeloc.proof.drawn_runs.allowed import row_of
from safeloc.proof.drawn_runs.lawful import NoFirstStateError, Pick, Repair, begins, first_state
from safeloc.proof.drawn_runs.occurring import Key, Occurring
from safeloc.proof.drawn_runs.profiles import Profile
from safeloc.proof.drawn_runs.slack import Slack
from safeloc.proof.provers.shorten import shortened

MOST_ROWS = 200_000
"""Rows of inputs that a driver remembers: some 400 MB for a machine of 200 inputs. Beyond them it forgets all and begins anew."""


@dataclass
class Statistics:
    """Statistics of the runs: lengths, fired transitions, discarded steps, and time.

    Steps of a stretch count when it is made, and not again where it is only remembered.

    admitted  for each property, the number of steps in which it was required
    occurred  for each property and case number, the number of states in which the case occurred while the property was
              required
    """

    runs: int = 0
    steps: int = 0
    deepest: int = 0
    known: int = 0
    refused: int = 0
    lawful: int = 0
    seconds: float = 0.0
    fired: Counter[str] = field(default_factory=Counter)
    admitted: Counter[Property] = field(default_factory=Counter)
    occurred: Counter[tuple[Property, int]] = field(default_factory=Counter)

    def notes(self, transitions: Sequence[str]) -> dict[str, str]:
        """Return the statistics as notes for a report."""
        never = [name for name in transitions if not self.fired[name]]
        return {
            "runs": str(self.runs),
            "steps": str(self.steps),
            "steps that keep the assumption": str(self.lawful),
            "steps of known runs among them": str(self.known),
            "deepest run": str(self.deepest),
            "steps per second, drawing and repair included": f"{self.steps / self.seconds:.0f}" if self.seconds else "",
            "steps given up": str(self.refused),
            "transitions fired": ", ".join(f"{name} {count}" for name, count in self.fired.most_common()),
            "never fired": ", ".join(never),
        }


@dataclass(frozen=True)
class _Known:
    """A recorded run with the state after each of its steps, so that a new run can start anywhere along it.

    breaks   its last step breaks a property; later recorded steps are left out
    """

    first: Mapping[str, Value]
    rows: tuple[Row, ...]
    states: tuple[Row, ...]
    kept: tuple[Sequence[bool], ...]
    breaks: bool

    def begins_with(self, rows: Sequence[Row]) -> bool:
        """Return whether a run of these inputs, from the same first state, is the beginning of this one, or all of it up to the break."""
        there = len(self.rows)
        return self.rows[: len(rows)] == tuple(rows[:there]) and (self.breaks or len(rows) <= there)

    def beginning(self, steps: int) -> _Known:
        """Return the first steps, as a run of its own."""
        steps = min(steps, len(self.rows))
        breaks = self.breaks and steps == len(self.rows)
        return _Known(self.first, self.rows[:steps], self.states[: steps + 1], self.kept[: steps + 1], breaks)


@dataclass(frozen=True)
class _Stretch:
    """The end of a stretch: the rows of inputs that it added, the state after them, and the properties that had held
    until then.
    """

    rows: tuple[Row, ...]
    state: Row
    kept: tuple[bool, ...]
    broken: Property | None


class _Code:
    """A system as generated code that is made soon. `compile_system` takes seven times as long, for steps twice as fast: too few are
    driven for that to pay.
    """

    def __init__(self, system: TransitionSystem) -> None:
        self._system, self._states = system, len(system.state)
        self._move = compile_terms(
            (*system.state, *system.inputs), [*(system.next[var] for var in system.state), *system.fired.values()]
        )
        self.outputs = compile_terms(system.state, list(system.outputs.values()))
        self._names: dict[Row, tuple[str, ...]] = {}

    def first(self, chosen: Mapping[str, Value]) -> Row:
        """Return the first state; InputError as in `interpret.start`."""
        return tuple(start(self._system, chosen).values())

    def step(self, state: Row, inputs: Row) -> tuple[Row, Row]:
        """Return the state after a step, and the numbers of the transitions that fired."""
        moved = self._move((*state, *inputs))
        return moved[: self._states], moved[self._states :]

    def fired(self, numbers: Row) -> tuple[str, ...]:
        """Return the names of the transitions that fired; the same few come again and again, and are looked up once."""
        if numbers not in self._names:
            fired = dict(zip(self._system.fired, map(int, numbers), strict=True))
            self._names[numbers] = tuple(fired_names(fired).values())
        return self._names[numbers]


class Driver:
    """Driver of runs; `broken` is the first property that failed in the present run.

    NoFirstStateError if no first state is found and no known run has one.
    """

    def __init__(self, system: TransitionSystem, properties: Sequence[Property], corpus: Sequence[Trace] = ()) -> None:
        self.properties = [prop for prop in properties if prop.kind != "reachable"]
        self.goals = [observe(system, prop) for prop in self.properties]
        watched = watch(system, self.goals).system
        self._slack = [Slack(goal.good) for goal in self.goals]
        self._occurring = Occurring(system, watched.state, self.properties)
        flags, begin = self._occurring.moves, self._occurring.initial
        allowed = BoolVar("observer.allowed")
        further: dict[Var, Expr] = {
            BoolVar(f"observer.further {n}"): goal.prop.further_assumption for n, goal in enumerate(self.goals)
        }
        outputs: dict[str, Expr] = {f"good {n}": goal.good for n, goal in enumerate(self.goals)}
        self._compiled_system = replace(
            watched,
            state=(*watched.state, *flags, *further, allowed),
            next={**watched.next, **flags, **further, allowed: environment(system)},
            initial={**watched.initial, **begin, **dict.fromkeys(further, True), allowed: True},
            init=first_without_the_world(system),  # `begins` checks the environment for each known run
            outputs=outputs,
        )
        self.system, self._code = system, _Code(self._compiled_system)
        self._kept = [True]
        self._rows: list[Row] = []
        self.broken: Property | None = None
        self._place: tuple[object, ...] = ()
        self._repair, self._row = Repair(system), row_of(system.inputs)
        self._usual = _usual(system, corpus)
        self.statistics = Statistics()
        self._stretches: dict[object, _Stretch] = {}
        self._remembered = 0
        self._known = self._all_recorded(corpus)
        self.reset()

    def reset(self, first: Mapping[str, Value] | None = None) -> None:
        """Start a new run, from the given first values or the usual ones."""
        self.first = dict(self._usual if first is None else first)
        self._start(self._code.first(dict(self.first)), [])
        self._place = tuple(self.first.items())

    def follow(self, which: int, share: float = 1.0) -> None:
        """Start a new run that first repeats a share of a run of the corpus."""
        known = self._known[which]
        steps = round(share * len(known.rows))
        self.first = dict(known.first)
        self._start(known.states[steps], list(known.rows[:steps]), known.kept[steps])
        self._place = (which, steps)

    @property
    def breaking(self) -> int | None:
        """Return the first run of the corpus that breaks a property; None if there is none."""
        return next((which for which, known in enumerate(self._known) if known.breaks), None)

    def drive(self, kind: str, length: int, seed: int, *, faulty: bool = False, lean: int | None = None) -> None:
        """Make up to `length` steps by one rule of safeloc.proof.drawn_runs.profiles.

        lean  seed of the side to which the environment leans
        """
        self._place = (self._place, kind, length, seed, faulty, lean)
        if self._place in self._stretches:
            self._go_to(self._stretches[self._place])
            return
        before = len(self._rows)
        self._drive(kind, length, seed, faulty, lean)
        self._remember(_Stretch(tuple(self._rows[before:]), self._state, tuple(self._kept), self.broken))

    def _go_to(self, stretch: _Stretch) -> None:
        self._rows += stretch.rows
        self._state, self._kept, self.broken = stretch.state, list(stretch.kept), stretch.broken

    def _remember(self, stretch: _Stretch) -> None:
        if self._remembered + len(stretch.rows) > MOST_ROWS:
            self._stretches.clear()
            self._remembered = 0
        self._stretches[self._place] = stretch
        self._remembered += len(stretch.rows)

    def _drive(self, kind: str, length: int, seed: int, faulty: bool, lean: int | None) -> None:
        started = time.perf_counter()
        leaning = None if lean is None else random.Random(lean)
        profile = Profile(self.system, kind, random.Random(seed), leaning)
        for _ in range(length):
            if self.broken is not None:
                break
            values = self.state()
            inputs: dict[Var, Value] | None = profile.inputs(values)
            if self.kept and not faulty and inputs is not None:
                inputs = self._mended(values, inputs, profile.draw, profile.pick)
            if inputs is not None:
                self._step(tuple(self._row(inputs)))
        self.statistics.seconds += time.perf_counter() - started

    @property
    def stream(self) -> list[dict[str, Value]]:
        """The inputs of the present run by name, step by step."""
        names = [var.name for var in self.system.inputs]
        return [dict(zip(names, row, strict=True)) for row in self._rows]

    @property
    def steps(self) -> int:
        """The number of steps of the present run."""
        return len(self._rows)

    def state(self) -> dict[Var, Value]:
        """Return the present state, observers of the properties included."""
        return dict(zip(self._compiled_system.state, self._state, strict=True))

    def edges(self) -> dict[str, float]:
        """Return, for each property with a distance, how near the present state is to violating it; greater is nearer."""
        values = self.state()
        found = {goal.prop.name: -slack(values) for goal, slack in zip(self.goals, self._slack, strict=True)}
        return {name: edge for name, edge in found.items() if math.isfinite(edge)}

    def trace(self) -> Trace:
        """Return the run that broke a property, shortened, as the interpreter replays it."""
        goal = next(goal for goal in self.goals if goal.prop is self.broken)
        return shortened(goal, self.first, self.stream)

    def _start(self, state: Row, rows: list[Row], kept: Sequence[bool] = ()) -> None:
        self._state, self._rows = state, rows
        self._kept = list(kept) if kept else [True] * (len(self.goals) + 1)
        self._count_cases(self._occurring.at_first(state))
        self.broken = None
        self.statistics.runs += 1
        self._judge()

    @property
    def kept(self) -> bool:
        """True if the run has satisfied the assumption so far."""
        return self._kept[-1]

    def _mended(
        self, values: Mapping[Var, Value], inputs: dict[Var, Value], draw: random.Random, pick: Pick
    ) -> dict[Var, Value] | None:
        repaired = self._repair.mend(values, inputs, draw, pick)
        self.statistics.refused += repaired is None
        return repaired

    def _step(self, row: Row) -> None:
        before = self._state
        state, fired = self._code.step(before, row)
        self._state = state
        now = state[-len(self.goals) - 1 :]
        if not all(now):
            self._kept = [was and bool(one) for was, one in zip(self._kept, now, strict=True)]
        self._rows.append(row)
        self._judge()
        self._count(fired)
        self._count_cases(self._occurring.after(before, row, state, fired))

    def _judge(self) -> None:
        goods = self._code.outputs(self._state)
        if all(goods):
            return
        for number, (prop, good) in enumerate(zip(self.properties, goods, strict=True)):
            if not good and self._required(number):
                self.broken = prop
                return

    def _count_cases(self, occurring: Iterable[Key]) -> None:
        for number, place in occurring:
            self.statistics.occurred[self.properties[number], place] += self._required(number)

    def _required(self, number: int) -> bool:
        """Return whether the run has satisfied all assumptions of a property so far."""
        return self._kept[number] and (self.kept or self.properties[number].unconditional)

    def _count(self, fired: Row) -> None:
        done = self.statistics
        done.steps += 1
        done.lawful += self.kept
        if all(self._kept):
            done.admitted.update(self.properties)
        else:
            for number, prop in enumerate(self.properties):
                done.admitted[prop] += self._required(number)
        done.deepest = max(done.deepest, self.steps)
        done.fired.update(self._code.fired(fired))

    def _all_recorded(self, corpus: Sequence[Trace]) -> list[_Known]:
        """Run the corpus, the longest run first: one that another run begins with is a part of it, and is not made again."""
        known, longer = dict[int, _Known](), defaultdict[object, list[_Known]](list)
        for number, trace in sorted(enumerate(corpus), key=lambda one: -len(one[1].steps)):
            rows = [tuple(step.inputs[var.name] for var in self.system.inputs) for step in trace.steps]
            alike = longer[tuple(sorted(trace.initial.items()))]
            whole = next((one for one in alike if one.begins_with(rows)), None)
            if whole is None:
                whole = self._recorded(trace.initial, rows)
                alike.append(whole)
            known[number] = whole.beginning(len(rows))
        return [known[number] for number in range(len(corpus))]

    def _recorded(self, first: Mapping[str, Value], rows: Sequence[Row]) -> _Known:
        self.first = dict(first)
        lawful = begins(self.system, self.first)
        self._start(self._code.first(dict(self.first)), [], [*[True] * len(self.goals), lawful])
        started = time.perf_counter()
        states, kept = [self._state], [self._kept]
        for row in rows:
            if self.broken is not None:
                break
            self._step(row)
            states.append(self._state)
            kept.append(self._kept)
        self.statistics.known += self.steps
        self.statistics.seconds += time.perf_counter() - started
        return _Known(self.first, tuple(self._rows), tuple(states), tuple(kept), self.broken is not None)


def _usual(system: TransitionSystem, corpus: Sequence[Trace]) -> dict[str, Value]:
    """Return a lawful first state near zero, or else that of a known run."""
    try:
        return first_state(system, random.Random(0))
    except NoFirstStateError:
        lawful = [run.initial for run in corpus if begins(system, run.initial)]
        if not lawful:
            raise
        return dict(lawful[0])
