"""The search for the cases of a system's properties, made once for all that wait for its outcome."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem
from safeloc.language.verdict import Verdict
from safeloc.proof.provers import antecedents
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.recorded_witnesses import Recording, Witnesses
from safeloc.proof.provers.workers import Lost, Queue


class CaseSearch:
    """The search, in processes of its own. Properties of which a case never occurs are vacuous; until it ends, nobody knows.

    Known runs are looked through first (`begin_known_runs`), which may begin before the base is proved; what is left is searched
    (`begin_search`).
    """

    def __init__(
        self,
        system: TransitionSystem,
        properties: Sequence[Property],
        limits: Limits,
        recordings: Sequence[Recording],
        witnesses: Witnesses,
    ) -> None:
        self._system, self.properties, self._limits = system, properties, limits
        self._recordings, self._witnesses = recordings, witnesses
        self._seconds: float | None = None
        self._waiting = list[Callable[[float], None]]()
        self._shown: Mapping[int, antecedents.Outcome] | None = None
        self._search_asked = False

    @property
    def known_runs(self) -> list[Recording]:
        """The recordings and the shipped witnesses of the whole system."""
        return [*self._recordings, *self._witnesses.get(self._system.name, ())]

    def begin_known_runs(self, queue: Queue) -> None:
        """Add the look through known runs, unless all cases are known from an earlier search."""
        if antecedents.all_known(self._system, self.properties, self._limits, len(self._recordings)):
            self._end(0.0)
            return
        task = antecedents.known_runs_task(
            self._system, self.properties, self._limits, self._recordings, self._witnesses
        )
        queue.add(task, partial(self._receive_known_runs, queue))

    def begin_search(self, queue: Queue) -> None:
        """Add the search for the cases that no known run shows, as soon as these are known."""
        self._search_asked = True
        if self._seconds is None and self._shown is not None:
            self._search(queue, self._shown)

    def _receive_known_runs(
        self, queue: Queue, shown: Mapping[int, antecedents.Outcome] | Lost, seconds: float
    ) -> None:
        self._shown = {} if isinstance(shown, Lost) else shown
        every = len(antecedents.all_cases(self.properties))
        if len(self._shown) == every:
            self._remember([self._shown[number] for number in range(every)], seconds)
        elif self._search_asked:
            self._search(queue, self._shown)

    def _search(self, queue: Queue, shown: Mapping[int, antecedents.Outcome]) -> None:
        task = antecedents.search_task(
            self._system, self.properties, self._limits, self._recordings, self._witnesses, shown
        )
        queue.add(task, self._remember, next_=True)

    def when_known(self, then: Callable[[float], None]) -> None:
        """Call `then` with the seconds of the search as soon as it has ended: now, if it has."""
        if self._seconds is None:
            self._waiting.append(then)
        else:
            then(self._seconds)

    def judged(self, prop: Property, verdict: Verdict) -> Verdict:
        """Return the verdict: Vacuous instead of Proved if a case never occurs."""
        return antecedents.found(self._system, [prop]).judged(prop, verdict)

    def obligations(self) -> list[Obligation]:
        """Return the obligation that all cases occur, and one for each run that a search found."""
        return list(antecedents.found(self._system, self.properties).obligation())

    def _remember(self, outcomes: Any | Lost, seconds: float) -> None:
        antecedents.remember(self._system, self.properties, self._limits, len(self._recordings), outcomes)
        self._end(seconds)

    def _end(self, seconds: float) -> None:
        self._seconds = seconds
        for then in self._waiting:
            then(seconds)
        self._waiting.clear()
