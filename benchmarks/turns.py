"""Measuring: contenders take turns, so that whatever else the machine does falls on all of them alike."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

ROUNDS = 15

Last = tuple[int, ...]
Ready = Callable[[], Last]


@dataclass(frozen=True)
class Contender:
    """One way to run a machine: `prepare(steps)` gives a function that runs that many steps and tells the last state.

    runs   how many runs of so many steps it does at once
    """

    name: str
    steps: int
    prepare: Callable[[int], Ready]
    runs: int = 1


@dataclass(frozen=True)
class Target:
    """At least `factor` times as fast as another contender; `than` None: at least `factor` steps a second."""

    contender: str
    factor: float
    than: str | None


def race(contenders: Sequence[Contender], expected: Callable[[int], Last], rounds: int = ROUNDS) -> dict[str, float]:
    """Steps a second of processor time, best of all rounds, by name; AssertionError where a last state is wrong."""
    ready = [(contender, contender.prepare(contender.steps)) for contender in contenders]
    best: dict[str, float] = {}
    for contender, run in ready:
        assert run() == expected(contender.steps), f"{contender.name} ends in a state of its own"
    gc.disable()
    for _ in range(rounds):
        for contender, run in ready:
            begin = time.process_time()
            run()
            speed = contender.steps * contender.runs / (time.process_time() - begin)
            best[contender.name] = max(speed, best.get(contender.name, 0.0))
    gc.enable()
    return best


def table(title: str, speeds: Mapping[str, float], unit: str) -> list[str]:
    """Speeds and their ratio to one contender's, slowest first."""
    width = max(map(len, speeds))
    lines = [title, f"{'':{width}}  {'steps/s':>13}  ratio to {unit}"]
    for name, speed in sorted(speeds.items(), key=lambda item: item[1]):
        lines.append(f"{name:{width}}  {speed:13,.0f}  {speed / speeds[unit]:10.4f}")
    return lines


def judged(target: Target, speeds: Mapping[str, float]) -> str:
    """One line: the target, what was found, met or missed."""
    speed = speeds.get(target.contender)
    reference = 1.0 if target.than is None else speeds.get(target.than)
    wanted = f"{target.factor:,.0f} steps/s" if target.than is None else f"{target.factor:g} x {target.than}"
    if speed is None or reference is None:
        return f"not measured  {target.contender} >= {wanted}"
    found = speed / reference
    shown = f"{found:,.0f}" if target.than is None else f"{found:.2f}"
    return f"{'met   ' if found >= target.factor else 'MISSED'}  {target.contender} >= {wanted}: {shown}"
