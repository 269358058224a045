"""Position from satellites: proved with the selection in one step; initialisation, coasting, rejection in figures."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import replace
from typing import Any, Literal, get_args

import pytest

from safeloc.language.expr import TRUE, Bool, Lit, Num, as_num, exact_to, floor_div
from safeloc.language.interpret import run
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.units import MM, MS, NM, UM_S
from safeloc.language.verdict import Proved, word
from safeloc.models.satellite import Satellite, build, compose_machines
from safeloc.models.satellite.anchor import Anchor
from safeloc.models.satellite.configurations import CONFIGURATIONS
from safeloc.models.satellite.simulate import FINE, STREET, first_of, simulate
from safeloc.models.satellite.variables import FIX, MISSING, REASON, Parts, Redundancy, SatelliteConfig, State, parts
from safeloc.models.satellite.world import Trusted, signal_errors
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.testing import run_tests
from safeloc.properties.satellite import drift_properties, properties
from tests.models.inductive import inductive_in
from tests.models.wrong_edits import lost_by

CONFIG = SatelliteConfig(selection=SelectionConfig(channels=4))
MACHINE = build(parts(CONFIG))
SYSTEM = without_ghosts(lower(MACHINE))
CHANNELS = range(1, 5)
Kind = Literal["range", "speed"]
KINDS: tuple[Kind, ...] = get_args(Kind)


def cycle(**changes: int | bool) -> dict[str, int | bool]:
    """A cycle in which nothing is solved; all satellites are usable and used."""
    quiet: dict[str, int | bool] = {
        "fix_dilution_permille": 0, "fix_further_mm": 5_000, "fix_speed_um_s": 0, "fix_speed_dilution_permille": 0,
        "fix_speed_further_um_s": 500_000, "fix_unknowns": 2, "fix_missing": 0, "reference_accuracy_mm": 0, "reference_speed_accuracy_um_s": 0, "odometry_error_mm": 100,
    }  # fmt: skip
    return {**quiet, **{f"usable_{n}": True for n in CHANNELS}, **{f"used_{n}": True for n in CHANNELS}, **changes}


START = cycle(reference_mm=1_000_000, reference_accuracy_mm=3_000)


def instead(own: Parts, **others: object) -> Parts:
    """The variables, some of them exchanged."""
    changed = copy(own)
    vars(changed).update(others)
    return changed


def driven(*cycles: dict[str, int | bool]) -> Trace:
    """The cycles, on board."""
    return run(SYSTEM, cycles)


def verdict(trace: Trace, number: int = -1) -> str:
    """What became of a cycle's solution."""
    return FIX[int(trace.steps[number].state["fix_last_verdict"])].label


def mode(trace: Trace, number: int = -1) -> str:
    """The mode after a cycle."""
    return MACHINE.modes[int(trace.steps[number].state["mode"])].label


def test_only_a_reference_starts_it() -> None:
    """A solution alone does not: the first state has to come from a trusted place."""
    trace = driven(cycle(fix_mm=1_000_000), START)
    assert ["UNLOCATED", "LOCATED"] == [mode(trace, 0), mode(trace, 1)]
    assert "UNLOCATED" == verdict(trace, 0)
    assert 3_000 == trace.steps[1].outputs["margin_below_mm"]


def test_a_solution_narrows() -> None:
    """A solution that counts bounds the place; the estimate goes a quarter of the way to it."""
    trace = driven(START, cycle(fix_mm=1_001_000, fix_further_mm=2_000, fix_speed_um_s=10_000_000))
    assert ("ACCEPTED", "LOCATED") == (verdict(trace), mode(trace))
    position, below, above = (
        trace.steps[-1].outputs[f"{name}_mm"] for name in ("position", "margin_below", "margin_above")
    )
    assert (999_000, 1_003_001) == (position - below, position + above)
    assert 1_000_250 == position


def test_a_level_charges_all_that_usable_signals_may_be_wrong_by() -> None:
    """A dilution of 1 in range and rate: 9.5 + 3.1 + 2.1 m, 1.15 + 0.7 + 0.1 m/s, and what is told beside."""
    wide = {
        **START,
        "reference_accuracy_mm": 25_000,
        "reference_speed_um_s": 0,
        "reference_speed_accuracy_um_s": 4_000_000,
    }
    told = {"fix_dilution_permille": 1_000, "fix_speed_dilution_permille": 1_000, "fix_further_mm": 300}
    trace = driven(wide, cycle(fix_mm=1_000_000, fix_speed_um_s=0, **(told | {"fix_speed_further_um_s": 0})))
    state = trace.steps[-1].state
    assert ("ACCEPTED", 14_700, 1_950) == (verdict(trace), *bounds_in_figures(CONFIG))
    assert [-15_000_000_000, 15_000_000_000] == [int(state[f"{end}_nm"]) - 10**12 for end in ("low", "high")]
    assert [-1_950_000, 1_950_000] == [state["slowest_um_s"], state["fastest_um_s"]]


def bounds_in_figures(config: SatelliteConfig) -> tuple[int, int]:
    """What a usable signal may be wrong by: mm and mm/s."""
    return config.selection.usable_range_error_mm, config.selection.usable_speed_error_mm_s


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"usable_2": False}, "NOT_USABLE"),
        ({"used_1": False, "used_2": False}, "TOO_FEW"),
        ({"fix_unknowns": 4}, "TOO_FEW"),
        ({"fix_mm": 2_000_000}, "DISJOINT"),
        ({"fix_further_mm": 30_001}, "TOO_COARSE"),
        ({"fix_further_mm": 600, "fix_dilution_permille": 2_001}, "TOO_COARSE"),
    ],
)
def test_what_does_not_count(change: dict[str, int | bool], expected: str) -> None:
    """A solution with an unusable satellite, too few, far from the prediction or too coarse leaves the state coasting."""
    trace = driven(START, {**cycle(fix_mm=1_000_000), **change})
    assert (expected, "COASTING") == (verdict(trace), mode(trace))
    assert trace.steps[-1].outputs["margin_below_mm"] > 3_000


def test_coasting_ends() -> None:
    """Without solutions the margin grows with speed and acceleration, and after the limit nothing is reported."""
    good = cycle(fix_mm=1_000_000, fix_further_mm=1_000, fix_speed_further_um_s=100_000)
    trace = driven(START, good, good, *[cycle()] * 15)
    margins = [int(step.outputs["margin_below_mm"]) for step in trace.steps[2:12]]
    assert sorted(margins) == margins
    assert ["COASTING"] * 10 == [mode(trace, n) for n in range(3, 13)]
    assert "UNLOCATED" == mode(trace, 13)
    assert "COASTED_OUT" == REASON[int(trace.steps[13].state["reason"])].label


def test_the_prediction_is_constant_acceleration() -> None:
    """Place, speed and the last change of speed give the next place: s + v T + dv T / 2, to the nanometre."""
    first = cycle(fix_mm=1_000_000, fix_further_mm=1_000, fix_speed_um_s=0, fix_speed_further_um_s=100_000)
    second = {**first, "fix_speed_um_s": 200_000, "fix_speed_further_um_s": 50_000}
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


@pytest.mark.parametrize(
    ("redundancy", "unknowns", "least"),
    [
        ("solve", 2, 2), ("detect", 2, 3), ("exclude", 2, 4),
        ("solve", 4, 4), ("detect", 4, 5), ("exclude", 4, 6),
        ("detect", 3, 4),
    ],
)  # fmt: skip
def test_how_many_satellites_a_solution_needs(redundancy: Redundancy, unknowns: int, least: int) -> None:
    """Along the track 2, 3, 4; free of it 4, 5, 6; a second constellation's clock is one unknown more. One fewer: no fix."""
    machine = build(parts(SatelliteConfig(redundancy=redundancy, selection=SelectionConfig(channels=8))))
    system = without_ghosts(lower(machine))

    def after(satellites: int) -> str:
        used = {f"used_{n}": n <= satellites for n in range(1, 9)} | {f"usable_{n}": True for n in range(1, 9)}
        trace = run(system, [{**START, **used}, {**cycle(fix_mm=1_000_000, fix_unknowns=unknowns), **used}])
        return verdict(trace)

    assert ["TOO_FEW", "ACCEPTED"] == [after(least - 1), after(least)]


def test_a_cycle_without_a_solution_says_why() -> None:
    """The signals' reason is told on; a solution clears it."""
    why = [one.value for one in MISSING if one.label in ("NONE_LEFT", "ALIKE")]
    trace = driven(START, *(cycle(fix_missing=one) for one in why), cycle(fix_mm=1_000_000, fix_missing=why[0]))
    assert [*why, 0] == [int(step.outputs["missing"]) for step in trace.steps[1:]]


def test_a_reference_may_know_the_speed() -> None:
    """With the speed of the train at the balise the margin grows by metres less in the next cycle."""
    slow = driven(START, cycle())
    known = driven({**START, "reference_speed_um_s": 20_000_000, "reference_speed_accuracy_um_s": 100_000}, cycle())
    assert 1_004_000 == known.steps[-1].outputs["position_mm"]
    assert int(known.steps[-1].outputs["margin_below_mm"]) + 8_000 < int(slow.steps[-1].outputs["margin_below_mm"])


def drifting(cycles: int, **every: int | bool) -> list[dict[str, int | bool]]:
    """False signals that lead a standing train 400 mm on in each cycle, each within the prediction's margin."""
    speed = {"fix_speed_um_s": 2_000_000, "fix_speed_further_um_s": 2_500_000, "fix_further_mm": 8_000}
    return [cycle(fix_mm=1_000_000 + 400 * (n + 1), **speed, **every) for n in range(cycles)]


def test_odometry_ends_a_common_drift() -> None:
    """Against a train that stands the false place counts until both margins are used up, then DRIFTED, and it ends."""
    trace = driven(START, *drifting(60, odometry_mm=0, odometry_error_mm=1))
    judged = [verdict(trace, n) for n in range(1, 61)]
    assert "ACCEPTED" == judged[10]
    first = judged.index("DRIFTED")
    assert 15 < first < 40
    assert all(
        abs(int(step.state["position_nm"]) - 10**12) < 20 * 10**9 for step in trace.steps if step.outputs["valid"]
    )
    assert not trace.steps[-1].outputs["valid"]


def test_odometry_that_runs_elsewhere_ends_the_position() -> None:
    """A train that is known to stand, and odometry that runs 2 m in each cycle: no more than both margins are carried on."""
    standing = {**START, "reference_speed_um_s": 0, "reference_speed_accuracy_um_s": 100_000}
    trace = driven(standing, *[cycle(odometry_mm=2_000, odometry_error_mm=100)] * 6)
    assert ["LOCATED", "COASTING", "UNLOCATED"] == list(dict.fromkeys(mode(trace, n) for n in range(7)))
    assert "DRIFT" == REASON[int(trace.steps[-1].state["reason"])].label


def test_without_odometry_the_drift_goes_on() -> None:
    """The stated assumption, shown: nothing else finds it within a minute; what is told says how little is known."""
    trace = driven(START, *drifting(60))
    assert ["ACCEPTED"] * 50 == [verdict(trace, n) for n in range(11, 61)]
    bounds = [int(step.outputs["drift_bound_mm"]) for step in trace.steps[1:]]
    assert sorted(bounds) == bounds
    assert int(trace.steps[-1].outputs["drift_bound_mm"]) > 500_000


def test_odometry_that_is_lost_too_long_checks_nothing() -> None:
    """Beyond its limit the anchor is given up, and said so; where it is required the position ends with it."""
    close = SatelliteConfig(anchor_limit_mm=50_000, selection=CONFIG.selection)
    trace = driven(START, *drifting(10))
    loose = run(without_ghosts(lower(build(parts(close)))), [START, *drifting(10)])
    assert (True, False) == (trace.steps[-1].outputs["drift_checked"], loose.steps[-1].outputs["drift_checked"])
    strict = close.model_copy(update={"drift_check": "required"})
    ended = run(without_ghosts(lower(build(parts(strict)))), [START, *drifting(10)])
    assert (True, False) == (loose.steps[-1].outputs["valid"], ended.steps[-1].outputs["valid"])


def test_wrong_configurations_are_refused() -> None:
    """An odd period, more satellites than channels, a prediction bound below what braking makes of it."""
    with pytest.raises(ValueError, match="period_ms must be even"):
        SatelliteConfig(period_ms=201)
    with pytest.raises(ValueError, match="3 satellites are needed, and the receiver has 2 channels"):
        SatelliteConfig(selection=SelectionConfig(channels=2))
    with pytest.raises(ValueError, match="speed_prediction_mm_s 700 is below the predictor's error 3100"):
        SatelliteConfig(period_ms=1_000, state_error_mm=0)
    with pytest.raises(ValueError, match="range_prediction_mm 3000 is below the predictor's error 3080"):
        SatelliteConfig(selection=SelectionConfig(range_prediction_mm=3_000))
    with pytest.raises(
        ValueError, match=r"may be 14700 mm wrong .* within protection_limit_mm 14699; lower the thresholds"
    ):
        SatelliteConfig(protection_limit_mm=14_699)
    with pytest.raises(ValueError, match="removal 'both' keeps signals of any error"):
        SatelliteConfig(selection=SelectionConfig(removal="both"))


def _unproved(model: Satellite, *names: str, seconds: float = 60) -> list[str]:
    asked = [prop for prop in properties(model) if not names or prop.name in names]
    findings = prove(model.composition.system, asked, Limits(seconds=seconds), jobs=2)
    wanted = {f"{model.composition.system.name}/property/{name}" for name in names}
    return [f.id for f in findings if not isinstance(f.result, Proved) and (not names or f.id in wanted)]


@pytest.mark.thorough
@pytest.mark.parametrize("channels", [4, *(pytest.param(n, marks=pytest.mark.slow) for n in (8, 16, 32))])
def test_everything_is_proved(channels: int) -> None:
    """Every property of selection and position together, without a bound."""
    model = compose_machines(SatelliteConfig(selection=SelectionConfig(channels=channels)))
    assert [] == _unproved(model, seconds=60 if channels == 4 else 600)


@pytest.mark.thorough
@pytest.mark.parametrize("drift_check", ["where present", "required"])
def test_false_signals_lead_no_farther_than_told(drift_check: Literal["where present", "required"]) -> None:
    """With nothing assumed of any signal: the distance between position and truth is bounded, without a bound on time."""
    config = SatelliteConfig(selection=SelectionConfig(channels=4), drift_check=drift_check)
    model = compose_machines(config, trusted="odometry")
    findings = prove(model.composition.system, drift_properties(model), Limits(seconds=60), jobs=2)
    assert [] == [finding.id for finding in findings if not isinstance(finding.result, Proved)]


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("trusted", "makes"), [("satellites", properties), ("odometry", drift_properties)])
def test_random_runs_hold(trusted: Trusted, makes: Callable[[Satellite], list[Property]]) -> None:
    """From a simulated street on, plausible and faulty streams keep every property, what the interpreter does included."""
    config = SatelliteConfig(selection=SelectionConfig(channels=3))
    system, asked = (model := compose_machines(config, trusted)).composition.system, makes(model)
    found = run_tests(
        system, asked, examples=8, steps=25, seed=7, corpus=[street(system, config)] if system.ghosts else []
    )
    said = {finding.id.rpartition("/")[2]: word(finding.result) for finding in found}
    assert [prop.name for prop in asked if prop.kind != "reachable"] == list(said)
    assert {"held"} == {one for name, one in said.items() if name not in NEVER_MET}


NEVER_MET = ("an excluded one never counts", "channel 2: braking excludes no healthy one")
"""In eight runs no satellite is excluded and used all the same, and none of the second channel is excluded."""


def street(system: TransitionSystem, config: SatelliteConfig) -> Trace:
    """A simulated ride along a street."""
    steps = simulate(config, seed=1, journey=STREET)
    told = [{name: value for name, value in step.items() if name != "truth_mm"} for step in steps]
    return run(system, told, first=first_of(config, STREET))


@pytest.mark.slow
def test_a_wrong_machine_is_caught_by_random_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Solutions that count whatever satellites they use: found without a proof."""
    from safeloc.models import satellite

    right = satellite.verdict
    monkeypatch.setattr(satellite, "verdict", lambda own, located: right(instead(own, usable=own.used), located))
    model = compose_machines(SatelliteConfig(selection=SelectionConfig(channels=3)))
    asked = [prop for prop in properties(model) if prop.name == "only usable satellites count"]
    found = run_tests(model.composition.system, asked, examples=200, steps=25, seed=7)
    assert ["violated"] == [word(finding.result) for finding in found]


def test_containment_needs_its_assumption() -> None:
    """With nothing assumed of any signal the reported interval may miss the truth: the proof of it is no empty one."""
    assert ["satellite_drift/property/containment"] == _unproved(compose_machines(CONFIG, "odometry"), "containment")


@pytest.mark.thorough(ordinary=1)
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

    def lax(own: Parts, located: Bool) -> Num:
        if "few" in weaker:
            return right(instead(own, config=own.config.model_copy(update={"redundancy": "solve"})), located)
        return right(instead(own, usable=own.used), located)

    monkeypatch.setattr(satellite, "verdict", lax)
    assert [f"satellite/property/{noticed}"] == _unproved(compose_machines(CONFIG), noticed)


def _halved(state: State) -> State:
    return replace(state, low=state.low + floor_div(state.below, 2), high=state.high - floor_div(state.above, 2))


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "broken", "noticed"),
    [
        ("predicted", lambda right: lambda own: _halved(right(own)), "containment"),
        ("predicted", lambda right: lambda own: _halved(right(own)), "coasting only grows"),
        ("fixed", lambda right: lambda own: _halved(right(own)), "containment"),
        (
            "carried",
            lambda right: lambda own, state: replace(right(own, state), holds=TRUE),
            "position and odometry meet",
        ),
        ("enough", lambda right: lambda own: TRUE, "no fix below the minimum"),
        ("fixed", lambda right: lambda own: right(instead(own, further=as_num(0, MM))), "containment"),
    ],
)
def test_a_wrong_machine_is_noticed(
    name: str, broken: Callable[[Any], Any], noticed: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Margins that shrink, a drift nobody checks, any number of satellites: not proved."""
    from safeloc.models import satellite

    monkeypatch.setattr(satellite, name, broken(getattr(satellite, name)))
    assert [f"satellite/property/{noticed}"] == _unproved(compose_machines(CONFIG), noticed)


def test_a_prediction_that_overshoots_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The change of speed counted twice does not follow from ranges and lemmas, in one step; counted once it does."""
    from safeloc.models import satellite

    name, right = "the prediction is the state before", satellite.predicted

    def overshoots(own: Parts) -> State:
        return replace(right(own), speed=right(own).speed + own.change)

    def keeps() -> bool:
        model = compose_machines(CONFIG)
        [claim] = [prop for prop in properties(model) if prop.name == name]
        return inductive_in(model.composition.system, claim, name)

    assert keeps()
    monkeypatch.setattr(satellite, "predicted", overshoots)
    assert not keeps()


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["range_threshold_mm", "speed_threshold_mm_s"])
def test_the_threshold_rule_is_sharp(name: str) -> None:
    """One above noise, clock and what a cycle makes of the state's error keeps every healthy satellite; exactly that does not."""
    chosen = CONFIG.selection
    least = {
        "range_threshold_mm": chosen.range_noise_mm + chosen.range_clock_mm + CONFIG.least_range_prediction_mm,
        "speed_threshold_mm_s": chosen.speed_noise_mm_s + chosen.speed_clock_mm_s + CONFIG.least_speed_prediction_mm_s,
    }[name]
    rule = "channel 1: braking excludes no healthy one"

    def unproved(threshold: int) -> list[str]:
        selection = chosen.model_copy(update={name: threshold})
        return _unproved(compose_machines(CONFIG.model_copy(update={"selection": selection})), rule)

    assert [[], [f"satellite/property/{rule}"]] == [unproved(least + 1), unproved(least)]


def _beside(right: Callable[[Parts, State], Anchor]) -> Callable[[Parts, State], Anchor]:
    """Odometry that counts from beside the reference."""
    return lambda own, state: replace(right(own, state), offset=right(own, state).offset + 1)


def _at_constant_speed(right: Callable[[Parts], State]) -> Callable[[Parts], State]:
    """A prediction without acceleration, in place and in speed."""

    def predicted(own: Parts) -> State:
        period = Lit(own.config.period_ms, MS)
        return replace(right(own), position=own.position + exact_to(own.speed * period, NM), speed=own.speed)

    return predicted


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "broken", "noticed"),
    [
        ("predicted", _at_constant_speed, "the prediction is the state before"),
        pytest.param(
            "predicted", lambda right: lambda own: replace(right(own), fastest=own.fastest), "containment",
            marks=pytest.mark.slow,
        ),
        ("_change", lambda _: lambda own, state: as_num(0, UM_S), "the prediction goes on with the change of speed"),
        ("_at_reference", _beside, "a position begins with no earlier data"),
        ("referred", lambda right: lambda own: replace(right(own), low=right(own).low - 1), "a reference bounds the position"),
        ("reportable", lambda right: lambda own, state: right(own, state) & own.anchored, "a good reference begins a position"),
    ],
)  # fmt: skip
def test_a_wrong_edit_of_prediction_or_restart_is_noticed(
    name: str, broken: Callable[[Any], Any], noticed: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """SAT-1, SAT-D1: constant acceleration from the state before alone, and a beginning without anything before it."""
    from safeloc.models import satellite

    monkeypatch.setattr(satellite, name, broken(getattr(satellite, name)))
    model = compose_machines(CONFIG)
    assert lost_by(model.composition.system, properties(model), noticed)


@pytest.mark.thorough
@pytest.mark.parametrize("noticed", ["containment", "a satellite that violates the criterion never counts"])
def test_a_selection_that_accepts_every_satellite_is_noticed(noticed: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """SAT-1: that usable signals keep their bounds follows from the criterion, and from nothing that is assumed of them."""
    from safeloc.models import satellite_selection

    monkeypatch.setattr(satellite_selection, "accepts", lambda *_: TRUE)
    model = compose_machines(CONFIG)
    assert lost_by(model.composition.system, properties(model), noticed)


@pytest.mark.thorough
def test_the_lax_criterion_bounds_no_signal() -> None:
    """Where both violations are needed to remove a satellite, nothing follows for its error, nor for the position."""
    lax = CONFIG.model_copy(update={"selection": CONFIG.selection.model_copy(update={"removal": "both"})})
    model = compose_machines(lax)
    assert lost_by(model.composition.system, properties(model), "containment")


# ------------------------------------------------------------------ what a usable signal may be wrong by

TERMS = ("threshold", "prediction", "clock")
NARROWED = "a solution narrows to its protection level and no farther"


def _without(kind: Kind, *left_out: str) -> property:
    """What a machine adds for a usable signal that leaves some of the terms out."""
    unit = "mm" if kind == "range" else "mm_s"
    counted = [f"{kind}_{term}_{unit}" for term in TERMS if term not in left_out]
    return property(lambda config: sum(getattr(config, name) for name in counted))


LEFT_OUT = [*((term,) for term in TERMS), TERMS[1:]]
"""One of the terms, and all but the threshold, as it once was."""


def _uncharged(kind: Kind, left_out: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> Satellite:
    """A machine that leaves these terms out of its levels; the world and the claims have figures of their own."""
    name = "usable_range_error_mm" if kind == "range" else "usable_speed_error_mm_s"
    monkeypatch.setattr(SelectionConfig, name, _without(kind, *left_out))
    return compose_machines(CONFIG)


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("left_out", LEFT_OUT, ids=" and ".join)
def test_a_term_that_is_not_added_is_noticed(
    kind: Kind, left_out: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Threshold, prediction or clock left out of a level, or prediction and clock as it once was."""
    model = _uncharged(kind, left_out, monkeypatch)
    (asked,) = [prop for prop in properties(model) if prop.name == NARROWED]
    assert not inductive_in(model.composition.system, asked, NARROWED)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["range", pytest.param("speed", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "left_out", [*(pytest.param(one, marks=pytest.mark.slow) for one in LEFT_OUT[:-1]), LEFT_OUT[-1]], ids=" and ".join
)
def test_a_term_that_is_not_added_misses_the_truth(
    kind: Kind, left_out: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same, as a run whose reported interval does not hold the truth while every law is kept."""
    model = _uncharged(kind, left_out, monkeypatch)
    assert {"containment": "violated"} == lost_by(model.composition.system, properties(model), "containment")


@pytest.mark.thorough
@pytest.mark.parametrize("kind", KINDS)
def test_one_unit_less_is_noticed(kind: Kind, monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine that adds 1 mm, or 1 mm/s, less than a usable signal may be wrong by; in place with a run that misses the truth."""
    name = "usable_range_error_mm" if kind == "range" else "usable_speed_error_mm_s"
    right = bounds_in_figures(CONFIG)[KINDS.index(kind)]
    monkeypatch.setattr(SelectionConfig, name, property(lambda _: right - 1))
    model = compose_machines(CONFIG)
    (asked,) = [prop for prop in properties(model) if prop.name == NARROWED]
    assert not inductive_in(model.composition.system, asked, NARROWED)
    if kind == "range":
        assert {"containment": "violated"} == lost_by(model.composition.system, properties(model), "containment")


def test_the_right_machine_keeps_its_levels() -> None:
    """Nothing is noticed of the machine as it is."""
    model = compose_machines(CONFIG)
    (asked,) = [prop for prop in properties(model) if prop.name == NARROWED]
    assert inductive_in(model.composition.system, asked)


@pytest.mark.slow
@pytest.mark.parametrize("less", [(1, 0), (0, 1)])
def test_the_selection_does_not_guarantee_less(less: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    """What the world takes from the selection is proved of it, in range and in rate; 2 mm (or 2 mm/s) less is not.

    Differences are whole mm below the threshold: 1 less is as true.
    """

    def smaller(config: SelectionConfig) -> tuple[int, ...]:
        return tuple(most - 2 * one for most, one in zip(signal_errors(config), less, strict=True))

    monkeypatch.setattr("safeloc.models.satellite.signal_errors", smaller)
    model = compose_machines(CONFIG)
    assert lost_by(model.composition.system, properties(model), "containment")


@pytest.mark.parametrize(
    "config", [CONFIG, FINE, *CONFIGURATIONS.named.values()], ids=["defaults", "fine", *CONFIGURATIONS.named]
)
def test_machine_and_world_have_the_same_figure(config: SatelliteConfig) -> None:
    """What the machine adds, what the world takes from the selection, and the sum of the configured terms."""
    chosen = config.selection
    figures = (
        chosen.range_threshold_mm + chosen.range_prediction_mm + chosen.range_clock_mm,
        chosen.speed_threshold_mm_s + chosen.speed_prediction_mm_s + chosen.speed_clock_mm_s,
    )
    assert figures == bounds_in_figures(config) == signal_errors(chosen)
