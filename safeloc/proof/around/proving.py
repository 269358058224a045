"""All of a target's proof around one stream: claims decided, emptiness excluded, violations brought nearer and replayed."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

from safeloc.errors import EngineError
from safeloc.language.expr import TRUE
from safeloc.language.interpret import holds, start, step
from safeloc.language.spec import observe, speaks_of
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Result, Unknown, Vacuous, Violated
from safeloc.proof.around.broken_runs import broken_run, open_first
from safeloc.proof.around.claims import Asked
from safeloc.proof.around.containment import first_outside
from safeloc.proof.around.deciding import Deciding
from safeloc.proof.around.deviations import PARTS
from safeloc.proof.around.emptiness import a_lawful_stream
from safeloc.proof.around.members import Member
from safeloc.proof.around.nearest import nearest
from safeloc.proof.around.question import Question
from safeloc.proof.around.shown import Decided, Shown
from safeloc.proof.around.ways import plain
from safeloc.proof.around.windows import OVER, Breaks, Holds, Open, Outcome
from safeloc.proof.provers.limits import clock_after, deadline
from safeloc.proof.provers.recheck import confirmed_by, rechecked_in_words
from safeloc.proof.results import Finding

_NEARER_SECONDS, _NEARER_CLOCK = 30.0, 2.5
"""Seconds of effort to bring a run nearer that breaks a claim in its cycle, and the multiple of a limit after which the clock ends each question
about nearer ones: a run is there already.
"""


@dataclass(frozen=True, eq=False)
class Around(Question):
    """A question about all streams around a stream of a target, and its answer."""

    def findings(self) -> list[Finding]:
        """Decide every claim; return one finding of each."""
        return self.decided().findings

    def decided(self) -> Decided:
        """Decide every claim; return one finding of each, with what shows them again."""
        run = _Run(self)
        return Decided(list(run.findings()), run.witness, run.shown)


@dataclass(eq=False)
class _Run:
    of: Question

    def __post_init__(self) -> None:
        self._began = time.monotonic()
        self._deciding = Deciding(self.of, deadline(self.of.seconds_in_all))
        self.witness: Member | None = None
        self.shown: dict[Asked, Shown] = {}

    def findings(self) -> Sequence[Finding]:
        """Return the findings, in the order asked."""
        self.of.say("streams near the given one: is there a lawful one?")
        found: dict[Asked, tuple[Result, str]] = {}
        lawful = [one for one in self.of.asked if not one.prop.unconditional]
        if lawful:
            self.witness, empty = a_lawful_stream(self.of.system, self._deciding.tube(PARTS), self._deciding.limits)
            if empty is not None:
                found |= dict.fromkeys(lawful, (empty, "windows"))
        left = [one for one in self.of.asked if one not in found]
        self._deciding.look_for_general_proofs(left)
        for asked, outcome, words in self._deciding.decided(left, self._deciding.tube(PARTS)):
            if isinstance(outcome, Holds) and outcome.passage is not None:
                self.shown[asked] = self._deciding.passages[outcome.passage]
            found[asked] = self._result(asked, outcome, words)
        self._watch_the_whole_tube(left)
        return [self._finding(one, *found[one]) for one in self.of.asked]

    def _watch_the_whole_tube(self, asked: Sequence[Asked]) -> None:
        """Go through the tube for whoever watches, where no claim needed that: each was broken by a stream at its corners."""
        on_board = [one for one in asked if speaks_of(self._deciding.board.system, one.prop)]
        if self.of.watched is not None and not self._deciding.was_watched:
            self._deciding.passed(self._deciding.board, on_board[:1], self._deciding.tube(PARTS))

    def _finding(self, asked: Asked, result: Result, method: str) -> Finding:
        tube = f"{self.of.name} within {self.of.deviations.told(self.of.system)}"
        left_out = (
            f"; without the law{'s' if len(self.of.without) > 1 else ''} {', '.join(self.of.without)}"
            if self.of.without
            else ""
        )
        cycles = self.of.given.length if asked.last is None else asked.last
        return Finding(
            f"{self.of.target}/around {self.of.name}/{asked.prop.name}",
            self.of.target,
            "property",
            f"{asked.prop.statement} — in cycles {max(1, asked.first)} to {cycles} of every stream around {tube}{left_out}",
            self._judged_at_all(asked, result),
            method,
            time.monotonic() - self._began,
            asked.prop.requirements,
            asked.prop.relies_on,
        )

    def _judged_at_all(self, asked: Asked, result: Result) -> Result:
        """Return the result; a proof is vacuous if what the claim reads is absent in every cycle of the stream given."""
        if not isinstance(result, Proved) or asked.there is None or asked.there is TRUE:
            return result
        system = self._deciding.board.system if speaks_of(self._deciding.board.system, asked.prop) else self.of.system
        if system is self.of.system:
            return result
        watching = replace(asked.prop, name="there", term=~asked.there)
        goal, judged = observe(system, watching), range(asked.first, (asked.last or self.of.given.length) + 1)
        state = start(goal.system, open_first(goal.system, self.of.given.first))
        for cycle, row in enumerate(self.of.given.rows, 1):
            state, _ = step(goal.system, state, {var: row[var] for var in goal.system.inputs})
            if cycle in judged and not holds(goal.good, state):
                return result
            state = {**state, **dict.fromkeys(goal.observers, False)}
        return Vacuous(
            f"in no cycle of the stream given all of {', '.join(asked.reads)} are there, so the claim says nothing"
        )

    def _result(self, asked: Asked, outcome: Outcome, words: str) -> tuple[Result, str]:
        match outcome:
            case Holds(texts, by_folding, passage):
                by = confirmed_by(texts)
                how = "windows with proved hand-over states, " if texts else "folding of every step, "
                how = words if passage is None else how + words
                depth = self.of.given.length if asked.last is None else asked.last
                return (
                    Proved(
                        None,
                        "windows",
                        depth,
                        by,
                        texts,
                        by_construction="every step folds to constants" if by_folding and not texts else "",
                    ),
                    rechecked_in_words(how, by),
                )
            case Breaks():
                return self._violated(asked, outcome, words)
            case Open(cycles, reason):
                told = ", ".join(map(str, cycles))
                more = "--timeout" if reason == OVER else "--seconds"
                what = f"try narrower widths, fewer inputs in --within, or a greater {more}"
                return Unknown(f"undecided in cycle {told}: {reason}; {what}", min(cycles) - 1), f"windows, {words}"

    def _violated(self, asked: Asked, found: Breaks, words: str) -> tuple[Result, str]:
        """Return the nearest violation, replayed."""
        self.of.say(f"{asked.prop.name}: the nearest stream that breaks it")
        lawful = len(found.stream) == 0 or any(var in found.stream[0] for var in self.of.system.ghosts)
        tube = self._deciding.tube(PARTS, lawful=lawful)

        def decide(parts: int) -> Outcome:
            [(_, outcome, _)] = self._deciding.decided([asked], self._deciding.tube(parts), whole=False)
            return outcome

        ends = deadline(_NEARER_SECONDS)

        def again(parts: int, cycle: int) -> Breaks | None:
            return None if ends.passed else self._deciding.again(asked, parts, cycle)

        with clock_after(_NEARER_CLOCK):
            near = nearest(tube, found, decide, again)
        trace = self._replayed(asked, near.breaks)
        return Violated(trace, "windows", f"cycle {near.breaks.cycle}: {near.told}"), f"windows, {words}"

    def _replayed(self, asked: Asked, found: Breaks) -> Trace:
        """Return the run that breaks a claim in its last cycle; EngineError if the interpreter does not agree."""
        lawful = not found.stream or all(var in found.stream[0] for var in self.of.system.inputs)
        lawful = lawful and all(var in found.first for var in self.of.system.state)
        way = self._deciding.lawful_way(asked.prop) if lawful else self._deciding.board
        goal = observe(way.system, plain(asked.prop))
        outside = first_outside(self._deciding.tube(PARTS, lawful=lawful), found.stream)
        if outside is not None:
            raise EngineError(
                f"a stream that breaks {asked.prop.name!r} leaves the tube in cycle {outside}; report this."
            )
        return broken_run(goal, asked, way.system, found)
