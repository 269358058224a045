"""Which cases are ordinary: those of tests without a mark, and of one that is marked `thorough(ordinary=3)` three, spread evenly.

`make test` and CI run the ordinary ones, `make test-all` all that take less than minutes, `make test-long TOPIC=slow` those that take longer.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence

import pytest


def ordinary(cases: Sequence[pytest.Item]) -> Iterator[pytest.Item]:
    """Yield those cases of one test that are ordinary. UsageError for a mark that does not say how many these are."""
    mark = cases[0].get_closest_marker("thorough")
    if mark is None:
        yield from (case for case in cases if case.get_closest_marker("slow") is None)
    elif mark.args or mark.kwargs:
        wanted = min(_wanted(cases[0], mark), len(cases))
        yield from (cases[number * len(cases) // wanted] for number in range(wanted))


def _wanted(case: pytest.Item, mark: pytest.Mark) -> int:
    wanted = mark.kwargs.get("ordinary")
    if mark.args or set(mark.kwargs) != {"ordinary"} or not isinstance(wanted, int) or wanted < 1:
        raise pytest.UsageError(f"{case.nodeid}: `thorough` takes `ordinary=` and a number of cases, 1 or more.")
    return wanted


def by_test(items: Iterable[pytest.Item]) -> list[list[pytest.Item]]:
    """Return the cases of each test, in order."""
    cases: dict[Hashable, list[pytest.Item]] = {}
    for item in items:
        cases.setdefault((item.parent, getattr(item, "originalname", item.name)), []).append(item)
    return list(cases.values())
