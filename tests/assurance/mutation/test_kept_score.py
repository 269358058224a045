"""The mutation score that a report takes from earlier runs: of the same content, and of the greatest sample."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from safeloc.assurance.mutation.kept_score import SCORES, keep_score, score_data
from safeloc.assurance.mutation.results import EQUIVALENT, SURVIVED, UNPROVED, Judged, Outcome
from safeloc.proof.cache.store import Store
from tests.assurance.mutation.shop import loaded


def one(name: str, fate: str) -> Judged:
    """A mutant with the same outcome in both ways of making it."""
    told = Outcome(fate)
    return Judged(name, "brake", "kind", "words", "f.py:1", "a", "a", "b", ("row",), (), (), told, told, 0.1)


SOME = (one("a", UNPROVED), one("b", UNPROVED), one("c", EQUIVALENT), one("d", SURVIVED), one("e", SURVIVED))
COUNTS = {"mutants": 9, "judged": 5, "wrong": 4, "by_proof": 2, "with_reason": 1, "open": 1}


def test_what_is_counted() -> None:
    """Equivalent ones do not count; of those that no proof notices, one has a reason. Clauses of the world are no machine."""
    law = replace(one("f", SURVIVED), of="world")
    assert COUNTS == score_data((*SOME, law), 9, {"d": "nobody needs it"})


def test_it_is_of_this_content_alone(tmp_path: Path) -> None:
    """A target with one property less has none: a stale score is never shown."""
    store, (target, _, _) = Store(tmp_path), loaded()
    assert {} == SCORES.of_targets(store, [target])
    keep_score(store, target, SOME, 9, {"d": "nobody needs it"})
    found = SCORES.of_targets(store, [target])["brake"]
    assert {**COUNTS, "since": found["since"]} == found
    assert SCORES.kept(store, replace(target, properties=target.properties[1:])) is None


def test_a_smaller_sample_does_not_replace_a_greater_one(tmp_path: Path) -> None:
    """A report in the cache is used until another score is kept; none is kept of a run that judged no machine."""
    store, (target, _, _) = Store(tmp_path), loaded()
    stamps = [SCORES.stamp(store)]
    for few in (0, 3, 5, 4, 5):
        keep_score(store, target, SOME[:few], 9, {})
        stamps.append(SCORES.stamp(store))
    assert "" == stamps[0] == stamps[1]
    assert 3 == len(set(stamps))
    assert stamps[3] == stamps[4] == stamps[5]
    assert 5 == (SCORES.kept(store, target) or {})["judged"]
