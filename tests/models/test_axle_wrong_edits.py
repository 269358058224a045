"""Wrong edits of the terms that axle counters compute with: each loses a proof that speaks of the truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from safeloc.language.expr import FALSE, TRUE, Bool, Lit, Num, any_of, between
from safeloc.language.terms import Substitution
from safeloc.language.units import MS
from safeloc.models import axle_counter, axle_head, axle_section
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.models.axle_counter.cycle import Cycle
from safeloc.models.axle_head import UP, AxleHeadConfig
from safeloc.models.axle_section import AxleSectionConfig
from safeloc.models.axle_section.variables import Parts
from safeloc.properties import axle_counter as counter_properties
from safeloc.properties import axle_head as head_properties
from safeloc.properties import axle_section as section_properties
from tests.models.inductive import inductive
from tests.models.spoilt import rebuilt

Term = Callable[[Parts], Bool | Num]


# ------------------------------------------------------------------ heads


def _head_lacks(config: AxleHeadConfig, claim: str, only: str = "") -> bool:
    model = axle_head.build(axle_head.parts(config))
    return not inductive(model.machine, next(p for p in head_properties.properties(model) if p.name == claim), only)


@pytest.mark.parametrize("wrong", [{"sample_us": 700}, {"spacing_mm": 42}], ids=["overlap", "one channel alone"])
def test_figures_that_are_refused_lose_a_proof(wrong: dict[str, int]) -> None:
    """Where a wheel can pass a stretch between two samples, it disturbs the head: the check of the figures is needed."""
    claim = "no disturbance by wheels"
    config = AxleHeadConfig.model_construct(None, **(AxleHeadConfig().model_dump() | wrong))
    assert _head_lacks(config, claim)
    assert not _head_lacks(AxleHeadConfig(), claim)


ALIVE = "a channel that is not alive disturbs"


@pytest.mark.parametrize("claim", [ALIVE, "no disturbance by wheels", "a wheel that is not counted is told"])
def test_a_head_that_does_not_ask_whether_a_channel_is_alive_is_noticed(claim: str) -> None:
    """Channel B is taken as alive: what it tells may be anything, and a wheel is missed."""
    model = axle_head.build(axle_head.parts(AxleHeadConfig()))
    taken = Substitution({model.own.channel_b_alive: TRUE})
    rows = [replace(row, when=taken.bool(row.when)) for row in model.machine.transitions]
    wrong = replace(model, machine=rebuilt(model.machine, rows))
    [prop] = [one for one in head_properties.properties(wrong) if one.name == claim]
    assert not inductive(wrong.machine, prop)
    assert not _head_lacks(AxleHeadConfig(), claim)


def test_a_disturbed_head_that_is_told_free_is_noticed() -> None:
    """A head that cannot tell whether a wheel is on it says that it is damped."""
    model, claim = axle_head.build(axle_head.parts(AxleHeadConfig())), "damped unless free and sound"
    machine, mode = model.machine, model.machine.mode
    free, *_, disturbed = machine.modes
    told = {**machine.outputs, "damped": mode.ne(free) & mode.ne(disturbed)}
    wrong = replace(model, machine=rebuilt(machine, machine.transitions, outputs=told))
    [prop] = [one for one in head_properties.properties(wrong) if one.name == claim]
    assert not inductive(wrong.machine, prop, claim)
    assert not _head_lacks(AxleHeadConfig(), claim, claim)


# ------------------------------------------------------------------ sections


def _ways(own: Parts) -> list[tuple[Bool, Bool, Bool, Bool]]:
    """In here, not out here, not in there, out there: for a sweep from the low end, and for one from the high end."""
    (in_low, in_high), (out_low, out_high) = own.swept_from, own.swept_to
    return [(in_low, ~out_low, ~in_high, out_high), (in_high, ~out_high, ~in_low, out_low)]


def _without(condition: int) -> Callable[[Parts], Bool]:
    """A sweep that is believed without one of its four conditions."""

    def through(own: Parts) -> Bool:
        kept = [[term for number, term in enumerate(way) if number != condition] for way in _ways(own)]
        return any_of(way[0] & way[1] & way[2] for way in kept)

    return through


SECTION_EDITS: list[tuple[str, Term, str]] = [
    ("_through", _without(1), "cleared only by a sweep that met nothing"),
    ("_through", _without(2), "cleared only by a sweep that met nothing"),
    ("_through", _without(0), "clear after a reset needs a sweep"),
    ("_through", _without(3), "clear after a reset needs a sweep"),
    ("_through", lambda own: _without(4)(own) & own.swept_from[0], "a sweep through clears"),
    ("_counted", lambda own: own.counted_axles + own.into[0] - own.out[0] + own.out[1], "clear is clear"),
    ("_counted", lambda own: own.counted_axles + own.into[0] + own.into[1] - own.out[0], "axles counted out clear"),
    ("_moved", lambda own: any_of(var > 0 for var in (*own.into, own.out[0])), "the lead time is counted"),
    ("_possible", lambda own: own.counted_axles + own.into[0] <= 1_000, "an impossible count is disturbed"),
    (
        "_possible",
        lambda own: between(1, own.counted_axles + own.into[0] - own.out[0], 1_000),
        "only a fault or an impossible count disturbs",
    ),
]


def _section_lacks(claim: str) -> bool:
    model = axle_section.build(axle_section.parts(AxleSectionConfig()))
    return not inductive(model.machine, next(p for p in section_properties.properties(model) if p.name == claim))


@pytest.mark.parametrize(("name", "wrong", "broken"), SECTION_EDITS)
def test_a_wrong_term_of_a_section_is_noticed(
    name: str, wrong: Term, broken: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A sweep believed with less than it has to do, axles that are not counted, a lead time that some axles do not end."""
    monkeypatch.setattr(axle_section, name, wrong)
    assert _section_lacks(broken)


@pytest.mark.parametrize("name", sorted({broken for *_, broken in SECTION_EDITS}))
def test_the_right_section_keeps_it(name: str) -> None:
    """What the wrong edits lose, the section as it ships has."""
    assert not _section_lacks(name)


@pytest.mark.parametrize(("end", "way"), [(0, "swept_from"), (1, "swept_from"), (0, "swept_to"), (1, "swept_to")])
def test_a_way_of_the_sweep_that_is_not_kept_is_noticed(end: int, way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """At each end and in each direction, what the sweep did is remembered."""
    ways = axle_section._ways  # pyright: ignore[reportPrivateUsage]
    monkeypatch.setattr(
        axle_section, "_ways", lambda own: [one for one in ways(own) if one[0] is not getattr(own, way)[end]]
    )
    assert _section_lacks("axles of a sweep stay counted at each end")


# ------------------------------------------------------------------ entry records


def _counter_lacks(claim: str) -> bool:
    model = axle_counter.build(axle_counter.parts(AxleCounterConfig()))
    return not inductive(model.machine, next(p for p in counter_properties.properties(model) if p.name == claim))


def _unchanged_runs(cycle: Cycle) -> tuple[Num, Num]:
    """The run of a cycle at the speeds before it."""
    own, period = cycle.own, Lit(100, MS)
    return own.run_low + own.speed_low * period, own.run_high + own.speed_high * period


COUNTER_EDITS: list[tuple[str, Callable[[Cycle], object], str]] = [
    ("speeds", lambda self: (self.own.speed_low, self.own.speed_high), "speed is true"),
    ("runs", _unchanged_runs, "place is true"),
    ("past", lambda self: self.own.past_low + self.speeds[1] * Lit(100, MS), "the whole train has passed"),
    ("measured", lambda self: (self.own.axle_speed_low.value, self.own.axle_speed_high.value), "speed is true"),
    ("measured", lambda self: self.speeds, "speeds that exclude each other spoil the passage"),
    ("maybe_another", lambda self: self.own.axles_counted > 999, "count is true"),
    ("paused", lambda self: self.own.pause, "the pause is counted"),
    ("onward", lambda self: self.own.axle.eq(UP), "turning spoils"),
    ("length_known", lambda self: self.own.length_low > 0, "length is exact enough"),
    ("passed", lambda self: self.past > 0, "the whole train has passed"),
    ("may_lack_an_axle", lambda self: FALSE, "count is true"),
    ("may_lack_an_axle", lambda self: FALSE, "no record while the head is damped"),
    ("may_lack_an_axle", lambda self: FALSE, "an axle that a damped head has missed is in no record"),
    (
        "may_lack_an_axle",
        lambda self: self.own.damped & ~self.counted,
        "a passage is spoilt only for the reported reason",
    ),
    ("may_lack_an_axle", lambda self: self.passed & ~self.counted, "a free head gives the record that is due"),
]


@pytest.mark.parametrize(("name", "wrong", "broken"), COUNTER_EDITS, ids=[name for name, *_ in COUNTER_EDITS])
def test_a_wrong_term_of_a_record_is_noticed(
    name: str, wrong: Callable[[Cycle], object], broken: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bounds that do not grow, a passage that is over too early, an axle of another train that is counted, a damped head that is not heard."""
    monkeypatch.setattr(Cycle, name, property(wrong))
    assert _counter_lacks(broken)


@pytest.mark.parametrize("claim", sorted({broken for *_, broken in COUNTER_EDITS}))
def test_the_right_record_keeps_it(claim: str) -> None:
    """What the wrong edits lose, the entry record as it ships has."""
    assert not _counter_lacks(claim)


def test_a_change_of_speed_that_is_not_added_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The world reckons with traction and brake by itself: half of it in the machine loses a proof."""
    monkeypatch.setattr(AxleCounterConfig, "change_mm_s", 75)
    assert _counter_lacks("speed is true")
