"""All of a target's proof around one stream: claims decided, emptiness excluded, violations replayed and brought nearer.

Each claim is asked in up to three ways, the cheapest first:

    in general a declared property that is proved for all lawful streams holds for those of the tube
    on board   for all inputs of the tube, whether or not they obey the laws of the world: the machine without its world
    lawful     for the streams of the tube that obey the laws, with the facts that are proved of the machine
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from safeloc.errors import EngineError
from safeloc.language.expr import TRUE, Var, all_of
from safeloc.language.interpret import holds, start, step
from safeloc.language.nodes import Value
from safeloc.language.spec import Property, observe, speaks_of, watch
from safeloc.language.system import TransitionSystem, first_without_the_world, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Result, Unknown, Vacuous, Violated
from safeloc.proof.around.broken_runs import broken_run, first_of, open_first
from safeloc.proof.around.claims import Asked
from safeloc.proof.around.containment import first_outside
from safeloc.proof.around.corners import broken_at_corners
from safeloc.proof.around.course import Course, Space, first_piece
from safeloc.proof.around.deviations import PARTS, Deviations
from safeloc.proof.around.members import Member, as_recorded, emptied, first_unlawful, member
from safeloc.proof.around.nearest import nearest
from safeloc.proof.around.shown import Decided, Shown
from safeloc.proof.around.tube import Given, Tube
from safeloc.proof.around.windows import (
    LEAST_SECONDS,
    OVER,
    Breaks,
    Claim,
    Holds,
    Observe,
    Open,
    Outcome,
    Passage,
    Windows,
    breaking,
)
from safeloc.proof.provers.limits import Limits, clock_after, deadline
from safeloc.proof.provers.proved_base import base
from safeloc.proof.provers.recheck import confirmed_by, rechecked_in_words
from safeloc.proof.results import Finding

_NEARER_SECONDS, _NEARER_CLOCK = 30.0, 2.5
"""Seconds of effort to bring a run nearer that breaks a claim in its cycle, and the multiple of a limit after which the clock ends each question
about nearer ones: a run is there already.
"""
General = Callable[[Sequence[Property]], Mapping[Property, Mapping[str, str]]]
"""Declared properties -> the certificates of the proofs for all lawful streams, of those that are proved."""


@dataclass(frozen=True, eq=False)
class Around:
    """A question about all streams around a stream of a target.

    system   the machine with its world, without the laws that are left out
    name     of the stream
    general  looks for general proofs of declared properties
    watched  is called with every course of a window, such as to draw the tube
    seconds_in_all  limit of effort for the whole question, besides those of `limits` for each of its parts
    """

    target: str
    system: TransitionSystem
    name: str
    given: Given
    deviations: Deviations
    asked: Sequence[Asked]
    limits: Limits
    without: tuple[str, ...] = ()
    general: General | None = None
    watched: Observe | None = None
    say: Callable[[str], None] = field(default=lambda _: None)
    seconds_in_all: float = math.inf

    def findings(self) -> list[Finding]:
        """Decide every claim; return one finding of each."""
        return self.decided().findings

    def decided(self) -> Decided:
        """Decide every claim; return one finding of each, with what shows them again."""
        run = _Run(self)
        return Decided(list(run.findings()), run.witness, run.shown)


@dataclass(frozen=True, eq=False)
class _Way:
    """One way of asking: the system that is run, without or with the world."""

    system: TransitionSystem
    words: str
    lawful: bool


@dataclass(eq=False)
class _Run:
    of: Around

    def __post_init__(self) -> None:
        self.board = _Way(without_ghosts(self.of.system), "for all inputs of the tube, without any law", lawful=False)
        self._began, self._ends = time.monotonic(), deadline(self.of.seconds_in_all)
        self.witness: Member | None = None
        self.shown: dict[Asked, Shown] = {}
        self._general: dict[Property, Mapping[str, str]] = {}
        self._passages: dict[Passage, Shown] = {}
        self._was_watched = False

    @property
    def _limits(self) -> Limits:
        """The limits of a part of the question: its own, or what is left of the whole."""
        return replace(self.of.limits, seconds=min(self.of.limits.seconds, max(self._ends.left, LEAST_SECONDS)))

    # -------------------------------------------------------------- findings

    def findings(self) -> Sequence[Finding]:
        """Return the findings, in the order asked."""
        self.of.say("streams near the given one: is there a lawful one?")
        found: dict[Asked, tuple[Result, str]] = {}
        lawful = [one for one in self.of.asked if not one.prop.unconditional]
        if lawful:
            empty = self._empty()
            if empty is not None:
                found |= dict.fromkeys(lawful, (empty, "windows"))
        left = [one for one in self.of.asked if one not in found]
        self._look_for_general_proofs(left)
        for asked, outcome, words in self._decided(left, self._tube(PARTS)):
            if isinstance(outcome, Holds) and outcome.passage is not None:
                self.shown[asked] = self._passages[outcome.passage]
            found[asked] = self._result(asked, outcome, words)
        self._watch_the_whole_tube(left)
        return [self._finding(one, *found[one]) for one in self.of.asked]

    def _watch_the_whole_tube(self, asked: Sequence[Asked]) -> None:
        """Go through the tube for whoever watches, where no claim needed that: each was broken by a stream at its corners."""
        on_board = [one for one in asked if speaks_of(self.board.system, one.prop)]
        if self.of.watched is not None and not self._was_watched:
            self._passed(self.board, on_board[:1], self._tube(PARTS))

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
        system = self.board.system if speaks_of(self.board.system, asked.prop) else self.of.system
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
        tube = self._tube(PARTS, lawful=lawful)

        def decide(parts: int) -> Outcome:
            [(_, outcome, _)] = self._decided([asked], self._tube(parts), whole=False)
            return outcome

        ends = deadline(_NEARER_SECONDS)

        def again(parts: int, cycle: int) -> Breaks | None:
            return None if ends.passed else self._again(asked, parts, cycle)

        with clock_after(_NEARER_CLOCK):
            near = nearest(tube, found, decide, again)
        trace = self._replayed(asked, near.breaks)
        return Violated(trace, "windows", f"cycle {near.breaks.cycle}: {near.told}"), f"windows, {words}"

    # -------------------------------------------------------------- ways of asking

    def _tube(self, parts: int, *, lawful: bool = True) -> Tube:
        system = self.of.system if lawful else self.board.system
        return Tube(system, self.of.given, self.of.deviations.scaled(parts))

    def _decided(self, asked: Sequence[Asked], tube: Tube, *, whole: bool = True) -> list[tuple[Asked, Outcome, str]]:
        """Decide claims in one tube, each in the first way that decides it; `whole` if it is the tube that was asked for."""
        found: list[tuple[Asked, Outcome, str]] = [
            (one, Holds(texts, by_folding=False), "it follows from the proof for all lawful streams")
            for one in asked
            if (texts := self._in_general(one)) is not None
        ]
        left = [one for one in asked if self._in_general(one) is None]
        on_board = [one for one in left if speaks_of(self.board.system, one.prop)]
        for one, broken in self._at_corners(on_board, tube).items():
            found.append((one, broken, "streams at the corners of the tube"))
            left.remove(one)
        on_board = [one for one in on_board if one in left]
        for one, outcome in self._passed(self.board, on_board, tube, whole=whole).items():
            settled = self._settled_on_board(one, outcome)
            if settled is not None:
                found.append((one, settled, self.board.words))
                left.remove(one)
        for group in _alike(left):
            way = self._lawful_way(group[0].prop)
            passed = self._passed(way, group, tube, whole=whole)
            found += [(one, outcome, way.words) for one, outcome in passed.items()]
        return found

    def _look_for_general_proofs(self, asked: Sequence[Asked]) -> None:
        """Look for proofs of declared properties for all lawful streams; with a law that is left out there is none."""
        declared = [one.prop for one in asked if not one.own]
        if not declared or self.of.general is None or self.of.without:
            return
        self.of.say(f"{_claims(len(declared))}: which are proved for all lawful streams?")
        self._general = dict(self.of.general(declared))

    def _in_general(self, asked: Asked) -> Mapping[str, str] | None:
        """Return the certificates of the proof of a declared property for all lawful streams, if there is one."""
        return None if asked.own else self._general.get(asked.prop)

    def _at_corners(self, asked: Sequence[Asked], tube: Tube) -> dict[Asked, Breaks]:
        """Return claims that a stream at the corners of the tube breaks, with the truth if they rely on laws."""
        if not asked:
            return {}
        space, claims = self._space(self.board, asked, tube)
        found = broken_at_corners(space, list(claims.values()))
        lawful = {
            one: found[claim] if one.prop.unconditional else self._with_truth(one, found[claim])
            for one, claim in claims.items()
            if claim in found
        }
        return {one: broken for one, broken in lawful.items() if broken is not None}

    def _settled_on_board(self, asked: Asked, outcome: Outcome) -> Outcome | None:
        """Return what the machine without its world decides; a stream that breaks the claim counts if it can be lawful."""
        if isinstance(outcome, Holds) or asked.prop.unconditional:
            return outcome
        if not isinstance(outcome, Breaks):
            return None
        return self._with_truth(asked, outcome)

    def _with_truth(self, asked: Asked, found: Breaks) -> Breaks | None:
        """Return a stream of inputs on board with a truth beside it that the laws allow."""
        way = self._lawful_way(asked.prop)
        board = self.board.system
        first = {var: value for var, value in found.first.items() if var in set(board.state)}
        rows = [{var: row[var] for var in board.inputs} for row in found.stream]
        ghosts = {
            name: width
            for name, width in self.of.deviations.widths.items()
            if name in {v.name for v in way.system.ghosts}
        }
        given = replace(self.of.given, rows=rows, first={**self.of.given.first, **first})
        as_it_was = as_recorded(way.system, given)
        if as_it_was is not None and first_unlawful(way.system, as_it_was) is None:
            return Breaks(as_it_was.first, as_it_was.stream)
        tube = Tube(way.system, given, Deviations(ghosts))
        made = member(Space(way.system, tube), self._limits, len(rows))
        return None if made is None else Breaks(made.first, made.stream)

    def _lawful_way(self, prop: Property) -> _Way:
        words = "for all streams of the tube that obey the laws"
        system = self.of.system
        if prop.unconditional:
            words, system = (
                "for all streams of the tube",
                replace(system, assume=TRUE, init=first_without_the_world(system)),
            )
        if prop.further_assumption is not TRUE:
            words += " and the further assumption"
            system = replace(system, assume=all_of([system.assume, prop.further_assumption]))
        return _Way(system, words, lawful=True)

    def _passed(self, way: _Way, asked: Sequence[Asked], tube: Tube, *, whole: bool = True) -> dict[Asked, Outcome]:
        """Go through the tube in one way; only the whole one is watched."""
        if not asked:
            return {}
        self._was_watched = self._was_watched or whole
        space, claims = self._space(way, asked, tube)
        self.of.say(f"{_claims(len(asked))} through {_last(asked, tube)} cycles, {way.words}")
        outcomes = Windows(
            space, list(claims.values()), self.of.limits, watched=self.of.watched if whole else None, ends=self._ends
        ).outcomes()
        facts = base(way.system, seconds=self.of.limits.seconds).certificates if way.lawful else {}
        for outcome in outcomes.values():
            if isinstance(outcome, Holds) and outcome.passage is not None:
                self._passages[outcome.passage] = Shown(way.lawful, asked, outcome.passage, facts)
        return {one: outcomes[claim] for one, claim in claims.items()}

    def _space(self, way: _Way, asked: Sequence[Asked], tube: Tube) -> tuple[Space, dict[Asked, Claim]]:
        goals = {one: observe(way.system, _plain(one.prop)) for one in asked}
        watched = watch(way.system, list(goals.values()))
        claims = {one: Claim(one.prop.name, goal, one.first, one.last) for one, goal in goals.items()}
        facts = base(way.system, seconds=self.of.limits.seconds).everything if way.lawful else []
        restarts: dict[int, dict[Var, Value]] = {}
        for one, goal in goals.items():
            if one.first > 1:
                restarts.setdefault(one.first - 1, {}).update(first_of(goal))
        made = Tube(way.system, tube.given, tube.deviations if way.lawful else _on_board(tube.deviations, way.system))
        return Space(watched.system, made, facts, restarts), claims

    def _again(self, asked: Asked, parts: int, cycle: int) -> Breaks | None:
        """Return a stream of the scaled tube that breaks a claim: in any cycle one at its corners, else in this one.

        On board if it can be lawful, else with the laws.
        """
        if self._ends.passed:
            return None
        tube = self._tube(parts)
        if speaks_of(self.board.system, asked.prop):
            at_corners = self._at_corners([asked], tube)
            if at_corners:
                return at_corners[asked]
            found = self._breaking(self.board, asked, tube, cycle)
            if found is None or asked.prop.unconditional:
                return found
            lawful = self._with_truth(asked, found)
            if lawful is not None:
                return lawful
        return self._breaking(self._lawful_way(asked.prop), asked, tube, cycle)

    def _breaking(self, way: _Way, asked: Asked, tube: Tube, cycle: int) -> Breaks | None:
        space, claims = self._space(way, [asked], tube)
        return breaking(Course(space, first_piece(space), 0).to(cycle), claims[asked], cycle, self._limits)

    # -------------------------------------------------------------- emptiness

    def _empty(self) -> Vacuous | Unknown | None:
        """Return the verdict of every lawful claim if no lawful stream of the tube is known."""
        system = self.of.system
        recorded = as_recorded(system, self.of.given)
        if recorded is not None and first_unlawful(system, recorded) is None:
            self.witness = recorded
            return None
        length = self.of.given.length
        widths = self.of.deviations.widths
        for deviations in (Deviations(dict.fromkeys(widths, 0)), self.of.deviations):
            tube = Tube(system, self.of.given, deviations)
            self.witness = member(Space(system, tube), self._limits, length)
            if self.witness is not None:
                return None
        empty = emptied(Space(system, self._tube(PARTS)), self._limits)
        if empty is None:
            return Unknown(
                "no stream of the tube was found that obeys the laws up to the end, and none was excluded either"
            )
        laws = " and ".join(repr(law) for law in empty.laws) or "the ranges of the inputs"
        return Vacuous(
            f"the tube is empty from cycle {empty.cycle} on: no stream of it obeys {laws} so far; widen the tube, "
            "or leave a law out with --without"
        )

    # -------------------------------------------------------------- replay

    def _replayed(self, asked: Asked, found: Breaks) -> Trace:
        """Return the run that breaks a claim in its last cycle; EngineError if the interpreter does not agree."""
        lawful = not found.stream or all(var in found.stream[0] for var in self.of.system.inputs)
        lawful = lawful and all(var in found.first for var in self.of.system.state)
        way = self._lawful_way(asked.prop) if lawful else self.board
        goal = observe(way.system, _plain(asked.prop))
        outside = first_outside(self._tube(PARTS, lawful=lawful), found.stream)
        if outside is not None:
            raise EngineError(
                f"a stream that breaks {asked.prop.name!r} leaves the tube in cycle {outside}; report this."
            )
        return broken_run(goal, asked, way.system, found)


def _claims(number: int) -> str:
    """Return the number of claims in words."""
    return "1 claim" if number == 1 else f"{number} claims"


def _last(asked: Sequence[Asked], tube: Tube) -> int:
    """Return the last cycle in which one of the claims is judged."""
    return max(tube.length if one.last is None else min(one.last, tube.length) for one in asked)


def _plain(prop: Property) -> Property:
    """Return a property without its assumption, which the system that is run has."""
    return replace(prop, unconditional=False, further_assumption=TRUE)


def _alike(asked: Sequence[Asked]) -> list[list[Asked]]:
    """Return the claims in groups of the same assumption."""
    groups: dict[tuple[bool, object], list[Asked]] = {}
    for one in asked:
        groups.setdefault((one.prop.unconditional, one.prop.further_assumption), []).append(one)
    return list(groups.values())


def _on_board(deviations: Deviations, system: TransitionSystem) -> Deviations:
    """Return the deviations of inputs on board."""
    known = {var.name for var in system.inputs}
    return replace(deviations, widths={name: width for name, width in deviations.widths.items() if name in known})
