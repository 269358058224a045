"""Reachability by random runs: most modes and transitions of a machine occur within a few steps of any stream.

Runs are drawn on generated code, as in the property tests (safeloc.proof.drawn_runs.profiles). The interpreter replays each run that
reaches a new goal. Drawing stops after several rounds without a new goal.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress

from safeloc.language.expr import Var
from safeloc.language.interpret import start
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal, watch
from safeloc.language.system import environment
from safeloc.language.trace import Trace
from safeloc.proof.drawn_runs.allowed import compiled_terms
from safeloc.proof.drawn_runs.lawful import NoFirstStateError, Repair, first_state
from safeloc.proof.drawn_runs.profiles import FAULTY, PLAUSIBLE, Profile
from safeloc.proof.provers.replayed_evidence import confirmed_together

LENGTHS = (5, 5, 5, 15, 15, 40)
"""Lengths in steps of the runs of one round; short runs first, so that early events get short witnesses."""
STRETCH = 8
IDLE = 5
"""Rounds without a new goal after which drawing stops."""


def drawn(goals: Sequence[Goal], seed: int = 0) -> dict[Goal, Trace]:
    """Return a run for each goal that some random run reaches; all goals are of one system and one assumption.

    If the goals rely on no assumption, half of the runs satisfy that of the system until a fault is injected.
    """
    found: dict[Goal, Trace] = {}
    if not goals:
        return found
    draw, idle = _Draw(goals, seed), 0
    with suppress(NoFirstStateError):
        while draw.left and idle < IDLE:
            idle += 1
            for length in LENGTHS:
                new = draw.run(length)
                found |= new
                idle = 0 if new else idle
    return found


class _Draw:
    """Drawn runs of a system with the observers of goals; `left` holds the goals not reached yet, by index."""

    def __init__(self, goals: Sequence[Goal], seed: int) -> None:
        self._watched = watch(goals[0].plain, goals)
        system = self._watched.system
        self.left = dict(enumerate(self._watched.goals))
        self._draw = random.Random(seed)
        self._plain, self._free = goals[0].plain, goals[0].prop.unconditional
        self._repair = Repair(goals[0].original)
        self._step = compiled_terms((*system.state, *system.inputs), [environment(system), *system.next.values()])
        self._goods = compiled_terms(system.state, [goal.good for goal in self._watched.goals])

    def run(self, length: int) -> dict[Goal, Trace]:
        """Make one more run; return the new goals that it reaches, each with its run."""
        first = first_state(self._plain, self._draw, adventurous=self._draw.choice((0.0, 0.0, 0.5)))
        faulty = self._free and self._draw.random() < 0.5
        stream, reached, needed = list[dict[str, Value]](), list[Goal](), 0
        for values in self._states(first, length, stream, faulty=faulty):
            goods = self._goods([values[var] for var in self._watched.system.state])
            new = [place for place in self.left if not goods[place]]
            if new:
                reached += map(self.left.pop, new)
                needed = len(stream)
        return confirmed_together(self._watched, reached, first, stream[:needed], "a drawn run") if reached else {}

    def _states(
        self, first: Mapping[str, Value], length: int, stream: list[dict[str, Value]], *, faulty: bool
    ) -> Iterator[dict[Var, Value]]:
        """Yield one state after the other; `stream` collects the inputs that lead to it."""
        system, plain = self._watched.system, self._plain
        values = start(system, first)
        yield values
        profile = self._profile(PLAUSIBLE)
        breaks = self._draw.randrange(length) if self._free else length
        for number in range(length):
            if number % STRETCH == 0 or number == breaks:
                profile = self._profile(FAULTY if faulty or number >= breaks else PLAUSIBLE)
            inputs: dict[Var, Value] | None = profile.inputs(values)
            if not faulty and number < breaks and inputs is not None:
                inputs = self._repair.mend(values, inputs, profile.draw, profile.pick)
            if inputs is None:
                continue
            row = [values[var] for var in system.state]
            allowed, *after = self._step([*row, *(inputs[var] for var in plain.inputs)])
            if not allowed:
                return
            values = dict(zip(system.next, after, strict=True))
            stream.append({var.name: value for var, value in inputs.items()})
            yield values

    def _profile(self, kinds: Sequence[str]) -> Profile:
        lean = random.Random(self._draw.random()) if self._draw.random() < 0.5 else None
        return Profile(self._plain, self._draw.choice(kinds), random.Random(self._draw.random()), lean)
