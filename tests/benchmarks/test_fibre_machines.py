"""What is timed of the fibre machines is what the interpreter does."""

from __future__ import annotations

import pytest

from benchmarks.fibre_machines import UNIT, contenders, loaded, measured


@pytest.mark.parametrize("name", ["emitter", "axle_section"])
def test_every_contender_ends_where_the_interpreter_does(name: str) -> None:
    """After the whole stream."""
    made = loaded(name)
    assert [made.last] * 3 == [one.prepare(one.steps)() for one in contenders(name, made)]


def test_speeds_are_told_beside_the_unit() -> None:
    """One round is enough to see every row."""
    speeds = measured("emitter", rounds=1)
    assert {UNIT, "emitter, step", "emitter, tick", "emitter, fused loop"} == set(speeds)
    assert all(speed > 0 for speed in speeds.values())
