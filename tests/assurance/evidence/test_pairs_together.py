"""Pairs of clauses decided by few proofs: the same pairs as if each was asked by itself."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import pytest

from safeloc.assurance.evidence.pairs_together import harmless_together
from safeloc.proof.cores.clauses import ClauseId

ONE, OTHER = ([ClauseId(name, f"clause {number}") for number in range(8)] for name in ("one", "other"))


class Harm:
    """Some pairs do harm; so does every set that contains one of them."""

    def __init__(self, pairs: Sequence[tuple[ClauseId, ClauseId]]) -> None:
        self._pairs, self.asked = list(map(set, pairs)), list[tuple[ClauseId, ...]]()

    def are_proved(self, sets: Sequence[tuple[ClauseId, ...]]) -> list[bool]:
        """What a prover would say."""
        self.asked += sets
        return [not any(pair <= set(one) for pair in self._pairs) for one in sets]


def different() -> list[tuple[ClauseId, ...]]:
    """The pairs of clauses of different machines."""
    return [(one, other) for one in ONE for other in OTHER]


def test_one_proof_may_do() -> None:
    """Without all clauses nothing happens: no pair is asked."""
    harm = Harm([])
    assert set(different()) == harmless_together(different(), harm.are_proved)
    assert [(*ONE, *OTHER)] == [tuple(sorted(one)) for one in harm.asked]


@pytest.mark.parametrize("number", [1, 2])
def test_what_does_harm_is_left(number: int) -> None:
    """All other pairs are proved, by far fewer questions than there are pairs; a single pair is never asked."""
    bad = [(ONE[3], OTHER[5]), (ONE[6], OTHER[0])][:number]
    harm = Harm(bad)
    found = harmless_together(different(), harm.are_proved)
    assert found <= set(different()) - set(bad)
    assert 3 * number >= len(set(different()) - set(bad) - found)
    assert 24 >= len(harm.asked)
    assert all(len(one) > 2 for one in harm.asked)


def test_pairs_of_one_machine() -> None:
    """The whole set is divided into halves, and what stands between them."""
    pairs, bad = list(combinations(ONE, 2)), (ONE[0], ONE[7])
    found = harmless_together(pairs, Harm([bad]).are_proved)
    assert bad not in found
    assert len(pairs) - 3 <= len(found)


def test_pairs_that_are_not_asked_do_not_count() -> None:
    """Harm of two clauses of one machine says nothing of pairs of different ones."""
    harm = Harm([(ONE[1], ONE[2])])
    found = harmless_together(different(), harm.are_proved)
    assert set(different()) - found <= {(one, other) for one in ONE[1:3] for other in OTHER}
    assert {(ONE[0], other) for other in OTHER} <= found


def test_no_pairs() -> None:
    """Nothing is asked."""
    harm = Harm([])
    assert set() == harmless_together([], harm.are_proved)
    assert [] == harm.asked
