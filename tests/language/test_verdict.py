"""Verdicts: no truth value, ordered from worst to best, and impossible to overlook."""

from __future__ import annotations

import pytest

from safeloc.errors import NotProvedError, TruthValueError
from safeloc.language.expr import TRUE, boolean
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import lower
from safeloc.language.verdict import (
    WORST_FIRST,
    Held,
    NotAsked,
    Proved,
    Result,
    Unknown,
    Vacuous,
    Verdict,
    Violated,
    require_proved,
    word,
    worst,
)

OFF, ON = modes("OFF", "ON")
PUSHED = boolean("pushed")
LAMP = Machine("lamp", (OFF, ON), [PUSHED], {}, {}, [Transition("light", OFF, ON, PUSHED)])
TRACE = run(lower(LAMP), [{"pushed": False}, {"pushed": True}])
RESULTS: tuple[Result, ...] = (
    Violated(TRACE, "bmc"),
    Unknown("time"),
    Vacuous("never happens"),
    NotAsked("no property"),
    Held("runs", 3, 40),
    Proved(TRUE, "spacer"),
)


@pytest.mark.parametrize("result", RESULTS, ids=word)
def test_a_verdict_has_no_truth_value(result: Result) -> None:
    """`if verdict:` raises and names the remedy."""
    with pytest.raises(TruthValueError, match="match on Proved, Held, Unknown, Violated or call require_proved"):
        bool(result)


def test_words_and_their_order() -> None:
    """Each verdict has its word; the order is from worst to best."""
    assert tuple(word(result) for result in RESULTS) == WORST_FIRST


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ([], "not asked"),
        (["proved", "held", "not asked"], "not asked"),
        (["not asked", "vacuous"], "vacuous"),
        (["vacuous", "unknown"], "unknown"),
        (["proved", "held"], "held"),
        (["held", "unknown", "proved"], "unknown"),
        (["unknown", "violated"], "violated"),
    ],
)
def test_the_headline_is_the_worst(words: list[str], expected: str) -> None:
    """One violation outweighs everything; a report of nothing was not asked anything."""
    assert worst(words) == expected


def test_an_unknown_word_is_no_verdict() -> None:
    """A misspelt verdict is refused, never taken for a good one."""
    with pytest.raises(ValueError, match=r"fine|not in tuple"):
        worst(["proved", "fine"])


def test_require_proved_hands_the_proof_on() -> None:
    """require_proved returns a Proved verdict unchanged."""
    proof = Proved(TRUE, "spacer")
    assert require_proved(proof) is proof


@pytest.mark.parametrize(
    ("verdict", "message"),
    [
        (
            Violated(TRACE, "bmc", "lit by day"),
            "violated (found by bmc) lit by day after 2 steps\n"
            "   0  start  mode=OFF\n"
            "   1  (stay)  [pushed=false]\n"
            "   2  light  [pushed=true]  mode=ON",
        ),
        (Violated(None, "induction", "unreachable"), "violated (found by induction) unreachable"),
        (Unknown("time limit of 5 s", 12), "undecided: time limit of 5 s (no violation up to depth 12)"),
    ],
)
def test_require_proved_raises_with_the_evidence(verdict: Verdict, message: str) -> None:
    """A violation shows its run, an undecided one its reason and depth."""
    with pytest.raises(NotProvedError) as caught:
        require_proved(verdict)
    assert str(caught.value) == message
