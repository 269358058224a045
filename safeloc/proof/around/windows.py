"""A stream window by window: in each window the claims are asked, and the states in which it may end are handed to the next.

A claim that does not follow from the states handed over is asked again from those of earlier windows, at last from the start.
From there the cycles are exact: a model is a stream that breaks the claim.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import Bool, Var
from safeloc.language.nodes import Truth, Value
from safeloc.language.spec import Goal
from safeloc.proof.around.course import Course, Piece, Space, first_piece
from safeloc.proof.around.hand_over import UnsettledError, hand_over, joined
from safeloc.proof.provers.implication import Undecided, countermodel
from safeloc.proof.provers.limits import Deadline, Limits, deadline
from safeloc.proof.provers.settle import settled

_MOST_CHOICES = 12
"""A window ends where more choices than that are open: then states are told apart, ranges are narrowed, and the next steps fold."""
_BACK_SECONDS = 6.0
"""Seconds of effort for a question from the states of earlier windows."""
_BACK_WINDOWS = 2.0
"""Multiple of the limit for all these questions of one claim in one window."""
OVER = "the time for the whole question is over"
"""The reason of a claim that is left when the limit of the whole question is reached."""
LEAST_SECONDS = 0.1
"""Seconds of effort that a question gets at least, so that a window that was begun is left in order."""
_WINDOW = 20
"""Cycles of a window, as long as nothing is left undecided."""


@dataclass(frozen=True, eq=False)
class Claim:
    """A claim on each state from a cycle to another; `goal` is that of the machine which is run."""

    name: str
    goal: Goal
    first: int = 0
    last: int | None = None

    def judges(self, cycle: int) -> bool:
        """Return whether the claim speaks of the state after a cycle."""
        return self.first <= cycle and (self.last is None or cycle <= self.last)


@dataclass(frozen=True)
class Back:
    """A claim that was shown in some cycles from the states of an earlier hand-over: its number, 0 for the start."""

    claim: str
    handed: int
    first: int
    last: int


@dataclass(frozen=True, eq=False)
class Passage:
    """The sets of states that were handed over, each with its cycle, that of the start first; and what was shown from further back."""

    handed: Sequence[tuple[int, Sequence[Piece]]]
    back: Sequence[Back]


@dataclass(frozen=True, eq=False)
class Holds:
    """The claim holds in all cycles, with certificates; `by_folding` is true if no solver was needed for it."""

    texts: Mapping[str, str]
    by_folding: bool
    passage: Passage | None = None


@dataclass(frozen=True, eq=False)
class Breaks:
    """A stream of the tube breaks the claim in its last cycle: the first state and the inputs of each cycle."""

    first: Mapping[Var, Value]
    stream: Sequence[Mapping[Var, Value]]

    @property
    def cycle(self) -> int:
        """The cycle in which the claim is broken; 0 for the first state."""
        return len(self.stream)


@dataclass(frozen=True)
class Open:
    """The claim is not decided in these cycles."""

    cycles: tuple[int, ...]
    reason: str


@dataclass(frozen=True)
class At:
    """A claim in a cycle: the key of a goal."""

    claim: str
    cycle: int

    def __str__(self) -> str:
        return f"{self.claim} after cycle {self.cycle}"


Outcome: TypeAlias = Holds | Breaks | Open
Observe: TypeAlias = Callable[[Course], None]


@dataclass(eq=False)
class Windows:
    """One passage through the tube, up to the last cycle in which a claim is judged.

    ends     the limit of the whole question: what is left open by then is undecided
    watched  called with every course of a window
    """

    space: Space
    claims: Sequence[Claim]
    limits: Limits
    window: int = _WINDOW
    watched: Observe | None = None
    ends: Deadline = field(default_factory=lambda: deadline(math.inf))
    handed: list[tuple[int, Sequence[Piece]]] = field(default_factory=list, init=False)
    texts: dict[str, str] = field(default_factory=dict, init=False)
    empty: int | None = field(default=None, init=False)
    _found: dict[Claim, Outcome] = field(default_factory=dict, init=False)
    _of_claim: dict[Claim, dict[str, str]] = field(default_factory=dict, init=False)
    _judged: int = field(default=0, init=False)
    _back: list[Back] = field(default_factory=list, init=False)

    def outcomes(self) -> dict[Claim, Outcome]:
        """Go through all cycles; return what was found of each claim."""
        self._of_claim = {claim: {} for claim in self.claims}
        self.handed.append((0, [first_piece(self.space)]))
        self._judge([Course(self.space, self.handed[0][1][0], 0)], 0, 0)
        try:
            while self._left() and self._judged < self._last() and self.empty is None:
                if self.ends.passed:
                    raise UnsettledError(OVER)  # as where states are not settled, what is left is open
                self._window()
        except UnsettledError as why:
            cycle = self.handed[-1][0] + 1
            told = OVER if self.ends.passed else f"the states after cycle {cycle}: {why}"
            self._found |= {claim: Open((cycle,), told) for claim in self._left() if self._is_judged_after(claim)}
        return {claim: self._found.get(claim) or self._holding(claim) for claim in self.claims}

    def _holding(self, claim: Claim) -> Holds:
        passage = Passage(self.handed, self._back)
        return Holds({**self.texts, **self._of_claim[claim]}, by_folding=not self._of_claim[claim], passage=passage)

    def _left(self) -> list[Claim]:
        return [claim for claim in self.claims if claim not in self._found]

    def _last(self) -> int:
        """Return the last cycle in which a claim that is left is judged."""
        length = self.space.tube.length
        return max(length if claim.last is None else min(claim.last, length) for claim in self._left())

    def _is_judged_after(self, claim: Claim) -> bool:
        """Return whether a claim speaks of a cycle that was not judged yet."""
        return claim.last is None or claim.last > self._judged

    def _seconds(self) -> float:
        """Return the limit of a question: its own, or what is left of the whole."""
        return min(self.limits.seconds, max(self.ends.left, LEAST_SECONDS))

    def _window(self) -> None:
        at, pieces = self.handed[-1]
        courses = [Course(self.space, piece, at) for piece in pieces]
        to = self._along(courses, at)
        if self.watched is not None:
            for course in courses:
                self.watched(course)
        self._judge(courses, at + 1, to)
        self._judged = to
        if self._left() and to < self._last():
            self.handed.append((to, self._handed_over(courses)))
            if not self.handed[-1][1]:
                self.empty = to

    def _along(self, courses: Sequence[Course], at: int) -> int:
        """Go on with all courses up to the end of the window; it ends early where steps leave much undecided."""
        to = at
        while to < min(self.space.tube.length, at + self.window):
            to += 1
            for course in courses:
                course.to(to)
            if any(course.choices > _MOST_CHOICES for course in courses):
                break
        return to

    def _handed_over(self, courses: Sequence[Course]) -> list[Piece]:
        found: list[Piece] = []
        for number, course in enumerate(courses, 1):
            name = f"{self.space.system.name} after cycle {course.end} from {course.begin}.{number}"
            made = hand_over(course, deadline(self._seconds()), name)
            self.texts |= made.texts
            found += made.pieces
        labels = list(dict.fromkeys(var for piece in found for var in piece.fixed if self.space.tells_apart(var)))
        return joined(found, labels)

    # -------------------------------------------------------------- claims

    def _judge(self, courses: Sequence[Course], begin: int, end: int) -> None:
        """Ask the claims in all cycles from one to another; what does not follow is asked from further back."""
        failing: dict[Claim, int] = {}
        for course in courses:
            for claim, cycle in self._not_following(course, self._left(), begin, end):
                failing[claim] = min(cycle, failing.get(claim, cycle))
        for claim, cycle in failing.items():
            self._from_further_back(claim, cycle, end)

    def _not_following(
        self, course: Course, claims: Sequence[Claim], begin: int, end: int, seconds: float | None = None
    ) -> Iterator[tuple[Claim, int]]:
        """Yield the claims that do not follow in a cycle, with the cycle; the certificates of the others are kept."""
        by_name = {claim.name: claim for claim in claims}
        for last, goals in _together(course, claims, begin, end):
            asked = settled(
                Query(self._name(course, last), course.hypotheses(last), goals),
                deadline(self._seconds() if seconds is None else seconds),
            )
            for key in goals:
                self._of_claim[by_name[key.claim]] |= asked.texts
            yield from ((by_name[key.claim], key.cycle) for key in asked.failed)

    def _name(self, course: Course, last: int) -> str:
        return f"{self.space.system.name} claims up to cycle {last} from {course.begin}"

    def _from_further_back(self, claim: Claim, cycle: int, end: int) -> None:
        """Decide a claim from a failing cycle to the end of the window, from the states of earlier windows."""
        ends, at = deadline(_BACK_WINDOWS * self._seconds()), self.handed[-1][0]
        for back in _doubling(len(self.handed) - 1):
            at, pieces = self.handed[-1 - back]
            courses = [Course(self.space, piece, at).to(end) for piece in pieces]
            wrong = [
                (course, found)
                for course in courses
                for _, found in self._not_following(course, [claim], cycle, end, min(_BACK_SECONDS, ends.left))
            ]
            if not wrong:
                self._back.append(Back(claim.name, len(self.handed) - 1 - back, cycle, end))
                return
            if at == 0:
                course, found = min(wrong, key=lambda pair: pair[1])
                self._found[claim] = self._broken(course, claim, found)
                return
            if ends.passed:
                break
        self._found[claim] = Open(
            (cycle,), f"it does not follow from the states after cycle {at}, and there was no time to look further back"
        )

    def _broken(self, course: Course, claim: Claim, cycle: int) -> Outcome:
        """Return the stream from the start that breaks a claim in a cycle."""
        found = breaking(course, claim, cycle, self.limits)
        return Open((cycle,), f"cycle {cycle} from the start: {Undecided('limit reached')}") if found is None else found


def breaking(course: Course, claim: Claim, cycle: int, limits: Limits) -> Breaks | None:
    """Return a stream that breaks a claim in a cycle of a course from the start, if the solver finds one."""
    if course.end < cycle:
        return None
    good = course.at(claim.goal.good, cycle)
    assert isinstance(good, Bool)
    values = countermodel(Query("a stream", course.hypotheses(cycle), {0: good}), limits.seconds)
    return None if values is None else Breaks(course.first_state(values), course.stream(values, cycle))


def _doubling(most: int) -> Iterator[int]:
    """Yield 1, 2, 4 ... and at last `most`; 0 alone if that is the most."""
    back = 1
    while back < most:
        yield back
        back *= 2
    yield most


def _together(course: Course, claims: Sequence[Claim], begin: int, end: int) -> Iterator[tuple[int, dict[At, Bool]]]:
    """Yield the claims that folding leaves open, those together that have the same conditions, each time with the last cycle."""
    goals: dict[At, Bool] = {}
    last = begin
    for cycle in range(begin, min(end, course.end) + 1):
        if goals and course.conditions(cycle) != course.conditions(last):
            yield last, goals
            goals = {}
        last = cycle
        for claim in claims:
            good = course.at(claim.goal.good, cycle) if claim.judges(cycle) else Truth(True)
            assert isinstance(good, Bool)
            if not (isinstance(good, Truth) and good.value):
                goals[At(claim.name, cycle)] = good
    if goals:
        yield last, goals
