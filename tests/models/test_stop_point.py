"""The stop-point machine: stops in place, short and beyond, and everything that must not be ordered."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest
from pydantic import ValidationError

from safeloc.codegen.compiled import compile_system
from safeloc.language.expr import TRUE
from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.verdict import Violated, word
from safeloc.models.stop_point import MODES, StopPoint, build, machine
from safeloc.models.stop_point.simulate import IN_PLACE, OVERRUN, SHORT, Stop, simulate_stop
from safeloc.models.stop_point.variables import StopPointConfig, parts
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.stop_point import properties
from safeloc.runtime.streams.steps import Cell
from tests.models.everything_proved import shipped_runs
from tests.models.inductive import changed, inductive

CONFIG = StopPointConfig()
ON_BOARD = without_ghosts(lower(machine(CONFIG)))
PLACES = (100_000, 150_000)


def step(position_mm: int, speed_mm_s: int = 0, *, margin: int = 200, **fields: Cell) -> dict[str, Cell]:
    """One cycle on a platform with two stop points, the first one selected, position measured."""
    given: dict[str, Cell] = {
        "position_valid": True,
        "position_precise": True,
        "position_mm": position_mm,
        "margin_above_mm": margin,
        "margin_below_mm": margin,
        "speed_mm_s": speed_mm_s,
        "selected_stop": 1,
        "reposition_permitted": False,
        "departure": False,
        "released": False,
    }
    for number, place in enumerate(PLACES, 1):
        given |= {f"stop_{number}_position_mm": place, f"stop_{number}_before_mm": 500, f"stop_{number}_after_mm": 500}
    return {name: value for name, value in {**given, **fields}.items() if value is not None}


def driven(*steps: Mapping[str, Cell]) -> Trace:
    """The machine on board."""
    return run(ON_BOARD, steps)


def modes(trace: Trace) -> list[str]:
    """The mode after every step."""
    return [MODES[one.state["mode"]] for one in trace.steps]


def order(trace: Trace, index: int = -1) -> str:
    """The order after a step."""
    return str(trace.system.outputs["order"].unit.members[trace.steps[index].outputs["order"]])


APPROACH = step(20_000, 10_000)
"""80 m before the stop at 10 m/s: the stop is selected, and the vehicle may proceed."""
BRAKING = step(60_000, 8_000)
"""40 m before it at 8 m/s: the braking distance has come."""


# ------------------------------------------------------------------ simulated stops of source fig. 2


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("stop", "seen"),
    [
        (IN_PLACE, ["stop selected", "brakes", "stops in place", "departs"]),
        (OVERRUN, ["brakes", "overruns", "repositions", "reverses on", "stops in place", "departs"]),
        (SHORT, ["brakes", "stops short", "creeps forward", "stops in place", "departs"]),
        (Stop(off_mm=8_000), ["overruns", "too far to reposition", "held"]),
    ],
    ids=["in place", "overrun", "short", "too far"],
)
def test_figure_2(stop: Stop, seen: list[str]) -> None:
    """The vehicle of fig. 2 stops, well or badly; the stream keeps the law, and every property holds on it."""
    made = build(parts(CONFIG))
    stream = simulate_stop(CONFIG, seed=3, stop=stop)
    trace = run(lower(made.machine), [{k: v for k, v in one.items() if k != "truth_mm"} for one in stream])
    fired = [one.fired["fired"] for one in trace.steps]
    first = [fired.index(name) for name in seen]
    assert first == sorted(first)
    assert not any(isinstance(result, Violated) for result in check_all(trace, properties(made)))


def test_compiled_machine_follows_the_interpreter() -> None:
    """The generated machine agrees with the interpreter on an overrun."""
    stream = [
        {name: value for name, value in one.items() if not name.startswith(("next_", "truth"))}
        for one in simulate_stop(CONFIG, seed=5, stop=OVERRUN)
    ]
    code, state = compile_system(ON_BOARD), compile_system(ON_BOARD).first()
    for record, one in zip(stream, driven(*stream).steps, strict=True):
        state, number = code.step(state, code.read(record))
        assert (code.fired(number), code.named_outputs(state)) == (one.fired, one.outputs)


# ------------------------------------------------------------------ by hand


def test_brake_order_on_the_measured_distance() -> None:
    """At 8.1 m/s the vehicle needs 12.15 m of reaction and 41.01 m of braking: it proceeds at 53.2 m, not at 53.1 m."""
    far, near = step(100_000 - 53_200, 8_000), step(100_000 - 53_100, 8_000)
    assert modes(driven(APPROACH, far)) == ["APPROACH", "APPROACH"]
    assert modes(driven(APPROACH, near)) == ["APPROACH", "BRAKING"]


def test_without_a_measurement_the_far_end_counts() -> None:
    """By odometry alone the distance to the stop is taken from the interval's far end: braking begins earlier."""
    far = step(100_000 - 53_200, 8_000, position_precise=False, margin=6_000)
    assert modes(driven(APPROACH, far))[-1] == "BRAKING"


def test_the_far_end_of_a_coarse_interval_counts() -> None:
    """A measured interval of 2 m reaches 1.5 m farther than the window of 0.5 m: braking begins 1.5 m earlier."""
    far, near = step(100_000 - 54_700, 8_000, margin=2_000), step(100_000 - 54_600, 8_000, margin=2_000)
    assert modes(driven(APPROACH, far)) == ["APPROACH", "APPROACH"]
    assert modes(driven(APPROACH, near)) == ["APPROACH", "BRAKING"]


@pytest.mark.parametrize(
    ("position", "margin", "mode"),
    [
        (100_000, 200, "STOPPED"),
        (100_300, 200, "STOPPED"),
        (99_699, 200, "SHORT"),
        (99_700, 200, "STOPPED"),
        (100_301, 200, "OVERRUN"),
        (100_000, 600, "OVERRUN"),
    ],
)
def test_only_a_whole_interval_is_in_place(position: int, margin: int, mode: str) -> None:
    """In place is what surely lies in the window of 0.5 m on either side; wider than the window is no place, and is not repositioned."""
    trace = driven(
        APPROACH,
        BRAKING,
        step(position, margin=margin),
        step(position, margin=margin, reposition_permitted=margin > 500),
    )
    assert modes(trace)[-1] == mode
    assert trace.steps[-1].outputs["in_position"] is (mode == "STOPPED")


def test_no_measurement_no_stop() -> None:
    """Standing without a measured distance is not in position: braked until the reflector is measured again."""
    trace = driven(APPROACH, BRAKING, step(100_000, position_precise=False), step(100_000))
    assert modes(trace)[-2:] == ["BRAKING", "STOPPED"]


BEYOND = step(102_000, reposition_permitted=True)


def test_repositioning() -> None:
    """After an overrun: standing, measured and permitted, backwards at reduced speed, and stop in the window."""
    back = [step(101_500, -500, reposition_permitted=True), step(100_200, -500, reposition_permitted=True)]
    trace = driven(APPROACH, BRAKING, step(102_000, 1_000), BEYOND, *back, step(100_000))
    assert modes(trace)[2:] == ["OVERRUN", "REPOSITIONING", "REPOSITIONING", "BRAKING", "STOPPED"]
    assert (order(trace, 3), trace.steps[3].outputs["speed_limit_mm_s"]) == ("REVERSE", 833)


def test_reversing_ends_where_the_interval_reaches_before_the_window() -> None:
    """Measured so coarsely that the vehicle may stand before the window and beyond it: the order to reverse is taken back."""
    coarse = step(100_200, -500, margin=5_000, reposition_permitted=True)
    trace = driven(APPROACH, BRAKING, step(102_000, 1_000), BEYOND, coarse)
    assert (modes(trace)[-2:], order(trace)) == (["REPOSITIONING", "BRAKING"], "BRAKE")


@pytest.mark.parametrize(
    "fields",
    [
        {"reposition_permitted": False},
        {"position_precise": False},
        {"speed_mm_s": 400},
        {"position_mm": 106_000},
    ],
)
def test_no_repositioning(fields: dict[str, Cell]) -> None:
    """Not permitted, not measured, not standing, or too far: no order to reverse."""
    trace = driven(APPROACH, BRAKING, step(102_000, 1_000), {**BEYOND, **fields})
    assert order(trace) == "HOLD"


def test_reversing_too_fast_is_stopped() -> None:
    """At 0.74 m/s, with an error of 0.1 m/s, the reduced speed of 0.833 m/s may be passed: the order is taken back."""
    trace = driven(APPROACH, BRAKING, step(102_000, 1_000), BEYOND, step(101_900, -740, reposition_permitted=True))
    assert (modes(trace)[-1], order(trace)) == ("OVERRUN", "HOLD")


def test_creeping_into_the_window() -> None:
    """Stopped short: forward at reduced speed while permitted, and no farther than the window."""
    short = step(98_000, reposition_permitted=True)
    creep = step(99_000, 500, reposition_permitted=True)
    trace = driven(APPROACH, BRAKING, short, short, creep, step(99_800, 400, reposition_permitted=True), step(100_000))
    assert modes(trace)[2:] == ["SHORT", "CREEPING", "CREEPING", "BRAKING", "STOPPED"]
    assert order(trace, 3) == "CREEP"


def test_position_lost_holds() -> None:
    """A lost position holds the vehicle in the same step; measured again at standstill, the stop goes on."""
    lost = step(70_000, 5_000, position_valid=False, position_precise=False)
    trace = driven(APPROACH, BRAKING, lost, step(99_900), step(99_900))
    assert modes(trace)[2:] == ["HELD", "BRAKING", "STOPPED"]
    assert order(trace, 2) == "HOLD"


def test_several_stop_points() -> None:
    """Another stop point may be selected until the brake order, and not after it."""
    other = {"selected_stop": 2}
    early = driven(APPROACH, step(30_000, 10_000, **other), step(60_000, 8_000, **other))
    late = driven(APPROACH, BRAKING, step(62_000, 8_000, **other))
    assert (modes(early)[-1], early.steps[-1].state["stop_mm"]) == ("APPROACH", 150_000)
    assert (modes(late)[-1], late.steps[-1].state["stop_mm"]) == ("BRAKING", 100_000)


@pytest.mark.parametrize(
    ("fields", "reason"),
    [({"stop_1_position_mm": None}, "UNKNOWN_STOP"), ({"position_mm": 120_000}, "NOT_AHEAD")],
)
def test_stops_that_cannot_be_selected(fields: dict[str, Cell], reason: str) -> None:
    """Not on the map, or not ahead: refused with the reason."""
    trace = driven(step(**{"position_mm": 20_000, **fields}))  # type: ignore[arg-type]
    unit = trace.system.outputs["reason"].unit
    assert (modes(trace), unit.members[trace.steps[-1].outputs["reason"]]) == (["IDLE"], reason)


def test_departure_and_release() -> None:
    """A served stop is not selected again until another one is, or none was; a held one ends by release."""
    stand, leave = step(100_000), step(100_000, departure=True)
    served = driven(APPROACH, BRAKING, stand, leave, step(100_100), step(100_100, selected_stop=2))
    assert modes(served)[3:] == ["IDLE", "IDLE", "APPROACH"]
    held = driven(APPROACH, BRAKING, step(107_000, 900), step(107_000), step(107_000, released=True))
    assert modes(held)[2:] == ["OVERRUN", "HELD", "IDLE"]


def test_rolling_out_of_place() -> None:
    """A vehicle that rolls is no longer in position."""
    trace = driven(APPROACH, BRAKING, step(100_000), step(100_100, 200))
    assert (modes(trace)[-1], trace.steps[-1].outputs["in_position"]) == ("BRAKING", False)


def test_a_speed_limit_below_the_error_is_refused() -> None:
    """A reduced speed that the speed error uses up permits no movement."""
    with pytest.raises(ValidationError, match="no movement is allowed"):
        StopPointConfig(reduced_speed_mm_s=100)


# ------------------------------------------------------------------ proofs


@pytest.mark.thorough
def test_everything_is_proved() -> None:
    """All properties and obligations, without bound."""
    made = build(parts(CONFIG))
    system = lower(made.machine)
    known = shipped_runs("stop_point")
    found = [
        *prove(system, properties(made), Limits(seconds=30), jobs=1, **known),
        *obligations(system, Limits(seconds=30), **known),
    ]
    assert {one.id: word(one.result) for one in found if word(one.result) != "proved"} == {}


@pytest.mark.parametrize(
    ("transition", "fields", "broken"),
    [
        ("overruns", {"target": "CREEPING"}, "never on beyond the window"),
        ("creeps forward", {"when": TRUE}, "never on beyond the window"),
        ("repositions", {"when": TRUE}, "reversing is permitted and measured"),
        ("stands beyond", {"target": "REPOSITIONING"}, "reversing begins at standstill"),
        ("stops reversing", {"target": "REPOSITIONING"}, "reversing is slow"),
        ("stops creeping", {"target": "CREEPING"}, "creeping is slow"),
        ("backs into the window", {"target": "REPOSITIONING"}, "reversing ends in the window"),
        ("brakes", {"target": "APPROACH"}, "brake order in time"),
        ("position lost", {"target": "APPROACH"}, "without a position nothing moves"),
        ("stops in place", {"when": TRUE}, "in position within the window"),
        ("stops short", {"target": "STOPPED"}, "in position within the window"),
        ("brakes on", {"target": "CREEPING"}, "no movement out of the brake order"),
        ("stands beyond", {"target": "IDLE"}, "a stop is left only when served or released"),
    ],
)
def test_a_broken_guard_is_noticed(transition: str, fields: dict[str, object], broken: str) -> None:
    """Each order that must not be given is given by a machine with one row changed, and the proof notices."""
    made = build(parts(CONFIG))
    by_label = dict(zip(MODES, made.machine.modes, strict=True))
    wrong = changed(made.machine, transition, **{key: by_label.get(str(v), v) for key, v in fields.items()})
    prop = next(one for one in properties(_with(made, wrong)) if one.name == broken)
    assert not inductive(wrong, prop, broken)


def _with(made: StopPoint, machine_: object) -> StopPoint:
    return replace(made, machine=machine_)  # type: ignore[arg-type]
