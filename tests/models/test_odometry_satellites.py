"""Positions of satellites in place of markers (MRK-D6): what they set, what they leave alone, and wrong edits that proofs notice."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import pytest

from safeloc.language.expr import FALSE, TRUE, Bool, as_num, ite
from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.units import NM
from safeloc.language.verdict import Held
from safeloc.models import odometry
from safeloc.models.odometry import cycle
from safeloc.models.odometry.cycle import Judgement
from safeloc.models.odometry.marker_reading import ACCEPTED, NONE, NOT_BETTER, Fix
from safeloc.models.odometry.satellite_reading import SatelliteReader
from safeloc.models.odometry.simulate import NO_SATELLITES, simulate
from safeloc.models.odometry.variables import OdometryConfig, Parts, parts
from safeloc.models.odometry.world import SATELLITES
from safeloc.models.vocabulary.error_law import ACCELEROMETER, EDDY_CURRENT
from safeloc.properties.odometry import properties
from tests.models.test_odometry import PLAIN, label, marker, on_board, step
from tests.models.test_odometry_wrong_edits import refuted

GIVEN = PLAIN.model_copy(update={"satellite_markers": True, "trust_first_marker": False})
TRUSTING = GIVEN.model_copy(update={"trust_first_marker": True})
DEFAULTS = OdometryConfig(satellite_markers=True)
Patch = pytest.MonkeyPatch


def satellites(place: int, margin: int = 8_000, **more: int) -> dict[str, int]:
    """A position of satellites with equal margins, unless `below` or `above` says otherwise."""
    below, above = more.get("below", margin), more.get("above", margin)
    return {
        "satellite_position_mm": place, "satellite_margin_below_mm": below, "satellite_margin_above_mm": above,
    }  # fmt: skip


def course(*stream: Mapping[str, int], config: OdometryConfig = GIVEN) -> Trace:
    """What the machine makes of these cycles; without a distance of their own the vehicle stands."""
    return run(on_board(config), [{**step(0, config), **NO_SATELLITES, **one} for one in stream])


def verdicts(trace: Trace) -> list[str]:
    """The verdict on each cycle's position of satellites."""
    return [label(trace, "satellite_reading", at) for at in range(len(trace.steps))]


def valid(trace: Trace) -> list[bool]:
    """Whether a position is reported after each cycle."""
    return [bool(one.outputs["valid"]) for one in trace.steps]


LOCATED = ({**marker("front", 1, 0, 5_000)}, {**step(1_000), **marker("front", 2, 1_000, 5_000)})
"""Two markers that agree: a position with a margin of 5 m is reported at place 1 m."""


# ------------------------------------------------------------------ after a loss


def test_satellites_alone_end_no_loss() -> None:
    """However often they agree with each other, they stay the candidate; a marker confirms it."""
    trace = course(*([satellites(0)] * 5), marker("front", 1, 2_000, 1_000))
    assert ["CANDIDATE"] * 5 == verdicts(trace)[:5]
    assert [False] * 5 + [True] == valid(trace)
    assert 2_000 == trace.steps[-1].outputs["position_mm"]


def test_satellites_confirm_a_marker() -> None:
    """The candidate is a marker: the position is that of the satellites, and the marker's identity still waits."""
    trace = course(marker("front", 1, 0, 1_000), satellites(3_000))
    assert [False, True] == valid(trace)
    assert ["NONE", "ACCEPTED"] == verdicts(trace)
    assert 3_000 == trace.steps[-1].outputs["position_mm"]
    assert 1 == trace.steps[-1].state["pending_1"]


def test_what_contradicts_takes_the_candidates_place() -> None:
    """A marker far from the satellites' candidate, satellites far from the marker's: neither is reported."""
    trace = course(satellites(0), marker("front", 7, 400_000, 1_000), satellites(0), marker("front", 8, 1_000, 1_000))
    assert [False, False, False, True] == valid(trace)
    assert ["CANDIDATE", "NONE", "CANDIDATE", "NONE"] == verdicts(trace)


def test_the_same_marker_counts_again_after_satellites() -> None:
    """A marker that the satellites' candidate replaced is no longer the last one."""
    trace = course(marker("front", 7, 400_000, 1_000), satellites(0), marker("front", 7, 500, 1_000))
    assert ["CANDIDATE", "CANDIDATE", "ACCEPTED"] == [
        label(trace, "front_reading", 0), label(trace, "satellite_reading", 1), label(trace, "front_reading", 2),
    ]  # fmt: skip


def test_where_the_first_reference_is_believed_satellites_are_too() -> None:
    """A line without fixed markers is configured so; no candidate is known."""
    trace = course(satellites(5_000), config=TRUSTING)
    assert [True] == valid(trace)
    assert "trusted position of satellites" in trace.steps[0].fired.values()


# ------------------------------------------------------------------ while a position is reported


@pytest.mark.parametrize(
    ("given", "verdict"),
    [
        (satellites(1_500, 4_000), "ACCEPTED"),
        (satellites(1_500, 5_000), "NOT_BETTER"),
        (satellites(1_500, below=4_000, above=5_000), "NOT_BETTER"),
        (satellites(10_001, 4_000), "OUT_OF_WINDOW"),
        (satellites(10_000, 4_000), "ACCEPTED"),
        (satellites(1_500, 30_001), "TOO_COARSE"),
        (satellites(1_500, 30_000), "NOT_BETTER"),
        (satellites(GIVEN.position_limit_mm + 1, 4_000), "TOO_COARSE"),
    ],
)
def test_both_sides_of_every_limit(given: Mapping[str, int], verdict: str) -> None:
    """The interval [-4, 6] m is known: what is narrower and touches it counts, to the millimetre."""
    assert verdict == verdicts(course(*LOCATED, given))[-1]


def test_both_margins_are_kept_apart() -> None:
    """An interval that reaches farther ahead than behind is reported so."""
    outputs = course(*LOCATED, satellites(1_500, below=1_000, above=3_000)).steps[-1].outputs
    assert (1_500, 1_000, 3_000, "M1") == (
        outputs["position_mm"], outputs["margin_below_mm"], outputs["margin_above_mm"],
        label(course(*LOCATED, satellites(1_500, below=1_000, above=3_000)), "values"),
    )  # fmt: skip


def test_a_marker_counts_before_satellites() -> None:
    """In one cycle both fit; the marker sets the device although it is the coarser one."""
    trace = course(*LOCATED, {**step(1_000), **marker("front", 3, 2_000, 4_900), **satellites(2_100, 1_000)})
    assert "NOT_BETTER" == verdicts(trace)[-1]
    assert 2_000 == trace.steps[-1].outputs["position_mm"]


def test_dual_reading_goes_on_as_without_satellites() -> None:
    """The rear reader passes a marker that the front one read before satellites set the device."""
    length = GIVEN.vehicle_length_mm
    runs = [step(1_000)] * ((length - 1_000) // 1_000)
    read = {**step(1_000), **marker("rear", 1, 0, 100)}
    trace = course(*LOCATED, satellites(1_500, 4_000), *runs, read)
    assert "ACCEPTED" == label(trace, "rear_reading")
    assert "M2" == label(trace, "values")


def test_a_vehicle_that_runs_backwards_is_set_by_satellites() -> None:
    """They have no leading and no trailing side."""
    back = [step(-1_000)] * 4
    trace = course(*LOCATED, *back, satellites(-3_000, 4_000))
    assert trace.steps[-1].state["backwards"]
    assert "ACCEPTED" == verdicts(trace)[-1]


# ------------------------------------------------------------------ the machine without satellites is as it was


def test_without_the_option_nothing_is_heard_of_satellites() -> None:
    """No input, no state, no law."""
    plain = lower(odometry.machine(OdometryConfig()))
    assert [] == [var.name for var in (*plain.inputs, *plain.state) if "satellite" in var.name]
    assert SATELLITES not in odometry.machine(OdometryConfig()).world.clauses


def test_a_simulated_run_gives_no_position_of_satellites() -> None:
    """It has every input that the machine needs, and between markers the machine runs as without satellites."""
    found = []
    for config in (DEFAULTS, OdometryConfig()):
        stream = simulate(config, seed=1, seconds=60)
        told = [{key: cell for key, cell in one.items() if key != "truth_mm"} for one in stream]
        found.append([one.outputs for one in run(lower(odometry.machine(config)), told).steps])
    assert found[0] == found[1]


# ------------------------------------------------------------------ wrong edits


def fix_with(**fields: Callable[[SatelliteReader, Fix], object]) -> Callable[[Patch], None]:
    """The place by satellites is computed otherwise."""
    sound = vars(SatelliteReader)["fix"].fget

    def edit(patch: Patch) -> None:
        def wrong(reader: SatelliteReader) -> Fix:
            found = sound(reader)
            return replace(found, **{name: of(reader, found) for name, of in fields.items()})

        patch.setattr(SatelliteReader, "fix", property(wrong))

    return edit


def confirms_itself(patch: Patch) -> None:
    """Satellites confirm their own candidate."""
    sound = cycle._position

    def position(own: Parts, reader: SatelliteReader, *rest: Any) -> cycle.Reading:
        return sound(own, replace(reader, candidate_of_satellites=FALSE), *rest)  # type: ignore[arg-type]

    patch.setattr(cycle, "_position", position)


def forgets_whose_candidate(patch: Patch) -> None:
    """Every candidate counts as a marker."""
    patch.setattr(
        odometry, "_candidate_of_satellites", lambda own, is_so: {own.satellites.candidate_of_satellites: FALSE}
    )


def no_window(patch: Patch) -> None:
    """A position of satellites is accepted wherever it lies."""
    patch.setattr(Fix, "fits", lambda fix, reference: TRUE)


def beside_markers(patch: Patch) -> None:
    """A position of satellites sets the device in a cycle in which a marker does."""
    sound = cycle._position

    def position(own: Parts, reader: SatelliteReader, readings: Sequence[cycle.Reading], *rest: Any) -> cycle.Reading:
        silent = [replace(one, verdict=NONE) for one in readings]
        return sound(own, reader, silent, *rest)

    patch.setattr(cycle, "_position", position)


def forgets_identities(patch: Patch) -> None:
    """The identities that wait are forgotten in a cycle with a position of satellites."""
    sound = Judgement.remembered

    def remembered(judgement: Judgement) -> cycle.Remembered:
        found, taken = sound(judgement), _taken(judgement)
        zero = as_num(0, found.last_marker.unit)
        return replace(found, pending=[ite(taken, zero, one) for one in found.pending])

    patch.setattr(Judgement, "remembered", remembered)


def _taken(judgement: Judgement) -> Bool:
    assert judgement.satellites is not None
    return judgement.satellites.accepted


EDITS: Mapping[str, tuple[Callable[[Patch], None], str]] = {
    "margin below left out": (fix_with(below=lambda *_: as_num(0, NM)), "containment"),
    "margins swapped": (fix_with(below=lambda _, fix: fix.above, above=lambda _, fix: fix.below), "containment"),
    "place a metre off": (fix_with(position=lambda _, fix: fix.position + 1_000), "containment"),
    "satellites confirm themselves": (confirms_itself, "satellites alone end no loss"),
    "whose candidate it is is forgotten": (forgets_whose_candidate, "a candidate of satellites is known as one"),
    "no window": (no_window, "a position of satellites that is outside sets nothing"),
    "a marker and satellites in one cycle": (beside_markers, "a marker counts before satellites"),
    "identities forgotten": (forgets_identities, "satellites touch no identity"),
}


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", EDITS)
def test_a_wrong_edit_is_noticed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """After the edit the claim, or a lemma that it rests on, does not hold any more."""
    edit, claim = EDITS[name]
    edit(monkeypatch)
    assert refuted(odometry.build(parts(DEFAULTS)), claim)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("claim", sorted({claim for _, claim in EDITS.values()}))
def test_without_an_edit_nothing_is_refuted(claim: str) -> None:
    """The machine as it is keeps all that the edits break."""
    assert refuted(odometry.build(parts(DEFAULTS)), claim) == set()


def never_used(patch: Patch) -> None:
    """A position of satellites is judged not better, whatever it is."""
    sound = cycle._position

    def position(*given: Any) -> cycle.Reading:
        found = sound(*given)
        return replace(found, verdict=ite(found.verdict.eq(ACCEPTED), NOT_BETTER, found.verdict))

    patch.setattr(cycle, "_position", position)


@pytest.mark.thorough
def test_a_position_that_is_never_used_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """It sets nothing, so no claim of safety is broken; the one that bounds the margin is."""
    never_used(monkeypatch)
    assert refuted(odometry.build(parts(DEFAULTS)), "a position of satellites bounds the margin")


DRIFTING = OdometryConfig(
    devices=1, first_unit=EDDY_CURRENT, second_unit=ACCELEROMETER, satellite_markers=True, trust_first_marker=True
)


def test_a_position_outside_sets_nothing_where_a_unit_drifts(monkeypatch: Patch) -> None:
    """The law of a unit that drifts explains ever more with its age: the units may differ by two runs, and the claim allows for it."""
    outside = "a position of satellites that is outside sets nothing"
    assert refuted(odometry.build(parts(DRIFTING)), outside) == set()
    monkeypatch.setattr(Fix, "fits", lambda *_: TRUE)
    assert refuted(odometry.build(parts(DRIFTING)), outside)


OLD_REAR = OdometryConfig(
    first_unit=EDDY_CURRENT,
    second_unit=ACCELEROMETER.model_copy(update={"drift_mm_s2": 1_000}),
    satellite_markers=True,
    trust_first_marker=True,
    period_ms=1_000,
    max_speed_mm_s=1_000,
    measuring_step_mm=0,
    reader_latency_ms=0,
    vehicle_length_mm=0,
    vehicle_length_tolerance_mm=0,
)
"""One second a cycle, 1 m/s, and an accelerometer of 1 m/s2: the drift of an old device shows after a few cycles."""


def test_the_device_that_is_meant_has_its_own_age() -> None:
    """The front device has failed, the rear one is 20 s old: a lone distance of its accelerometer explains 20 m, and the claim allows for them."""
    rear = ("rear_eddy_current_mm", "rear_accelerometer_mm")
    still = dict.fromkeys((*rear, "front_eddy_current_mm", "front_accelerometer_mm"), 0)
    alone = dict.fromkeys(rear, 0)
    stream = [
        {**still, **marker("front", 1, 0)},
        {**still, **marker("rear", 1, 0)},
        *([alone] * 18),
        {"rear_accelerometer_mm": 0, **satellites(20_000, 0)},
    ]
    model = odometry.build(parts(OLD_REAR))
    trace = run(without_ghosts(lower(model.machine)), [{**NO_SATELLITES, **one} for one in stream])
    before, after = trace.steps[-2], trace.steps[-1]
    assert ("REAR", "ACCEPTED") == (label(trace, "mode", -2), label(trace, "satellite_reading"))
    assert (False, 0, 20_000) == (
        before.state["front_eddy_current_alive"], before.state["front_age_ms"], after.outputs["position_mm"],
    )  # fmt: skip
    outside = "a position of satellites that is outside sets nothing"
    claim = next(one for one in properties(model) if one.name == outside)
    assert isinstance(check_all(trace, [claim])[0], Held)
