"""One end of a train as inputs of the fibre machine."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from safeloc.language.expr import Optional
from safeloc.models.fibre import FibreConfig, parts
from safeloc.sensing.fibre.features import Bounds, End
from safeloc.sensing.fibre.step_inputs import step_inputs
from tests.sensing.fibre.scenes import coaches, seen, told, world

END = End(Bounds(1_000, 3_000), Bounds(900, 3_100), Bounds(10, 30), ("P1",), 1_180)
BEFORE = replace(END, path_mm=Bounds(500, 2_400))


def test_what_is_known_is_handed_over() -> None:
    """By the machine's own names."""
    made = step_inputs(END, BEFORE, {"P1": 2_100})
    expected = {"flight_position_mm": 2_000, "run_mm": 550, "amplitude_cdb": 1_180, "reflecting_point_mm": 2_100}
    assert expected == made
    optional = {item.value.name for item in parts(FibreConfig()).declared.inputs if isinstance(item, Optional)}
    assert set(made) == optional


def test_what_is_not_known_is_absent() -> None:
    """No end, no cycle before, no normal, two points at once."""
    assert {} == step_inputs(None, BEFORE, {})
    assert {"flight_position_mm": 2_000} == step_inputs(replace(END, amplitude_cdb=None, points=("P1", "P2")), None, {})


def test_a_simulated_train_runs_as_far_as_it_does() -> None:
    """40 m/s in half-second cycles, summed over a run; amplitude stays about normal."""
    ends = [train.high for _, train in told(seen(world(coaches(5, 200, 40.0)), 46)) if train.high is not None]
    steps = [step_inputs(now, before, {}) for before, now in pairwise(ends)]
    assert abs(sum(one["run_mm"] for one in steps) - 20_000 * len(steps)) < 30_000
    levels = [one["amplitude_cdb"] for one in steps if "amplitude_cdb" in one]
    assert len(levels) > 10
    assert max(abs(level) for level in levels) < 700
