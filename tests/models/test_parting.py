"""A train that parts: whenever it does, no section is FREE over what it lost, and each addition for it is needed to the last unit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pytest

from safeloc.language.expr import Num, exact_to, ite, maximum
from safeloc.language.interpret import run
from safeloc.language.machine import Machine
from safeloc.language.monitor import check_all
from safeloc.language.spec import Property, always
from safeloc.language.system import lower
from safeloc.language.trace import Trace
from safeloc.language.units import UM, UM_PER_MM
from safeloc.language.verdict import Proved, Result, Violated
from safeloc.language.world import Law
from safeloc.models.area import AreaConfig
from safeloc.models.fibre_area import FibreArea, FibreAreaConfig, compose_machines
from safeloc.models.fibre_area import entry as entry_model
from safeloc.models.fibre_area.parting import PartingConfig, ReportedRun, parts
from safeloc.models.fibre_area.recorded_runs import CONFIG, SPLIT
from safeloc.models.fibre_area.report import Believed, Report, build
from safeloc.models.fibre_area.simulate import LOST_AXLES, REMARK, Journey, first_state, simulate_journey
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.fibre_area import properties
from tests.models.edited_terms import edited
from tests.models.inductive import inductive, inductive_in

FIGURES = PartingConfig(count_run_mm=3_000, roll_back_mm=20)
REACH = AreaConfig(period_ms=500, limit_mm=1_000_000).reach
TOLD_RUN = ReportedRun(50_000, 60_000, 2_000)
HELD = "what is told of a counted train holds it"


# ------------------------------------------------------------------ the machine by itself


def alone() -> tuple[Machine, Report]:
    """The machine that tells which ends are believed, beside a detector that keeps its bounds and counts as it should."""
    own = parts(FIGURES, REACH, TOLD_RUN, 10**9, 900_000)
    report = build(own)
    machine = report.machine
    low, high = (own.low, own.rear_high), (own.front_low, own.high)
    keeps = {
        "the ends lie between their bounds": Law(
            (exact_to(low[0], UM) <= own.pattern_rear) & (own.pattern_rear <= exact_to(low[1], UM))
            & (exact_to(high[0], UM) <= own.pattern_front) & (own.pattern_front <= exact_to(high[1], UM))
        ),
        "only all axles match": Law(own.count_matches_now.implies(own.count_had_all_axles)),
        "the pattern is the train's": Law(
            (own.trusted | own.count_matches_now | own.upwards | own.downwards).implies(own.pattern_is_the_trains)
        ),
    }  # fmt: skip
    world = replace(machine.world, clauses={**machine.world.clauses, **keeps})
    return replace(machine, world=world), report


def holds(machine: Machine, report: Report) -> Property:
    """Where it is told as whole, the train with all that it lost lies between the bounds, but for the reading's age."""
    own = report.own
    told = machine.flag("reported") & machine.flag("integer") & own.age.eq(0)
    low, high = exact_to(own.reported_low, UM), exact_to(own.reported_high, UM)
    inside = (own.next_rear >= low) & (own.next_front <= high)
    return always(HELD, told.implies(inside), statement="it does", assumption="the laws of the report")


def verdict(made: tuple[Machine, Report]) -> Result:
    """What becomes of the claim."""
    prop = holds(*made)
    found = prove(lower(made[0]), [prop], Limits(seconds=60), jobs=1)
    return next(one.result for one in found if one.id.endswith(HELD))


def test_what_is_told_of_a_counted_train_holds_it() -> None:
    """Without a bound, whenever it parts, stands and turns."""
    assert isinstance(verdict(alone()), Proved)


def one_less(_own: Believed, right: Num) -> Num:
    """A millimetre less than is needed."""
    return right - 1


def test_a_run_refutes_one_millimetre_less(monkeypatch: pytest.MonkeyPatch) -> None:
    """A train that parts as soon as it was counted, runs for the count's run, and is still told with all axles."""
    edited(monkeypatch, Believed, "farthest", one_less)
    found = verdict(alone())
    assert isinstance(found, Violated)
    assert found.trace is not None
    last = found.trace.steps[-1]
    assert 0 <= FIGURES.count_run_mm * UM_PER_MM - last.state["run_since_complete_um"] < UM_PER_MM


Wrong = Callable[..., object]
OF_THE_ENDS: dict[str, tuple[str, Wrong]] = {
    "the count's run is not added": ("farthest", lambda own, _: own.own.longest + FIGURES.roll_back_mm),
    "the length of the train is not added": ("farthest", lambda own, right: right - own.own.longest),
    "what rolls back is not added": ("farthest", lambda _, right: right - FIGURES.roll_back_mm),
    "the trailing low end is believed": ("low", lambda own, _: own.own.low - FIGURES.roll_back_mm),
    "the trailing high end is believed": ("high", lambda own, _: own.own.high + FIGURES.roll_back_mm),
    "the outer bound of the front is taken": ("low", lambda own, _: own.own.high - own.farthest),
    "the outer bound of the rear is taken": ("high", lambda own, _: own.own.low + own.farthest),
    "an end leads a millimetre early": ("led_high", lambda own, _, straight: straight > own.own.config.count_run_mm - 1),
    "the low end leads at once": ("led_low", lambda _own, _, straight: straight < 0),
    "a stop is no new beginning": ("straight", lambda own, right: ite(own.up | own.down, right, own.own.run_one_way)),
    "a turn is no new beginning": ("straight", lambda own, right: ite(own.down & (own.own.run_one_way > 0), own.own.run_one_way, right)),
    "run that is told twice as long": ("straight", lambda own, right: ite(own.up, right + own.run, right)),
    "what the run may be wrong by is not taken off": ("run", lambda own, _: maximum(ite(own.down, -own.own.run, own.own.run), 0)),
    "its floor is not taken off": ("run", lambda _, right: ite(right > 0, right + 2_000, 0)),
    "a train that is gone leads on": ("up", lambda own, _: own.own.upwards & ~own.own.downwards),
}  # fmt: skip


@pytest.mark.thorough(ordinary=5)
@pytest.mark.parametrize("edit", OF_THE_ENDS)
def test_a_wrong_edit_of_what_is_believed_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """What is told of a counted train holds it; not of one whose trailing end is believed too soon or too far in."""
    name, wrong = OF_THE_ENDS[edit]
    machine, report = alone()
    assert inductive(machine, holds(machine, report))
    edited(monkeypatch, Believed, name, wrong)
    machine, report = alone()
    assert not inductive(machine, holds(machine, report))


# ------------------------------------------------------------------ the whole, told in journeys


@cache
def whole(config: FibreAreaConfig) -> FibreArea:
    """The composition."""
    return compose_machines(config)


def told(journey: Journey, config: FibreAreaConfig = CONFIG) -> Trace:
    """A journey through the machines of `config`, in a world as late in counting as that of CONFIG may be."""
    steps = [
        {key: cell for key, cell in one.items() if key != REMARK}
        for one in simulate_journey(CONFIG, seed=1, journey=journey)
    ]
    return run(whole(config).composition.system, steps, first=first_state(CONFIG, journey))


def states(trace: Trace) -> list[str]:
    """The section after every step."""
    table = whole(CONFIG).sections[0].machine.modes
    return [table[int(step.state["section_1.mode"])].label for step in trace.steps]


def over_the_lost(trace: Trace, journey: Journey) -> list[str]:
    """The states of the section in the steps in which the lost part stands in it."""
    (low, high), found = journey.cuts_mm[0], list[str]()
    for step, state in zip(trace.steps, states(trace), strict=True):
        rear = step.state["area.train_1_true_rear_um"]
        if not step.state["report.rear_is_the_trains"] and low * UM_PER_MM <= rear <= high * UM_PER_MM:
            found.append(state)
    return found


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("split", "after_mm"), [(47, 800_000), (52, 800_000), (61, 800_000), (60, 300_000)])
def test_no_section_is_free_over_what_was_lost(split: int, after_mm: int) -> None:
    """Whenever it parts, and however late the detector's count follows: until the rest has left the area, and after that."""
    journey = replace(SPLIT, split=split, counted_after_mm=after_mm)
    trace = told(journey)
    assert not [one for one in check_all(trace, properties(whole(CONFIG))) if isinstance(one, Violated)]
    found = over_the_lost(trace, journey)
    assert len(found) > 100
    assert "FREE" not in found


def test_a_count_that_is_believed_at_once_frees_what_was_lost() -> None:
    """As it was: the trailing end of a train that is still told with all its axles, taken where the pattern ends."""
    config = CONFIG.model_copy(update={"parting": PartingConfig(count_run_mm=0, roll_back_mm=0)})
    assert "FREE" in over_the_lost(
        told(replace(SPLIT, cuts_mm=((600_000, 1_050_000),)), config), replace(SPLIT, cuts_mm=((600_000, 1_050_000),))
    )


def test_a_train_that_leaves_a_part_behind_has_not_left() -> None:
    """The counters tell that it leaves, with four axles fewer than came in: the area keeps it, and nothing behind it is freed."""
    trace = told(SPLIT)
    outputs = [step.outputs for step in trace.steps]
    (leaves,) = [number for number, step in enumerate(trace.steps) if step.inputs["entry.leaves_high"]]
    assert outputs[leaves]["entry.axles_inside"] == LOST_AXLES
    assert not any(one["entry.left"] for one in outputs)
    assert outputs[leaves]["entry.left_in_part"]
    assert all(one["area.train_1_in_area"] for one in outputs[leaves:])
    assert set(states(trace)[leaves:]) == {"UNKNOWN"}


STAYED = "a train that leaves a part behind has not left"
UNCOUNTED = "a train of which axles were not counted is not counted out"
OF_THE_EXIT: dict[str, tuple[str, Wrong]] = {
    "leaving is believed without a count": ("complete", lambda one, _: one.leaving),
    "axles that leave are not counted": ("balance", lambda one, right: right + sum(one.of_this(one.axles_out))),
    "one axle less is enough": ("complete", lambda one, _: one.leaving & one.counted & (one.balance <= 1)),
    "a disturbed counter counts none": ("counted", lambda one, _: one.enters_now | one.sure),
    "axles of any train are this one's": ("of_this", lambda _one, _right, axles: axles),
    "an area that is not clear is empty": ("emptied", lambda one, _: ~one.enters_now),
    "what the train before left is counted": (
        "balance",
        lambda one, _: one.inside + sum(one.passes),
    ),
}


def nothing_inside() -> tuple[Machine, Property]:
    """The machine of the entry, and that none of the axles of a train that left is in the area."""
    made = entry_model.build(entry_model.parts(trains=2, wait_cycles=240, axle_limit=1_000, axles_a_cycle=40))
    out = made.own.left.implies(made.own.true_axles_inside.eq(0))
    return made.machine, always("nothing inside", out, statement="nothing is left", assumption="each axle is counted")


@pytest.mark.parametrize("edit", OF_THE_EXIT)
def test_a_wrong_edit_of_the_exit_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """A train that has left has left with all its axles; not where they are counted, or believed, wrongly."""
    assert inductive(*nothing_inside())
    edited(monkeypatch, entry_model.Parts, *OF_THE_EXIT[edit])
    assert not inductive(*nothing_inside())


@pytest.mark.parametrize(
    ("wrong", "claim"),
    [
        (lambda one, _: one.leaving & one.balance.eq(0), UNCOUNTED),
        (lambda one, _: one.leaving & one.counted, STAYED),
    ],
    ids=["an unsure count is believed", "what is left behind is not looked at"],
)
def test_the_whole_notices_a_wrong_exit(monkeypatch: pytest.MonkeyPatch, wrong: Wrong, claim: str) -> None:
    """Each loses a claim of the composition."""
    edited(monkeypatch, entry_model.Parts, "complete", wrong)
    model = compose_machines(CONFIG)
    (prop,) = [one for one in properties(model) if one.name == claim]
    assert not inductive_in(model.composition.system, prop)
