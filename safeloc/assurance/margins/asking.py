"""Ask whether every claim of a target still holds with figures at other values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from safeloc.assurance.evidence.interval import HOLDS, claims_of
from safeloc.assurance.margins.figures import Refused, moved
from safeloc.assurance.margins.moved_world import MovedWorld, in_world_of
from safeloc.assurance.margins.rests_on import RestsOn
from safeloc.codegen.smtlib import Query
from safeloc.errors import InputError
from safeloc.language.expr import FALSE
from safeloc.language.interpret import taken
from safeloc.language.nodes import Value
from safeloc.language.renamed import hint
from safeloc.language.spec import Property, observe
from safeloc.language.system import TransitionSystem, environment, in_range
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Vacuous, Violated
from safeloc.proof.provers.along import along
from safeloc.proof.provers.bmc import search
from safeloc.proof.provers.implication import unproved
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove_one
from safeloc.target import Target

Where = Literal["world", "design"]
"""Where a figure moves: in the world alone, while the machine keeps its configuration; or in machine, world and claims alike."""

UNMOVED = "nothing in the world depends on it"
_ALONG_SHARE, _QUICK_SHARE, _MORE_SHARE = 0.3, 0.5, 0.3
"""Shares of a claim's limit for a run along the way of another one, for a first short search, and for one after all engines."""
_KNOWN_SHARE = 0.1
"""Share of a claim's limit for a run along the way of one that is known."""
_QUICK_STEPS = 5
"""Steps of the runs of the short search."""
_MORE_STEPS = 100
"""Steps of the runs of the search after all engines: where figures count cycles, a run that breaks a claim is longer than they are."""
_AGAIN = 4
"""Multiple of a claim's limit where a value that was not decided is asked again."""


@dataclass(frozen=True)
class Answer:
    """The answer for one value of a figure: whether all claims hold.

    end     proved: each claim was; broken: a run breaks `claim`; undecided: `claim` was not decided within the limits;
            vacuous: nothing breaks `claim`, but it says nothing at this value, for the reason `why`;
            refused: the configuration or the machine does not take the value, for the reason `why`
    first, inputs  of a run that breaks a claim: its first state, and the inputs of every cycle
    """

    end: Literal["proved", "broken", "undecided", "vacuous", "refused"]
    claim: str = ""
    why: str = ""
    first: Mapping[str, Value] | None = None
    inputs: tuple[Mapping[str, Value], ...] = ()


@dataclass(frozen=True)
class Way:
    """A run that broke a claim at some values: its first state, and the inputs of every cycle."""

    claim: str
    first: Mapping[str, Value]
    inputs: tuple[Mapping[str, Value], ...]


_Values = tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class _Run:
    """A run that breaks a claim."""

    claim: str
    trace: Trace


class Asking:
    """Asks about one target; an answer is kept.

    rests_on  what of the world each claim rests on, as far as it is known: a claim that rests on nothing that has moved is not
              asked again

    The claim that broke last is asked first, and at first that of the interval.
    """

    def __init__(
        self,
        target: Target,
        where: Where,
        limits: Limits,
        only: Iterable[str] = (),
        rests_on: Mapping[str, RestsOn | None] | None = None,
        ways: Sequence[Way] = (),
    ) -> None:
        self._target, self._where, self._limits = target, where, limits
        self._only, self._rests_on = frozenset(only), rests_on or {}
        self._answers: dict[_Values, Answer] = {}
        self._runs: dict[_Values, _Run] = {}
        self._made: dict[_Values, Target | str] = {}
        self._worlds: dict[_Values, MovedWorld] = {}
        self._broke_last, self._ways = HOLDS, ways
        self._asked_again: set[_Values] = set()

    def refusal(self, values: Mapping[str, int]) -> str:
        """Return the reason why the machine cannot be made at these values; "" if it can."""
        made = self._at(_key(values))
        return made if isinstance(made, str) else ""

    def answer(self, values: Mapping[str, int]) -> Answer:
        """Return whether all claims hold with these figures at these values."""
        key = _key(values)
        if key not in self._answers:
            self._answers[key] = self._asked(key)
        return self._answers[key]

    def again(self, values: Mapping[str, int]) -> Answer:
        """Return the answer for these values; one that is undecided is asked again, once, with a longer limit."""
        key = _key(values)
        if self.answer(values).end == "undecided" and key not in self._asked_again:
            self._asked_again.add(key)
            patient = replace(self._limits, seconds=_AGAIN * self._limits.seconds)
            asked = self._claims_at(key)
            self._answers[key] = asked if isinstance(asked, Answer) else self._of_claims(*asked, key, patient)
        return self._answers[key]

    def quickly(self, values: Mapping[str, int]) -> bool:
        """Return whether a short search finds a run at these values that breaks the claim which is asked first."""
        key = _key(values)
        asked = self._claims_at(key) if key not in self._answers else self._answers[key]
        if not isinstance(asked, Answer) and asked[1]:
            system, [first, *_] = asked[0], self._in_order(asked[1])
            run = search(
                observe(system, replace(first, kept_by=None)), replace(self._share(_QUICK_SHARE), depth=_QUICK_STEPS)
            )
            if isinstance(run, Trace):
                self._answers[key] = self._broken(first, run, key)
        return key in self._answers and self._answers[key].end == "broken"

    def along_known(self, values: Mapping[str, int]) -> bool:
        """Return whether a run breaks a claim at these values along the way of a run that broke one at other figures.

        Figures of one law are broken in one way, so that this is often the quickest answer.
        """
        key = _key(values)
        if key in self._answers:
            return self._answers[key].end == "broken"
        asked = self._claims_at(key)
        if isinstance(asked, Answer):
            return False
        system, every = asked
        by_name = {prop.name: prop for prop in every}
        for way in self._ways:
            prop = by_name.get(way.claim)
            trace = None if prop is None else self._run_of(way)
            if prop is not None and trace is not None:
                goal = observe(system, replace(prop, kept_by=None))
                run = along(goal, trace, self._share(_KNOWN_SHARE))
                if run is not None:
                    self._answers[key] = self._broken(prop, run, key)
                    return True
        return False

    def _run_of(self, way: Way) -> Trace | None:
        """Return the run of a way; None where this machine does not take its inputs."""
        system = self._target.system
        values = {var: way.first[var.name] for var in system.state if var.name in way.first}
        if len(values) < len(system.state):
            return None
        try:
            steps = tuple(step for step, _ in taken(system, values, way.inputs))
        except InputError:
            return None
        return Trace(system, dict(way.first), steps)

    def along(self, values: Mapping[str, int], broken_at: Mapping[str, int]) -> bool:
        """Return whether a run breaks a claim at these values along the way of the run that breaks it at others.

        If so, this run is the answer at these values.
        """
        key, known = _key(values), self._runs[_key(broken_at)]
        if key in self._answers:
            return self._answers[key].end == "broken"
        asked = self._claims_at(key)
        if isinstance(asked, Answer):
            return False
        system, every = asked
        limits = self._share(_ALONG_SHARE)
        for prop in every:
            if prop.name == known.claim:
                run = along(observe(system, replace(prop, kept_by=None)), known.trace, limits)
                if run is not None:
                    self._answers[key] = self._broken(prop, run, key)
        return key in self._answers

    def _at(self, key: _Values) -> Target | str:
        if key not in self._made:
            try:
                self._made[key] = moved(self._target, dict(key))
            except Refused as error:
                self._made[key] = str(error)
        return self._made[key]

    def _asked(self, key: _Values) -> Answer:
        asked = self._claims_at(key)
        return asked if isinstance(asked, Answer) else self._of_claims(*asked, key, self._limits)

    def _claims_at(self, key: _Values) -> tuple[TransitionSystem, list[Property]] | Answer:
        """Return the system at these values with the claims that are open there; an answer if there is nothing to ask."""
        made = self._at(key)
        if isinstance(made, str):
            return Answer("refused", why=made)
        if self._where == "design":
            return made.system, self._chosen(claims_of(made))
        try:
            world = self._world(key, made)
        except Refused as error:
            return Answer("refused", why=str(error))
        if not world.differs:
            return Answer("proved", why=UNMOVED)
        moved_claims = [prop for prop in self._chosen(claims_of(self._target)) if self._may_move(prop, world)]
        if not moved_claims:
            return Answer("proved", why="no proof of a claim rests on what it moves")
        if not world.moves and world.ranges_are_within and self._allows_no_more(world):
            if self._allows_nothing(world.system):
                return Answer("vacuous", moved_claims[0].name, "the world allows no cycle at all")
            return Answer("proved", why="the world allows nothing that it did not allow before")
        return world.system, [world.claim(prop) for prop in moved_claims]

    def _world(self, key: _Values, made: Target) -> MovedWorld:
        if key not in self._worlds:
            self._worlds[key] = in_world_of(self._target.system, made.system)
        return self._worlds[key]

    def _may_move(self, prop: Property, world: MovedWorld) -> bool:
        rests = self._rests_on.get(prop.name)
        return rests is None or rests.is_moved_by(world)

    def _allows_no_more(self, world: MovedWorld) -> bool:
        """True if the assumption implies the original one: what was proved of the original holds here too."""
        system = world.system
        hypotheses = [in_range(system.state), environment(system)]
        original = world.before(self._target.system.assume)
        query = Query(f"{system.name}: the moved world allows no more", hypotheses, {"": original})
        return not unproved(query, self._limits.seconds)

    def _allows_nothing(self, system: TransitionSystem) -> bool:
        """True if no first cycle obeys the assumption."""
        hypotheses = [in_range(system.state), system.init, environment(system)]
        query = Query(f"{system.name}: the moved world allows no cycle", hypotheses, {"": FALSE})
        return not unproved(query, self._limits.seconds)

    def _chosen(self, every: Iterable[Property]) -> list[Property]:
        return [prop for prop in every if not self._only or prop.name in self._only]

    def _in_order(self, every: Iterable[Property]) -> list[Property]:
        return sorted(every, key=lambda one: one.name != self._broke_last)

    def _share(self, share: float) -> Limits:
        return replace(self._limits, seconds=self._limits.seconds * share)

    def _of_claims(self, system: TransitionSystem, every: Iterable[Property], key: _Values, limits: Limits) -> Answer:
        for prop in self._in_order(self._chosen(every)):
            goal = observe(system, replace(prop, kept_by=None))
            verdict = prove_one(goal, limits)
            if isinstance(verdict, Proved):
                continue
            if isinstance(verdict, Vacuous):
                return Answer("vacuous", prop.name, verdict.reason)
            run = verdict.trace if isinstance(verdict, Violated) else None
            more = replace(limits, seconds=limits.seconds * _MORE_SHARE, depth=_MORE_STEPS)
            found = search(goal, more) if run is None else run
            if isinstance(found, Trace):
                return self._broken(prop, found, key)
            self._broke_last = prop.name
            return Answer("undecided", prop.name)
        return Answer("proved")

    def _broken(self, prop: Property, run: Trace, key: _Values) -> Answer:
        self._broke_last, self._runs[key] = prop.name, _Run(prop.name, run)
        inputs = tuple(dict(step.inputs) for step in run.steps)
        return Answer("broken", prop.name, first=dict(run.initial), inputs=inputs)


def _key(values: Mapping[str, int]) -> _Values:
    return tuple(sorted(values.items()))


def chosen_claims(target: Target, names: list[str] | None) -> list[str]:
    """Return the names of the claims to ask; InputError for a name that the target does not have."""
    known = [one.name for one in claims_of(target)]
    for name in names or ():
        if name not in known:
            raise InputError(f"{target.name} has no claim {name!r}; it has {', '.join(known)}.{hint(name, known)}")
    return known if names is None else names
