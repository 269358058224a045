"""Motion with a check unit: whichever unit breaks its law, what is told of the distance covers its error, in every run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError

from safeloc.language.composition import compose
from safeloc.language.expr import Expr, Num, Var, as_num, ite, maximum
from safeloc.language.interpret import run
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.units import NM
from safeloc.language.verdict import Proved
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.localizer import CHECKED, Localizer, LocalizerConfig, SourceName, compose_machines
from safeloc.models.motion import MotionConfig, build, parts
from safeloc.models.motion.simulate import reported
from safeloc.models.vocabulary.error_law import ACCELEROMETER, EDDY_CURRENT, RADAR, ErrorLaw
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.proved_base import base
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg, VehicleConfig, move
from safeloc.simulation.motion import Motion as Drive
from safeloc.simulation.sensors import Distances, measure
from tests.proof.provers.small import told as names

KINDS = ("stuck", "runaway", "slip", "slide", "freeze", "drop-out")
DRIVE = move(
    VehicleConfig(max_speed_mm_s=40_000, acceleration_mm_s2=1_000),
    [Leg(0, 3), Leg(25_000, 35), Leg(0, 40), Leg(12_000, 20), Leg(0, 30)],
    100,
)


# ------------------------------------------------------------------ proved


def test_motion_keeps_its_obligations() -> None:
    """Ranges, overflow, every transition fires: with a check unit and without one."""
    for config in (CHECKED, MotionConfig()):
        findings = obligations(lower(build(parts(config)).machine), Limits(seconds=60))
        assert [one.id for one in findings if not isinstance(one.result, Proved)] == []


@pytest.mark.parametrize("source", ["balise", pytest.param("reflector", marks=pytest.mark.slow)])
def test_the_law_is_owed_and_kept(source: SourceName) -> None:
    """What a user of the distance assumes of it is proved for either unit at fault, and with it that its interval is true."""
    known = base(one_user(compose_machines(LocalizerConfig(sources=(source,))), {}))
    assert f"contract of {source} holds" in names(known.kept)
    assert not known.refuted


CREEPS = CHECKED.model_copy(update={"creep_mm_s": 500})
NOT_BELIEVED = CHECKED.model_copy(update={"standing_believed": False})


def _with(motion: MotionConfig) -> Localizer:
    """A vehicle that is located by balises, with that motion."""
    balise = BaliseConfig(odometer=motion.reported_law, checked_distance=True, tolerance_mm=45_000)
    return compose_machines(LocalizerConfig(sources=("balise",), motion=motion, balise=balise))


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("motion", [CREEPS, NOT_BELIEVED])
def test_the_law_is_owed_and_kept_of_a_vehicle_that_may_creep(motion: MotionConfig) -> None:
    """The same is proved where a vehicle that measures nothing may creep, and where nothing is assumed of it."""
    known = base(one_user(_with(motion), {}))
    assert "contract of balise holds" in names(known.kept)
    assert not known.refuted


BETWEEN_NM = CHECKED.between_pulses_mm * 1_000_000


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("motion", "added_nm"), [(CHECKED, BETWEEN_NM), (CREEPS, 50_000_000), (CREEPS, 50_000_000 + BETWEEN_NM)]
)
def test_what_a_standing_vehicle_may_run_is_added_to_the_last_unit(motion: MotionConfig, added_nm: int) -> None:
    """One nm less in a cycle that adds the run to the next pulse, the creep, or both: to be discharged, and not kept."""
    whole = _with(motion)
    added = whole.motion.machine.output("more_nm")
    assert isinstance(added, Num)
    one_less = ite(added.eq(added_nm), added - 1, added)
    assert "contract of balise holds" in names(base(one_user(whole, {"odometer_more_nm": one_less})).refuted)


def test_stops_of_one_pulse_each_are_covered_by_what_is_added_for_them() -> None:
    """A radar at the end of its law, and stops between which the wheel turns by a pulse: 20 mm each are missing, and 20 mm are added."""
    stops = 400
    run, zero = np.tile([0, 14], stops), np.zeros(2 * stops, dtype=np.int64)
    odometer = Distances("odometer", run, np.ones(len(run), dtype=np.bool_), zero)
    said = reported(CHECKED, odometer, replace(odometer, name="check"))
    assert said.more_nm is not None and said.more_nm.tolist()[::2] == [BETWEEN_NM] * stops
    true_nm = np.tile([BETWEEN_NM, 14_000_000 + 55_600_000], stops)
    drive = Drive(100, np.cumsum(true_nm), true_nm / 100_000, 0)
    assert uncovered_nm(said, drive) <= BETWEEN_NM
    without = replace(said, more_nm=np.where(run == 0, 0, said.more_nm))
    assert uncovered_nm(without, drive) > CHECKED.reported_law.constant_mm * 1_000_000


def test_a_step_of_the_odometer_that_no_figure_covers_is_refused() -> None:
    """A vehicle that stands between two pulses may run one step unmeasured; who believes in no standstill need not say so."""
    with pytest.raises(ValidationError, match="between_pulses_mm is 20, less than measuring_step_mm 30"):
        MotionConfig(check=RADAR, measuring_step_mm=30)
    assert MotionConfig(check=RADAR, measuring_step_mm=30, standing_believed=False).reported_law.constant_mm == 6_200


def test_standing_is_one_clause_or_none() -> None:
    """Where standing is not believed, no clause speaks of it; and a creep is then refused."""
    named = [build(parts(config)).machine.world.clauses for config in (CHECKED, NOT_BELIEVED)]
    assert set(named[0]) - set(named[1]) == {"a vehicle that measures nothing stays between two pulses"}
    with pytest.raises(ValueError, match="standing_believed is false"):
        MotionConfig(check=CHECKED.check, standing_believed=False, creep_mm_s=1)


def test_who_rolls_away_is_covered_unless_standing_is_believed() -> None:
    """Two minutes at 0.5 m/s with a locked wheel and a radar that hears nothing below its floor."""
    drive = move(VehicleConfig(max_speed_mm_s=500, acceleration_mm_s2=1_000), [Leg(500, 120)], 100)
    zero = np.zeros_like(drive.distance_nm)
    nothing = Distances("odometer", zero, np.ones(len(zero), dtype=np.bool_), zero)
    uncovered = [
        uncovered_nm(reported(motion, nothing, replace(nothing, name="check")), drive)
        for motion in (CHECKED, CREEPS, NOT_BELIEVED)
    ]
    constant = CHECKED.reported_law.constant_mm * 1_000_000
    assert uncovered[0] > 50_000_000_000 > constant >= max(uncovered[1:])


def _no_charge(_: Localizer) -> Mapping[str, Expr]:
    return {"odometer_more_nm": as_num(0, NM)}


def _a_little_less(whole: Localizer) -> Mapping[str, Expr]:
    return {"odometer_more_nm": maximum(whole.motion.machine.output("more_nm") - 1, 0)}


def _as_measured(whole: Localizer) -> Mapping[str, Expr]:
    step = whole.motion.own.odometer.measured
    return {"odometer_mm": step.value, "odometer_mm.present": step.present}


@pytest.mark.parametrize(
    "wrong", [_a_little_less, *(pytest.param(one, marks=pytest.mark.slow) for one in (_no_charge, _as_measured))]
)
def test_a_smaller_charge_is_not_enough(wrong: Callable[[Localizer], Mapping[str, Expr]]) -> None:
    """No added error, one nm less, or the odometer as it measured: to be discharged, and not kept."""
    whole = compose_machines(LocalizerConfig(sources=("balise",)))
    assert "contract of balise holds" in names(base(one_user(whole, wrong(whole))).refuted)


def one_user(whole: Localizer, changed: Mapping[str, Expr]) -> TransitionSystem:
    """Motion and the one source that hears it, with wires changed, by the input's name."""
    [piece] = whole.pieces.values()
    wires: dict[Var, Expr] = dict(piece.wires)
    for name, term in changed.items():
        [heard] = [var for var in wires if var.name == name]
        wires[heard] = term
    return compose(
        "part", (whole.motion.machine, *piece.machines), wires, shared=whole.motion.shared, discharge=piece.discharged
    ).system


# ------------------------------------------------------------------ along runs


def measured(seed: int, faulty: str, kind: str | None) -> tuple[Distances, Distances]:
    """Both units along the drive; of the faulty one, a fault from its start to its end for a third of the time."""
    rng = np.random.default_rng(seed)
    begin = int(rng.integers(20, 500))
    faults = [Fault(kind, faulty, begin, begin + 400)] if kind else []
    assert CHECKED.check is not None
    return _unit("odometer", CHECKED.odometer, rng, faults), _unit("check", CHECKED.check, rng, faults)


def _unit(name: str, law: ErrorLaw, rng: np.random.Generator, faults: list[Fault]) -> Distances:
    return measure(name, DRIVE, law, rng, faults=faults, severity=1.0, dropout=0.02)


def uncovered_nm(said: Distances, drive: Drive = DRIVE) -> int:
    """The most by which the error of a run, whenever it began, exceeds the added errors of its cycles; nm, to either side."""
    law, worst = CHECKED.reported_law, 0
    error = drive.distance_nm - np.where(said.present, said.distance_mm, 0) * 1_000_000
    own = np.abs(said.distance_mm) * law.rate_ppm
    added_error = np.where(said.present, own, CHECKED.limits.blind_nm) + _more(said)
    for side in (error, -error):
        left = 0
        for one in side - added_error:
            left = max(0, left + int(one))
            worst = max(worst, left)
    return worst


def _more(said: Distances) -> NDArray[np.int64]:
    return np.zeros_like(said.distance_mm) if said.more_nm is None else said.more_nm


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("kind", [None, *KINDS])
@pytest.mark.parametrize("faulty", ["odometer", "check"])
def test_every_run_is_covered(faulty: str, kind: str | None) -> None:
    """Whichever unit fails, and however: beyond its added errors no run errs by more than the one-off constant."""
    for seed in range(5):
        said = reported(CHECKED, *measured(seed, faulty, kind))
        assert uncovered_nm(said) <= CHECKED.reported_law.constant_mm * 1_000_000


def test_unchecked_runs_are_not_covered() -> None:
    """The same wheel, sliding, taken as it measures: a run errs by far more than the constant."""
    assert uncovered_nm(measured(1, "odometer", "slide")[0]) > 5 * CHECKED.reported_law.constant_mm * 1_000_000


def test_lawful_units_are_never_refused() -> None:
    """However far apart both laws let them be: what both measured is told."""
    for seed in range(10):
        odometer, check = measured(seed, "odometer", None)
        both = odometer.present & check.present
        assert (reported(CHECKED, odometer, check).present == both).all()


# ------------------------------------------------------------------ cycles


def cycles(*measures: tuple[int | None, int | None]) -> list[dict[str, object]]:
    """What is said in each of them: distance or None, added error in nm, and the transition."""
    system = without_ghosts(lower(build(parts(CHECKED)).machine))
    steps = [
        {name: value for name, value in (("odometer_mm", one), ("check_mm", other)) if value is not None}
        for one, other in measures
    ]
    return [
        {"distance": one.outputs["distance_mm"] if one.outputs["reported"] else None, "more": one.outputs["more_nm"],
         "fired": next(iter(one.fired.values()))}
        for one in run(system, steps).steps
    ]  # fmt: skip


def test_units_that_agree_cost_what_the_worse_law_is() -> None:
    """At 15 m/s the wheel's law is the worse one and nothing is told beyond it; at 5 m/s the radar's floor is."""
    fast, slow = cycles((1_500, 1_500))[0], cycles((500, 500))[0]
    assert (fast["distance"], fast["more"]) == (1_500, 0)
    assert slow["more"] == 55_600_000 - 25_000_000


def test_jitter_within_the_band_costs_nothing() -> None:
    """Differences that come back are not added."""
    said = cycles(*[(1_500, 1_500 + (12 if number % 2 else -12)) for number in range(20)])
    assert {one["more"] for one in said} == {0}


def test_a_slide_is_reported_halfway_and_adds_error() -> None:
    """Once the band is used up: a quarter of 2 m is missing; half of it is told, the error covers either unit being right."""
    *_, last = cycles(*[(1_500, 2_000)] * 3)
    assert last["fired"] == "units disagree"
    assert last["distance"] == 1_752
    assert isinstance(last["more"], int) and 240_000_000 < last["more"] < 241_000_000


def test_a_vehicle_that_stands_gets_the_run_to_the_next_pulse_once() -> None:
    """The radar says no more than its floor while no pulse comes: 20 mm in the first of these cycles, and again after a pulse or a silence."""
    stop = [(0, 50)] * 3
    said = [one["more"] for one in cycles(*stop, (14, 50), *stop, (None, 50), *stop, (0, None), *stop)]
    assert [said[first : first + 3] for first in (0, 4, 8, 12)] == [[BETWEEN_NM, 0, 0]] * 4
    assert cycles((0, 60))[0]["more"] != 0


def test_a_distance_that_comes_alone_is_not_told() -> None:
    """Neither of them; and when nothing was told for longer than permitted, it is said so."""
    said = cycles((1_000, 1_000), *[(1_000, None)] * 6, (None, 1_000), (1_000, 1_000))
    assert [one["distance"] for one in said] == [1_000, *[None] * 7, 1_000]
    assert [one["fired"] for one in said[1:8]] == [
        *["distance without its check"] * 5,
        "silent too long",
        "still silent",
    ]


def test_the_constant_covers_either_unit_and_the_band() -> None:
    """5 m of the wheel; 6 m of the radar, 0.1 m to either side and 20 mm between pulses; 2 m of an eddy current unit."""
    assert CHECKED.reported_law.constant_mm == 6_220
    assert MotionConfig(check=EDDY_CURRENT).reported_law.constant_mm == 5_000
    assert MotionConfig().reported_law == CHECKED.odometer


def test_a_unit_that_measures_no_distance_is_refused() -> None:
    """One that drifts with time, and one whose floor is beyond the highest speed."""
    for law in (ACCELEROMETER, with_a_high_floor(RADAR)):
        with pytest.raises(ValidationError, match="check"):
            MotionConfig(check=law, max_speed_mm_s=5_000)


def with_a_high_floor(law: ErrorLaw) -> ErrorLaw:
    """The same law with a floor of 10 m/s."""
    return law.model_copy(update={"floor_mm_s": 10_000})


def test_a_vehicle_has_one_odometer() -> None:
    """A source that assumes another law than what is told, or does not receive the added error, is refused."""
    for balise in (BaliseConfig(), BaliseConfig(odometer=CHECKED.reported_law), BaliseConfig(checked_distance=True)):
        with pytest.raises(ValidationError, match="balise"):
            LocalizerConfig(balise=balise)
