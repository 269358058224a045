"""Ask whether every claim of a target still holds with figures at other values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

from safeloc.assurance.evidence.interval import HOLDS, claims_of
from safeloc.assurance.margins.figures import Refused, moved
from safeloc.assurance.margins.moved_world import in_world_of
from safeloc.codegen.smtlib import Query
from safeloc.errors import InputError
from safeloc.language.nodes import Value
from safeloc.language.renamed import hint
from safeloc.language.spec import Property, observe
from safeloc.language.system import TransitionSystem, environment, in_range
from safeloc.language.verdict import Proved, Violated
from safeloc.proof.provers.implication import unproved
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove_one
from safeloc.target import Target

Where = Literal["world", "design"]
"""Where a figure moves: in the world alone, while the machine keeps its configuration; or in machine, world and claims alike."""

UNMOVED = "nothing in the world depends on it"


@dataclass(frozen=True)
class Answer:
    """Whether all claims hold at one value of a figure.

    end     proved: each claim was; broken: a run breaks `claim`; undecided: `claim` was not decided within the limits;
            refused: the configuration or the machine does not take the value, for the reason `why`
    first, inputs  of a run that breaks a claim: its first state, and the inputs of every cycle
    """

    end: Literal["proved", "broken", "undecided", "refused"]
    claim: str = ""
    why: str = ""
    first: Mapping[str, Value] | None = None
    inputs: tuple[Mapping[str, Value], ...] = ()


class Asking:
    """Asks about one target; an answer is kept. The claim that broke last is asked first, and at first that of the interval."""

    def __init__(self, target: Target, where: Where, limits: Limits, only: Iterable[str] = ()) -> None:
        self._target, self._where, self._limits = target, where, limits
        self._only = frozenset(only)
        self._answers: dict[tuple[tuple[str, int], ...], Answer] = {}
        self._made: dict[tuple[tuple[str, int], ...], Target | str] = {}
        self._broke_last = HOLDS

    def as_it_is(self) -> Answer:
        """Return whether all claims hold with the figures as they are: without this there is no margin to find."""
        return self._of_claims(self._target.system, claims_of(self._target))

    def refusal(self, values: Mapping[str, int]) -> str:
        """Return the reason why the machine cannot be made at these values; "" if it can."""
        made = self._at(values)
        return made if isinstance(made, str) else ""

    def answer(self, values: Mapping[str, int]) -> Answer:
        """Return whether all claims hold with these figures at these values."""
        key = tuple(sorted(values.items()))
        if key not in self._answers:
            self._answers[key] = self._asked(values)
        return self._answers[key]

    def _at(self, values: Mapping[str, int]) -> Target | str:
        key = tuple(sorted(values.items()))
        if key not in self._made:
            try:
                self._made[key] = moved(self._target, values)
            except Refused as error:
                self._made[key] = str(error)
        return self._made[key]

    def _asked(self, values: Mapping[str, int]) -> Answer:
        made = self._at(values)
        if isinstance(made, str):
            return Answer("refused", why=made)
        if self._where == "design":
            return self._of_claims(made.system, claims_of(made))
        try:
            world = in_world_of(self._target.system, made.system)
        except Refused as error:
            return Answer("refused", why=str(error))
        if not world.differs:
            return Answer("proved", why=UNMOVED)
        if not world.moves and not world.ranges and self._allows_no_more(world.system):
            return Answer("proved", why="the world allows nothing that it did not allow before")
        return self._of_claims(world.system, map(world.claim, claims_of(self._target)))

    def _allows_no_more(self, system: TransitionSystem) -> bool:
        """True if the assumption implies the original one: what was proved of the original holds here too."""
        given = [in_range(system.state), environment(system)]
        query = Query(f"{system.name}: the moved world allows no more", given, {"": self._target.system.assume})
        return not unproved(query, self._limits.seconds)

    def _of_claims(self, system: TransitionSystem, every: Iterable[Property]) -> Answer:
        asked = [prop for prop in every if not self._only or prop.name in self._only]
        for prop in sorted(asked, key=lambda one: one.name != self._broke_last):
            verdict = prove_one(observe(system, replace(prop, kept_by=None)), self._limits)
            if isinstance(verdict, Violated) and verdict.trace is not None:
                self._broke_last = prop.name
                inputs = tuple(dict(step.inputs) for step in verdict.trace.steps)
                return Answer("broken", prop.name, first=dict(verdict.trace.initial), inputs=inputs)
            if not isinstance(verdict, Proved):
                self._broke_last = prop.name
                return Answer("undecided", prop.name)
        return Answer("proved")


def chosen_claims(target: Target, names: list[str] | None) -> list[str]:
    """Return the names of the claims to ask; InputError for a name that the target does not have."""
    known = [one.name for one in claims_of(target)]
    for name in names or ():
        if name not in known:
            raise InputError(f"{target.name} has no claim {name!r}; it has {', '.join(known)}.{hint(name, known)}")
    return known if names is None else names
