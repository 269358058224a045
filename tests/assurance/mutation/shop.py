"""The small machine with all its mutants, and what becomes of them; made once."""

from __future__ import annotations

from functools import cache

from safeloc.assurance.mutation.declared import Declared, declared
from safeloc.assurance.mutation.judge_machine_mutant import Bench, bench, judged
from safeloc.assurance.mutation.mutants import Mutant, mutants
from safeloc.assurance.mutation.places import Places, noted
from safeloc.assurance.mutation.results import Judged
from safeloc.proof.provers.limits import Limits
from safeloc.target import Target

SPEC = "tests.assurance.mutation.brake:machine"


@cache
def loaded() -> tuple[Target, Declared, Places]:
    """The target, its declaration, and where its terms are written."""
    with noted() as places:
        target, whole = declared(SPEC)
    return target, whole, places


@cache
def every() -> tuple[Mutant, ...]:
    """All mutants."""
    _, whole, places = loaded()
    return tuple(mutants(whole, places))


def mutant(kind: str, words: str, where: str = "") -> Mutant:
    """The one mutant of this kind, words and place."""
    [found] = [
        one
        for one in every()
        if (one.kind, one.words) == (kind, words) and (not where or any(where in name for name in one.where))
    ]
    return found


@cache
def known() -> Bench:
    """The machine as it is, proved and run."""
    target, whole, _ = loaded()
    return bench(target, whole, Limits(seconds=2), 0)


def outcome(kind: str, words: str, where: str = "") -> Judged:
    """What becomes of a mutant."""
    return judged(known(), mutant(kind, words, where))
