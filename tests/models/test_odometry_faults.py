"""One faulty unit, whichever: what is proved with and without `single_fault_safe`, and what a hidden fault can do."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.errors import PropertyError
from safeloc.language.expr import Num
from safeloc.language.interpret import run
from safeloc.language.spec import observe
from safeloc.language.system import lower, without_ghosts
from safeloc.language.verdict import Proved, Violated, word
from safeloc.models import odometry
from safeloc.models.odometry.variables import OdometryConfig, parts
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.odometry.faults import containment, properties

SAFE = OdometryConfig(single_fault_safe=True)
NO_STRAYS = OdometryConfig(trust_first_marker=True)


def model(config: OdometryConfig) -> odometry.Odometry:
    """The machine with a ghost that names the faulty unit."""
    return odometry.build(parts(config, with_fault=True))


@pytest.mark.slow
@pytest.mark.parametrize("devices", [1, 2])
def test_containment_with_one_faulty_unit_is_proved(devices: int) -> None:
    """MRK-4: with `single_fault_safe`, whichever unit is faulty, the reported interval holds the truth: unbounded."""
    made = model(SAFE.model_copy(update={"devices": devices}))
    findings = prove(lower(made.machine), properties(made), Limits(seconds=60), jobs=2)
    assert len(findings) > 1
    assert {finding.id: word(finding.result) for finding in findings if word(finding.result) != "proved"} == {}


@pytest.mark.slow
def test_a_hidden_fault_adds_no_more_than_twice_the_law() -> None:
    """Without `single_fault_safe`, what a fault too small to be seen can add is bounded, and the bound is proved.

    No reading is stray here: that would be a second fault.
    """
    made = model(NO_STRAYS)
    findings = prove(lower(made.machine), properties(made), Limits(seconds=60), jobs=2)
    assert {finding.id: word(finding.result) for finding in findings if word(finding.result) != "proved"} == {}


@pytest.mark.slow
def test_a_hidden_fault_can_make_the_plain_interval_wrong() -> None:
    """Without `single_fault_safe` containment with one faulty unit does not hold: a run shows it."""
    made = model(NO_STRAYS)
    found = prove(lower(made.machine), [containment(made)], Limits(seconds=90), lemmas=False)
    result = found[0].result
    assert isinstance(result, Violated)
    assert result.trace is not None
    last, truth = result.trace.steps[-1].outputs, int(result.trace.steps[-1].state["truth_nm"])
    assert last["valid"]
    low, high = (
        int(last["position_mm"]) - int(last["margin_below_mm"]),
        int(last["position_mm"]) + int(last["margin_above_mm"]),
    )
    assert not low * 1_000_000 <= truth <= high * 1_000_000
    assert result.trace.steps[0].state["faulty_unit"] != 0


@pytest.mark.slow
def test_a_missing_charge_is_noticed() -> None:
    """A margin that grows by one nanometre a cycle less than it must is not proved to hold the truth."""
    made = model(SAFE.model_copy(update={"devices": 1}))
    wheel, table = made.own.units[0], []
    for row in made.machine.transitions:
        grown = row.set.get(wheel.above)
        if isinstance(grown, Num) and row.name.startswith("run on"):
            table.append(replace(row, set={**row.set, wheel.above: grown - 1}))
        else:
            table.append(row)
    broken = replace(made, machine=replace(made.machine, transitions=table))
    goal = observe(lower(broken.machine), containment(broken))
    assert not isinstance(kinduction(goal, Limits(seconds=20, induction=1)), Proved)


@pytest.mark.parametrize(("safe", "moved"), [(True, 0), (False, 50)])
def test_a_lone_distance_moves_nothing_where_it_may_be_faulty(safe: bool, moved: int) -> None:
    """With `single_fault_safe` a distance without its check adds to the error as if none had come."""
    config = OdometryConfig(single_fault_safe=safe, trust_first_marker=True, tolerance_mm=60_000)
    reading = {"front_marker": 1, "front_marker_position_mm": 0, "front_marker_since_mm": 0}
    both = {"front_wheel_mm": 50, "front_radar_mm": 50}
    trace = run(without_ghosts(lower(odometry.machine(config))), [{**both, **reading}, both, {"front_wheel_mm": 50}])
    before, after = trace.steps[-2].state, trace.steps[-1].state
    assert int(after["front_wheel_position_mm"]) - int(before["front_wheel_position_mm"]) == moved
    grown = int(after["front_wheel_margin_above_nm"]) - int(before["front_wheel_margin_above_nm"])
    assert (grown >= config.limits.blind_nm) == safe


def test_faults_need_their_ghost() -> None:
    """The properties of a faulty unit are refused for a machine that has none."""
    with pytest.raises(PropertyError, match="has no ghost of a faulty unit; make its parts with with_fault=True"):
        properties(odometry.build(parts(OdometryConfig())))
