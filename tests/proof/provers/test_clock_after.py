"""Inside a block the clock ends work after another multiple of its limit: a search of many questions ends each of them sooner."""

from __future__ import annotations

import pytest

from safeloc.proof.provers import limits
from safeloc.proof.provers.limits import CLOCK, clock_after, deadline


@pytest.mark.parametrize(("after_s", "passed"), [(7.9, False), (8.1, True), (CLOCK * 2 + 0.1, True)])
def test_the_clock_ends_work_sooner_inside_the_block(
    monkeypatch: pytest.MonkeyPatch, after_s: float, passed: bool
) -> None:
    now = [1000.0]
    monkeypatch.setattr(limits.time, "monotonic", lambda: now[0])
    with clock_after(4.0):
        hurried = deadline(2.0)
    usual = deadline(2.0)
    now[0] += after_s
    assert (hurried.passed, usual.passed) == (passed, after_s > CLOCK * 2)
