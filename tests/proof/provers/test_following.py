"""The goals of a query that follow: the same query is not solved again, and nothing that is kept proves a goal by itself."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import number
from safeloc.language.units import MM
from safeloc.proof.cache.answers import keep_proved, keep_unproved, kept_in, unproved_before
from safeloc.proof.cache.store import Store
from safeloc.proof.provers import implication, limits
from safeloc.proof.provers.implication import Failure, following, text_of, unproved

A, B, C = (number(name, MM, -1000, 1000) for name in "abc")
SECONDS = 5.0
HYPOTHESES = [A < B, B < C]


def query(**more: Any) -> Query[str]:
    """Two goals that follow, and two that do not."""
    return Query("some", HYPOTHESES, {"one": A < C, "no": C < A, "two": A + 1 < C, "nor": B > 0, **more})


@pytest.fixture(name="asked")
def _asked(monkeypatch: pytest.MonkeyPatch) -> list[Query[str]]:
    """The queries that z3 was asked."""
    found, ours = list[Query[str]](), implication._failures

    def counted(one: Query[str], *arguments: float) -> Mapping[str, Failure]:
        found.append(one)
        return ours(one, *arguments)  # type: ignore[arg-type]  # as they came

    monkeypatch.setattr(implication, "_failures", counted)
    return found


def test_a_query_is_solved_once(tmp_path: Path, asked: list[Query[str]]) -> None:
    """The second time the proof of those that follow answers it; another query is another question."""
    assert following(query(), SECONDS) == {"one", "two"} == following(query(), SECONDS)
    assert len(asked) == 2
    with kept_in(Store(tmp_path)):
        assert following(query(), SECONDS) == {"one", "two"} == following(query(), SECONDS)
        assert len(asked) == 3
        assert following(query(third=A < B), SECONDS) == {"one", "two", "third"}
        assert len(asked) == 4
        assert unproved(Query("the rest", HYPOTHESES, {"one": A < C, "two": A + 1 < C}), SECONDS) == {}
        assert len(asked) == 4


@pytest.mark.parametrize(
    ("goals", "found"), [({"no": C < A}, set()), ({"one": A < C}, {"one"}), (dict[str, Any](), set())]
)
def test_none_or_all_may_follow(
    tmp_path: Path, asked: list[Query[str]], goals: dict[str, Any], found: set[str]
) -> None:
    with kept_in(Store(tmp_path)):
        for _ in range(2):
            assert following(Query("some", HYPOTHESES, goals), SECONDS) == found
    assert len(asked) == 1


def test_more_effort_asks_again(tmp_path: Path, asked: list[Query[str]]) -> None:
    """What was left with less may follow with more."""
    with kept_in(Store(tmp_path)):
        following(query(), SECONDS)
        following(query(), SECONDS / 2)
        assert len(asked) == 1
        following(query(), SECONDS * 2)
        assert len(asked) == 2


def test_what_is_left_proves_nothing_of_the_others(tmp_path: Path, asked: list[Query[str]]) -> None:
    """With wrong numbers in the cache the query is solved: that the others follow is known by their own proof alone."""
    with kept_in(Store(tmp_path)):
        for numbers in ([], [1], [1, 4]):
            keep_unproved(text_of(query()), SECONDS, numbers)
            assert following(query(), SECONDS) == {"one", "two"}
        assert len(asked) == 3
        keep_unproved(text_of(query()), SECONDS, [0, 1, 2, 3])
        assert following(query(), SECONDS) == set()  # less is excluded, so more is searched


def test_what_the_clock_ended_is_not_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A less busy computer may get farther; what was proved stays."""
    with kept_in(Store(tmp_path)):
        monkeypatch.setattr(limits.Deadline, "overdue", property(lambda _: True))
        assert following(query(), SECONDS) == set()  # nothing was asked in time
        monkeypatch.undo()
        assert unproved_before(text_of(query()), 4, SECONDS) is None
        assert following(query(), SECONDS) == {"one", "two"}


def test_a_proof_of_all_counts_for_both_ways_of_asking(tmp_path: Path, asked: list[Query[str]]) -> None:
    """`unproved` keeps no list of what is left."""
    all_follow = Query("some", HYPOTHESES, {"one": A < C})
    with kept_in(Store(tmp_path)):
        keep_proved(text_of(all_follow))
        assert following(all_follow, SECONDS) == {"one"}
        assert unproved(all_follow, SECONDS) == {}
    assert not asked
