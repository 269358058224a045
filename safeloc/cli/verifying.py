"""Display of progress while several targets are verified: a bar for each on a terminal, plain lines in a pipe."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from datetime import timedelta

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

from safeloc.catalogue import Target
from safeloc.cli.console import err
from safeloc.cli.finding_lines import one_word
from safeloc.proof.verification.many import Began, Event, Found, Kept, Over, Phase
from safeloc.proof.verification.one import expected
from safeloc.proof.verification.time_left import TimeLeft
from safeloc.report.headline import BEST_FIRST


class Verifying:
    """Display of the events of `verify_targets`: running targets with their counts, and finished ones; nothing with --json.

    seconds  how long targets took in an earlier run, by name
    jobs     number of processes
    taken    how long each finished target took in this run
    """

    def __init__(self, targets: Sequence[Target], *, quiet: bool, seconds: Mapping[str, float], jobs: int) -> None:
        self._plain = not quiet and not sys.stderr.isatty()
        self._quiet = quiet
        self._bars = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.fields[left]}"),
            console=err,
            disable=quiet or self._plain,
            transient=True,
        )
        self._all = self._bars.add_task("all machines", total=sum(map(expected, targets)), left="")
        self._expected = {target.name: expected(target) for target in targets}
        self._time_left = TimeLeft(self._expected, seconds, jobs)
        self.taken: dict[str, float] = {}
        self._running: dict[str, TaskID] = {}
        self._counts: dict[str, Counter[str]] = {target.name: Counter() for target in targets}

    def __enter__(self) -> Verifying:
        self._bars.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bars.stop()

    @property
    def done(self) -> dict[str, tuple[int, int]]:
        """Return, for each bar, the number of findings so far and the expected number."""
        return {task.description: (int(task.completed), int(task.total or 0)) for task in self._bars.tasks}

    def __call__(self, event: Event) -> None:
        """Display one event of `verify_targets`."""
        self._event(event)
        self._bars.update(self._all, left=f"about {timedelta(seconds=round(self._time_left.seconds))} left")

    def _event(self, event: Event) -> None:
        match event:
            case Began(target, findings):
                self._running[target] = self._bars.add_task(target, total=findings, left="")
                self._time_left.began(target)
            case Phase(target, text):
                self._bars.update(self._running[target], description=text)
                self._line(text)
            case Found(target, id_, verdict, seconds):
                self._counts[target][verdict] += 1
                # there may be more findings than expected: cases that a search found
                expected_yet = int(self._counts[target].total() <= self._expected[target])
                self._bars.advance(self._running[target], expected_yet)
                self._bars.advance(self._all, expected_yet)
                self._line(f"{one_word(verdict):9} {id_}  ({seconds:.1f} s)")
            case Kept(target, findings, since):
                self._bars.advance(self._all, self._expected[target])
                self._time_left.over(target, 0.0)
                if not self._quiet:
                    err.print(f"{target}: unchanged, {findings} results from the cache of {since}", markup=False)
            case Over(target, seconds):
                self._over(target, seconds)

    def _over(self, target: str, seconds: float) -> None:
        found = self._counts[target]
        self.taken[target] = seconds
        self._time_left.over(target, seconds)
        self._bars.remove_task(self._running.pop(target))
        self._bars.advance(self._all, max(0, self._expected[target] - sum(found.values())))
        if not self._quiet:
            counts = ", ".join(f"{found[verdict]} {verdict}" for verdict in reversed(BEST_FIRST) if found[verdict])
            err.print(f"{target}: {counts or 'nothing found'} in {seconds:.0f} s", markup=False)

    def _line(self, text: str) -> None:
        if self._plain:
            err.print(text, markup=False)
