"""Prints, after the table of pytest-benchmark, every contender's speed as a ratio, and the project's targets."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

import pytest

T = TypeVar("T")

UNIT = "hand-written class"
SPEEDS = pytest.StashKey[dict[str, float]]()


@dataclass(frozen=True)
class Target:
    """At least `factor` times as fast as another contender; `than` None: at least `factor` steps a second."""

    contender: str
    factor: float
    than: str | None


TARGETS = (
    Target("generated Python, tick", 1.0, UNIT),
    Target("generated Python, fused", 1.0, UNIT),
    Target("transitions, embedded", 0.8, "transitions, bare"),
    Target("numpy batch", 10.0, "generated Python, tick"),
    Target("numpy batch", 50e6, None),
)


def pytest_configure(config: pytest.Config) -> None:
    """One table of speeds a run."""
    config.stash[SPEEDS] = {}


@pytest.fixture
def measure(request: pytest.FixtureRequest, benchmark: Any) -> Callable[[str, int, Callable[[], T]], T]:
    """Measure a contender: (name, steps in one call, call) -> what the call returned."""

    def measured(name: str, steps: int, call: Callable[[], T]) -> T:
        benchmark.name = name
        result: T = benchmark.pedantic(call, rounds=7, iterations=1, warmup_rounds=1)
        if benchmark.stats is not None:  # None under --benchmark-disable
            request.config.stash[SPEEDS][name] = steps / benchmark.stats.stats.min
        return result

    return measured


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """The ratios."""
    speeds = config.stash[SPEEDS]
    if UNIT not in speeds:
        return
    terminalreporter.section(f"steps a second, best of 7 rounds (ratio to the {UNIT})")
    for name, speed in sorted(speeds.items(), key=lambda item: item[1]):
        terminalreporter.write_line(f"{name:28}{speed / 1e6:10.3f} M {speed / speeds[UNIT]:10.4f}")
    for target in TARGETS:
        terminalreporter.write_line(_judged(target, speeds))


def _judged(target: Target, speeds: Mapping[str, float]) -> str:
    speed = speeds.get(target.contender)
    reference = 1.0 if target.than is None else speeds.get(target.than)
    wanted = f"{target.factor / 1e6:g} M/s" if target.than is None else f"{target.factor:g} x {target.than}"
    if speed is None or reference is None:
        return f"target {target.contender} >= {wanted}: not measured"
    found = speed / reference
    shown = f"{found / 1e6:.1f} M/s" if target.than is None else f"{found:.2f}"
    return f"target {target.contender} >= {wanted}: {shown}, {'met' if found >= target.factor else 'MISSED'}"
