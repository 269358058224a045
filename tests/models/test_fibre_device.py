"""The fibre device: what its sensors give is no input, a wrong counter or light is noticed, and the recordings say what they teach."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from pydantic import ValidationError

from safeloc.catalogue import load_target
from safeloc.language.expr import TRUE, Num, NumVar, Var, as_num, ite, minimum
from safeloc.language.interpret import run
from safeloc.language.system import without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.units import COUNT
from safeloc.language.world import Law
from safeloc.models import fibre_device
from safeloc.models.area.world import CLEAR_CLAUSE
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.models.fibre import FibreConfig
from safeloc.models.fibre.variables import FLIGHT_DIFFERS
from safeloc.models.fibre_area import FibreAreaConfig
from safeloc.models.fibre_area.entry_world import EMPTY, EXACT, SOUND
from safeloc.models.fibre_device import FibreDevice, FibreDeviceConfig, compose_machines
from safeloc.models.fibre_device import reference as reference_model
from safeloc.models.fibre_device.configurations import CONFIGURATIONS
from safeloc.models.fibre_device.course import Parts as Course
from safeloc.models.fibre_device.reference import ONE_TRAIN, Counted
from safeloc.models.fibre_device.simulate import (
    CONFIG,
    RUNS,
    SERVICE,
    Stay,
    first_values,
    simulate,
    simulate_stay,
    write,
)
from safeloc.models.fibre_timed.additional import TRUE_PLACE
from safeloc.models.fibre_timed.simulate import Timed
from safeloc.models.train_order import TrainOrder
from safeloc.models.verification import VerificationConfig
from safeloc.proof.provers.implication import Refuted
from safeloc.proof.provers.replayed_evidence import admissible_run
from safeloc.properties.fibre_device import properties
from safeloc.runtime.streams.steps import read_steps
from tests.models.inductive import inductive_in
from tests.models.owed_contracts import contract
from tests.shipped_recordings import shipped

NO_F = "a true time raises no F"
"""The end of two claims that hold by more than one step."""

# ------------------------------------------------------------------ contracts


def test_what_a_sensor_of_the_area_gives_is_no_input() -> None:
    """Neither a record, nor an axle count, nor a place by time of flight; each law on them is owed."""
    system = compose_machines().composition.system
    left = {var.name for var in system.inputs}
    wired = ("verification.record_", "entry.record_", "entry.reference_", "axle_section.axles_", "axle_section.head_")
    assert not {name for name in left if name.startswith(wired) or "flight_position" in name}
    assert {"counter_low.axle", "counter_high.head_fault", "reference.neighbour_sends", "rear_flight.delay_ps"} <= left
    assert {
        "front_additional": (TRUE_PLACE,), "rear_additional": (TRUE_PLACE,),
        "entry": (SOUND, EXACT, EMPTY), "area": (CLEAR_CLAUSE,),
    } == {part.name: part.guaranteed for part in system.parts if part.guaranteed}  # fmt: skip


def test_a_sound_reference_follows_from_the_counter_and_one_train_a_passage(monkeypatch: pytest.MonkeyPatch) -> None:
    """And from neither alone: without the counter's count, and with a passage of two trains, it may have too many axles."""
    whole = compose_machines().composition
    assert None is contract(whole, "entry")
    for side in ("low", "high"):
        assert isinstance(contract(whole, "entry", f"counter_{side}: the count is true"), Refuted)
    laws = reference_model._laws
    monkeypatch.setattr(
        reference_model,
        "_laws",
        lambda own: {**laws(own), ONE_TRAIN: Law(TRUE, "Nothing.", source="[D]", owner="nobody")},
    )
    assert isinstance(contract(compose_machines().composition, "entry"), Refuted)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"counter": AxleCounterConfig(axles_a_cycle=40)}, r"area\.verification\.period_ms is 500, but counter\.period_ms is 100"),
        (
            {"counter": CONFIG.counter.model_copy(update={"max_speed_mm_s": 50_000})},
            r"area\.verification\.max_speed_mm_s is 44445, but counter\.max_speed_mm_s is 50000",
        ),
        (
            {
                "counter": CONFIG.counter.model_copy(update={"max_speed_mm_s": 50_000}),
                "area": CONFIG.area.model_copy(
                    update={"verification": VerificationConfig(length_limit_mm=1_600_000, max_speed_mm_s=50_000)}
                ),
            },
            r"area\.sections\.area\.max_speed_mm_s is 44445, but counter\.max_speed_mm_s is 50000",
        ),
        ({"counter": CONFIG.counter.model_copy(update={"axles_a_cycle": 10})}, r"area\.axle_section\.axles_a_cycle is 40, but counter\.axles_a_cycle is 10"),
        (
            {"area": FibreAreaConfig(fibre=FibreConfig(flight_threshold_mm=155_000), verification=VerificationConfig(max_speed_mm_s=44_445))},
            r"length_limit_mm 1500000 is below 1542873",
        ),
        ({"area": CONFIG.area.model_copy(update={"fibre": FibreConfig()})}, r"fibre\.flight_threshold_mm is 60000, but a true time"),
        (
            {"area": CONFIG.area.model_copy(update={"verification": VerificationConfig(length_limit_mm=1_600_000, max_speed_mm_s=44_445, position_limit_mm=100_000_000)})},
            r"position_limit_mm 100000000 is below 103090747",
        ),
    ],
)  # fmt: skip
def test_configurations_that_cannot_work_are_refused(fields: dict[str, object], message: str) -> None:
    """With the figure that is in the way."""
    with pytest.raises(ValidationError, match=message):
        FibreDeviceConfig(**fields)  # type: ignore[arg-type]


def _loses(whole: FibreDevice) -> set[str]:
    """Claims that are not kept in one step."""
    system = whole.composition.system
    asked = [prop for prop in properties(whole) if prop.kind == "always" and NO_F not in prop.name]
    return {prop.name for prop in asked if not inductive_in(system, prop, prop.name)}


@pytest.mark.thorough
@pytest.mark.parametrize("shift", [lambda own: own.place, lambda own: minimum(own.place + own.run, 0)])
def test_light_to_another_place_than_the_end_is_noticed(
    shift: Callable[[Course], Num], monkeypatch: pytest.MonkeyPatch
) -> None:
    """To where it was before the cycle, and to none beyond zero."""
    monkeypatch.setattr(Course, "place_after", property(shift))
    lost = {f"{end}: the light runs to the end that the sections follow" for end in ("front", "rear")}
    assert lost <= _loses(compose_machines())


@pytest.mark.thorough
@pytest.mark.parametrize("trains", [1, 2])
def test_the_record_of_another_train_is_none(trains: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """With two trains a machine that takes the record of whoever is outermost is noticed; with one train there is nobody else."""
    right = Counted.is_this_trains
    of_anybody = property(lambda one: right.fget(replace(one, outermost=ite(one.outermost > 0, as_num(1, COUNT), 0))))  # type: ignore[attr-defined, misc]
    monkeypatch.setattr(Counted, "is_this_trains", of_anybody)
    config = CONFIG if trains == 1 else CONFIGURATIONS.named["two trains"]
    assert isinstance(config, FibreDeviceConfig)
    assert (trains == 2) == ("the counter's record of the train is its reference" in _loses(compose_machines(config)))


@pytest.mark.thorough
@pytest.mark.parametrize("trains", [1, 2])
def test_the_outermost_train_at_the_other_end_is_noticed(trains: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """With two trains; with one, it is the outermost at both ends."""
    right = fibre_device.outermost_before

    def exchanged(order: TrainOrder, low_and_high: Sequence[NumVar]) -> dict[Var, Num]:
        (low, at_low), (high, at_high) = right(order, low_and_high).items()
        return {low: at_high, high: at_low}

    monkeypatch.setattr(fibre_device, "outermost_before", exchanged)
    config = CONFIG if trains == 1 else CONFIGURATIONS.named["two trains"]
    assert isinstance(config, FibreDeviceConfig)
    assert (trains == 2) == ("the counter's record of the train is its reference" in _loses(compose_machines(config)))


# ------------------------------------------------------------------ recordings


def _trace(stay: Stay) -> Trace:
    system = load_target("fibre_device").system
    steps = [
        {name: cell for name, cell in step.items() if name != "truth_mm"}
        for step in simulate_stay(CONFIG, stay, seed=1)
    ]
    return run(system, steps, first=first_values(CONFIG, stay.journey))


@cache
def _recorded(name: str) -> Trace:
    return _trace(RUNS[name])


def _cycles(trace: Trace, output: str, value: object) -> list[int]:
    return [number for number, step in enumerate(trace.steps) if step.outputs[output] == value]


def test_recordings_are_what_the_simulation_makes(tmp_path: Path) -> None:
    """Name by name, and no other one ships."""
    made = write(tmp_path)
    assert {f"fibre_device-{name}" for name in RUNS} == {path.name.removesuffix(".jsonl.gz") for path in made}
    for path in made:
        ships = read_steps(shipped(path.name.removesuffix(".jsonl.gz")))
        assert list(read_steps(path).steps) == list(ships.steps)


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("name", RUNS)
def test_recordings_obey_all_laws(name: str) -> None:
    """Of every machine: counters, light, fibre, area."""
    recording = read_steps(shipped(f"fibre_device-{name}"))
    system = load_target("fibre_device").system
    steps = [{key: cell for key, cell in step.items() if key != "truth_mm"} for step in recording.steps]
    assert len(steps) == len(admissible_run(system, recording.first, steps).steps)


@pytest.mark.parametrize(("name", "side"), [("service", "low"), ("from-high", "high")])
def test_a_train_is_verified_by_the_record_of_its_counter(name: str, side: str) -> None:
    """From the cycle of that record on, whichever way it came in; the one at the other end has none of it."""
    trace = _recorded(name)
    [record] = _cycles(trace, "reference.sender", 1)
    told = trace.steps[record]
    assert told.outputs[f"counter_{side}.record_sound"] and told.outputs["verification.trusted"]
    assert 40 == told.outputs["reference.axles"]
    assert min(_cycles(trace, "verification.trusted", True)) == record


def test_a_simulated_stay_has_its_first_state() -> None:
    """So that what `safeloc simulate` writes can be replayed."""
    made = simulate(CONFIG, seed=3)
    steps = [{name: cell for name, cell in step.items() if name != "truth_mm"} for step in made.steps]
    assert len(steps) == len(admissible_run(load_target("fibre_device").system, made.first, steps).steps)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("length_mm", "axles", "speed_mm_s"),
    [(205_000, 40, 15_000), (400_000, 64, 20_000), (740_000, 144, 15_000), (740_000, 144, 40_000)],
)
def test_a_longer_train_is_verified_too(length_mm: int, axles: int, speed_mm_s: int) -> None:
    """From 15 m/s on, up to the longest train of the lines in Europe."""
    journey = replace(
        SERVICE, cycles=240, length_mm=length_mm, axles=axles, speeds_mm_s=((0, speed_mm_s),), area_mm=(0, 8_000_000)
    )
    assert any(step["verification.trusted"] for step in _without_ghosts(Stay(journey)))


def test_a_train_that_is_handed_over_is_verified_before_its_record() -> None:
    """By the neighbour's record, and then by the counter's; a section that is missed later ends that."""
    trace = _recorded("handed-over")
    [handed_over], [record] = (_cycles(trace, "reference.sender", sender) for sender in (2, 1))
    assert handed_over < record
    assert trace.steps[record - 1].outputs["verification.trusted"]
    assert trace.steps[record].outputs["verification.trusted"]


def test_a_passage_with_a_flaw_verifies_nobody() -> None:
    """Its record is overdue, and is not sound when the counter reports that the passage is over."""
    trace = _recorded("no-speed")
    [record] = _cycles(trace, "reference.sender", 1)
    assert trace.steps[record - 1].outputs["entry.reference_missing"]
    assert not trace.steps[record].outputs["reference.sound"]
    assert not _cycles(trace, "verification.trusted", True)


# ------------------------------------------------------------------ laws broken


def test_light_that_becomes_slower_raises_f_and_withholds() -> None:
    """The place by sections is contradicted: F in the cycle of a section's signal, and the train is trusted no more."""
    trace = _without_ghosts(Stay(SERVICE, Timed(index_ppm=60)))
    errors = [number for number, step in enumerate(trace) if FLIGHT_DIFFERS.value == step["front.why"]]
    assert errors and any(step["verification.trusted"] for step in trace[: errors[0]])
    assert not any(step["verification.trusted"] for step in trace[errors[0] :])


def test_a_follower_within_the_headway_is_counted_with_the_train_and_not_verified() -> None:
    """It breaks the law of one train a passage: the record has both trains' axles, and the fibre's count contradicts it."""
    close = Stay(replace(SERVICE, unannounced=(20, 15_000)))
    trace = _without_ghosts(close)
    [record] = [step for step in trace if step["reference.sender"] == 1]
    assert record["reference.sound"] and 60 == record["reference.axles"]
    assert not any(step["verification.trusted"] for step in trace)


def _without_ghosts(stay: Stay) -> list[Mapping[str, object]]:
    """Outputs and state of each step, of the machines alone."""
    system = without_ghosts(load_target("fibre_device").system)
    inputs = {var.name for var in system.inputs}
    steps = [
        {name: cell for name, cell in step.items() if name in inputs} for step in simulate_stay(CONFIG, stay, seed=1)
    ]
    first = {
        name: value
        for name, value in first_values(CONFIG, stay.journey).items()
        if name in {var.name for var in system.state}
    }
    return [{**step.state, **step.outputs} for step in run(system, steps, first=first).steps]
