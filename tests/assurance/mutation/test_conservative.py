"""Mutants that are only more careful: proved, and never said of one that reports less than the machine."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

from safeloc.assurance.mutation.declared import Declared, remade
from safeloc.assurance.mutation.judge_machine_mutant import Bench, bench, judged
from safeloc.assurance.mutation.mutants import Mutant, mutants
from safeloc.assurance.mutation.places import Places
from safeloc.assurance.mutation.results import Outcome, score
from safeloc.language.expr import Expr
from safeloc.proof.provers.limits import Limits
from safeloc.target import Target
from tests.assurance.evidence.receivers import MARGIN, MODE, target

LIMITS = Limits(seconds=2)


def benched(whole: Target, **outputs: Expr) -> tuple[Bench, list[Mutant]]:
    """The receivers with further outputs, and their mutants."""
    machine = remade(whole.machines[0], outputs={**whole.machines[0].outputs, **outputs})
    made = Declared(machine, whole.properties)
    return bench(whole, made, LIMITS, 0), mutants(made, Places())


@cache
def plain() -> tuple[Bench, list[Mutant]]:
    """The receivers as they are."""
    return benched(target())


def fate(of: tuple[Bench, list[Mutant]], words: str, where: str, term: str = "") -> str:
    """What becomes of the one mutant."""
    on, every = of
    [one] = [one for one in every if one.words == words and where in str(one.where) and term in one.term]
    return judged(on, one).alone.fate


@pytest.mark.parametrize(
    ("words", "where"),
    [("1 becomes 2", "update of margin_mm"), ("8 becomes 9", "row 'fixed'"), ("to LOST instead of LOCATED", "run on")],
)
def test_wider_or_earlier_withdrawn(words: str, where: str) -> None:
    """A margin that grows faster, is wider from the beginning, or is given up at once: proved to be more careful."""
    assert "conservative" == fate(plain(), words, where)


@pytest.mark.parametrize(
    ("words", "where", "term"),
    [
        ("3 becomes 4", "guard of 'fixed'", ""),
        ("first_mm becomes second_mm", "row 'fixed'", "place_mm"),
        ("always the second", "output margin_below_mm", ""),
    ],
)
def test_less_careful_or_elsewhere(words: str, where: str, term: str) -> None:
    """Believing receivers that hardly agree, another place, and no margin at all are no care."""
    assert "survived" == fate(plain(), words, where, term)


def test_other_outputs_stay_the_same() -> None:
    """An output beside the interval is the same wherever both report or neither does; the mode is, the margin is not."""
    wider, earlier = ("8 becomes 9", "row 'fixed'"), ("<= becomes <", "'run on'", "margin_mm + 1 mm")
    assert "survived" == fate(benched(target(), margin=MARGIN), *wider)
    assert "conservative" == fate(benched(target(), mode_now=MODE), *earlier)


def test_without_an_interval_nothing_is_careful() -> None:
    """A target that reports none has no such verdict."""
    assert "survived" == fate(benched(replace(target(), reported=None)), "8 becomes 9", "row 'fixed'")


def test_it_is_not_counted_as_wrong() -> None:
    """Like an equivalent one: it is no wrong machine as far as safety goes."""
    told = score([Outcome("conservative"), Outcome("survived"), Outcome("equivalent"), Outcome("refuted by a run")])
    assert (1, 1, 2, 2, 0.5) == (told.conservative, told.equivalent, told.set_aside, told.asked, told.share)
