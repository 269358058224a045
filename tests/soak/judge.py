"""Whether a day was a good one: each criterion is passed or failed, with its figures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from statistics import median

from tests.soak.day import HOUR_MS
from tests.soak.windows import Window, at_share

MIB = 1024


@dataclass(frozen=True)
class Bounds:
    """What is still good.

    growth_mib  memory may grow by that over the last half of the day: of 200 vehicles some 4 million reports, so what keeps
                two bytes of each is seen
    p99_ms      of the reports of windows with cores to themselves: the target of a vehicle among 30 that flood
    waited      a window had cores to itself where neither process nor sender waited for one for more of the time
    free        so many of the windows have to be such, or the latency is not decided
    located     share of reports with a place, at least; else the day says little about places
    """

    growth_mib: float = 8.0
    p99_ms: float = 50.0
    waited: float = 0.1
    free: float = 0.1
    located: float = 0.5


@dataclass(frozen=True)
class Found:
    """A criterion."""

    passed: bool
    words: str


def growth_mib(windows: Sequence[Window]) -> float:
    """How much memory grows over the last half of the day: its length by the median slope between any two windows of it.

    Both windows of a pair are of one life of the process, for with each start memory begins anew. 0 where no two are.
    """
    half = [one for one in windows if one.from_ms * 2 >= windows[-1].to_ms]
    slopes = [
        (later.resident_kib - earlier.resident_kib) / MIB / (later.to_ms - earlier.to_ms)
        for earlier, later in combinations(half, 2)
        if earlier.life == later.life
    ]
    return median(slopes) * windows[-1].to_ms / 2 if slopes else 0.0


def latency_words(windows: Sequence[Window]) -> str:
    """Of all their reports."""
    p50, p99 = (at_share([one.latency for one in windows], share) for share in (0.5, 0.99))
    worst = max((one.worst_ms for one in windows), default=0.0)
    return f"{p50:.2f} ms in the median, {p99:.2f} ms at 99 %, {worst:.0f} ms at worst"


def _latency(windows: Sequence[Window], bounds: Bounds) -> Found:
    free = [one for one in windows if one.waited <= bounds.waited]
    kept = at_share([one.latency for one in free], 0.99) <= bounds.p99_ms
    return Found(
        kept and len(free) >= max(1, bounds.free * len(windows)),
        f"latency in the {len(free)} of {len(windows)} windows that had cores to themselves is {latency_words(free)}; "
        f"at most {bounds.p99_ms:g} ms at 99 %, in {bounds.free:.0%} of the windows; in all {latency_words(windows)}",
    )


def judged(windows: Sequence[Window], wanted: int, bounds: Bounds) -> Iterator[Found]:
    """Every criterion of the day."""
    reports, located = sum(one.reports for one in windows), sum(one.located for one in windows)
    wrong = sum(one.wrong for one in windows)
    first = next((one.first_wrong for one in windows if one.wrong), "")
    yield Found(wrong == 0, f"{wrong} of {reports} reports are wrong, {located} of them have a place {first}".strip())
    share = located / max(1, reports)
    yield Found(share >= bounds.located, f"{share:.1%} of the reports have a place; at least {bounds.located:.0%}")
    grown = growth_mib(windows)
    yield Found(
        grown <= bounds.growth_mib,
        f"memory grows by {grown:.2f} MiB over the last half of the day; at most {bounds.growth_mib:g} MiB",
    )
    yield _latency(windows, bounds)
    failures = [told for one in windows for told in one.failures]
    yield Found(not failures, f"the process failed {len(failures)} times {'; '.join(failures[:3])}".strip())
    hours = windows[-1].to_ms / HOUR_MS
    yield Found(len(windows) == wanted, f"{len(windows)} of {wanted} windows: {hours:.2f} hours of the fleet")
