"""A vehicle that nobody announces, beside a train that is known: from which cycle on it is noticed, what is free until then, and wrong machines."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pytest

from safeloc.language.expr import FALSE, all_of, any_of
from safeloc.language.interpret import run, start, taken
from safeloc.language.monitor import check_all
from safeloc.language.system import environment, lower, without_ghosts
from safeloc.language.trace import Step, Trace
from safeloc.language.verdict import Violated
from safeloc.models.area import AreaConfig
from safeloc.models.fibre_area import FibreArea, compose_machines
from safeloc.models.fibre_area import entry as entry_model
from safeloc.models.fibre_area.entry_variables import Parts
from safeloc.models.fibre_area.recorded_runs import CONFIG, UNANNOUNCED
from safeloc.models.fibre_area.simulate import REMARK, Journey, first_state, simulate_journey
from safeloc.models.fibre_area.simulated_counters import sweep
from safeloc.models.sections import SectionsConfig
from safeloc.models.verification.variables import NOBODY
from safeloc.properties.fibre_area import properties
from safeloc.runtime.streams.steps import Cell
from tests.models.edited_terms import edited
from tests.models.inductive import inductive_in

Wrong = Callable[..., object]
SWEPT = len(sweep(CONFIG.axle_section))
SOON = "an unannounced vehicle behind a train is noticed once the train's axles are known"
AT_ONCE = "an unannounced vehicle at the other end is noticed at once"
NEVER = "section_1 is never clear with an unannounced vehicle behind the train"
BEHIND_A_VERIFIED_TRAIN = replace(UNANNOUNCED, cycles=120, unannounced=(20, 400_000), cuts_mm=((50_000, 300_000),))
"""The follower comes in when the train's record has come."""


@cache
def whole() -> FibreArea:
    """The composition of one train and one section."""
    return compose_machines(CONFIG)


def travelled(journey: Journey, model: FibreArea, **cells: Cell) -> Trace:
    """A journey through the composition, with its truth; `cells` are the same in every cycle."""
    steps = [
        {name: cell for name, cell in step.items() if name != REMARK} | cells
        for step in simulate_journey(CONFIG, seed=1, journey=journey)
    ]
    return run(model.composition.system, steps, first=first_state(CONFIG, journey))


def violated(trace: Trace, model: FibreArea) -> set[str]:
    """The claims that a run violates."""
    claims = properties(model)
    return {
        claim.name for claim, one in zip(claims, check_all(trace, claims), strict=True) if isinstance(one, Violated)
    }


def modes(trace: Trace, machine: str) -> list[str]:
    """The mode of a machine after every cycle of the journey."""
    (found,) = [one for one in trace.system.machines if one.name == machine]
    return [found.modes[int(step.state[f"{machine}.mode"])].label for step in trace.steps[SWEPT:]]


def others(step: Step) -> int:
    """Axles of the follower in the area."""
    return int(step.state["entry.axles_of_others_behind"])


# ------------------------------------------------------------------ runs


def test_a_follower_is_noticed_when_the_record_comes() -> None:
    """Its first axles come in with nothing known of the train's own; until the record nothing is free behind the train's front."""
    trace = travelled(UNANNOUNCED, whole())
    noticed = [bool(step.outputs["entry.unannounced"]) for step in trace.steps[SWEPT:]]
    first = next(cycle for cycle, step in enumerate(trace.steps[SWEPT:]) if others(step) > 0)
    assert (first, noticed.index(True)) == (13, UNANNOUNCED.record)
    assert all(noticed[17:])
    assert {*modes(trace, "section_1")[17:]} == {"UNKNOWN"}
    assert {*modes(trace, "verification")[17:]} == {"WITHHELD"}
    assert violated(trace, whole()) == set()


def test_a_follower_of_a_verified_train_is_noticed_at_its_first_axle() -> None:
    """A section that was free behind the train is so no more in the cycle in which the follower's first axle is counted in."""
    trace = travelled(BEHIND_A_VERIFIED_TRAIN, whole())
    first = next(cycle for cycle, step in enumerate(trace.steps[SWEPT:]) if others(step) > 0)
    noticed = [bool(step.outputs["entry.unannounced"]) for step in trace.steps[SWEPT:]]
    assert noticed.index(True) == first
    assert "TRUSTED" in modes(trace, "verification")[first - 5 : first]
    assert "TRUSTED" not in modes(trace, "verification")[first:]
    assert "FREE" not in modes(trace, "section_1")[first:]
    assert violated(trace, whole()) == set()


def test_axles_that_are_taken_for_the_trains_free_what_the_follower_is_in(monkeypatch: pytest.MonkeyPatch) -> None:
    """As it was: once the train before it is far enough away, the section is free over the follower."""
    edited(monkeypatch, Parts, "has_more", lambda _one, _right: FALSE)
    model = compose_machines(CONFIG)
    journey = replace(UNANNOUNCED, cycles=100, unannounced=(20, 1_200_000), cuts_mm=((5_000, 150_000),))
    trace = travelled(journey, model, **{"area.next_loose_there": False})
    over = [modes(trace, "section_1")[cycle] for cycle, step in enumerate(trace.steps[SWEPT:]) if others(step) > 0]
    assert "FREE" in over
    assert {SOON, NEVER} <= violated(trace, model)


def test_a_vehicle_at_the_other_end_in_the_cycle_of_the_entry_is_noticed_in_it() -> None:
    """Two axles, all of them in that cycle, where no train is known and none comes in: a section over them was free for a minute before."""
    journey = replace(UNANNOUNCED, unannounced=None, record=14, cuts_mm=((2_600_000, 3_000_000),))
    comes: dict[str, Cell] = {
        "axle_section.axles_in_high": 2, "axle_section.true_axles_in_high": 2, "entry.other_axles_high": 2,
    }  # fmt: skip
    steps = simulate_journey(CONFIG, seed=1, journey=journey)
    for number, one in enumerate(steps):
        del one[REMARK]
        one.update(comes if number == SWEPT else {}, **({"area.next_loose_there": True} if number >= SWEPT else {}))
        stands: dict[str, Cell] = {"area.next_loose_rear_um": 2_900_000_000, "area.next_loose_front_um": 2_910_000_000}
        one.update(stands if number >= SWEPT else {})
    trace = run(whole().composition.system, steps, first=first_state(CONFIG, journey))
    assert all(step.outputs["entry.unannounced"] for step in trace.steps[SWEPT:])
    assert {*modes(trace, "section_1")} == {"UNKNOWN"}
    system = whole().composition.system
    obeyed = [*taken(system, start(system, first_state(CONFIG, journey)), steps, while_=environment(system))]
    assert len(obeyed) == len(steps)
    assert violated(trace, whole()) == set()


def test_a_train_that_is_announced_early_is_there() -> None:
    """Its first wheel stands on the head for two cycles before it is counted: what is claimed of trains in sections is claimed of it."""
    journey = replace(UNANNOUNCED, unannounced=None, record=17, enters=3)
    steps = simulate_journey(CONFIG, seed=1, journey=journey)
    for one in steps:
        del one[REMARK]
    announced = SWEPT + journey.enters
    steps[announced - 2 : announced] = [
        {**one, "axle_section.head_damped": True, "entry.enters_low": int(number == 0)}
        for number, one in enumerate(steps[announced - 2 : announced])
    ]
    steps[announced]["entry.enters_low"] = 0
    trace = run(whole().composition.system, steps, first=first_state(CONFIG, journey))
    assert all(step.state["area.train_1_there"] for step in trace.steps[announced:])
    assert "TRUSTED" in modes(trace, "verification")


def test_a_train_that_left_in_a_disturbance_is_gone_in_the_world() -> None:
    """So that the laws allow the next one to come in before the counters are reset; its slot stays, since nobody counted it out."""
    journey = replace(UNANNOUNCED, unannounced=None, record=14, cycles=190)
    steps = simulate_journey(CONFIG, seed=1, journey=journey)
    for number, one in enumerate(steps):
        del one[REMARK]
        one["axle_section.head_fault"] = number == SWEPT + 76
    trace = run(whole().composition.system, steps, first=first_state(CONFIG, journey))
    there = [bool(step.state["area.train_1_there"]) for step in trace.steps[SWEPT:]]
    axles = [int(step.state["axle_section.true_axles"]) for step in trace.steps[SWEPT:]]
    assert there == [number > 0 for number in axles]
    assert all(step.outputs["area.train_1_in_area"] for step in trace.steps[SWEPT:])


# ------------------------------------------------------------------ the entry by itself


def heard(*cycles: dict[str, Cell]) -> list[Step]:
    """The entry of the first of two trains after each cycle, with what differs from a cycle in which nothing happens."""
    own = entry_model.parts(trains=2, wait_cycles=240, axle_limit=1_000, axles_a_cycle=40)
    still: dict[str, Cell] = {
        "enters_low": 0, "enters_high": 0, "leaves_low": False, "leaves_high": False, "train_2_all_left": False,
        "train_2_axles_of_others": False, "record_sound": True, "record_axles": 40, "outermost_low": 1, "outermost_high": 1,
        "reference_comes": "NOBODY", "counters_clear": False, "counters_occupied": True, "counters_count": True,
        "axles_in_low": 0, "axles_in_high": 0, "axles_out_low": 0, "axles_out_high": 0,
    }  # fmt: skip
    system = without_ghosts(lower(entry_model.build(own).machine))
    return run(system, [{**still, **cycle} for cycle in cycles], first={}).steps


COMES: dict[str, Cell] = {"enters_low": 1, "outermost_low": 0, "outermost_high": 0, "axles_in_low": 40}
TOLD: dict[str, Cell] = {"reference_comes": "AXLE_COUNTER"}


@pytest.mark.parametrize(
    ("cycles", "unannounced"),
    [
        ([COMES, TOLD, {}], [False, False, False]),
        ([COMES, TOLD, {"axles_in_low": 1}], [False, False, True]),
        ([COMES, {"axles_in_low": 1}, TOLD], [False, False, True]),
        ([COMES, {"axles_in_low": 1}, {**TOLD, "record_sound": False}, TOLD], [False, False, False, True]),
        ([COMES, {**TOLD, "record_axles": 0}, {"axles_in_low": 1}], [False, False, False]),
        ([COMES, {"axles_in_high": 1}], [False, True]),
        ([COMES, {"axles_out_high": 2}, {"axles_in_high": 2}, {"axles_in_high": 1}], [False, False, False, True]),
        ([COMES, TOLD, {"axles_out_low": 2}, {"axles_in_low": 2}], [False, False, False, False]),
        ([COMES, TOLD, {"axles_out_high": 30, "leaves_high": True}, {}], [False, False, False, False]),
        ([COMES, TOLD, {"axles_out_high": 30, "leaves_high": True}, {"axles_in_high": 1}], [False, False, False, True]),
        ([COMES, TOLD, {"axles_out_low": 30, "leaves_low": True}, {"axles_in_low": 1}], [False, False, False, True]),
        ([COMES, TOLD, {"axles_out_high": 40}, {"axles_out_high": 1}], [False, False, False, True]),
        ([COMES, TOLD, {**TOLD, "record_axles": 36}, {}], [False, False, False, False]),
        ([COMES, TOLD, {"train_2_axles_of_others": True}], [False, False, True]),
        ([COMES, {**TOLD, "outermost_low": 2, "axles_in_low": 5}], [False, False]),
        ([{**COMES, "counters_count": False}], [True]),
        ([{**COMES, "axles_in_high": 1}], [True]),
        ([COMES, TOLD, {"axles_out_low": 30, "leaves_low": True}, {}, {"axles_in_low": 1}], [False, False, False, False, True]),
    ],
    ids=[
        "its own", "one more after the record", "one more before the record", "one more, a disturbed record",
        "a record without axles", "at the other end", "more than had gone out", "out and in again", "a part goes out",
        "a part comes back at the other end", "a part comes back where it came in", "more out than in", "a later record with fewer axles",
        "beside another train", "of another train", "while no order is known",
        "at the other end as it comes in", "a part comes back later",
    ],
)  # fmt: skip
def test_whose_axles(cycles: list[dict[str, Cell]], unannounced: list[bool]) -> None:
    """Each axle that cannot be the train's is noticed in its cycle, or in that of the record."""
    assert [step.outputs["unannounced"] for step in heard(*cycles)] == unannounced


# ------------------------------------------------------------------ broken on purpose

WRONG: dict[str, tuple[str, Wrong, str]] = {
    "nobody looks": ("has_more", lambda _one, _right: FALSE, SOON),
    "the balance is compared with the record": (
        "has_more",
        lambda one, _: (one.was_known | one.reference_comes_now) & (one.balance > one.most),
        AT_ONCE,
    ),
    "the record is looked at one cycle late": (
        "has_more",
        lambda one, _: any_of([one.was_known & (one.come_in_now > one.most), one.balance > one.come_in_now]),
        SOON,
    ),
    "one axle more is let pass": (
        "has_more",
        lambda one, _: any_of([one.come_in_now > one.most + 1, one.balance > one.come_in_now]),
        SOON,
    ),
    "a part that went out is waited for": (
        "has_more",
        lambda one, _: any_of(
            [(one.was_known | one.reference_comes_now) & (one.come_in_now > one.most), one.balance > one.come_in_now]
        ),
        SOON,
    ),
    "a disturbed record is believed": (
        "reference_comes_now",
        lambda one, _: one.comes.ne(NOBODY) & (one.record_axles > 0),
        SOON,
    ),
    "the record of the train before is compared": ("was_known", lambda one, _: one.known, SOON),
    "nobody looks at the end at which nobody comes in": (
        "of_nobody",
        lambda one, _: all_of(
            [
                one.occupied,
                all_of(came.eq(0) for came in one.enters) | ~one.counters_count,
                *(last.eq(0) for last in one.outermost),
            ]
        ),
        AT_ONCE,
    ),
    "it comes into an area without an order": (
        "of_nobody",
        lambda one, _: all_of([one.occupied, *(came.eq(0) for came in one.enters), *(last.eq(0) for last in one.outermost)]),
        SOON,
    ),
    "the end at which it came in is mistaken": ("is_from_high", lambda _one, right: ~right, SOON),
}  # fmt: skip


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("edit", WRONG)
def test_a_wrong_entry_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """Each loses the claim that speaks of it; the right one has it."""
    name, wrong, claim = WRONG[edit]
    (right,) = [one for one in properties(whole()) if one.name == claim]
    assert inductive_in(whole().composition.system, right)
    edited(monkeypatch, Parts, name, wrong)
    model = compose_machines(CONFIG)
    (prop,) = [one for one in properties(model) if one.name == claim]
    assert not inductive_in(model.composition.system, prop)


@pytest.mark.thorough(ordinary=1)
def test_a_vehicle_at_the_other_end_than_another_train_is_noticed_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """With two trains: an entry that looks only while its own train comes in loses the claim on counters that are believed."""
    config = CONFIG.model_copy(
        update={
            "sections": SectionsConfig(area=AreaConfig(trains=2, period_ms=500), following=CONFIG.sections.following)
        }
    )
    claim = "disturbed counters leave the area unswept"

    def keeps() -> bool:
        model = compose_machines(config)
        (prop,) = [one for one in properties(model) if one.name == claim]
        return inductive_in(model.composition.system, prop)

    assert keeps()
    edited(
        monkeypatch,
        Parts,
        "of_nobody",
        lambda one, right: right & (one.enters_now | all_of(came.eq(0) for came in one.enters)),
    )
    assert not keeps()


def test_the_laws_allow_a_follower() -> None:
    """So the proofs speak of it; the journey's laws are tested with the other recordings."""
    assert any(others(step) > 0 for step in travelled(UNANNOUNCED, whole()).steps)
