"""Models that the direction hears of the radar's frame: wrong terms are refused by a claim, and the recordings tell each reflector once as it is passed (RFL-D5)."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import pytest
from pydantic import ValidationError

from safeloc.language.expr import FALSE, TRUE, Bool, Expr, all_of, maximum, minimum
from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.trace import Trace
from safeloc.language.verdict import Violated
from safeloc.models.balise.groups import Group
from safeloc.models.reflector.echo import Slot
from safeloc.models.reflector.simulate import Reflector, Route
from safeloc.models.reflector.simulate import Scene as RadarScene
from safeloc.models.reflector_device import ReflectorDevice, ReflectorDeviceConfig, compose_machines
from safeloc.models.reflector_device.met_models import Carried, Frame
from safeloc.models.reflector_device.simulate import GROUPS, Scene, first_state, simulate
from safeloc.models.vocabulary.reflectors import MODEL, NO_MODEL
from safeloc.properties.reflector_device.met import properties
from safeloc.simulation.faults import Fault
from tests.models.composed_devices import Runs, holds
from tests.models.edited_terms import edited

AHEAD = "the direction hears the nearest reflector ahead"
NOTHING_ELSE = "the direction hears nothing else ahead"
PASSED = "a reflector is passed where its distance is run"
NO_OTHER = "no other reflector is passed"
MEASURED = "the nearest reflector is measured as it comes near"
CARRIED = "a reflector that is near is carried on by the odometer"
NOTHING_NEAR = "without a reflector near nothing comes next"
CLAIMS = (AHEAD, NOTHING_ELSE, PASSED, NO_OTHER, MEASURED, CARRIED, NOTHING_NEAR)


def kept(claim: str) -> bool:
    """Whether the device as its terms are now keeps the claim."""
    whole = compose_machines()
    return holds(whole.composition, properties(whole), claim)


def _heard(frame: Frame, one: Slot, **left_out: bool) -> Bool:
    """An echo that shows a reflector, without some of the conditions."""
    figures = frame.config.reflector
    conditions = {
        "present": frame.present,
        "range": one.range.present,
        "strong": one.intensity >= figures.minimum_intensity_cdb,
        "model": one.model.ne(NO_MODEL),
        "beyond": one.range.value >= max(figures.near_range_mm, figures.radar_offset_mm),
    }
    return all_of(condition for name, condition in conditions.items() if name not in left_out)


EDITS: Mapping[str, tuple[type, str, Callable[..., Expr], str]] = {
    "weak echoes are heard": (Frame, "_shows_reflector", lambda f, _, one: _heard(f, one, strong=True), NOTHING_ELSE),
    "echoes without a frame are heard": (
        Frame, "_shows_reflector", lambda f, _, one: _heard(f, one, present=True), NOTHING_ELSE),
    "echoes from too near are heard": (
        Frame, "_shows_reflector", lambda f, _, one: _heard(f, one, beyond=True), NOTHING_ELSE),
    "the first echo is the nearest": (Frame, "_is_nearest", lambda f, _, one: f._shows_reflector(one), AHEAD),
    "every reflector in view is near": (Frame, "_is_near", lambda f, _, one: f._shows_reflector(one), NOTHING_NEAR),
    "the passing range is 1 mm less": (
        Frame, "_is_near", lambda f, right, one: right & (one.range.value < f.config.passing_range_mm), MEASURED),
    "the distance is that of the front end": (
        Frame, "away", lambda f, right: maximum(right - f.config.balise.antenna_mm, 0), MEASURED),
    "a reflector behind a nearer one is passed": (
        Frame, "shows_near", lambda f, _, model: f.near & f.model.eq(model), NO_OTHER),
    "a reflector that is still seen is passed": (Frame, "shows_near", lambda _f, _right, _model: FALSE, NO_OTHER),
    "no reflector is ever passed": (Frame, "shows_near", lambda _f, _right, _model: TRUE, PASSED),
    "passed as soon as it is not seen": (
        Carried, "passed", lambda c, _: c.near.ne(NO_MODEL) & ~c.frame.shows_near(c.near), NO_OTHER),
    "passed 1 mm early": (
        Carried, "passed", lambda c, _: all_of([c.near.ne(NO_MODEL), c.due <= 1, ~c.frame.shows_near(c.near)]), NO_OTHER),
    "passed 1 mm late": (Carried, "passed", lambda c, right: right & (c.due < 0), PASSED),
    "a nearer one comes first": (Carried, "measured", lambda c, _: c.frame.near, CARRIED),
    "only a new one is measured": (Carried, "measured", lambda c, right: right & c.near.eq(NO_MODEL), MEASURED),
    "the run is not taken off": (Carried, "left", lambda c, right: minimum(right + 1, c.frame.farthest_mm), CARRIED),
}  # fmt: skip
"""Owner, term, wrong term, and the claim that refuses it."""


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", EDITS)
def test_a_wrong_term_is_refused(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the claim that is named."""
    owner, term, wrong, claim = EDITS[name]
    edited(monkeypatch, owner, term, wrong)
    assert not kept(claim)


@pytest.mark.parametrize("claim", CLAIMS)
def test_the_right_terms_keep_it(claim: str) -> None:
    """So that a refusal is due to the edit."""
    assert kept(claim)


def driven(scene: Scene) -> Trace:
    """The device along a simulated run."""
    config, whole = ReflectorDeviceConfig(), compose_machines()
    trace = run(whole.composition.system, simulate(config, scene, seed=7), first=first_state(config, scene))
    claims = properties(whole)
    assert not [one for one in check_all(trace, claims) if isinstance(one, Violated)]
    return trace


def passed_in(trace: Trace) -> list[tuple[int, str]]:
    """The cycles in which a reflector is passed, with its model."""
    label = {one.value: one.label for one in MODEL}
    told = [(n, label[step.outputs["met.passed_model"]]) for n, step in enumerate(trace.steps)]
    return [(n, model) for n, model in told if model != "NONE"]


RUNS = Runs("reflector_device")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", ["line", "wrong-way"])
def test_each_reflector_is_passed_once(name: str) -> None:
    """A, B, C and D in their order, each within one cycle of that in which the balise antenna reaches it."""
    places_mm = {"A": 380_000, "B": 700_000, "C": 1_400_000, "D": 1_480_000}
    steps, antenna_mm = RUNS.recorded(name).steps, 3_000
    found = passed_in(RUNS.recorded(name))
    assert [model for _, model in found] == list(places_mm)
    for cycle, model in found:
        place_nm = (places_mm[model] + antenna_mm) * 10**6
        reached = next(n for n, one in enumerate(steps) if one.state["truth_nm"] >= place_nm)
        assert abs(cycle - reached) <= 1


def test_hearing_a_reflector_needs_its_machine() -> None:
    """The machine assumes nothing, and hears the frame of the reflector machine."""
    whole: ReflectorDevice = compose_machines()
    assert not whole.met.machine.world.laws
    system = whole.composition.system
    assert not {var.name for var in system.inputs if var.name.startswith("met.")}
    assert set(whole.met.machine.inputs) - {whole.met.turned, whole.met.run} <= set(whole.source.machine.inputs)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("place_mm", "disturbances"),
    [(506_000, ()), (522_000, (Fault("blind", "", 402, 420),))],
    ids=["6 m behind the group", "22 m behind it, hidden as the group is read"],
)
def test_a_reflector_behind_a_group_is_none_before_it(place_mm: int, disturbances: tuple[Fault, ...]) -> None:
    """It is near, and seen no more, as the group is read: taken for one that is passed, it would state the wrong direction."""
    places = (100_000, 200_000, 300_000, 500_000)
    groups = tuple(Group(101 + number, place, accuracy_mm=1_000) for number, place in enumerate(places))
    line = (Reflector(400_000, "A", 100_000), Reflector(place_mm, "B", 100_000), Reflector(600_000, "A", 80_000))
    radar = RadarScene(Route((), line), pauses=0, dropout=0, disturbances=disturbances)
    trace = driven(Scene([(640_000, 20_000, 700, 2.0)], groups, radar))
    done = [step.fired["travel_direction.fired"] for step in trace.steps]
    assert ["A", "B", "A"] == [model for _, model in passed_in(trace)]
    assert ["fits along", "refuted"] == [one for one in done if not one.startswith(("stay", "turned"))]


@pytest.mark.thorough
def test_a_vehicle_that_stands_passes_nothing() -> None:
    """30.1 m before a reflector, the noise of the radar brings it near and far in turn."""
    reflectors = (Reflector(400_000, "A", 100_000),)
    radar = RadarScene(Route((), reflectors), pauses=0, dropout=0, clutter=0)
    trace = driven(Scene([(369_900, 20_000, 700, 6.0), (60_000, 15_000, 700, 2.0)], GROUPS, radar))
    assert ["A"] == [model for _, model in passed_in(trace)]


@pytest.mark.parametrize("range_mm", [7_444, 300_000])
def test_a_passing_range_that_no_reflector_is_seen_in_is_refused(range_mm: int) -> None:
    """Less than the near range and the run of a cycle, or all that the radar sees."""
    with pytest.raises(ValidationError, match=r"passing_range_mm \d+ must be at least 7445 "):
        ReflectorDeviceConfig(passing_range_mm=range_mm)
