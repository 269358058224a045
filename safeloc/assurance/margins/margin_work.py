"""The limits of all figures of a target, and of pairs of figures, in several processes, with kept results."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, get_args

from safeloc.assurance.evidence.interval import claims_of
from safeloc.assurance.kept_work import Batch, Keeping, kept_or_done
from safeloc.assurance.margins import rests_on
from safeloc.assurance.margins.asking import Answer, Asking, Way, Where
from safeloc.assurance.margins.figures import Figure
from safeloc.assurance.margins.limits_of_figures import Direction, Limit, limit
from safeloc.assurance.margins.makers import as_it_is_key, margins_key
from safeloc.assurance.margins.rests_on import RestsOn
from safeloc.language.spec import Property, observe
from safeloc.language.verdict import Proved, word
from safeloc.proof.cache.store import Store
from safeloc.proof.provers.limits import CLOCK, Limits, clock_after
from safeloc.proof.provers.portfolio import prove_one, proved_base
from safeloc.proof.provers.workers import Lost, Task
from safeloc.target import Target

_KIND, _AS_IT_IS, _FRONTS = "margins", "claims before margins", "fronts"
_PATIENCE, _QUESTIONS_AS_IT_IS = 3, 20
"""Multiple of the limit for a claim with the figures as they are, and questions with the plain limit that the clock allows for there."""
_QUESTIONS = 60
"""Questions of one search that the clock allows for; a search over a range of 2**31 asks some 50."""
_CLOCK = 2.5
"""Multiple of the limit after which the clock ends a question: of the hundreds of a search, some take minutes for seconds of counted effort."""
_MOST_WAYS = 4
"""Runs that are tried for a figure before anything is searched."""
POINTS = 8
"""Points of the front of two figures, besides its ends."""


@dataclass(frozen=True, eq=False)
class Margins:
    """A search for limits.

    where   where the figures move
    claims  names of the claims that have to hold
    limits  bounds of the provers, for each claim at each value
    rests_on  what of the world each claim rests on, once `as_it_is` has told it
    ways    runs that ended limits found so far
    """

    target: Target
    where: Where
    claims: Sequence[str]
    limits: Limits
    jobs: int = 2
    look_in: Store | None = None
    keep_in: Store | None = None
    rests_on: dict[str, RestsOn | None] = field(default_factory=dict)
    ways: list[Way] = field(default_factory=list)

    def asking(self) -> Asking:
        """Return one who asks about the target."""
        return Asking(self.target, self.where, self.limits, self.claims, self.rests_on, self.ways)

    def learn(self, found: Limit) -> None:
        """Keep the run that ends a limit for searches that begin later: the last ones, of each claim and length one."""
        if found.end.end == "broken" and found.end.first is not None:
            like = [
                one for one in self.ways if (one.claim, len(one.inputs)) != (found.end.claim, len(found.end.inputs))
            ]
            self.ways[:] = [Way(found.end.claim, found.end.first, found.end.inputs), *like][:_MOST_WAYS]

    def as_it_is(self) -> Iterator[tuple[str, str]]:
        """Yield each claim with its verdict with the figures as they are; without all of them proved there is no margin to find.

        What of the world each claim rests on is noted, so that a claim is asked again only where that has moved.
        """
        claims = {prop.name: prop for prop in claims_of(self.target) if prop.name in self.claims}

        def batches(left: Sequence[str]) -> list[Batch]:
            proved_base(self.target.system, self._patient)
            return [Batch((name,), self._task_as_it_is(claims[name])) for name in left]

        key = as_it_is_key(self.target, _AS_IT_IS, self.limits)
        keeping = Keeping(_AS_IT_IS, key, self.look_in, self.keep_in, lambda found: found["verdict"] != "unknown")
        for name, found in kept_or_done([*claims], batches, keeping, self.jobs):
            if not isinstance(found, Lost):
                self.rests_on[name] = rests_on.from_data(found["rests_on"])
            yield name, "unknown" if isinstance(found, Lost) else found["verdict"]

    def _task_as_it_is(self, prop: Property) -> Task:
        def work() -> list[dict[str, Any]]:
            verdict = prove_one(observe(self.target.system, replace(prop, kept_by=None)), self._patient)
            used = rests_on.rests_on(self.target.system, prop, self.limits) if isinstance(verdict, Proved) else None
            return [{"verdict": word(verdict), "rests_on": rests_on.to_data(used)}]

        return Task(prop.name, work, CLOCK * _QUESTIONS_AS_IT_IS * self.limits.seconds)

    @property
    def _patient(self) -> Limits:
        """The limits of the claims as they are: one that is not proved there leaves no margin to find at all."""
        return replace(self.limits, seconds=_PATIENCE * self.limits.seconds)

    def singles(self, figures: Sequence[Figure]) -> Iterator[Limit]:
        """Yield the limits of each figure up and down, as they are found."""
        pieces = {f"{one.name} {way}": (one, way) for one in figures for way in get_args(Direction)}
        for name, found in self._worked(pieces):
            figure, way = pieces[name]
            lost = Limit(figure, way, figure.value, Answer("undecided", why="the search ran out of time"), None)
            one = lost if isinstance(found, Lost) else from_data(found)
            self.learn(one)
            yield one

    def _worked(self, pieces: Mapping[str, tuple[Figure, Direction]]) -> Iterator[tuple[str, Any | Lost]]:
        def batches(left: Sequence[str]) -> list[Batch]:
            return [Batch((name,), self._task(name, *pieces[name])) for name in left]

        key = margins_key(self.target, _KIND, self.limits, self.where, list(self.claims))
        keeping = Keeping(_KIND, key, self.look_in, self.keep_in, _is_decided)
        return kept_or_done([*pieces], batches, keeping, self.jobs)

    def _task(self, name: str, figure: Figure, way: Direction) -> Task:
        most = CLOCK * _QUESTIONS * len(self.claims) * self.limits.seconds

        def work() -> list[dict[str, Any]]:
            with clock_after(_CLOCK):
                return [asdict(limit(self.asking(), figure, way))]

        return Task(name, work, most)


Moving = tuple[Figure, Direction]
"""A figure, and the direction in which it moves."""
Point = tuple[int, Limit]
"""A value of the first figure of a front, and the limit of the second beside it."""


def fronts(margins: Margins, pairs: Mapping[str, tuple[Moving, Moving]]) -> Iterator[tuple[str, list[Point]]]:
    """Yield the front of each pair, by its name, as they are found; one that was lost has no points."""

    names = {_said(*both): name for name, both in pairs.items()}

    def batches(left: Sequence[str]) -> list[Batch]:
        return [Batch((said,), _task_of_front(margins, said, *pairs[names[said]])) for said in left]

    key = margins_key(margins.target, _FRONTS, margins.limits, margins.where, list(margins.claims), POINTS)
    keeping = Keeping(_FRONTS, key, margins.look_in, margins.keep_in, _all_decided)
    for said, found in kept_or_done([*names], batches, keeping, margins.jobs):
        yield names[said], [] if isinstance(found, Lost) else [(value, from_data(one)) for value, one in found]


def _said(first: Moving, second: Moving) -> str:
    return ",".join(f"{figure.name}:{way}" for figure, way in (first, second))


def _task_of_front(margins: Margins, name: str, first: Moving, second: Moving) -> Task:
    most = CLOCK * _QUESTIONS * POINTS * len(margins.claims) * margins.limits.seconds

    def work() -> list[list[list[Any]]]:
        with clock_after(_CLOCK):
            return [[[value, asdict(one)] for value, one in front(margins, first, second)]]

    return Task(name, work, most)


def front(margins: Margins, first: Moving, second: Moving) -> Iterator[Point]:
    """Yield points of the Pareto front of two figures: a value of the first, and the limit of the second beside it.

    The first figure takes its own value, its limit, and values between them in equal steps.
    """
    asking, (figure, way) = margins.asking(), first
    farthest = limit(asking, figure, way).holds_to
    steps = min(abs(farthest - figure.value), POINTS + 1)
    between = (figure.value + (farthest - figure.value) * step // max(steps, 1) for step in range(steps + 1))
    for value in dict.fromkeys(between):
        yield value, limit(asking, *second, {figure.name: value})


def _is_decided(one: Mapping[str, Any]) -> bool:
    return bool(one["end"]["end"] != "undecided")


def _all_decided(points: Sequence[tuple[int, Mapping[str, Any]]]) -> bool:
    return all(_is_decided(one) for _, one in points)


def from_data(data: Mapping[str, Any]) -> Limit:
    """Return a limit from its plain data (`asdict`)."""
    end = dict(data["end"])
    return Limit(
        Figure(**data["figure"]),
        data["direction"],
        data["holds_to"],
        Answer(**{**end, "inputs": tuple(end["inputs"])}),
        data["beyond"],
        data["broken_at"],
        data["proved_why"],
    )
