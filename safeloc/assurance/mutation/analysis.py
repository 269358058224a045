"""Mutation analysis of one target: choose its mutants, judge them, and find the written reasons for survivors."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from safeloc.assurance.mutation.choosing import by_id, chosen, judge
from safeloc.assurance.mutation.composed_work import JudgingComposed, parts
from safeloc.assurance.mutation.declared import declared_of
from safeloc.assurance.mutation.members import composed
from safeloc.assurance.mutation.places import Places
from safeloc.assurance.mutation.reasons import Reasons
from safeloc.assurance.mutation.results import Judged, Of
from safeloc.assurance.mutation.work import Judging, OnJudged, Plan
from safeloc.errors import InputError
from safeloc.proof.cache.store import Store
from safeloc.target import Target


@dataclass(frozen=True, eq=False)
class Analysed:
    """The judged mutants, the number of all mutants from which they were chosen, and the written reasons by id."""

    judged: Sequence[Judged]
    of: int
    reasons: Mapping[str, str]


@dataclass(frozen=True, eq=False)
class Analysis:
    """A mutation analysis of one target.

    places     the places of its terms, noted while it was loaded
    most       judge at most so many mutants, each kind in its share; None: all
    only       judge only the mutants with these ids; empty: all
    reasons    reasons why no proof needs to notice a mutant
    on_begin   called with the number of mutants to judge, before the first is judged
    on_judged  called with the result of each mutant as soon as it is judged
    look_in    store with results of earlier runs; None: none is used
    keep_in    store for each new result
    """

    target: Target
    places: Places
    plan: Plan
    reasons: Reasons
    on_begin: Callable[[int], None]
    on_judged: OnJudged
    most: int | None = None
    only: Sequence[str] = ()
    look_in: Store | None = None
    keep_in: Store | None = None

    def of(self, asked: Sequence[Of]) -> Analysed:
        """Judge mutants of these parts of the declaration. InputError for an unknown id, and for a part that a composition has not."""
        return self._of_composition(asked) if self.target.system.parts else self._of_machine(asked)

    def _of_machine(self, asked: Sequence[Of]) -> Analysed:
        declared, seed = declared_of(self.target), self.plan.seed
        some = (
            by_id(declared, self.places, self.only, most=self.most, seed=seed)
            if self.only
            else chosen(declared, self.places, asked, most=self.most, seed=seed)
        )
        why = self.reasons.of(some.existing)
        self.on_begin(some.number)
        judging = Judging(self.target, declared, self.plan, self.on_judged, self.look_in, self.keep_in)
        return Analysed(judge(judging, some), some.of, why)

    def _of_composition(self, asked: Sequence[Of]) -> Analysed:
        made = composed(self.target, self.places)
        if [*asked] != ["machine"]:
            raise InputError(
                f"{self.target.name} is a composition: only its machines and wires are made wrong. For worlds and claims "
                f"give one of its machines: {', '.join(made.members)}."
            )
        some = parts(made, self.places, most=self.most, seed=self.plan.seed, only=self.only)
        why = self.reasons.of({"machine": some.existing})
        self.on_begin(some.number)
        judging = JudgingComposed(made, self.plan, self.on_judged, self.look_in, self.keep_in)
        return Analysed(judging.all(some), some.of, why)
