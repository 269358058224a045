"""The reflector machine: the source's figures, echoes and balises of every kind, and what goes wrong on the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import pytest
from pydantic import ValidationError

from safeloc.codegen.compiled import compile_system
from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.verdict import Violated
from safeloc.models.reflector import MODES, build, machine
from safeloc.models.reflector.simulate import (
    FIGURE_1,
    FIGURE_2,
    Balise,
    Reflector,
    Route,
    Scene,
    Steps,
    board,
    intensity_cdb,
    lawful,
    simulate,
    stopping,
)
from safeloc.models.reflector.step_inputs import completed
from safeloc.models.reflector.variables import ReflectorConfig, parts
from safeloc.models.vocabulary.error_law import ACCELEROMETER, ErrorLaw
from safeloc.properties.reflector import properties
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg, Motion

PLAIN = ReflectorConfig(
    odometer=ErrorLaw(kind="wheel", constant_mm=0, rate_ppm=50_000),
    measuring_step_mm=6_000,
    frame_latency_ms=0,
    balise_latency_ms=0,
    map_accuracy_mm=0,
    radar_drift_mm_s=0,
    radar_scale_ppm=0,
    search_run_mm=10_000,
)
QUIET = Scene(clutter=0.0, pauses=0.0, dropout=0.0)


def on_board(config: ReflectorConfig = PLAIN) -> TransitionSystem:
    """The machine without its environment."""
    return without_ghosts(lower(machine(config)))


# ------------------------------------------------------------------ steps by hand


def step(distance_mm: int, *more: Mapping[str, Cell], **fields: Cell) -> dict[str, Cell]:
    """One cycle of 1 m to 10 m with a radar frame."""
    given: dict[str, Cell] = {"distance_mm": distance_mm, "frame_present": True}
    for part in more:
        given |= part
    return completed(PLAIN, {**given, **fields})


def echo(
    range_mm: int, model: str = "A", *, slot: int = 1, error: int = 100, intensity: int = -6_000
) -> dict[str, Cell]:
    """One candidate echo."""
    name = f"echo_{slot}"
    return {
        f"{name}_range_mm": range_mm,
        f"{name}_error_mm": error,
        f"{name}_model": model,
        f"{name}_intensity_cdb": intensity,
        f"{name}_lateral_mm": 3_000,
    }


def ahead(
    position_mm: int, model: str = "A", *, view: int = 100_000, clear: int = 1_000_000, **more: int
) -> dict[str, Cell]:
    """The map's next reflector."""
    return {
        "next_position_mm": position_mm,
        "next_model": model,
        "next_view_from_mm": view,
        "next_view_to_mm": 5_000,
        "next_clear_mm": clear,
        **{f"next_{name}": value for name, value in more.items()},
    }


def balise(identity: int, position_mm: int, *, accuracy: int = 500, **more: int) -> dict[str, Cell]:
    """A balise reading, passed at the end of the cycle."""
    told = {f"balise_{name}": value for name, value in more.items()}
    return {
        "balise": identity,
        "balise_position_mm": position_mm,
        "balise_accuracy_mm": accuracy,
        "balise_since_mm": 0,
        **told,
    }


def labels(trace: Trace, name: str) -> list[str]:
    """An enumerated state variable or output in every step."""
    unit = (trace.system.outputs[name] if name in trace.system.outputs else trace.system.variable(name)).unit
    return [str(unit.members[{**one.state, **one.outputs}[name]]) for one in trace.steps]


def modes(trace: Trace) -> list[str]:
    """The mode after every step."""
    return [MODES[one.state["mode"]] for one in trace.steps]


def fired(trace: Trace) -> list[str]:
    """What fired, repetitions left out."""
    names = [one.fired["fired"] for one in trace.steps]
    return [name for index, name in enumerate(names) if index == 0 or name != names[index - 1]]


def last(trace: Trace) -> Mapping[str, int]:
    """The outputs after the last step."""
    return trace.steps[-1].outputs


TESTED = [step(0, balise(7, 0), ahead(80_000, reference_mm=80_000), echo(80_000))]
"""A balise whose reflector of model A stands 80 m behind it, and is measured there: the self-test passes."""


def passing() -> list[dict[str, Cell]]:
    """The reflector is tracked, and passed: at 90 m the odometry zone begins."""
    near = [step(10_000, echo(80_000 - place)) for place in range(10_000, 80_000, 10_000)]
    return [*TESTED, *near, *(step(10_000) for _ in range(2))]


# ------------------------------------------------------------------ the source's figures


def zones(trace: Trace) -> list[str]:
    """Modes in order, repetitions left out."""
    named = modes(trace)
    return [mode for index, mode in enumerate(named) if index == 0 or mode != named[index - 1]]


def test_figure_1() -> None:
    """Balise and reflector 109 in view, odometry zone 114, search zone 116, view zone 115 of reflector 111."""
    stream = simulate(ReflectorConfig(), seed=1, scene=QUIET, legs=[Leg(20_000, 45)])
    trace = run(on_board(ReflectorConfig()), [board(one) for one in stream])
    assert zones(trace) == [
        "DELOCALIZED", "VIEW", "PASSING", "ODOMETRY", "SEARCH", "VIEW", "PASSING", "ODOMETRY",
    ]  # fmt: skip
    recognised = [one.outputs["reflector_position_mm"] for one in trace.steps if one.outputs["recognised"]]
    assert recognised == [180_000, 600_000]


def test_figure_1_deviation() -> None:
    """The deviation of fig. 1: small in view, growing in the odometry zone, never above the tolerable error."""
    stream = simulate(ReflectorConfig(), seed=1, scene=QUIET, legs=[Leg(20_000, 40)])
    trace = run(on_board(ReflectorConfig()), [board(one) for one in stream])
    margins: dict[str, list[int]] = {}
    reported = [(mode, one) for mode, one in zip(modes(trace), trace.steps, strict=True) if one.outputs["valid"]]
    for mode, one in reported:
        margins.setdefault(mode, []).append(max(one.outputs["margin_above_mm"], one.outputs["margin_below_mm"]))
    assert max(margins["VIEW"]) < 3_000
    assert margins["ODOMETRY"] == sorted(margins["ODOMETRY"][:-1]) + margins["ODOMETRY"][-1:]
    assert max(margins["ODOMETRY"] + margins["SEARCH"]) > 10_000
    assert max(max(values) for values in margins.values()) <= 30_000


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("seed", "scene", "motion"),
    [
        (0, Scene(FIGURE_1), None),
        (1, Scene(FIGURE_2), stopping(100, [(354_500, 20_000, 800, 2.0), (-4_500, 700, 300, 2.0)])),
        (2, Scene(FIGURE_2, pauses=0.2, clutter=0.8), stopping(100, [(450_000, 30_000, 900, 1.0)])),
    ],
    ids=["figure 1", "figure 2, overrun and back", "figure 2, run through"],
)
def test_simulated_runs_keep_the_law(seed: int, scene: Scene, motion: Motion | None) -> None:
    """Every simulated step keeps the assumption, and every property holds: the interval always holds the truth."""
    made = build(parts(ReflectorConfig()))
    stream = simulate(made.own.config, seed=seed, scene=scene, motion=motion)
    trace = run(lower(made.machine), [lawful(one) for one in stream])
    broken = [
        prop.name
        for prop, result in zip(properties(made), check_all(trace, properties(made)), strict=True)
        if isinstance(result, Violated)
    ]
    assert broken == []
    assert sum(bool(one.outputs["precise"]) for one in trace.steps) > 100


def test_overlapping_view_zones() -> None:
    """Fig. 2: while 205 is tracked, 208 comes into view, and takes over when 205 is too close."""
    through = stopping(100, [(450_000, 20_000, 800, 1.0)])
    stream = simulate(ReflectorConfig(), seed=4, scene=replace(QUIET, route=FIGURE_2), motion=through)
    trace = run(on_board(ReflectorConfig()), [board(one) for one in stream])
    assert "next reflector takes over" in fired(trace)
    taken = next(one for one in trace.steps if one.fired["fired"] == "next reflector takes over")
    assert (taken.outputs["reflector_position_mm"], taken.outputs["precise"]) == (410_000, True)


def test_compiled_machine_follows_the_interpreter() -> None:
    """The whole machine, generated, agrees with the interpreter on a disturbed run."""
    system, config = on_board(ReflectorConfig()), ReflectorConfig()
    code, stream = compile_system(system), simulate(config, seed=6, scene=Scene(FIGURE_2, pauses=0.1))
    state = code.first()
    for record, one in zip(stream, run(system, [board(one) for one in stream]).steps, strict=True):
        state, number = code.step(state, code.read(board(record)))
        assert code.fired(number) == one.fired
        assert code.named_outputs(state) == one.outputs


# ------------------------------------------------------------------ echoes


@pytest.mark.parametrize(
    ("given", "verdict"),
    [
        (echo(70_000), "FITS"),
        ({}, "NONE"),
        (echo(70_000) | {"frame_present": False}, "NO_FRAME"),
        (echo(70_000, intensity=-8_501), "WEAK"),
        (echo(70_000, intensity=-8_500), "FITS"),
        (echo(70_000, "B"), "OTHER_MODEL"),
        (echo(70_000, "NONE"), "OTHER_MODEL"),
        (echo(2_999), "TOO_CLOSE"),
        (echo(70_000, error=30_001), "TOO_COARSE"),
        (echo(90_000), "OUT_OF_WINDOW"),
    ],
)
def test_echoes(given: dict[str, Cell], verdict: str) -> None:
    """What becomes of an echo while reflector A is tracked, 70 m ahead; only one that fits is taken (RFL-1, RFL-10)."""
    trace = run(on_board(), [*TESTED, step(10_000, given)])
    assert labels(trace, "echo_1_last_verdict")[-1] == verdict
    assert modes(trace)[-1] == ("VIEW" if verdict == "FITS" else "COAST")
    assert labels(trace, "source")[-1] == ("REFLECTOR" if verdict == "FITS" else "ODOMETRY")


def test_clutter_in_the_odometry_zone() -> None:
    """However strong, and even of the next reflector's model: in the odometry zone an echo is a thing beside the track."""
    far = ahead(900_000, "B")
    trace = run(on_board(), [*passing(), *(step(10_000, far, echo(40_000, "B", intensity=0)) for _ in range(5))])
    assert labels(trace, "echo_1_last_verdict")[-5:] == ["NOT_SEARCHED"] * 5
    assert set(modes(trace)[-5:]) == {"ODOMETRY"}


def test_two_echoes_that_exclude_each_other() -> None:
    """Two echoes of the right model fit the window and not each other: neither is believed."""
    clash = step(10_000, echo(70_000), echo(70_600, slot=2))
    trace = run(on_board(), [*TESTED, clash])
    assert (labels(trace, "echo_1_last_verdict")[-1], labels(trace, "echo_2_last_verdict")[-1]) == ("FITS", "FITS")
    assert modes(trace)[-1] == "COAST"


def test_the_first_of_two_agreeing_echoes_counts() -> None:
    """Two agreeing echoes of one reflector: the first slot, which the front end fills with the strongest, counts."""
    trace = run(on_board(), [*TESTED, step(10_000, echo(70_000), echo(70_100, slot=2))])
    assert (last(trace)["range_mm"], last(trace)["precise"]) == (70_000, True)


def test_a_neighbour_of_the_same_model() -> None:
    """Where another reflector of the model could be meant, the search does not begin, and the machine says so in the end."""
    to_300 = [step(10_000) for _ in range(20)]
    near = [step(10_000, ahead(400_000, "A", clear=15_000)) for _ in range(6)]
    trace = run(on_board(), [*passing(), *to_300, *near])
    assert "SEARCH" not in modes(trace)
    assert labels(trace, "error")[-1] == "NOT_FOUND"


def test_equal_models_told_apart_by_order() -> None:
    """Source l. 219: both reflectors of fig. 1 may be of one model; window and order tell them apart."""
    equal = Route(FIGURE_1.balises, tuple(replace(one, model="A") for one in FIGURE_1.reflectors))
    stream = simulate(ReflectorConfig(), seed=1, scene=replace(QUIET, route=equal), legs=[Leg(20_000, 40)])
    trace = run(on_board(ReflectorConfig()), [board(one) for one in stream])
    recognised = [one.outputs["reflector_position_mm"] for one in trace.steps if one.outputs["recognised"]]
    assert recognised == [180_000, 600_000]


def test_the_radar_may_be_worse_than_the_balise() -> None:
    """A coarse echo reports its own bound, though the balise gave a better one: entering the view zone never flatters.

    0.9 m by the echo, and 1 m that a self-test with it, over a balise known to 0.1 m, leaves open.
    """
    coarse = step(0, balise(7, 0, accuracy=100), ahead(80_000, reference_mm=80_000), echo(80_000, error=900))
    trace = run(on_board(), [coarse])
    assert (last(trace)["margin_above_mm"], last(trace)["margin_below_mm"], last(trace)["precise"]) == (
        1_900,
        1_900,
        True,
    )


# ------------------------------------------------------------------ the self-test


def test_a_mismatch_ends_the_procedure() -> None:
    """Measured 3 m from where it has to be: not ready, with an error; the position goes on by odometry."""
    wrong = step(0, balise(7, 0), ahead(80_000, reference_mm=80_000), echo(83_000))
    later = [step(1_000, echo(79_000 - n * 1_000)) for n in range(5)]
    trace = run(on_board(), [wrong, *later])
    assert labels(trace, "error") == ["MISMATCH"] * 6
    assert set(modes(trace)) == {"NOT_READY"}
    assert (last(trace)["valid"], last(trace)["position_mm"]) == (True, 5_000)


def test_what_the_self_test_leaves_open_adds_error() -> None:
    """Measured 0.4 m too far, over a balise known to 0.5 m, by an echo known to 0.1 m: the radar may measure 1.0 m too
    long, or 0.2 m too short, and from then on end A may be so much farther ahead, and behind, than the echo has it."""
    start = step(0, balise(7, 0), ahead(80_000, reference_mm=80_000), echo(80_400))
    trace = run(on_board(), [start, step(10_000, echo(70_000))])
    out = trace.steps[0].outputs
    assert (-400, 1_100, 300) == (out["position_mm"], out["margin_above_mm"], out["margin_below_mm"])
    assert (10_000, 1_100, 300) == tuple(
        last(trace)[name] for name in ("position_mm", "margin_above_mm", "margin_below_mm")
    )


@pytest.mark.parametrize(("range_mm", "mode"), [(80_600, "VIEW"), (80_601, "NOT_READY"), (79_399, "NOT_READY")])
def test_the_tolerance_of_the_self_test_is_what_may_be_wrong_with_a_right_radar(range_mm: int, mode: str) -> None:
    """Balise 0.5 m and echo 0.1 m: farther off, the radar is wrong."""
    start = step(0, balise(7, 0), ahead(80_000, reference_mm=80_000), echo(range_mm))
    assert modes(run(on_board(), [start])) == [mode]


def test_a_radar_that_is_far_off_is_no_missing_reflector() -> None:
    """Measured 60 m too far: out of every window, and all the same the reference reflector, of which there is one."""
    start = step(0, balise(7, 0), ahead(80_000, reference_mm=80_000), echo(140_000))
    assert labels(run(on_board(), [start]), "error") == ["MISMATCH"]


def test_another_reflector_of_the_model_within_hearing() -> None:
    """A second one 150 m behind the reference reflector may be what a radar that is wrong takes for it: no self-test."""
    crowded = ahead(80_000, clear=120_000, reference_mm=80_000)
    trace = run(on_board(), [step(0, balise(7, 0), crowded, echo(80_000))])
    assert labels(trace, "echo_1_last_verdict") == ["AMBIGUOUS"]
    assert modes(trace) == ["REFERENCE"]


def test_the_radar_drifts() -> None:
    """In each cycle since the self-test the interval grows by the drift, until the test is too long ago."""
    config = PLAIN.model_copy(update={"radar_drift_mm_s": 10_000})
    here = [step(0, echo(80_000)) for _ in range(20)]
    trace = run(on_board(config), [*TESTED, *here])
    margins = [one.outputs["margin_above_mm"] for one in trace.steps if one.outputs["precise"]]
    assert margins == list(range(700, 20_101, 1_000))
    assert (modes(trace)[-1], labels(trace, "error")[-1]) == ("NOT_READY", "NO_SELF_TEST")


def test_a_balise_too_coarse_for_a_self_test() -> None:
    """12 m to either side leave more open than may be added: a position, and no precise one."""
    start = step(0, balise(7, 0, accuracy=12_000), ahead(80_000, reference_mm=80_000))
    trace = run(on_board(), [start])
    assert (modes(trace), labels(trace, "error")) == (["NOT_READY"], ["NO_SELF_TEST"])
    assert last(trace)["valid"]


def test_a_self_test_that_grows_too_coarse() -> None:
    """Waiting for the reference reflector, the run since the balise becomes too uncertain."""
    start = step(0, balise(7, 0, accuracy=9_000), ahead(250_000, view=150_000, reference_mm=250_000))
    trace = run(on_board(), [start, *(step(10_000) for _ in range(3))])
    assert modes(trace) == ["REFERENCE"] * 3 + ["NOT_READY"]
    assert fired(trace)[-1] == "self-test grows too coarse"


def test_no_retry_at_the_same_balise() -> None:
    """The balise that failed starts no second test; another one does."""
    wrong = step(0, balise(7, 0), ahead(80_000, reference_mm=80_000), echo(83_000))
    again = step(0, balise(7, 0), ahead(80_000, reference_mm=80_000), echo(80_000))
    other = step(0, balise(8, 0), ahead(80_000, reference_mm=80_000), echo(80_000))
    assert modes(run(on_board(), [wrong, again])) == ["NOT_READY", "NOT_READY"]
    assert modes(run(on_board(), [wrong, again, other]))[-1] == "VIEW"


def test_the_reference_reflector_comes_later() -> None:
    """Not in view yet at the balise: the test waits, with the distance run since, and passes at the first echo."""
    start = step(0, balise(7, 0), ahead(120_000, reference_mm=120_000))
    trace = run(on_board(), [start, *(step(10_000) for _ in range(3)), step(10_000, echo(80_200))])
    assert modes(trace) == ["REFERENCE"] * 4 + ["VIEW"]
    assert labels(trace, "error")[0] == "NO_SELF_TEST"


def test_the_reference_reflector_is_not_there() -> None:
    """Not found by the end of the search window: not ready, with an error (RFL-D3)."""
    start = step(0, balise(7, 0), ahead(80_000, reference_mm=80_000))
    trace = run(on_board(), [start, *(step(10_000) for _ in range(4))])
    assert (modes(trace)[-1], labels(trace, "error")[-1]) == ("NOT_READY", "NOT_FOUND")


@pytest.mark.parametrize(
    ("told", "config", "mode"),
    [
        ({"reference_mm": 80_000}, PLAIN, "VIEW"),
        ({"reference_mm": 90_000}, PLAIN, "NOT_READY"),
        ({}, PLAIN.model_copy(update={"reference_distance_mm": 80_000}), "VIEW"),
        ({}, PLAIN.model_copy(update={"reference_distance_mm": 75_000}), "NOT_READY"),
        ({}, PLAIN, "NOT_READY"),
    ],
)
def test_where_the_prescribed_distance_comes_from(told: dict[str, int], config: ReflectorConfig, mode: str) -> None:
    """Telegram before map before system variable; without any there is no self-test, and no precise positioning."""
    start = step(0, balise(7, 0, **told), ahead(80_000), echo(80_000))
    assert modes(run(on_board(config), [start])) == [mode]


def test_the_telegram_comes_before_the_map() -> None:
    """A telegram and a map that disagree: the telegram is what is tested."""
    start = step(0, balise(7, 0, reference_mm=85_000), ahead(80_000, reference_mm=80_000), echo(80_000))
    assert labels(run(on_board(), [start]), "error") == ["MISMATCH"]


def test_looked_for_from_the_prescribed_line_on() -> None:
    """RFL-8: the telegram says 30 m after the balise; an echo before that is not looked at."""
    start = step(0, balise(7, 0, search_from_mm=30_000), ahead(80_000, reference_mm=80_000), echo(80_000))
    echoes = [step(10_000, echo(80_000 - place)) for place in (10_000, 20_000, 30_000)]
    trace = run(on_board(), [start, *echoes])
    assert labels(trace, "echo_1_last_verdict") == ["NOT_SEARCHED"] * 3 + ["FITS"]
    assert modes(trace) == ["REFERENCE"] * 3 + ["VIEW"]


def test_a_balise_in_view_is_compared_at_once() -> None:
    """Source l. 111: a balise passed in the view zone compares both; on agreement nothing is interrupted."""
    same = step(10_000, balise(8, 10_000), ahead(80_000, reference_mm=70_000), echo(70_000))
    trace = run(on_board(), [*TESTED, same])
    assert (modes(trace)[-1], fired(trace)[-1]) == ("VIEW", "self-test passed at the balise")


# ------------------------------------------------------------------ leaving, losing, missing


def test_a_pause_is_no_loss() -> None:
    """Frames missing for a while: odometry goes on with a growing margin, and the echo is taken up again."""
    paused = [step(1_000, frame_present=False) for _ in range(20)]
    trace = run(on_board(), [*TESTED, *paused, step(1_000, echo(59_000))])
    assert modes(trace)[1:] == ["COAST"] * 20 + ["VIEW"]
    margins = [one.outputs["margin_above_mm"] for one in trace.steps]
    assert margins[1:21] == sorted(margins[1:21])
    assert margins[-1] == 700


def test_a_long_pause_is_a_loss() -> None:
    """After the permitted pause odometry goes on, from the last position, and the vehicle stays ready."""
    trace = run(on_board(), [*TESTED, *(step(1_000, frame_present=False) for _ in range(21))])
    assert (modes(trace)[-1], last(trace)["position_mm"], last(trace)["ready"]) == ("ODOMETRY", 21_000, True)


def test_frames_without_the_echo_are_a_loss_sooner() -> None:
    """Five frames may miss the echo; with the sixth the reflector is lost."""
    trace = run(on_board(), [*TESTED, *(step(1_000) for _ in range(6))])
    assert modes(trace)[1:] == ["COAST"] * 5 + ["ODOMETRY"]


def test_odometry_goes_on_from_the_last_measured_position() -> None:
    """Not from the balise: after the view zone the margin is the radar's, plus the odometer's for what was run since."""
    trace = run(on_board(), [*TESTED, step(10_000, echo(69_500)), step(10_000)])
    assert [one.outputs["position_mm"] for one in trace.steps] == [0, 10_500, 20_500]
    assert [one.outputs["margin_above_mm"] for one in trace.steps] == [700, 700, 1_200]


def test_backing_off_brings_the_reflector_back() -> None:
    """Too close, then backwards: the echo is taken up again without a new search (source l. 265)."""
    close = [step(10_000, echo(80_000 - place)) for place in range(10_000, 80_000, 10_000)]
    back = [step(6_000), step(-6_000), step(-10_000, echo(20_000))]
    trace = run(on_board(), [*TESTED, *close, *back])
    assert modes(trace)[-3:] == ["PASSING", "COAST", "VIEW"]


def test_a_search_that_is_backed_out_of() -> None:
    """The vehicle backs out of the search zone: odometry zone again, and a new search when it returns."""
    far = ahead(300_000, "B")
    there = [step(10_000, far) for _ in range(11)]
    trace = run(on_board(), [*passing(), *there, step(-10_000, far), step(-10_000, far), step(-10_000, far)])
    assert "SEARCH" in modes(trace)
    assert fired(trace)[-2:] == ["search zone left", "odometry zone"]


@pytest.mark.parametrize(("view", "name"), [(100_000, "reflector not found"), (250_000, "reflector passed unseen")])
def test_a_reflector_that_is_not_there(view: int, name: str) -> None:
    """Not found in its search zone, or announced only when it should have been found already: not ready (RFL-D3)."""
    far = ahead(300_000, "B", view=view)
    trace = run(on_board(), [*passing(), *(step(10_000, far) for _ in range(15))])
    assert name in fired(trace)
    assert (modes(trace)[-1], labels(trace, "error")[-1]) == ("NOT_READY", "NOT_FOUND")


# ------------------------------------------------------------------ faults


def disturbed(*what: Fault, seed: int = 1) -> tuple[Trace, Steps]:
    """The run of fig. 1 with something going wrong, on board."""
    stream = simulate(ReflectorConfig(), seed=seed, scene=replace(QUIET, disturbances=what), legs=[Leg(20_000, 40)])
    return run(on_board(ReflectorConfig()), [board(one) for one in stream]), stream


def never_wrong(trace: Trace, stream: Sequence[Mapping[str, Cell]]) -> bool:
    """Whenever an interval is reported, it holds the truth."""
    held = []
    for one, record in zip(trace.steps, stream, strict=True):
        low = one.outputs["position_mm"] - one.outputs["margin_below_mm"]
        high, true = one.outputs["position_mm"] + one.outputs["margin_above_mm"], int(record["truth_mm"])
        held.append(not one.outputs["valid"] or low - 1 <= true <= high)
    return all(held)


def test_a_radar_that_jumps_is_not_followed() -> None:
    """Echoes 12 m off: outside the window, the position runs on by odometry, and the reflector is given up."""
    trace, stream = disturbed(Fault("shift", "", 180, 200, {"by_mm": 12_000}))
    assert never_wrong(trace, stream)
    assert "OUT_OF_WINDOW" in labels(trace, "echo_1_last_verdict")
    assert "reflector lost" in fired(trace)


def test_a_radar_that_drifts_is_found_out() -> None:
    """An error that grows by 0.4 m a cycle passes each window, but not the check that it stays constant (source l. 241)."""
    trace, _ = disturbed(Fault("drift", "", 160, 200, {"by_mm": 400}))
    assert "measuring error drifts" in fired(trace)
    assert "DRIFT" in labels(trace, "error")


def test_weak_echoes_open_no_view_zone() -> None:
    """20 dB too weak: the reflector is not found, and the self-test ends not ready."""
    trace, stream = disturbed(Fault("weak", "", 0, 400))
    assert never_wrong(trace, stream)
    assert not any(one.outputs["precise"] for one in trace.steps[:400])
    assert "reference reflector not found" in fired(trace)


def test_a_missing_reflector() -> None:
    """Reflector 111 stands on the map and not at the track."""
    gone = replace(QUIET, route=replace(FIGURE_1, missing=frozenset({600_000})))
    stream = simulate(ReflectorConfig(), seed=1, scene=gone, legs=[Leg(20_000, 40)])
    trace = run(on_board(ReflectorConfig()), [board(one) for one in stream])
    assert "reflector not found" in fired(trace)
    assert never_wrong(trace, stream)


@pytest.mark.parametrize(
    ("record", "error"),
    [
        (step(1_000, route_contradicted=True), "ROUTE_CONTRADICTED"),
        (step(1_000, balise(9, 50_000)), "BALISE_CONTRADICTS"),
    ],
)
def test_contradictions_take_the_position_away(record: dict[str, Cell], error: str) -> None:
    """A route that is contradicted, and a balise that excludes the position: delocalized, with the reason."""
    trace = run(on_board(), [*TESTED, record])
    assert (modes(trace)[-1], labels(trace, "error")[-1]) == ("DELOCALIZED", error)
    assert last(trace)["valid"] is False


def test_two_reflectors_that_exclude_each_other() -> None:
    """Both reflectors of an overlap are measured, 3 m apart from what the map says: delocalized."""
    both = ahead(110_000, "B", view=150_000)
    far = [step(0, both, echo(80_000, error=2_000))]
    clash = step(0, both, echo(80_000, error=1_400), echo(111_600, "B", slot=2))
    trace = run(on_board(), [*TESTED, *far, clash])
    assert labels(trace, "error")[-1] == "ECHOES_CONTRADICT"


def test_odometer_failure_and_tolerance() -> None:
    """Silent longer than permitted: sensor failure; too far from any reference: tolerance."""
    silent = completed(PLAIN, {"frame_present": True})
    failed = run(on_board(), [*TESTED, *(silent for _ in range(6))])
    assert labels(failed, "error")[-1] == "SENSOR_FAILURE"
    far = run(on_board(), [*passing(), *(step(10_000) for _ in range(60))])
    assert labels(far, "error")[-1] == "TOLERANCE"


def test_a_distance_faster_than_the_vehicle_is_not_used() -> None:
    """The position rests, and the highest speed times the period is added on both sides."""
    trace = run(on_board(), [*TESTED, step(19_000)])
    assert (last(trace)["position_mm"], last(trace)["margin_above_mm"]) == (0, 700 + 4_445)


def test_only_a_balise_leads_out_of_delocalized() -> None:
    """Echoes alone, however good, give no position."""
    trace = run(on_board(), [step(10_000, ahead(80_000), echo(80_000)) for _ in range(5)])
    assert set(modes(trace)) == {"DELOCALIZED"}


def test_a_balise_without_a_reflector_gives_a_position_only() -> None:
    """A balise far from any reflector localizes by odometry, not ready for precise positioning."""
    trace = run(on_board(), [step(0, balise(7, 0))])
    assert (modes(trace)[-1], last(trace)["valid"], last(trace)["ready"]) == ("NOT_READY", True, False)


# ------------------------------------------------------------------ configuration and inputs


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"tolerance_mm": 5_000}, "no distance can be run within it"),
        ({"odometer": ACCELEROMETER}, "drifts with the time"),
        ({"frame_latency_ms": 200}, "older data is stale"),
        ({"reference_run_mm": 100}, "the distance of one cycle"),
        ({"echo_slots": 0}, "greater than or equal to 1"),
    ],
)
def test_configurations_that_cannot_work_are_refused(fields: dict[str, object], message: str) -> None:
    """A wrong configuration says what is wrong."""
    with pytest.raises(ValidationError, match=message):
        ReflectorConfig(**fields)  # type: ignore[arg-type]


def test_every_figure_carries_unit_and_source() -> None:
    """Each figure of the configuration says its unit and where it comes from."""
    for name, info in ReflectorConfig.model_fields.items():
        if info.annotation is int:
            assert set(info.json_schema_extra or {}) == {"unit", "source"}, name


def test_completed_inputs() -> None:
    """Empty slots and an absent map are filled; a range without its error is left for the machine to refuse."""
    whole = completed(PLAIN, {"echo_1_range_mm": 5})
    assert "echo_1_error_mm" not in whole
    assert (whole["echo_2_model"], whole["next_model"], whole["frame_present"]) == ("NONE", "NONE", False)


def test_range_law() -> None:
    """12 dB less for each doubling of the range, and the minimum intensity where the view zone begins."""
    assert [intensity_cdb(r, 100_000, -8_500) for r in (100_000, 200_000, 50_000)] == [-8_500, -9_700, -7_300]


def test_a_route_knows_its_neighbours() -> None:
    """The map's figure for equal models: the nearest other one of the model, on either side."""
    route = Route((Balise(1, 0),), tuple(Reflector(place, model) for place, model in ((0, "A"), (50, "B"), (80, "A"))))
    assert [route.clear_mm(one) for one in route.reflectors] == [80, 1_000_000, 80]
    assert route.ahead(50) is route.reflectors[2]
    assert route.ahead(80) is None
