"""Position from satellites: proved with the selection in one step; initialisation, coasting, rejection in figures."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.interpret import run
from safeloc.models.satellite import Satellite, build, compose_machines
from safeloc.models.satellite_parts.variables import FIX, REASON, SatelliteConfig, parts
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.properties.satellite import properties
from safeloc.provers.limits import Limits
from safeloc.provers.portfolio import prove
from safeloc.system import lower, without_ghosts
from safeloc.trace import Trace
from safeloc.verdict import Proved

CONFIG = SatelliteConfig(selection=SelectionConfig(channels=4))
MACHINE = build(parts(CONFIG))
SYSTEM = without_ghosts(lower(MACHINE))
CHANNELS = range(1, 5)


def cycle(**changes: int | bool) -> dict[str, int | bool]:
    """A cycle in which nothing is solved; all satellites are usable and used."""
    quiet: dict[str, int | bool] = {
        "fix_protection_mm": 5_000, "fix_speed_um_s": 0, "fix_speed_protection_um_s": 500_000, "fix_unknowns": 2,
        "fix_missing": 0, "reference_accuracy_mm": 0, "reference_speed_accuracy_um_s": 0, "odometry_error_mm": 100,
    }  # fmt: skip
    return {**quiet, **{f"usable_{n}": True for n in CHANNELS}, **{f"used_{n}": True for n in CHANNELS}, **changes}


START = cycle(reference_mm=1_000_000, reference_accuracy_mm=3_000)


def driven(*cycles: dict[str, int | bool]) -> Trace:
    """The cycles, on board."""
    return run(SYSTEM, cycles)


def verdict(trace: Trace, number: int = -1) -> str:
    """What became of a cycle's solution."""
    return FIX[int(trace.steps[number].state["fix_judged"])].label


def mode(trace: Trace, number: int = -1) -> str:
    """The mode after a cycle."""
    return MACHINE.modes[int(trace.steps[number].state["mode"])].label


def test_only_a_reference_starts_it() -> None:
    """A solution alone does not: the first state has to come from a trusted place."""
    trace = driven(cycle(fix_mm=1_000_000), START)
    assert ["UNLOCATED", "LOCATED"] == [mode(trace, 0), mode(trace, 1)]
    assert "UNLOCATED" == verdict(trace, 0)
    assert 3_000 == trace.steps[1].outputs["under_mm"]


def test_a_solution_narrows() -> None:
    """A solution that meets the prediction, of enough usable satellites, counts."""
    trace = driven(START, cycle(fix_mm=1_001_000, fix_protection_mm=2_000, fix_speed_um_s=10_000_000))
    assert ("ACCEPTED", "LOCATED") == (verdict(trace), mode(trace))
    assert (1_001_000, 2_000) == (trace.steps[-1].outputs["position_mm"], trace.steps[-1].outputs["under_mm"])


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"usable_2": False}, "NOT_USABLE"),
        ({"used_1": False, "used_2": False}, "TOO_FEW"),
        ({"fix_mm": 2_000_000}, "DISJOINT"),
        ({"fix_protection_mm": 30_001}, "TOO_COARSE"),
    ],
)
def test_what_does_not_count(change: dict[str, int | bool], expected: str) -> None:
    """A solution with an unusable satellite, too few, far from the prediction or too coarse leaves the state coasting."""
    trace = driven(START, {**cycle(fix_mm=1_000_000), **change})
    assert (expected, "COASTING") == (verdict(trace), mode(trace))
    assert trace.steps[-1].outputs["under_mm"] > 3_000


def test_coasting_ends() -> None:
    """Without solutions the margin grows with speed and acceleration, and after the limit nothing is reported."""
    good = cycle(fix_mm=1_000_000, fix_protection_mm=1_000, fix_speed_protection_um_s=100_000)
    trace = driven(START, good, good, *[cycle()] * 15)
    margins = [int(step.outputs["under_mm"]) for step in trace.steps[2:12]]
    assert sorted(margins) == margins
    assert ["COASTING"] * 10 == [mode(trace, n) for n in range(3, 13)]
    assert "UNLOCATED" == mode(trace, 13)
    assert "COASTED_OUT" == REASON[int(trace.steps[13].state["reason"])].label


def test_the_prediction_is_constant_acceleration() -> None:
    """Place, speed and the last change of speed give the next place: s + v T + dv T / 2, to the nanometre."""
    first = cycle(fix_mm=1_000_000, fix_protection_mm=1_000, fix_speed_um_s=0, fix_speed_protection_um_s=100_000)
    second = {**first, "fix_speed_um_s": 200_000, "fix_speed_protection_um_s": 50_000}
    trace = driven(START, first, second, cycle())
    before = trace.steps[-2].state
    change, period = int(before["change_um_s"]), CONFIG.period_ms
    way = int(before["speed_um_s"]) * period + change * period // 2
    assert 200_000 == change
    assert trace.steps[-1].state["position_nm"] == before["position_nm"] + way


def test_a_reference_that_contradicts_ends_it() -> None:
    """A common drift within all bounds is found by a reference elsewhere."""
    trace = driven(START, cycle(reference_mm=1_500_000, reference_accuracy_mm=3_000))
    assert "UNLOCATED" == mode(trace)
    assert "CONTRADICTION" == REASON[int(trace.steps[-1].state["reason"])].label


def test_wrong_configurations_are_refused() -> None:
    """An odd period, and more satellites than channels."""
    with pytest.raises(ValueError, match="period_ms must be even"):
        SatelliteConfig(period_ms=201)
    with pytest.raises(ValueError, match="3 satellites are needed, and the receiver has 2 channels"):
        SatelliteConfig(selection=SelectionConfig(channels=2))


def _unproved(model: Satellite, *names: str) -> list[str]:
    asked = [prop for prop in properties(model) if not names or prop.name in names]
    findings = prove(model.composition.system, asked, Limits(seconds=60), jobs=2)
    wanted = {f"satellite/property/{name}" for name in names}
    return [f.id for f in findings if not isinstance(f.result, Proved) and (not names or f.id in wanted)]


@pytest.mark.parametrize("channels", [4, pytest.param(32, marks=pytest.mark.slow)])
def test_everything_is_proved(channels: int) -> None:
    """Every property of selection and position together, without a bound."""
    assert [] == _unproved(compose_machines(SatelliteConfig(selection=SelectionConfig(channels=channels))))


@pytest.mark.parametrize(
    ("weaker", "noticed"),
    [
        ({"usable": True}, "only usable satellites count"),
        ({"few": True}, "no fix below the minimum"),
    ],
)
def test_a_wrong_judgement_is_noticed(weaker: dict[str, bool], noticed: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine that takes any solution, or any number of satellites, does not have the property."""
    from safeloc.models import satellite

    right = satellite.verdict

    def lax(own: satellite.Parts, located: satellite.Bool) -> satellite.Num:
        if "few" in weaker:
            return right(replace(own, config=own.config.model_copy(update={"redundancy": "solve"})), located)
        return right(replace(own, usable=own.used), located)

    monkeypatch.setattr(satellite, "verdict", lax)
    assert [f"satellite/property/{noticed}"] == _unproved(compose_machines(CONFIG), noticed)
