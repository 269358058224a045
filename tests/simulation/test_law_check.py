"""Simulated units keep their declared error law by construction, and each fault breaks it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from safeloc.errors import InputError
from safeloc.language.units import NM_PER_MM
from safeloc.models.vocabulary.error_law import RADAR, WHEEL, ErrorLaw
from safeloc.simulation.faults import Fault
from safeloc.simulation.law_check import Breach, first_breach
from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move, plan
from safeloc.simulation.sensors import KINDS, measure

VEHICLE = VehicleConfig()
LAWS = [
    pytest.param(WHEEL, id="SUBSET-041"),
    pytest.param(RADAR, id="radar"),
    pytest.param(ErrorLaw(kind="wheel", constant_mm=2, rate_ppm=0), id="rounding only"),
    pytest.param(ErrorLaw(kind="wheel", constant_mm=2, rate_ppm=1_000_000), id="as wrong as can be"),
    pytest.param(ErrorLaw(kind="wheel", constant_mm=100_000, rate_ppm=1_000, floor_mm_s=10_000), id="coarse"),
]
RUNNING = move(VEHICLE, [Leg(20_000, 60.0)], 100)


def still(cycles: int) -> Motion:
    """A vehicle at rest."""
    return Motion(100, np.zeros(cycles, dtype=np.int64), np.zeros(cycles), 0)


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("severity", [0.0, 0.9, 1.0])
def test_no_seed_breaks_the_law(law: ErrorLaw, severity: float) -> None:
    """Running, stopping, reversing and with drop-outs, up to the very ends of the law."""
    for seed in range(8):
        rng = np.random.default_rng(seed)
        motion = move(VEHICLE, plan(VEHICLE, 60, rng), 100)
        unit = measure("wheel", motion, law, rng, dropout=0.05, severity=severity)
        assert first_breach(motion, law, unit) is None


@pytest.mark.parametrize("kind", ["stuck", "runaway", "jump", "slip", "slide", "freeze"])
def test_every_fault_breaks_the_law_where_it_begins(kind: str) -> None:
    """The check sees the fault, not before it begins, and within a second."""
    law, begin = ErrorLaw(kind="wheel", constant_mm=200, rate_ppm=1_000), 60
    sound = measure("wheel", RUNNING, law, np.random.default_rng(1))
    assert first_breach(RUNNING, law, sound) is None
    broken = measure("wheel", RUNNING, law, np.random.default_rng(1), faults=[Fault(kind, "wheel", begin, 200)])
    breach = first_breach(RUNNING, law, broken)
    assert breach is not None
    assert begin <= breach.cycle < begin + 10
    assert breach.off_nm > breach.allowed_nm


def test_a_drop_out_is_no_breach_but_an_absence() -> None:
    """A unit that is silent says nothing wrong."""
    unit = measure(
        "wheel",
        RUNNING,
        ErrorLaw(kind="wheel", constant_mm=200, rate_ppm=1_000),
        np.random.default_rng(1),
        faults=[Fault("drop-out", "wheel", 5, 9)],
    )
    assert np.flatnonzero(~unit.present).tolist() == [5, 6, 7, 8]


@pytest.mark.parametrize("silent", [8, 40, 300])
def test_a_long_silence_is_followed_by_a_distance_that_can_be_run(silent: int) -> None:
    """No slip comes at once that gathered while the unit was silent: a vehicle cannot have run such a distance, and the law would break."""
    for seed in range(20):
        fault = Fault("drop-out", "wheel", 150, 150 + silent)
        unit = measure("wheel", RUNNING, WHEEL, np.random.default_rng(seed), faults=[fault])
        assert first_breach(RUNNING, WHEEL, unit) is None
        moved = np.abs(np.diff(unit.wander_nm))[150 + silent - 1]
        assert moved <= WHEEL.constant_mm * NM_PER_MM // 250


def test_one_nanometre_too_much_is_a_breach() -> None:
    """The check is exact: at the end of the band all is well, one beyond is not."""
    motion, law = still(3), ErrorLaw(kind="wheel", constant_mm=2, rate_ppm=0)
    unit = measure("wheel", motion, law, np.random.default_rng(0), severity=0.0)
    for wander, expected in ((1_000_000, None), (1_000_001, Breach("wheel", 1, 1_000_001, 1_000_000))):
        path = np.array([0, wander, 0], dtype=np.int64)
        lawful = Motion(100, path, motion.speed_mm_s, 0)
        assert first_breach(lawful, law, dataclasses.replace(unit, wander_nm=path)) == expected


def test_drift_is_allowed_by_rate_floor_and_knee_to_the_nanometre() -> None:
    """1000 mm measured, knee 400 mm, 1000 ppm, floor 10 mm/s for 100 ms: 600 000 + 1 000 000 nm."""
    law = ErrorLaw(kind="wheel", constant_mm=0, rate_ppm=1_000, floor_mm_s=10, knee_mm_s=4_000)
    allowed = 600 * 1_000 + 10 * 100 * 1_000
    unit = dataclasses.replace(
        measure("wheel", still(1), law, np.random.default_rng(0), severity=0.0), distance_mm=np.array([1_000])
    )
    for extra, expected in ((0, None), (1, Breach("wheel", 0, allowed + 1, allowed))):
        motion = Motion(100, np.array([1_000_000_000 + allowed + extra]), np.zeros(1), 0)
        assert first_breach(motion, law, unit) == expected


def test_wander_rests_while_nothing_is_measured() -> None:
    """An absent measurement must not be used to hide a change of wander."""
    unit = measure(
        "wheel", still(2), ErrorLaw(kind="wheel", constant_mm=10, rate_ppm=0), np.random.default_rng(0), severity=0.0
    )
    hidden = dataclasses.replace(unit, present=np.array([True, False]), wander_nm=np.array([0, 1]))
    assert first_breach(still(2), ErrorLaw(kind="wheel", constant_mm=10, rate_ppm=0), hidden) == Breach(
        "wheel", 1, 1, 0
    )


def test_a_constant_that_cannot_hold_the_rounding_is_refused() -> None:
    """Whole millimetres need at least 1 mm of one-off constant."""
    with pytest.raises(InputError, match=r"^wheel: a constant of 0 mm cannot hold the rounding to whole mm; "):
        measure("wheel", RUNNING, ErrorLaw(kind="wheel", constant_mm=0, rate_ppm=0), np.random.default_rng(0))


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        (
            Fault("stuck", "whel", 0, 9),
            r"^stuck of whel, 0 to 9: no such place; of a distance sensor there are wheel\.$",
        ),
        (Fault("stuck", "wheel", 9, 9), r"needs 0 <= begin < end\.$"),
        (Fault("stuck", "wheel", 50, 60), r"begins after the run, which is 50 long\.$"),
        (Fault("stuck", "wheel", -1, 60), r"needs 0 <= begin < end\.$"),
    ],
)
def test_a_fault_that_would_test_nothing_is_refused(fault: Fault, message: str) -> None:
    """A misspelt sensor or an empty span is an error, not a sound run."""
    with pytest.raises(InputError, match=message):
        KINDS.require([fault], places=["wheel"], length=50)
