"""The odometry machine: worked figures, real recordings, readings of every kind, and proofs that notice a wrong model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest
from pydantic import ValidationError

from safeloc.codegen.compiled import compile_system
from safeloc.language.interpret import run
from safeloc.language.machine import Machine
from safeloc.language.monitor import check_all
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.verdict import Held
from safeloc.models import odometry
from safeloc.models.odometry.simulate import simulate
from safeloc.models.odometry.variables import OdometryConfig, parts
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.proof.drawn_runs.driver import Driver
from safeloc.properties.odometry import properties
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg
from tests.data_sources import log_steps_mm, rows
from tests.models.inductive import inductive

FIVE_PERCENT = ErrorLaw(kind="wheel", constant_mm=0, rate_ppm=50_000)
PLAIN = OdometryConfig(
    first_unit=FIVE_PERCENT,
    second_unit=ErrorLaw(kind="radar", constant_mm=0, rate_ppm=50_000),
    vehicle_length_mm=100_000,
    vehicle_length_tolerance_mm=0,
    measuring_step_mm=1_000,
    reader_latency_ms=0,
    trust_first_marker=True,
)
UNITS = ("front_wheel_mm", "front_radar_mm", "rear_wheel_mm", "rear_radar_mm")


def on_board(config: OdometryConfig) -> TransitionSystem:
    """The machine without its environment."""
    return without_ghosts(lower(odometry.machine(config)))


def step(distance: int, config: OdometryConfig = PLAIN, **more: int) -> dict[str, int]:
    """One cycle in which all units measure the same distance."""
    return {**dict.fromkeys(UNITS[: 2 * config.devices], distance), **more}


def marker(end: str, identity: int, place: int | None, accuracy: int = 0, since: int | None = 0) -> dict[str, int]:
    """One marker reading."""
    values = {"": identity, "_position_mm": place, "_accuracy_mm": accuracy, "_since_mm": since}
    if place is None:
        values = {"": identity}
    return {f"{end}_marker{key}": value for key, value in values.items() if value is not None}


def outputs(trace: Trace) -> list[Mapping[str, Value]]:
    """The outputs of every step."""
    return [one.outputs for one in trace.steps]


def label(trace: Trace, name: str, index: int = -1) -> str:
    """An enumerated output or state variable as its member."""
    values = {**trace.steps[index].outputs, **trace.steps[index].state}
    unit = (trace.system.variable(name) if name not in trace.system.outputs else trace.system.outputs[name]).unit
    return str(unit.members[values[name]])


def drive(distance_mm: int, spacing_mm: int, length_mm: int) -> Trace:
    """A run over markers `spacing_mm` apart, each read by both ends, at one metre a cycle."""
    config = PLAIN.model_copy(update={"vehicle_length_mm": length_mm})
    stream = []
    for place in range(0, distance_mm + 1, 1_000):
        record = step(0 if place == 0 else 1_000)
        if place % spacing_mm == 0:
            record |= marker("front", place // spacing_mm + 1, place)
        if place >= length_mm and (place - length_mm) % spacing_mm == 0:
            record |= marker("rear", (place - length_mm) // spacing_mm + 1, place - length_mm)
        stream.append(record)
    return run(on_board(config), stream)


@pytest.mark.parametrize(("length", "on_m1", "on_m2"), [(300_000, 300, 200), (100_000, 100, 400)])
def test_worked_figures(length: int, on_m1: int, on_m2: int) -> None:
    """MRK-D5: 500 m between markers: M1 counts over one vehicle length, M2 over the rest."""
    trace = drive(1_000_000, 500_000, length)
    values = [label(trace, "values", index) for index in range(len(trace.steps))]
    between_markers = values[500:1000]
    assert (between_markers.count("M1"), between_markers.count("M2")) == (on_m1, on_m2)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("length", [100_000, 250_000, 300_000, 499_000])
def test_worst_run_is_the_longer_part(length: int) -> None:
    """The farthest run since a reading is max(L, D - L), for 0 < L < D; the reading comes in the next cycle."""
    trace = drive(1_500_000, 500_000, length)
    worst = max(int(out["distance_run_mm"]) for out in outputs(trace)[500:])
    assert worst == max(length, 500_000 - length) - 1_000


def test_two_devices_are_never_worse_than_the_front_one_alone() -> None:
    """On the same run the reported margin with both readers is never greater than with the front reader only."""
    config = OdometryConfig(vehicle_length_mm=100_000)
    stream = simulate(config, seed=3, seconds=120, missed=0.1)
    both = run(on_board(config), [plain(record) for record in stream])
    alone_config = config.model_copy(update={"devices": 1})
    front = [{k: v for k, v in plain(record).items() if k.startswith("front")} for record in stream]
    alone = run(on_board(alone_config), front)
    compared = 0
    for with_both, with_one in zip(outputs(both), outputs(alone), strict=True):
        if with_one["valid"] and with_both["valid"]:
            compared += 1
            assert margin(with_both) <= margin(with_one) + 1
    assert compared > 100


def margin(out: Mapping[str, Value]) -> int:
    """The greater side."""
    return max(int(out["margin_above_mm"]), int(out["margin_below_mm"]))


def plain(record: Mapping[str, int | bool]) -> dict[str, int | bool]:
    """A simulated step without ghosts and remarks."""
    return {
        name: value for name, value in record.items() if not name.endswith(("_nm", "_stray")) and name != "truth_mm"
    }


def test_published_trace_of_half_widths() -> None:
    """openETCS: markers at 100, 200, 700 m, 3 m and 5 %, no constant: all 801 half-widths agree (rounded outward)."""
    config = PLAIN.model_copy(update={"devices": 1, "max_acceleration_mm_s2": 10_000})
    recorded = rows("openetcs/scenario_01.csv")
    places = {0: (1, 0), 10_000: (2, 3_000), 20_000: (3, 3_000), 70_000: (4, 3_000)}
    stream, before = [], 0
    for row in recorded:
        true_cm = int(row["true_cm"])
        record = step((true_cm - before) * 10, config)
        if true_cm in places:
            identity, accuracy = places[true_cm]
            record |= marker("front", identity, true_cm * 10, accuracy)
        stream.append(record)
        before = true_cm
    reported = outputs(run(on_board(config), stream))
    assert len(reported) == 801
    for row, out in zip(recorded, reported, strict=True):
        assert out["position_mm"] == int(row["true_cm"]) * 10
        assert 0 <= int(out["margin_above_mm"]) - int(row["max_dev_cm"]) * 10 <= 1
        assert 0 <= int(out["margin_below_mm"]) + int(row["min_dev_cm"]) * 10 <= 1


def replayed_log(name: str) -> Trace:
    """A train log as distances of all four units."""
    config = OdometryConfig(period_ms=400)
    limit = 2 * config.limits.max_cycle_distance_mm + 1_000
    stream = []
    for distance in log_steps_mm(name):
        usable = distance is not None and distance <= limit  # farther is refused at the border: out of range
        stream.append(step(distance, config) if usable and distance is not None else {})
    return run(on_board(config), stream)


@pytest.mark.parametrize("name", ["trains/log_28876.csv", "trains/log_31176.csv"])
def test_clean_logs_are_admitted_whole(name: str) -> None:
    """Every distance of the clean recordings passes the gates."""
    trace = replayed_log(name)
    assert {label(trace, "front_wheel_last_verdict", index) for index in range(len(trace.steps))} == {"ADMITTED"}


def test_jumps_of_the_faulty_log_are_rejected() -> None:
    """The faulty recording: jumps are refused with a reason, and no interval narrows because of one."""
    trace = replayed_log("trains/log_29083.csv")
    judged = [label(trace, "front_wheel_last_verdict", index) for index in range(len(trace.steps))]
    assert judged.count("ADMITTED") > 700
    assert {"MISSING"} < set(judged)
    for index in range(1, len(trace.steps)):
        before, after = trace.steps[index - 1].state, trace.steps[index].state
        if before["front_wheel_alive"] and after["front_wheel_alive"]:
            assert after["front_wheel_margin_above_nm"] >= before["front_wheel_margin_above_nm"]


def test_jumps_move_no_interval_after_a_reference() -> None:
    """With a reference first, the faulty log's jumps never narrow the margin and never go unexplained."""
    config = OdometryConfig(period_ms=400, trust_first_marker=True, tolerance_mm=500_000)
    limit = 2 * config.limits.max_cycle_distance_mm + 1_000
    stream = [step(0, config, **marker("front", 1, 0))]
    stream += [step(d, config) if d is not None and d <= limit else {} for d in log_steps_mm("trains/log_29083.csv")]
    trace = run(on_board(config), stream)
    rejected = 0
    for index in range(1, len(trace.steps)):
        before, after = trace.steps[index - 1].outputs, trace.steps[index].outputs
        if before["valid"] and after["valid"]:
            assert margin(after) >= margin(before)
        rejected += label(trace, "front_wheel_last_verdict", index) != "ADMITTED"
    assert rejected > 0


# ------------------------------------------------------------------ readings of every kind


def located() -> list[dict[str, int]]:
    """A start at place 0 by a trusted marker, then 10 m of run."""
    return [step(0, **marker("front", 1, 0)), *(step(1_000) for _ in range(10))]


@pytest.mark.parametrize(
    ("reading", "verdict"),
    [
        (marker("front", 2, 11_000), "ACCEPTED"),
        (marker("front", 77, None), "FOREIGN"),
        (marker("front", 1, 0), "REPEATED"),
        (marker("front", 2, -5_000), "OUT_OF_ORDER"),
        (marker("front", 2, 90_000), "OUT_OF_WINDOW"),
        (marker("front", 2, 11_000, accuracy=40_000), "TOO_COARSE"),
        (marker("front", 2, 11_000, accuracy=29_000), "NOT_BETTER"),
        ({"front_marker_position_mm": 11_000}, "MALFORMED"),
    ],
)
def test_leading_readings(reading: dict[str, int], verdict: str) -> None:
    """What becomes of a leading reading; only an accepted one sets the device."""
    trace = run(on_board(PLAIN), [*located(), step(1_000, **reading)])
    assert label(trace, "front_reading") == verdict
    assert (trace.steps[-1].outputs["margin_above_mm"] == 0) == (verdict == "ACCEPTED")
    assert trace.steps[-1].outputs["position_mm"] == 11_000


@pytest.mark.parametrize(
    ("reading", "verdict"),
    [
        (marker("rear", 1, 0), "ACCEPTED"),
        (marker("rear", 5, 0), "UNPAIRED"),
        (marker("rear", 5, None), "FOREIGN"),
        (marker("rear", 1, 60_000), "OUT_OF_WINDOW"),
    ],
)
def test_trailing_readings(reading: dict[str, int], verdict: str) -> None:
    """The trailing reader counts only for the marker that the leading one has read."""
    stream = [*located(), *(step(1_000) for _ in range(89)), step(1_000, **reading)]
    trace = run(on_board(PLAIN), stream)
    assert label(trace, "rear_reading") == verdict
    assert (label(trace, "values") == "M2") == (verdict == "ACCEPTED")


def test_trailing_reading_counts_once() -> None:
    """A second trailing reading of the same marker is unpaired."""
    stream = [*located(), *(step(1_000) for _ in range(89)), step(1_000, **marker("rear", 1, 0))]
    trace = run(on_board(PLAIN), [*stream, step(0, **marker("rear", 1, 0))])
    assert label(trace, "rear_reading") == "UNPAIRED"


SLOW_MM, FAST_MM = 700, 1_000
"""Distances of a cycle that differ by more than the error laws of both devices allow."""


@pytest.mark.parametrize("ahead", ["front", "rear"])
def test_devices_that_exclude_each_other_have_no_position(ahead: str) -> None:
    """Whichever device is ahead, with units that agree within each."""
    both = [*located(), *(step(1_000) for _ in range(89)), step(1_000, **marker("rear", 1, 0))]
    apart = {name: FAST_MM if name.startswith(ahead) else SLOW_MM for name in UNITS}
    trace = run(on_board(PLAIN), [*both, *[step(SLOW_MM) | apart] * 120])
    lost = next(index for index, out in enumerate(outputs(trace)) if index > len(both) and not out["valid"])
    assert label(trace, "reason", lost) == "CONTRADICTION"


def test_train_longer_than_the_spacing() -> None:
    """Two identities wait for the trailing reader; it takes them in order, and the latest setting counts."""
    config = PLAIN.model_copy(update={"vehicle_length_mm": 15_000})
    stream = [step(0, **marker("front", 1, 0))]
    for place in range(1_000, 26_000, 1_000):
        more = marker("front", 2, 10_000) if place == 10_000 else {}
        more |= marker("rear", 1, 0) if place == 15_000 else marker("rear", 2, 10_000) if place == 25_000 else {}
        stream.append(step(1_000, **more))
    trace = run(on_board(config), stream)
    assert (trace.steps[10].state["pending_1"], trace.steps[10].state["pending_2"]) == (1, 2)
    assert label(trace, "rear_reading", 15) == "ACCEPTED"
    assert (trace.steps[15].state["pending_1"], trace.steps[15].state["pending_2"]) == (2, 0)
    assert label(trace, "rear_reading", 25) == "ACCEPTED"


def test_missed_trailing_reading_leaves_m1() -> None:
    """Without the trailing reading M1 goes on, and grows until the vehicle is delocalized."""
    trace = run(on_board(PLAIN), [*located(), *(step(1_000) for _ in range(700))])
    assert label(trace, "values", 400) == "M1"
    assert label(trace, "reason") == "TOLERANCE"
    assert trace.steps[-1].outputs["valid"] is False


def test_reversal_swaps_the_readers() -> None:
    """After running backwards the rear reader leads: its new marker is a leading reading."""
    back = [step(-500) for _ in range(20)]
    trace = run(on_board(PLAIN), [*located(), *back, step(-500, **marker("rear", 9, -100_500))])
    assert trace.steps[-1].state["backwards"] is True
    assert label(trace, "rear_reading") == "ACCEPTED"
    assert trace.steps[-1].fired["fired"] == "leading reading at rear"


def test_vibration_at_standstill_does_not_swap() -> None:
    """Small movements to and fro leave the direction as it is."""
    trace = run(on_board(PLAIN), [*located(), *(step(-14 if n % 2 else 14) for n in range(600))])
    assert trace.steps[-1].state["backwards"] is False


def test_latency_widens_the_side_the_vehicle_runs_to() -> None:
    """12 ms of 100 ms at 1 m a cycle: 120 mm, their 5 % and 1.5 mm of a changing speed above, only the latter below."""
    config = PLAIN.model_copy(update={"reader_latency_ms": 12})
    trace = run(on_board(config), [*located(), step(1_000, **marker("front", 2, 11_000))])
    assert (trace.steps[-1].outputs["margin_above_mm"], trace.steps[-1].outputs["margin_below_mm"]) == (128, 2)


def test_unknown_time_of_reading_charges_the_whole_cycle() -> None:
    """A reading without `since` may have been made anywhere in the cycle: 1 m, its 5 %, 12.5 mm of a changing speed."""
    far = [step(1_000) for _ in range(40)]
    trace = run(on_board(PLAIN), [*located(), *far, step(1_000, **marker("front", 2, 51_000, since=None))])
    assert (trace.steps[-1].outputs["margin_above_mm"], trace.steps[-1].outputs["margin_below_mm"]) == (1_063, 13)


def test_a_first_marker_is_only_a_candidate() -> None:
    """By default nothing is reported until a different marker agrees."""
    config = PLAIN.model_copy(update={"trust_first_marker": False})
    trace = run(on_board(config), [*located(), step(1_000, **marker("front", 2, 11_000))])
    assert [out["valid"] for out in outputs(trace)][-2:] == [False, True]


def test_radar_speaks_at_speed_and_wheel_after_the_marker() -> None:
    """MRK-D4: wheel pulses first, radar after some distance at high speed, wheel pulses all along at low speed."""
    config = OdometryConfig(trust_first_marker=True, measuring_step_mm=1_000)
    start = step(4_000, config, **marker("front", 1, 0))
    fast = run(on_board(config), [start, *(step(4_000, config) for _ in range(60))])
    slow = run(on_board(config), [start | step(100, config), *(step(100, config) for _ in range(60))])
    assert (label(fast, "unit", 2), label(fast, "unit")) == ("FIRST", "SECOND")
    assert {label(slow, "unit", index) for index in range(1, 60)} == {"FIRST"}


def test_silence_delocalizes_with_its_reason() -> None:
    """Without any distance for longer than the gap limit the sensors have failed."""
    trace = run(on_board(PLAIN), [*located(), *({} for _ in range(PLAIN.gap_limit_cycles + 1))])
    assert (label(trace, "mode"), label(trace, "reason")) == ("DELOCALIZED", "SENSOR_FAILURE")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("single_fault_safe", [False, True])
@pytest.mark.parametrize("kind", ["slide", "slip", "stuck", "runaway"])
def test_a_faulty_wheel_never_makes_the_interval_wrong(kind: str, single_fault_safe: bool) -> None:
    """While one unit breaks its law and the other keeps it, the reported interval still holds the truth."""
    config = OdometryConfig(trust_first_marker=True, single_fault_safe=single_fault_safe)
    faults = [Fault(kind, "front_wheel", 150, 350)]
    places = [(number + 1, (number - 9) * 100_000) for number in range(40)]
    legs = [Leg(30_000, 45)]
    stream = simulate(config, seed=9, legs=legs, markers=places, missed=0.0, dropout=0.0, faults=faults)
    trace = run(on_board(config), [plain(record) for record in stream])
    assert sum(bool(out["valid"]) for out in outputs(trace)) > 100
    for record, out in zip(stream, outputs(trace), strict=True):
        if out["valid"]:
            assert out["position_mm"] - out["margin_below_mm"] <= record["truth_mm"] + 1
            assert record["truth_mm"] <= out["position_mm"] + out["margin_above_mm"]


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(4))
def test_simulated_sensors_keep_the_assumption(seed: int) -> None:
    """The simulation with its ghosts satisfies the assumption in every step, so the interval always holds the truth."""
    model = odometry.build(parts(OdometryConfig(vehicle_length_mm=100_000)))
    stream = simulate(model.own.config, seed=seed, seconds=60)
    trace = run(lower(model.machine), [{k: v for k, v in record.items() if k != "truth_mm"} for record in stream])
    for prop, result in zip(properties(model), check_all(trace, properties(model)), strict=True):
        assert isinstance(result, Held), prop.name


def test_compiled_machine_follows_the_interpreter() -> None:
    """The whole machine, generated, agrees with the interpreter on a simulated service."""
    system = on_board(OdometryConfig())
    code, state = compile_system(system), None
    stream = [plain(record) for record in simulate(OdometryConfig(), seed=11, seconds=60, foreign=0.02)]
    expected = run(system, stream)
    state = code.first()
    for record, one in zip(stream, expected.steps, strict=True):
        state, fired = code.step(state, code.read(record))
        assert dict(zip(code.state_names, state, strict=True)) == one.state
        assert code.fired(fired) == one.fired
        assert code.named_outputs(state) == one.outputs


# ------------------------------------------------------------------ configuration


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"tolerance_mm": 5_000}, "no distance can be run within it"),
        ({"lone_limit_cycles": 1}, "losing both units is the worse fault"),
        ({"reader_latency_ms": 200}, "an older reading is stale"),
        ({"tolerance_m": 5}, "Extra inputs are not permitted"),
        ({"devices": 3}, "Input should be 1 or 2"),
    ],
)
def test_configurations_that_cannot_work_are_refused(fields: dict[str, int], message: str) -> None:
    """A wrong configuration says what is wrong."""
    with pytest.raises(ValidationError, match=message):
        OdometryConfig(**fields)  # type: ignore[arg-type]


def test_every_field_carries_unit_and_source() -> None:
    """Each figure of the configuration says its unit and where it comes from."""
    for kind in (OdometryConfig, ErrorLaw):
        for name, info in kind.model_fields.items():
            if info.annotation is int and name != "devices":
                assert set(info.json_schema_extra or {}) == {"unit", "source"}, name


# ------------------------------------------------------------------ proofs that would notice


def keeps(machine: Machine, name: str, model: odometry.Odometry, only: str = "") -> bool:
    """Whether a (possibly broken) machine keeps a property, its lemmas and ranges in one step, or the named one of these."""
    prop = next(one for one in properties(replace(model, machine=machine)) if one.name == name)
    return inductive(machine, prop, only)


def without(machine: Machine, name: str) -> Machine:
    """The machine without one transition."""
    return rebuilt(machine, [t for t in machine.transitions if t.name != name])


def rebuilt(machine: Machine, transitions: list[odometry.Transition]) -> Machine:
    """The machine with another table and the same variables."""
    return replace(machine, transitions=transitions)


def test_a_forgotten_loss_is_noticed() -> None:
    """Without the transition for a passed tolerance, `same-step loss` is not kept any more."""
    model = odometry.build(parts(OdometryConfig()))
    assert keeps(model.machine, "same-step loss", model)
    assert not keeps(without(model.machine, "tolerance exceeded"), "same-step loss", model, "same-step loss")


def test_simulated_runs_notice_a_forgotten_loss() -> None:
    """The same broken machine fails on lawful runs: simulated sensors first, then stretches driven at random."""
    model = odometry.build(parts(OdometryConfig(trust_first_marker=True)))
    stream = simulate(model.own.config, seed=2, legs=[Leg(30_000, 30)], markers=[(1, 50_000)])
    records = [{name: value for name, value in record.items() if name != "truth_mm"} for record in stream]

    def broken(machine: Machine) -> str:
        system = lower(machine)
        asked = [p for p in properties(model) if p.name in ("same-step loss", "tolerance")]
        driver = Driver(system, asked, [run(system, records[:150])])
        driver.follow(0)
        driver.drive("steady", 400, seed=2)
        return "" if driver.broken is None else driver.broken.name

    assert broken(model.machine) == ""
    assert broken(without(model.machine, "tolerance exceeded")) == "same-step loss"


def test_a_forgotten_hand_over_is_noticed() -> None:
    """Without the hand-over to the smaller margin, `the smallest margin leads` is not kept any more."""
    model = odometry.build(parts(OdometryConfig()))
    claim = "the smallest margin leads"
    assert keeps(model.machine, claim, model)
    assert not keeps(without(model.machine, "hand over to rear device"), claim, model, claim)


@pytest.mark.thorough
def test_an_optimistic_margin_is_noticed() -> None:
    """A margin that grows by one nanometre a cycle less than the error may is not proved to contain the truth."""
    model = odometry.build(parts(OdometryConfig()))
    wheel = model.own.devices[0].units[0]
    table = []
    for t in model.machine.transitions:
        less = {wheel.above: t.set[wheel.above] - 1} if wheel.above in t.set and t.name.startswith("run on") else {}
        table.append(replace(t, set={**t.set, **less}))
    assert keeps(model.machine, "containment", model)
    assert not keeps(rebuilt(model.machine, table), "containment", model, "containment")
