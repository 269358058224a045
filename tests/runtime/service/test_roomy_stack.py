"""Inside a roomy stack the frame of a large machine's step is not handed out by the system anew each time."""

from __future__ import annotations

import resource
from collections.abc import Callable
from typing import Any

import pytest

from safeloc.runtime.service.roomy_stack import in_roomy_stack

CALLS = 300


def large() -> Callable[[], int]:
    """A function with as many variables as a step of the localizer."""
    space: dict[str, Any] = {}
    exec("def step():\n" + "".join(f"    v{number} = {number}\n" for number in range(1_800)) + "    return v7", space)
    made: Callable[[], int] = space["step"]
    return made


def faults_of(step: Callable[[], int], depth: int) -> int:
    """Pages that the system handed out while it was called, from so many calls below."""
    if depth:
        return faults_of(step, depth - 1)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(CALLS):
        step()
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before


@pytest.mark.parametrize("depth", range(0, 200, 20))
def test_a_large_frame_finds_room(depth: int) -> None:
    """From whatever depth; without the room it costs some pages with each call."""
    step, found = large(), []
    step()
    in_roomy_stack(lambda: found.append(faults_of(step, depth)))
    assert found[0] < CALLS / 2


def test_what_the_work_raises_comes_out() -> None:
    """Unchanged."""
    with pytest.raises(ZeroDivisionError):
        in_roomy_stack(lambda: 1 / 0)
