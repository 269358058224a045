"""Pairs of clauses decided together: what is proved without a set of clauses holds without every pair of them.

A proof that assumes less is a proof for all worlds that assume more. So a first question leaves out all clauses that alone do no
harm. Where it is not proved, the set is divided: into the machines of a composition, then into halves, until a block of pairs is
proved, or is a single pair, which is then judged by itself.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

from safeloc.proof.cores.clauses import ClauseId

Clauses = tuple[ClauseId, ...]
AreProved = Callable[[Sequence[Clauses]], Sequence[bool]]
"""Whether no harm is done without these clauses, for each of several sets of clauses."""


@dataclass(frozen=True)
class _Block:
    """The pairs of a clause of `first` with one of `second`; if both are the same, the pairs of two of them."""

    first: Clauses
    second: Clauses

    @property
    def clauses(self) -> Clauses:
        """All clauses of the block."""
        return tuple(dict.fromkeys((*self.first, *self.second)))

    def pairs(self) -> Iterator[Clauses]:
        """Yield the pairs."""
        if self.first == self.second:
            yield from combinations(self.first, 2)
        else:
            yield from ((one, other) for one in self.first for other in self.second)

    def parts(self) -> Iterator[_Block]:
        """Yield smaller blocks with the same pairs."""
        if self.first == self.second:
            one, other = _halves(self.first)
            yield from (_Block(one, one), _Block(other, other), _Block(one, other))
        elif len(self.first) >= len(self.second):
            yield from (_Block(half, self.second) for half in _halves(self.first))
        else:
            yield from (_Block(self.first, half) for half in _halves(self.second))


def harmless_together(pairs: Collection[Clauses], are_proved: AreProved) -> set[Clauses]:
    """Return those of the pairs that are proved to do no harm by a proof for a greater set."""
    wanted = {frozenset(pair): pair for pair in pairs}
    every = tuple(dict.fromkeys(one for pair in pairs for one in pair))
    found, waiting, following = set[Clauses](), [_Block(every, every)], _by_machine(every)
    while waiting:
        asked = [block for block in waiting if sum(frozenset(pair) in wanted for pair in block.pairs()) > 1]
        left = list[_Block]()
        for block, is_proved in zip(
            asked, are_proved([block.clauses for block in asked]) if asked else (), strict=True
        ):
            if is_proved:
                found |= {wanted[key] for pair in block.pairs() if (key := frozenset(pair)) in wanted}
            else:
                left.append(block)
        waiting = following if left and following else [part for block in left for part in block.parts()]
        following = []
    return found


def _by_machine(every: Clauses) -> list[_Block]:
    """Return a block for each machine and each two machines; none if there is one machine only."""
    groups: dict[str, list[ClauseId]] = defaultdict(list)
    for one in every:
        groups[one.machine].append(one)
    some = [tuple(group) for group in groups.values()]
    alone = [_Block(group, group) for group in some]
    return [*alone, *(_Block(*two) for two in combinations(some, 2))] if len(some) > 1 else []


def _halves(clauses: Clauses) -> tuple[Clauses, Clauses]:
    middle = len(clauses) // 2
    return clauses[:middle], clauses[middle:]
