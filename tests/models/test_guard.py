"""The guard of a receiver: proved; every guard that is broken on purpose is noticed; rejection and recovery in figures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import pytest

from safeloc.catalogue import load_target
from safeloc.language.expr import FALSE, TRUE, Lit, Num, as_num, exact_to, ite, minimum
from safeloc.language.interpret import run
from safeloc.language.machine import Machine
from safeloc.language.monitor import check_all
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.units import COUNT, NM, UM_S
from safeloc.language.verdict import Held, Proved
from safeloc.models import guard
from safeloc.models.guard import Guard, box, build, judgement, stored
from safeloc.models.guard.judgement import Judgement
from safeloc.models.guard.simulate import FIRST_TRUTH, simulate
from safeloc.models.guard.variables import (
    ACROSS,
    AGAINST,
    DOUBTFUL,
    FAULT,
    JUDGED,
    JUMP,
    OFF_TRACK,
    OUT_OF_REACH,
    PASSED,
    SPEED_DISAGREES,
    GuardConfig,
    Parts,
    parts,
)
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.guard import properties
from safeloc.runtime.streams.steps import read_steps
from tests.models.everything_proved import shipped_runs
from tests.models.inductive import changed, inductive, without
from tests.models.spoilt import rebuilt
from tests.models.wrong_edits import lost

CONFIG = GuardConfig(confirmations=3, speed_window_ms=400, window_limit_mm=40_000)
MODEL = build(parts(CONFIG))
SYSTEM = without_ghosts(lower(MODEL.machine))
PROPERTIES = {prop.name: prop for prop in properties(MODEL)}


def quiet(**changes: Value) -> dict[str, Value]:
    """A step of one period in which nothing is delivered, but for the changes."""
    return {
        "advance": True, "fault": 0, "fix_offset_mm": 0, "fix_age_ms": 0, "fix_ambiguous": False, "fix_elsewhere": False,
        "forwards_only": True, "start_anew": False, **changes,
    }  # fmt: skip


def at(position_mm: int, **changes: Value) -> dict[str, Value]:
    """A step with a fix."""
    return quiet(fix_mm=position_mm, **changes)


def driven(*steps: Mapping[str, Value]) -> Trace:
    """The steps, on board."""
    return run(SYSTEM, steps)


def modes(trace: Trace) -> list[str]:
    """The mode after each step."""
    return [MODEL.machine.modes[int(step.state["mode"])].label for step in trace.steps]


def reasons(trace: Trace) -> list[str]:
    """What became of each step's delivery."""
    return [JUDGED[int(step.state["last_verdict"])].label for step in trace.steps]


BELIEVED = [at(0), at(0), at(0)]


# ------------------------------------------------------------------ proofs


@pytest.mark.thorough
@pytest.mark.parametrize(
    "figures",
    [
        {"confirmations": 3, "speed_window_ms": 400},
        pytest.param({}, marks=pytest.mark.slow),
        pytest.param({"period_ms": 400, "confirmations": 2}, marks=pytest.mark.slow),
        pytest.param({"acceleration_mm_s2": 181, "brake_mm_s2": 2_000, "speed_window_ms": 800}, marks=pytest.mark.slow),
    ],
    ids=["short", "default", "slow", "freight"],
)  # fmt: skip
def test_everything_is_proved(figures: Mapping[str, int]) -> None:
    """Without a bound, for configurations that differ in period, row and brake."""
    model = build(parts(GuardConfig.model_validate(figures)))
    findings = prove(lower(model.machine), properties(model), Limits(seconds=60), **shipped_runs("guard"))
    assert [finding.id for finding in findings if not isinstance(finding.result, Proved)] == []


def keeps(machine: Machine, name: str, only: str = "") -> bool:
    """Whether the property of that name and all lemmas, or the fact `only`, follow in one step."""
    found = {prop.name: prop for prop in properties(replace(MODEL, machine=machine))}
    return inductive(machine, found[name], only)


@pytest.mark.parametrize(
    ("name", "fields"),
    [
        ("receiver believed", {"when": MODEL.judgement.agrees & MODEL.judgement.begins}),
        ("receiver believed again", {"when": MODEL.judgement.agrees}),
        ("fix passed on", {"when": MODEL.judgement.begins}),
        ("receiver believed", {"when": MODEL.judgement.confirmed}),
    ],
    ids=["one fewer in the row", "one lucky fix on probation", "window not looked at", "agreement not looked at"],
)
def test_a_broken_guard_loses_the_truth(name: str, fields: Mapping[str, object]) -> None:
    """A fix that is taken too early, or without its gates, makes containment fail."""
    assert not keeps(changed(MODEL.machine, name, **fields), "containment", "the truth is inside")


def spoilt_updates(name: str, change: Callable[[Guard], dict[object, object]]) -> Machine:
    """The machine with some updates of one transition changed."""
    table = [replace(t, set={**t.set, **change(MODEL)}) if t.name == name else t for t in MODEL.machine.transitions]  # type: ignore[dict-item]
    return rebuilt(MODEL.machine, table)


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("coast while passing", lambda model: {model.own.high: model.own.high}),
        ("coast while probation", lambda model: {model.own.low: model.own.low}),
        ("implausible fix", lambda model: stored(model.own, model.judgement.with_fix)),
        ("fix agrees on probation", lambda model: stored(model.own, model.judgement.with_fix)),
        ("fix passed on", lambda model: {model.own.anchor_high: model.own.anchor_low}),
        ("coast while passing", lambda model: {model.own.fast: model.own.fast}),
    ],
    ids=["front rests", "rear rests", "an implausible fix narrows", "a doubtful fix narrows", "anchor", "speed rests"],
)
def test_a_broken_update_loses_the_truth(name: str, change: Callable[[Guard], dict[object, object]]) -> None:
    """An interval that does not grow by all that the vehicle can do, or narrows by what was withheld, is noticed."""
    assert not keeps(spoilt_updates(name, change), "containment")


@pytest.mark.parametrize(
    ("prop", "name", "fields"),
    [
        ("no resurrection", "receiver believed again", {"when": MODEL.judgement.agrees}),
        ("an implausible fix costs the trust", "implausible fix", {"when": FALSE}),
        ("only a full row passes", "fix passed on", {"set": {MODEL.own.agreed_fixes: as_num(1, COUNT)}}),
        ("faults are never passed", "fix passed on", {"when": TRUE}),
    ],
)
def test_a_broken_rule_is_noticed(prop: str, name: str, fields: Mapping[str, object]) -> None:
    """Each rule of trust fails when the transition that keeps it is broken."""
    assert not keeps(changed(MODEL.machine, name, **fields), prop, prop)


def test_the_implausible_fix_has_to_be_noticed() -> None:
    """Without its transition an implausible fix would leave the receiver trusted."""
    prop = "an implausible fix costs the trust"
    assert not keeps(without(MODEL.machine, "implausible fix"), prop, prop)


# ------------------------------------------------------------------ figures


def _trusted_at_once(_: object) -> property:
    return property(lambda judged: TRUE)


def _one_too_few(_: object) -> property:
    return property(lambda judged: judged.own.agreed_fixes + 2 >= judged.own.config.confirmations)


def _jumps_forgiven(_: object) -> property:
    return property(lambda judged: judged.verdict.one_of(OFF_TRACK, SPEED_DISAGREES))


def _speed_forgiven(_: object) -> property:
    return property(lambda judged: judged.verdict.one_of(OFF_TRACK, JUMP))


def _doubt_counts(_: object) -> property:
    return property(lambda judged: judged.verdict.one_of(PASSED, DOUBTFUL))


def _row_by_two(_: object) -> property:
    return property(lambda judged: minimum(judged.own.agreed_fixes + 2, judged.own.config.confirmations))


def _begins_by_anything(_: object) -> property:
    return property(lambda judged: judged.own.fix.present)


def _brake_forgotten(right: Callable[[Parts, box.Box], box.Box]) -> Callable[[Parts, box.Box], box.Box]:
    def moved(own: Parts, held: box.Box) -> box.Box:
        return replace(right(own, held), slow=held.slow)

    return moved


def _age_forgotten(right: Callable[[Parts], Num]) -> Callable[[Parts], Num]:
    return lambda own: right(own) - exact_to(Lit(own.config.max_speed_mm_s * 1_000, UM_S) * own.age, NM)


def _contradiction_forgiven(_: object) -> property:
    return property(lambda judged: TRUE)


def _farther_than_run(right: Callable[[Parts], tuple[Num, Num]]) -> Callable[[Parts], tuple[Num, Num]]:
    return lambda own: (right(own)[0] - 1_000_000, right(own)[1])


def _course_forgiven(right: Callable[..., Num]) -> Callable[..., Num]:
    def fair(own: Parts, known: tuple[Num, Num]) -> Num:
        return ite(right(own, known).eq(OUT_OF_REACH), OUT_OF_REACH, PASSED)

    return fair


def _backwards_forgiven(right: Callable[..., Num]) -> Callable[..., Num]:
    return lambda own, known: ite(right(own, known).eq(AGAINST), PASSED, right(own, known))


def _any_course_refused(right: Callable[..., Num]) -> Callable[..., Num]:
    return lambda own, known: ite(own.course.present, ACROSS, right(own, known))


def _reach_forgiven(right: Callable[..., Num]) -> Callable[..., Num]:
    return lambda own, known: ite(right(own, known).eq(OUT_OF_REACH), PASSED, right(own, known))


def _roll_back_refused(right: Callable[..., Num]) -> Callable[..., Num]:
    def fair(own: Parts, known: tuple[Num, Num]) -> Num:
        return right(own, (known[0] + own.config.rollback_mm * 1_000_000, known[1]))

    return fair


def _known_runs_back(right: Callable[[Parts], tuple[Num, Num]]) -> Callable[[Parts], tuple[Num, Num]]:
    return lambda own: (right(own)[0] - 1_000_000, right(own)[1])


def _known_stands(right: Callable[[Parts], tuple[Num, Num]]) -> Callable[[Parts], tuple[Num, Num]]:
    return lambda own: (right(own)[0], minimum(own.known_high, right(own)[1]))


def _nothing_forgotten(_: object) -> Callable[[Parts], dict[object, object]]:
    return lambda own: {}


CARRIED = "the place last known is carried"
COSTS = "an implausible fix costs the trust"
CONTRADICTS = "a receiver that contradicts itself loses the trust"
COMPARED = "a fix is compared with the last one near the way"
EDITS: dict[str, tuple[object, str, Callable[..., object], str]] = {
    "trusted with any fix that agrees": (Judgement, "confirmed", _trusted_at_once, "no resurrection"),
    "trusted with one fix too few": (Judgement, "confirmed", _one_too_few, "no resurrection"),
    "a jump costs no trust": (Judgement, "implausible", _jumps_forgiven, COSTS),
    "a speed costs no trust": (Judgement, "implausible", _speed_forgiven, COSTS),
    "a fix in doubt counts": (Judgement, "agrees", _doubt_counts, "a delivery agrees or has the first reason against it"),
    "the row grows by two": (Judgement, "more", _row_by_two, "a row that does not agree begins anew"),
    "anything begins a row": (Judgement, "begins", _begins_by_anything, "a row begins with a fix that may be true"),
    "brakes are not reckoned with": (judgement, "moved", _brake_forgotten, "a fix that is withheld narrows nothing"),
    "age is not added": (box, "half_nm", _age_forgotten, "an interval begun by a fix covers the fix's whole error"),
    "a receiver may contradict itself": (Judgement, "follows", _contradiction_forgiven, CONTRADICTS),
    "a vehicle runs farther than it can": (judgement, "near_now", _farther_than_run, COMPARED),
    "whatever is held is kept": (guard, "usable", lambda _: lambda config, held: TRUE, "a stored interval that bounds nothing is dropped"),
}  # fmt: skip


QUICK_EDITS: dict[str, tuple[object, str, Callable[..., object], str]] = {
    "a course across the way is forgiven": (judgement, "_fair", _course_forgiven, "a course across the way is refused"),
    "running backwards is forgiven": (judgement, "_fair", _backwards_forgiven, "a course against the permitted direction is refused"),
    "every course is refused": (judgement, "_fair", _any_course_refused, "a course along the way is not refused"),
    "a place out of reach is forgiven": (judgement, "_fair", _reach_forgiven, "a place out of reach is refused"),
    "rolling back is refused": (judgement, "_fair", _roll_back_refused, "a place in reach is not refused"),
    "the place last known runs back": (judgement, "known_now", _known_runs_back, CARRIED),
    "the place last known stands": (judgement, "known_now", _known_stands, CARRIED),
    "a new start forgets nothing": (guard, "_nowhere", _nothing_forgotten, "a new start forgets"),
}  # fmt: skip
"""What breaks these claims does so in one step."""


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("edit", QUICK_EDITS)
def test_a_wrong_edit_of_course_or_reach_is_noticed_in_one_step(edit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Refusals by course and by the place last known are claimed in both directions, and follow in one step where nothing is edited."""
    where, name, wrong, broken = QUICK_EDITS[edit]
    assert inductive(MODEL.machine, PROPERTIES[broken])
    monkeypatch.setattr(where, name, wrong(getattr(where, name)))
    made = build(parts(CONFIG))
    found = {prop.name: prop for prop in properties(made)}
    assert not inductive(made.machine, found[broken], broken)


SLOW = ("the row grows by two", "whatever is held is kept", "a jump costs no trust")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("edit", [pytest.param(edit, marks=pytest.mark.slow if edit in SLOW else ()) for edit in EDITS])
def test_a_wrong_edit_of_a_term_is_noticed(edit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """MRK-D6: gates, added errors and trust are claimed in figures of their own."""
    where, name, wrong, broken = EDITS[edit]
    monkeypatch.setattr(where, name, wrong(getattr(where, name)))
    made = build(parts(CONFIG))
    assert lost(made.machine, properties(made), broken)


def test_a_row_is_needed() -> None:
    """Two fixes are not enough where three are asked for; the third is passed on with 10 m on either side."""
    trace = driven(*BELIEVED)
    assert ["RECOVERING", "RECOVERING", "PASSING"] == modes(trace)
    assert ["UNCONFIRMED", "UNCONFIRMED", "PASSED"] == reasons(trace)
    assert (True, 0, 10_000, 10_000) == tuple(
        trace.steps[-1].outputs[name] for name in ("valid", "position_mm", "margin_below_mm", "margin_above_mm")
    )


def test_a_jump_costs_the_trust() -> None:
    """After a jump the next fix where the vehicle can be is withheld, and passed on only when the row is full again."""
    trace = driven(*BELIEVED, at(200_000), at(0), at(0), at(0))
    assert ["PROBATION", "PROBATION", "PROBATION", "PASSING"] == modes(trace)[3:]
    assert ["JUMP", "UNCONFIRMED", "UNCONFIRMED", "PASSED"] == reasons(trace)[3:]


def test_a_contradiction_costs_the_trust() -> None:
    """Two fixes beside what is held, one before it and one behind: one of them is false, and a row has to be filled anew."""
    trace = driven(*BELIEVED, at(-14_600), at(19_500), at(0), at(0), at(0))
    assert ["PASSING", "PROBATION", "PROBATION", "PROBATION", "PASSING"] == modes(trace)[3:]
    assert ["DOUBTFUL", "OUT_OF_REACH", "UNCONFIRMED", "UNCONFIRMED", "PASSED"] == reasons(trace)[3:]
    assert 0 == trace.steps[4].outputs["agreed_fixes"]


def test_a_course_across_or_against_the_way_costs_the_trust() -> None:
    """15 degrees pass and 15.1 do not; against the way only where both directions are permitted, and the row begins anew."""
    for course, only, expected in (
        (262, True, "PASSED"),
        (263, True, "ACROSS"),
        (2_879, False, "ACROSS"),
        (2_880, False, "PASSED"),
        (2_880, True, "AGAINST"),
        (1_571, True, "ACROSS"),
        (1_572, True, "AGAINST"),
    ):
        step = at(0, fix_course_mrad=course, forwards_only=only)
        assert expected == reasons(driven(*BELIEVED, step))[-1], course
        assert (expected == "PASSED") == (reasons(driven(*BELIEVED, step, at(0)))[-1] == "PASSED")


GIVEN_UP = [*BELIEVED, *[quiet()] * 40]
"""The window is given up long before its end, 4 s later."""


def test_the_place_last_known_outlasts_withdrawal() -> None:
    """A row behind it is refused, for ever; one as far ahead as a vehicle runs in the time is believed."""
    assert "WITHDRAWN" == modes(driven(*GIVEN_UP))[-1]
    behind = driven(*GIVEN_UP, *[at(-100_000)] * 20, *[quiet()] * 2_000, *[at(-100_000)] * 4)
    assert {"OUT_OF_REACH"} == set(reasons(behind)[43:63]) == set(reasons(behind)[-4:])
    ahead = driven(*GIVEN_UP, *[at(150_000)] * 3)
    assert ["UNCONFIRMED", "UNCONFIRMED", "PASSED"] == reasons(ahead)[-3:]
    assert ["OUT_OF_REACH"] * 3 == reasons(driven(*GIVEN_UP, *[at(250_000)] * 3))[-3:]


def test_a_vehicle_may_roll_back_a_little() -> None:
    """By 5 m, and a fix by its error more; where both directions are permitted, as far as it can run."""
    assert ["PASSED", "OUT_OF_REACH"] == [reasons(driven(*GIVEN_UP, *[at(mm)] * 3))[-1] for mm in (-25_000, -25_001)]
    back = [{**step, "forwards_only": False} for step in (*GIVEN_UP, *[at(-100_000)] * 3)]
    assert "PASSED" == reasons(driven(*back))[-1]


def test_a_wrong_first_place_is_forgotten_with_a_new_start() -> None:
    """Only the host can say that; then the next row is believed wherever it lies."""
    assert "OUT_OF_REACH" == reasons(driven(*GIVEN_UP, *[at(-100_000)] * 3))[-1]
    assert "PASSED" == reasons(driven(*GIVEN_UP, quiet(start_anew=True), *[at(-100_000)] * 3))[-1]
    started = driven(*BELIEVED, at(0, start_anew=True))
    assert ("WITHDRAWN", "UNCONFIRMED") == (modes(started)[-1], reasons(started)[-1])


def test_silence_widens_and_ends_it() -> None:
    """Without fixes the interval grows by 4.4 m a step and side at 160 km/h; beyond the window it is given up."""
    trace = driven(*BELIEVED, *[quiet()] * 9)
    widths = [step.outputs["window_to_mm"] for step in trace.steps[2:9]]
    assert widths == sorted(widths)
    assert (False, True) == (trace.steps[7].outputs["valid"], trace.steps[7].outputs["holding"])
    assert "WITHDRAWN" == modes(trace)[-1]


def test_after_silence_a_fix_that_agrees_is_passed_on() -> None:
    """A receiver that was only silent is not in doubt."""
    trace = driven(*BELIEVED, *[quiet()] * 5, at(20_000))
    assert ("PASSED", "PASSING", True) == (reasons(trace)[-1], modes(trace)[-1], trace.steps[-1].outputs["valid"])


def test_speed_is_told_from_distance() -> None:
    """After a window at rest the interval grows more slowly than at the highest speed."""
    config = GuardConfig(confirmations=2)
    trace = run(without_ghosts(lower(build(parts(config)).machine)), [*[at(0)] * 42, quiet()])
    assert trace.steps[-1].state["fast_um_s"] < 10_000_000
    assert trace.steps[-1].state["slow_um_s"] > -10_000_000


@pytest.mark.parametrize(
    ("step", "reason"),
    [
        (at(0, fix_offset_mm=10_001), "OFF_TRACK"),
        (at(0, fix_ambiguous=True), "AMBIGUOUS"),
        (at(0, fix_age_ms=900), "TOO_COARSE"),
        (at(0, fix_elsewhere=True), "JUMP"),
        (at(30_000), "JUMP"),
        (at(14_600), "DOUBTFUL"),
        (at(0, fix_speed_mm_s=46_000), "SPEED_DISAGREES"),
        *((quiet(fault=number), fault.label) for number, fault in enumerate(FAULT) if number),
        (at(0, fault=3), "NOT_FINITE"),
        (quiet(), "NOTHING"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_is_withheld(step: Mapping[str, Value], reason: str) -> None:
    """Each gate has its reason, and what fails it leaves the interval to grow as if nothing had come."""
    trace = driven(*BELIEVED, step)
    silent = driven(*BELIEVED, quiet())
    assert reason == reasons(trace)[-1]
    assert not trace.steps[-1].outputs["passed"]
    assert trace.steps[-1].outputs["window_to_mm"] == silent.steps[-1].outputs["window_to_mm"]


def test_speed_that_disagrees_with_the_distance_run() -> None:
    """A receiver that tells 20 m/s at rest is in doubt, once a window has told that the vehicle rests."""
    config = GuardConfig(confirmations=2)
    system = without_ghosts(lower(build(parts(config)).machine))
    trace = run(system, [*[at(0)] * 42, at(0, fix_speed_mm_s=20_000)])
    assert "SPEED_DISAGREES" == JUDGED[int(trace.steps[-1].state["last_verdict"])].label


def test_the_same_instant_moves_nothing() -> None:
    """A second delivery in one instant finds the vehicle where it was."""
    trace = driven(*BELIEVED, quiet(advance=False))
    assert trace.steps[-1].outputs["window_to_mm"] == trace.steps[-2].outputs["window_to_mm"]


def test_wrong_configurations_are_refused() -> None:
    """Figures under which no fix could be passed on, an odd period, a window less than the tolerance or of no steps."""
    for figures, told in (
        ({"fix_error_mm": 20_000}, "has an error bound of 35000 mm"),
        ({"period_ms": 101}, "period_ms must be even"),
        ({"window_limit_mm": 20_000}, "window_limit_mm must not be less"),
        ({"track_clearance_mm": 9_999}, "track_clearance_mm must not be less"),
        ({"speed_window_ms": 100}, "it must be 2 to 100"),
    ):
        with pytest.raises(ValueError, match=told):
            GuardConfig.model_validate(figures)


# ------------------------------------------------------------------ streams


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("seed", range(4))
def test_simulated_receivers_obey_the_law_and_are_guarded(seed: int) -> None:
    """On simulated faults every property holds with the truth beside it, and most fixes are passed on."""
    system = lower(MODEL.machine)
    trace = run(system, simulate(CONFIG, seed=seed, seconds=60), first=FIRST_TRUTH)
    found = zip(PROPERTIES, check_all(trace, list(PROPERTIES.values())), strict=True)
    assert [name for name, result in found if name != "probation is survived" and not isinstance(result, Held)] == []
    assert sum(bool(step.outputs["passed"]) for step in trace.steps) > 20


@pytest.mark.thorough
def test_shipped_streams_show_doubt_and_recovery() -> None:
    """In the recordings that ship every transition fires."""
    target = load_target("guard")
    streams = [read_steps(path) for path in target.streams]
    runs = [run(target.system, stream.steps, first=stream.first) for stream in streams]
    fired = {name for trace in runs for step in trace.steps for name in step.fired.values()}
    assert {transition.name for transition in target.machines[0].transitions} <= fired
