"""A composition with a lemma that is not proved: claims are tried by induction, and what is left is searched in one search."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.language.composition import compose
from safeloc.language.expr import TRUE
from safeloc.language.spec import Property, always, reachable
from safeloc.language.system import lower
from safeloc.language.verdict import Proved, Unknown, Verdict, Violated
from safeloc.proof.provers import portfolio
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.without_lemmas import search_limits, searched_together
from tests.proof.provers.test_inherited import Chain

LOST = Chain(limit=10, assumed=5)
"""The source rises to 10 by steps of 3; that it stays below 5 is a contract that is not kept."""


def claims(chain: Chain) -> list[Property]:
    """That what is kept stays below a bound, for three bounds, of which 20 is the range."""
    kept = chain.whole.of(chain.follower)
    return [
        always(f"at most {most}", kept.bool(chain.kept <= most), unconditional=free)
        for free in (True, False)
        for most in ((5, 9, 20) if free else (4,))
    ]


def verdicts(chain: Chain, *, depth: int = 8) -> dict[str, Verdict]:
    """What is said of the claims, by name."""
    found = portfolio.prove(chain.whole.system, claims(chain), Limits(depth=depth, induction=1))
    return {one.id.rpartition("/")[2]: one.result for one in found if "/property/" in one.id}


@pytest.fixture
def no_engines(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever asks the engines in turn gets no answer."""
    monkeypatch.setattr(portfolio, "_ENGINES", ())


@pytest.mark.usefixtures("no_engines")
def test_claims_are_decided_without_the_engines_in_turn() -> None:
    """A proof by induction, and the shortest run to each of the others, for all inputs and under the assumption."""
    told = verdicts(LOST)
    assert isinstance(told["at most 20"], Proved)
    runs = {name: one.trace for name, one in told.items() if isinstance(one, Violated)}
    assert {name: None if run is None else len(run.steps) for name, run in runs.items()} == {
        "at most 4": 2,
        "at most 5": 2,
        "at most 9": 4,
    }


@pytest.mark.usefixtures("no_engines")
def test_what_is_not_found_is_undecided_and_says_why() -> None:
    """The reason names what was tried: induction without some lemmas, and the length of the runs that were searched."""
    undecided = verdicts(LOST, depth=3)["at most 9"]
    assert isinstance(undecided, Unknown)
    assert undecided.reason.startswith("k-induction without some lemmas: ")
    assert undecided.reason.endswith("; no run of up to 3 steps breaks it")


@pytest.mark.usefixtures("no_engines")
def test_with_all_lemmas_the_engines_are_asked_in_turn() -> None:
    """Nothing is missing, so each claim has its own limit."""
    assert {type(one) for one in verdicts(Chain(limit=5, assumed=5)).values()} == {Unknown}


def test_what_follows_from_a_lost_lemma_is_searched_for_a_short_time() -> None:
    """Of a composition alone; the re-check of a proof has all of the limit."""
    limits = Limits(seconds=20.0)
    assert search_limits(Chain(limit=5, assumed=5).whole.system, limits) == limits
    [rise] = LOST.source.transitions
    broken = replace(LOST.source, transitions=[replace(rise, when=TRUE)])
    whole = compose("chain", [broken, LOST.follower], {LOST.seen: broken.output("level")})
    assert search_limits(lower(broken), limits) == limits
    short = search_limits(whole.system, limits)
    assert (short.seconds, short.recheck_seconds) == (2.0, 20.0)


def test_which_claims_are_searched_together() -> None:
    """Those of a composition; neither what can be reached nor a claim with a further assumption, whose runs are others."""
    kept = LOST.whole.of(LOST.follower).bool(LOST.kept <= 5)
    plain, more = (
        always("plain", kept),
        always("more", kept, further_assumption=LOST.whole.of(LOST.source).bool(LOST.level < 5)),
    )
    assert searched_together(LOST.whole.system, [plain, more, reachable("reached", kept)]) == {plain}
    assert not searched_together(lower(LOST.source), [always("alone", LOST.level < 5)])
