"""Claims decided in one tube, each in up to three ways, the cheapest first.

in general a declared property that is proved for all lawful streams holds for those of the tube
on board   for all inputs of the tube, whether or not they obey the laws of the world: the machine without its world
lawful     for the streams of the tube that obey the laws, with the facts that are proved of the machine
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from safeloc.language.expr import Var
from safeloc.language.nodes import Value
from safeloc.language.spec import Property, observe, speaks_of, watch
from safeloc.language.system import TransitionSystem
from safeloc.proof.around.broken_runs import first_of
from safeloc.proof.around.claims import Asked
from safeloc.proof.around.corners import broken_at_corners
from safeloc.proof.around.course import Course, Space, first_piece
from safeloc.proof.around.deviations import Deviations
from safeloc.proof.around.members import as_recorded, first_unlawful, member
from safeloc.proof.around.question import Question
from safeloc.proof.around.shown import Shown
from safeloc.proof.around.tube import Tube
from safeloc.proof.around.ways import Way, lawful_way, on_board, plain
from safeloc.proof.around.windows import LEAST_SECONDS, Breaks, Claim, Holds, Outcome, Passage, Windows, breaking
from safeloc.proof.provers.limits import Deadline, Limits
from safeloc.proof.provers.proved_base import base


@dataclass(eq=False)
class Deciding:
    """Decides claims of a question.

    ends         when the whole question has taken its effort
    passages     what shows each passage through the tube again
    was_watched  the whole tube was gone through
    """

    of: Question
    ends: Deadline
    passages: dict[Passage, Shown] = field(default_factory=dict)
    was_watched: bool = False
    _general: dict[Property, Mapping[str, str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.board = on_board(self.of.system)

    @property
    def limits(self) -> Limits:
        """The limits of a part of the question: its own, or what is left of the whole."""
        return replace(self.of.limits, seconds=min(self.of.limits.seconds, max(self.ends.left, LEAST_SECONDS)))

    def lawful_way(self, prop: Property) -> Way:
        """Return the way of the streams that obey the laws."""
        return lawful_way(self.of.system, prop)

    def tube(self, parts: int, *, lawful: bool = True) -> Tube:
        system = self.of.system if lawful else self.board.system
        return Tube(system, self.of.given, self.of.deviations.scaled(parts))

    def decided(self, asked: Sequence[Asked], tube: Tube, *, whole: bool = True) -> list[tuple[Asked, Outcome, str]]:
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
        for one, outcome in self.passed(self.board, on_board, tube, whole=whole).items():
            settled = self._settled_on_board(one, outcome)
            if settled is not None:
                found.append((one, settled, self.board.words))
                left.remove(one)
        for group in _alike(left):
            way = self.lawful_way(group[0].prop)
            passed = self.passed(way, group, tube, whole=whole)
            found += [(one, outcome, way.words) for one, outcome in passed.items()]
        return found

    def look_for_general_proofs(self, asked: Sequence[Asked]) -> None:
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
        way = self.lawful_way(asked.prop)
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
        made = member(Space(way.system, tube), self.limits, len(rows))
        return None if made is None else Breaks(made.first, made.stream)

    def passed(self, way: Way, asked: Sequence[Asked], tube: Tube, *, whole: bool = True) -> dict[Asked, Outcome]:
        """Go through the tube in one way; only the whole one is watched."""
        if not asked:
            return {}
        self.was_watched = self.was_watched or whole
        space, claims = self._space(way, asked, tube)
        self.of.say(f"{_claims(len(asked))} through {_last(asked, tube)} cycles, {way.words}")
        outcomes = Windows(
            space, list(claims.values()), self.of.limits, watched=self.of.watched if whole else None, ends=self.ends
        ).outcomes()
        facts = base(way.system, seconds=self.of.limits.seconds).certificates if way.lawful else {}
        for outcome in outcomes.values():
            if isinstance(outcome, Holds) and outcome.passage is not None:
                self.passages[outcome.passage] = Shown(way.lawful, asked, outcome.passage, facts)
        return {one: outcomes[claim] for one, claim in claims.items()}

    def _space(self, way: Way, asked: Sequence[Asked], tube: Tube) -> tuple[Space, dict[Asked, Claim]]:
        goals = {one: observe(way.system, plain(one.prop)) for one in asked}
        watched = watch(way.system, list(goals.values()))
        claims = {one: Claim(one.prop.name, goal, one.first, one.last) for one, goal in goals.items()}
        facts = base(way.system, seconds=self.of.limits.seconds).everything if way.lawful else []
        restarts: dict[int, dict[Var, Value]] = {}
        for one, goal in goals.items():
            if one.first > 1:
                restarts.setdefault(one.first - 1, {}).update(first_of(goal))
        made = Tube(way.system, tube.given, tube.deviations if way.lawful else _on_board(tube.deviations, way.system))
        return Space(watched.system, made, facts, restarts), claims

    def again(self, asked: Asked, parts: int, cycle: int) -> Breaks | None:
        """Return a stream of the scaled tube that breaks a claim: in any cycle one at its corners, else in this one.

        On board if it can be lawful, else with the laws.
        """
        if self.ends.passed:
            return None
        tube = self.tube(parts)
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
        return self._breaking(self.lawful_way(asked.prop), asked, tube, cycle)

    def _breaking(self, way: Way, asked: Asked, tube: Tube, cycle: int) -> Breaks | None:
        space, claims = self._space(way, [asked], tube)
        return breaking(Course(space, first_piece(space), 0).to(cycle), claims[asked], cycle, self.limits)


def _claims(number: int) -> str:
    """Return the number of claims in words."""
    return "1 claim" if number == 1 else f"{number} claims"


def _last(asked: Sequence[Asked], tube: Tube) -> int:
    """Return the last cycle in which one of the claims is judged."""
    return max(tube.length if one.last is None else min(one.last, tube.length) for one in asked)


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
