"""A counting head through a cycle of the axle counter: the contract of both sides, wrong edits, channels that fail, and the records
that come of them (FVA-4).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import pytest
from pydantic import ValidationError

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.codegen.smtlib import Query
from safeloc.language.expr import FALSE, TRUE, Bool, Expr, Lit, Num, as_num, ite
from safeloc.language.interpret import run
from safeloc.language.system import without_ghosts
from safeloc.language.units import COUNT
from safeloc.models import axle_counter
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.models.axle_counter.passage import Parts as CounterParts
from safeloc.models.axle_head import AXLE, DOWN, NO_AXLE, UP, AxleHeadConfig
from safeloc.models.axle_head import simulate as head
from safeloc.models.counting_head import CountingHeadConfig, compose_machines, cycle, wheel_time
from safeloc.models.counting_head.simulate import RUNS, failing, named
from safeloc.models.counting_head.variables import Parts
from safeloc.models.vocabulary import head_contract
from safeloc.proof.drawn_runs.worked import Steps
from safeloc.proof.provers.implication import Refuted, unproved
from safeloc.properties.counting_head import properties
from tests.models.inductive import inductive_in
from tests.models.owed_contracts import contract
from tests.models.wrong_edits import lost_by

CONTRACT = "a cycle is reported as the axle counter assumes"
CONFIG = CountingHeadConfig()

# ------------------------------------------------------------------ the contract of both sides


def counted(own: CounterParts) -> Bool:
    """The contract that the head is proved to keep, over the counter's inputs."""
    return head_contract.counts_every_axle(
        fault=own.fault, axle=own.axle, number=own.axles_in_cycle, passed=own.true_axles_in_cycle,
        upwards=own.axle_true_speed > 0, downwards=own.axle_true_speed < 0,
    )  # fmt: skip


def test_the_counters_law_is_the_contract() -> None:
    """The clause of the counter's world is the contract that the head's claim is made of, over the counter's inputs, or a head that stays damped."""
    own = axle_counter.parts(AxleCounterConfig())
    (law,) = [
        law
        for name, law in axle_counter.build(own).machine.world.clauses.items()
        if name.startswith("a head without a fault counts")
    ]
    expected = head_contract.counts_every_axle_or_stays_damped(
        counted(own), fault=own.fault, damped=own.damped, missed=own.missed
    )
    assert repr(expected) == repr(law.term)


def test_what_is_proved_of_the_head_implies_the_counters_law() -> None:
    """In each cycle, and no axle is ever missed then; without the contract the law does not hold."""
    own = axle_counter.parts(AxleCounterConfig())
    told = {"fault": own.fault, "damped": own.damped, "missed": own.missed}
    goals = {
        "law": head_contract.counts_every_axle_or_stays_damped(counted(own), **told),
        "none missed": ~head_contract.misses_an_axle(counted(own), **told),
    }
    assert not unproved(Query("contract", (counted(own), ~own.missed), goals), 20)
    assert goals.keys() == dict(unproved(Query("no contract", (~own.missed,), goals), 20)).keys()


def test_the_heads_claim_is_the_contract() -> None:
    """The claim is the same function over what the head reports at the end of a cycle, and over the wheels of its samples."""
    model = compose_machines()
    of, own, machine = model.composition.of(model.cycle.machine), model.cycle.own, model.cycle.machine
    ups, downs = of.num(own.true_axles_upwards), of.num(own.true_axles_downwards)
    expected = of.bool(machine.flag("cycle_done")).implies(
        head_contract.counts_every_axle(
            fault=of.bool(machine.flag("cycle_fault")), axle=of.num(machine.output("cycle_axle")),
            number=of.num(machine.output("cycle_axles")), passed=ups + downs, upwards=downs.eq(0), downwards=ups.eq(0),
        )
    )  # fmt: skip
    (claim,) = [one for one in properties(model) if one.name == CONTRACT]
    assert repr(expected) == repr(claim.term)


def test_both_sides_have_the_same_figures() -> None:
    """A cycle of the counter is a whole number of samples; what the counter takes in a cycle is what the head reports at most."""
    assert CONFIG.samples * CONFIG.head.sample_us == 1_000 * AxleCounterConfig().period_ms
    model = compose_machines()
    assert (CONFIG.samples, AxleCounterConfig().axles_a_cycle) == (model.cycle.own.cycle_samples, model.cycle.own.most)
    assert axle_counter.parts(CONFIG.counter).axles_in_cycle.high == model.cycle.own.most


@pytest.mark.parametrize(
    ("head_figures", "counter_figures", "message"),
    [
        ({"sample_us": 300}, {}, "is no whole number of samples of 300 us"),
        ({}, {"max_speed_mm_s": 90_000}, "head.max_speed_mm_s is 100000, but the counter's is 90000"),
    ],
)
def test_figures_that_do_not_fit_are_refused(
    head_figures: dict[str, int], counter_figures: dict[str, int], message: str
) -> None:
    """A sample would belong to two cycles; or a wheel of the counter would be too fast for the head."""
    with pytest.raises((ValidationError, ValueError), match=message):
        CountingHeadConfig(head=AxleHeadConfig(**head_figures), counter=AxleCounterConfig(**counter_figures))


def test_that_the_head_counts_each_wheel_is_proved() -> None:
    """The law that the adding up rests on is owed by the head, by where its mode says that the wheel is."""
    whole = compose_machines().composition
    assert None is contract(whole, "head_cycle")
    for lemmas in (("the axle is the wheel that passed", "the mode is where the wheel is"),):
        assert isinstance(contract(whole, "head_cycle", *(f"axle_head: {lemma}" for lemma in lemmas)), Refuted)


# ------------------------------------------------------------------ wrong edits

Edit = Callable[..., Expr]
AFTER, FLAWED = cycle.axles_after, cycle.sample_flawed
ADDS = "a cycle adds up its samples"
LATE, LATE_TERM = "a wheel that is counted late is a fault of the cycle", cycle.counted_late
REFUSED = "no wheel that comes fast enough is refused"


def _first_lost(own: Parts, before: Num, way: Lit) -> Num:
    """The first sample of a cycle is lost."""
    return ite(own.samples >= own.cycle_samples, as_num(0, COUNT), AFTER(own, before, way))


def _swapped(own: Parts, before: Num, way: Lit) -> Num:
    return AFTER(own, before, DOWN if way is UP else UP)


def _one_sample_skipped(own: Parts) -> Num:
    return ite(own.samples >= own.cycle_samples, as_num(2, COUNT), own.samples + 1)


EDITS: dict[str, tuple[str, Edit, str]] = {
    "axles are not added": ("axles_after", lambda own, before, way: before, CONTRACT),
    "the first sample is lost": ("axles_after", _first_lost, CONTRACT),
    "the first sample of a cycle is not added": ("axles_after", _first_lost, ADDS),
    "directions are exchanged": ("axles_after", _swapped, CONTRACT),
    "a sample is skipped": ("_sample_after", _one_sample_skipped, "each sample belongs to one cycle"),
    "so the cycle is not the counter's": ("_sample_after", _one_sample_skipped, CONTRACT),
    "no sample is a fault": ("sample_flawed", lambda own: FALSE, "a disturbance is a fault of the cycle"),
    "a channel that is not alive is none": (
        "sample_flawed",
        lambda own: FLAWED(own) & ~own.may_miss,
        "a channel that is not alive is a fault of the cycle",
    ),
    "so wheels pass unheard": ("sample_flawed", lambda own: FLAWED(own) & ~own.may_miss, CONTRACT),
    "the sample in which a disturbance ends is none": (
        "sample_flawed",
        lambda own: FLAWED(own) & (~own.may_miss | own.head_mode.ne(own.head_modes[0])),
        CONTRACT,
    ),
    "a wheel that leaves uncounted is none": (
        "sample_flawed",
        lambda own: FLAWED(own) & (own.may_miss | own.head_mode.ne(own.head_modes[0])),
        "a wheel that leaves uncounted is a fault of the cycle",
    ),
    "a wheel that goes back is none": (
        "sample_flawed",
        lambda own: FLAWED(own) & own.head_mode.one_of(own.head_modes[0], own.head_modes[-1]),
        "a wheel that goes back on the head is a fault of the cycle",
    ),
    "a wheel that is counted late is none": ("counted_late", lambda own: FALSE, LATE),
    "a rest as long as the first channel is late": (
        "counted_late",
        lambda own: LATE_TERM(own) | (own.counted.ne(NO_AXLE) & (own.since_both > own.first_alone)),
        REFUSED,
    ),
    "every sample is a fault": ("sample_flawed", lambda own: TRUE, "nothing else is a fault of the cycle"),
    "every sample begins a cycle": ("_begins", lambda own: TRUE, "a fault stays until its cycle ends"),
    "a damped head is not told": (
        "_head_is_damped",
        lambda own: FALSE,
        "a head that is damped when its cycle ends is told",
    ),
    "a head is told as damped always": ("_head_is_damped", lambda own: TRUE, "a free head is not told as damped"),
}
DEEPER = (
    "a wheel that goes back on the head is a fault of the cycle",
    "a wheel that leaves uncounted is a fault of the cycle",
    "nothing else is a fault of the cycle",
    "the samples of the first channel alone are counted",
)
"""Claims that look back by one step more; one step of induction decides the others, the contract together with the lemmas."""


TIMES: dict[str, tuple[str, Edit, str]] = {
    "the first channel is timed with the rest": (
        "_alone_after",
        lambda own, first: ALONE(own, TRUE),
        "the samples of the first channel alone are counted",
    ),
    "a wheel is timed while the head is disturbed": (
        "_untimed",
        wheel_time.went_back,
        "the samples of the first channel alone are counted",
    ),
    "a wheel that goes back is timed as one that does not": (
        "went_back",
        lambda own: FALSE,
        "the samples of the first channel alone are counted",
    ),
    "the rest is not timed": (
        "_since_after",
        lambda own: own.since_both,
        "the samples since both channels are counted",
    ),
}
ALONE = wheel_time._alone_after


def _lacks(claim: str) -> bool:
    """Whether the device as it stands is no longer proved to keep the claim."""
    model = compose_machines()
    (asked,) = [one for one in properties(model) if one.name == claim]
    if claim in DEEPER:
        return bool(lost_by(model.composition.system, [asked], seconds=90))
    return not inductive_in(model.composition.system, asked, "" if claim == CONTRACT else claim)


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_of_a_term_is_noticed(edit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Adding up, the length of a cycle, and what is a fault."""
    name, wrong, claim = EDITS[edit]
    monkeypatch.setattr(cycle, name, wrong)
    assert _lacks(claim)


@pytest.mark.parametrize("edit", TIMES)
def test_a_wrong_edit_of_a_time_is_noticed(edit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """How long a wheel damps the first channel alone, and the rest."""
    name, wrong, claim = TIMES[edit]
    monkeypatch.setattr(wheel_time, name, wrong)
    assert _lacks(claim)


def test_a_rest_that_is_not_counted_far_enough_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the rest is compared with may be greater than the variable holds: the claim reckons that from the figures."""
    monkeypatch.setattr(Parts, "longest", property(lambda _: 500))
    assert not _lacks(LATE)
    assert _lacks("the samples since both channels are counted")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("claim", sorted({claim for *_, claim in (EDITS | TIMES).values()}))
def test_the_right_device_keeps_it(claim: str) -> None:
    """Without an edit, so that the edits are what is noticed."""
    assert not _lacks(claim)


# ------------------------------------------------------------------ channels that fail


@cache
def program() -> Compiled:
    """The device on board, compiled: a few hundred runs would take minutes in the interpreter."""
    return compile_system(without_ghosts(compose_machines(CONFIG).composition.system))


@dataclass(frozen=True)
class Reported:
    """What the counter heard of a run, cycle by cycle: axles, and whether any cycle was at fault; and the head at the end."""

    axles: int
    fault: bool
    damped: bool


def reported(steps: Steps) -> Reported:
    """Run the device over the samples, and over as many free ones as end the last cycle."""
    one, axles, fault = program(), 0, False
    state, last = one.first(), {name: value for name, value in steps[-1].items() if name != "axle_head.next_wheel_um"}
    for step in [*steps, *[last] * (-len(steps) % CONFIG.samples)]:
        state, _ = one.step(
            state, one.read({key: value for key, value in step.items() if key != "axle_head.next_wheel_um"})
        )
        outputs = one.named_outputs(state)
        axles += int(outputs["head_cycle.cycle_axles"])
        fault = fault or bool(outputs["head_cycle.cycle_fault"])
    return Reported(axles, fault, bool(outputs["axle_head.damped"]))


WHEELS = (0, 2_500, 9_000)


def passage(speed_mm_s: int) -> Steps:
    """Three wheels roll over the head."""
    return head.samples(CONFIG.head, [head.through(CONFIG.head, WHEELS, speed_mm_s)])


@pytest.mark.parametrize("speed_mm_s", [30_000, -90_000])
def test_sound_channels_report_each_wheel(speed_mm_s: int) -> None:
    """At any speed, across the borders of cycles."""
    assert Reported(len(WHEELS), fault=False, damped=False) == reported(named(passage(speed_mm_s)))


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("channel", ["a", "b"])
@pytest.mark.parametrize("damped", [False, True])
@pytest.mark.parametrize("speed_mm_s", [60_000, -60_000])
def test_a_channel_that_fails_gives_no_sound_count(channel: str, damped: bool, speed_mm_s: int) -> None:
    """From every second sample of a passage on, one channel is silent, or stays damped: all wheels are reported, or a cycle is at
    fault, or the head is still damped: the counter hears that, its section is occupied, and the fault comes with the next wheel.
    """
    steps = passage(speed_mm_s)
    for begin in range(0, len(steps), 2):
        found = reported(named(failing(steps, channel, damped=damped, begin=begin)))
        assert found.axles == len(WHEELS) or found.fault or found.damped, begin
        assert damped or not found.damped, begin


def test_a_channel_that_stays_damped_is_a_fault_of_the_next_wheel() -> None:
    """What a channel that stays damped leaves open for one wheel ends with the next: wherever it begins, the second wheel after it
    makes a fault.
    """
    two = head.samples(CONFIG.head, [head.through(CONFIG.head, (*WHEELS, 12_000, 15_000), 60_000)])
    third = len(two) * 3 // 5
    for begin in range(0, third, 5):
        for channel in ("a", "b"):
            assert reported(named(failing(two, channel, damped=True, begin=begin))).fault, (begin, channel)


# ------------------------------------------------------------------ recordings


def records(name: str) -> list[tuple[str, int, bool]]:
    """The records of a run: direction, axles, fault, of each cycle in which there was something."""
    system = without_ghosts(compose_machines(CONFIG).composition.system)
    truth = ("axle_head.next_wheel_um", "head_cycle.next_speed_um_s")
    steps = [{k: v for k, v in step.items() if k not in truth} for step in RUNS[name].steps(CONFIG)]
    trace = run(system, steps)
    done = [step.outputs for step in trace.steps if step.outputs["head_cycle.cycle_done"]]
    told = [
        (
            AXLE[int(one["head_cycle.cycle_axle"])].label,
            int(one["head_cycle.cycle_axles"]),
            bool(one["head_cycle.cycle_fault"]),
        )
        for one in done
    ]
    return [one for one in told if one != ("NONE", 0, False)]


def test_recordings_say_what_they_teach() -> None:
    """Axles by cycle; both ways in a cycle, and a channel that fails, are faults."""
    service = records("counting_head-service")
    assert {False} == {fault for *_, fault in service}
    assert ("NONE", 0, True) in records("counting_head-slow")
    assert [("UP", 1), ("NONE", 0)] == [one[:2] for one in records("counting_head-late-channel")]
    assert [("UP", 4), ("DOWN", 2)] == [(way, sum(n for one, n, _ in service if one == way)) for way in ("UP", "DOWN")]
    for name in RUNS:
        assert (name == "counting_head-service") is not any(fault for *_, fault in records(name)), name
