"""Shortens a run that was found: messages without which the same still happens are left out of it.

Messages (a marker's reading, a telegram, a radar echo, a fix ...) are left out in halves: of all kinds, then of one kind for all of the
run, then for a part of it. They stay out where the run still shows what it is kept for: in the cycle in question a wrong interval, or one
that is not wrong and has a margin no greater, with the laws kept or broken as before and no further clause broken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from safeloc.campaign.judged import Judge
from safeloc.language.expr import Optional
from safeloc.language.system import TransitionSystem, canonical
from safeloc.simulation.many_runs import Array, ManyRuns

_MOST_TRIED = 300
"""Shorter runs that are tried for one stream."""


@dataclass(frozen=True)
class _Seen:
    """The standing of a run in a cycle: whether an interval is reported, its margin, and the clauses broken so far."""

    told: bool
    margin_nm: int
    broken: frozenset[int]

    def still(self, other: _Seen) -> bool:
        """Return whether the other run shows the same."""
        wrong = self.told and self.margin_nm < 0
        return (
            self.told == other.told
            and (other.margin_nm < 0 if wrong else min(0, self.margin_nm) <= other.margin_nm <= self.margin_nm)
            and bool(self.broken) == bool(other.broken)
            and other.broken <= self.broken
        )


@dataclass(frozen=True)
class _Messages:
    """Messages of one kind in some cycles."""

    kind: Optional
    begin: int
    end: int

    @property
    def halves(self) -> list[_Messages]:
        """Return both halves of the time; the one cycle cannot be halved."""
        middle = (self.begin + self.end) // 2
        both = _Messages(self.kind, self.begin, middle), _Messages(self.kind, middle, self.end)
        return [] if self.begin == middle else list(both)


def shortened(judge: Judge, run: ManyRuns, cycle: int) -> ManyRuns:
    """Return the run of one vehicle, arrays [cycle, 1], without messages that do not matter for what it shows in a cycle."""
    inputs = {name: np.array(values) for name, values in run.inputs.items()}
    return _Shortening(judge, inputs, run, cycle).done()


class _Shortening:
    def __init__(self, judge: Judge, inputs: dict[str, Array], run: ManyRuns, cycle: int) -> None:
        self._judge, self._inputs, self._first, self._cycle = judge, inputs, run.first, cycle
        self._expected, self._left = self._seen(inputs), _MOST_TRIED

    def done(self) -> ManyRuns:
        """Return the run when nothing more can be left out, or enough was tried."""
        length = len(next(iter(self._inputs.values())))
        self._leave_out([_Messages(one, 0, length) for one in self._judge.target.system.optionals])
        return ManyRuns(self._inputs, self._first)

    def _leave_out(self, some: Sequence[_Messages]) -> None:
        some = [one for one in some if self._inputs[one.kind.present.name][one.begin : one.end].any()]
        if not some or self._left == 0 or self._shows_without(some):
            return
        halves = some[0].halves if len(some) == 1 else []
        middle = len(some) // 2
        for part in [[one] for one in halves] if len(some) == 1 else [some[:middle], some[middle:]]:
            self._leave_out(part)

    def _shows_without(self, some: Sequence[_Messages]) -> bool:
        self._left -= 1
        tried = dict(self._inputs)
        for one in some:
            for name, absent in ((one.kind.value.name, canonical(one.kind.value)), (one.kind.present.name, False)):
                tried[name] = tried[name].copy()
                tried[name][one.begin : one.end] = absent
        if not self._expected.still(self._seen(tried)):
            return False
        self._inputs = tried
        return True

    def _seen(self, inputs: dict[str, Array]) -> _Seen:
        found, at = self._judge.outcome(ManyRuns(inputs, self._first)), self._cycle
        broken = np.flatnonzero(~found.held[:, : at + 1, 0].all(axis=1))
        return _Seen(bool(found.told[at, 0]), int(found.margin_nm[at, 0]), frozenset(broken.tolist()))


def messages_of(system: TransitionSystem, run: ManyRuns) -> int:
    """Return the number of messages in a run: cycles of optional inputs that are present."""
    return sum(int(run.inputs[one.present.name].sum()) for one in system.optionals)
