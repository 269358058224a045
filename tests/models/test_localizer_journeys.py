"""Worked journeys: nominal ones are located and never wrong; what goes wrong has the outcome that is told of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from itertools import pairwise

import pytest

from safeloc.language.interpret import holds, read_inputs, start, step
from safeloc.language.nodes import Value
from safeloc.language.system import environment
from safeloc.models.localizer import compose_machines
from safeloc.models.localizer.picture import picture
from safeloc.models.localizer.simulation import front_ends
from safeloc.models.localizer.simulation.journeys import (
    CASES,
    FREIGHT,
    NOMINAL,
    OFF_THE_FIBRE,
    Case,
    pairs,
    with_troubles,
)
from safeloc.models.localizer.simulation.simulate import first_state, simulate
from safeloc.simulation.faults import Fault
from tests.models.localizer_runs import CONFIG, Told, run

SOURCES = picture(CONFIG, lambda _: "").sources
LOCATED_FROM = {"metro": 250, "main-line": 370, "freight": 470}
"""The cycle by which each journey is located, at its first absolute reference that is confirmed."""
TOO_WIDE = {"metro": range(0), "main-line": range(0), "freight": range(1_460, 1_492)}
"""Cycles in which nothing is tolerable: beyond fibre and satellites balises alone are left, and the odometer checked at its price."""


@cache
def nominal(name: str) -> Told:
    """A journey on which nothing goes wrong."""
    return run(NOMINAL[name])


@pytest.mark.thorough
@pytest.mark.parametrize("name", NOMINAL)
def test_a_nominal_journey_is_located_and_never_wrong(name: str) -> None:
    """From the first confirmed reference on a position is given out, but where none is tolerable, and it holds the truth."""
    told = nominal(name)
    assert told.standings["WRONG"] == 0
    located = [not out["delocalized.restrictive"] for out in told.outputs]
    lost = {cycle for cycle, one in enumerate(located) if not one and cycle >= LOCATED_FROM[name]}
    assert lost <= set(TOO_WIDE[name])
    assert not any(located[:100])
    assert against_the_sources(told) == []


def against_the_sources(told: Told) -> list[int]:
    """Cycles in which what counts is not what the valid sources have in common, is led by one that is not valid, or in
    which the min safe front end advances by more than the distance that was told."""
    return [
        cycle
        for cycle, (one, out) in enumerate(zip([{}, *told.outputs], told.outputs, strict=False))
        if wrong(one, out)
    ]


def wrong(earlier: Mapping[str, Value], out: Mapping[str, Value]) -> bool:
    """Whether one cycle breaks that."""
    if not out["arbitration.valid"]:
        return False
    valid = {one.name: ends for one in SOURCES if (ends := one.reported.interval_mm(out)) is not None}
    position, below, above = (out[f"arbitration.{name}_mm"] for name in ("position", "margin_below", "margin_above"))
    common = max(low for low, _ in valid.values()), min(high for _, high in valid.values())
    lead = CONFIG.arbitration.sources[out["arbitration.lead"] - 1]
    return common != (position - below, position + above) or lead not in valid or _runs_ahead(earlier, out)


def _runs_ahead(earlier: Mapping[str, Value], out: Mapping[str, Value]) -> bool:
    if not earlier or not earlier["arbitration.valid"] or not out["motion.reported"]:
        return False
    advance = out["arbitration.min_safe_front_mm"] - earlier["arbitration.min_safe_front_mm"]
    return advance > out["motion.distance_mm"]


@pytest.mark.thorough
def test_sources_lead_where_they_are_best() -> None:
    """Metro: reflector and odometry; main line: satellites, but in the tunnel balises and odometry."""
    fired = {name: set(nominal(name).fired) for name in NOMINAL}
    assert {"arbitration: reflector takes over", "arbitration: odometry takes over"} <= fired["metro"]
    assert {"arbitration: satellite takes over", "arbitration: odometry takes over"} <= fired["main-line"]
    assert "downlink: report grows older" in fired["freight"]


LAWFUL = {
    **NOMINAL, "off the fibre": OFF_THE_FIBRE,
    "stale linking": replace(FREIGHT, troubles=[Fault("linking not replaced")]),
    "other branch": replace(FREIGHT, troubles=[Fault("other branch taken")]),
}  # fmt: skip


@pytest.mark.parametrize("name", LAWFUL)
@pytest.mark.slow
def test_a_lawful_journey_keeps_what_is_assumed(name: str) -> None:
    """Its ghosts obey every source's law, cycle by cycle, in the reference interpreter."""
    system = compose_machines(CONFIG).composition.system
    names, law = {var.name for var in system.inputs}, environment(system)
    state = start(system, first_state(CONFIG, LAWFUL[name]))
    for cycle, one in enumerate(simulate(CONFIG, LAWFUL[name], seed=3)):
        inputs = read_inputs(system, {key: cell for key, cell in one.items() if key in names})
        assert holds(law, {**state, **inputs}), cycle
        state, _ = step(system, state, inputs)


@pytest.mark.thorough
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name.replace(" ", "-"))
def test_what_goes_wrong_is_noticed_as_told(case: Case) -> None:
    """What is told of it fires, more often than on the nominal journey; no interval is wrong that could be right."""
    told = run(with_troubles([case]))
    often = nominal(case.journey).fired
    assert [name for name in case.fires if not told.fired[name]] == []
    assert any(told.fired[name] != often[name] for name in told.fired) or case.trouble.kind == "multipath"
    assert told.standings["WRONG"] == 0 or case.undetectable
    assert against_the_sources(told) == []


@pytest.mark.thorough
@pytest.mark.parametrize("journey", ["main-line", "freight"])
def test_one_satellite_by_a_detour_is_left_out(journey: str) -> None:
    """Its channel is not usable while it is disturbed, the other seven are; nothing else is different."""
    case = next(one for one in CASES if one.name == f"{journey}: multipath")
    pairs_ = list(zip(run(with_troubles([case])).outputs, nominal(journey).outputs, strict=True))
    changed = {cycle for cycle, (one, other) in enumerate(pairs_) if one != other}
    assert changed <= set(range(case.trouble.begin, case.trouble.end))
    seen = [(pairs_[cycle][0]["selection.channel_1_usable"], pairs_[cycle][0]["selection.usable"]) for cycle in changed]
    assert set(seen) == {(False, 7)}
    assert len(seen) > 50


@pytest.mark.slow
@pytest.mark.parametrize("journey", NOMINAL)
def test_no_two_together_give_a_wrong_interval(journey: str) -> None:
    """But for those of which it is told why nothing can notice them."""
    wrong = [
        f"{one.name} and {other.trouble.kind}"
        for one, other in pairs(journey)
        if not (one.undetectable or other.undetectable) and run(with_troubles([one, other])).standings["WRONG"]
    ]
    assert wrong == []


@pytest.mark.thorough
def test_spoofing_is_wrong_for_a_while_and_said_to_be() -> None:
    """The freight train's interval is wrong while the drift is smaller than what the others leave open."""
    case = next(one for one in CASES if one.name == "freight: spoofing")
    assert run(with_troubles([case])).standings["WRONG"] > 0


@pytest.mark.thorough
def test_sources_that_come_to_exclude_each_other_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drawn away by 3 m/s the satellites are believed until another source excludes them: in that cycle both are named, and
    nothing is passed on. Where it is passed on again, an absolute reference has just been accepted and all agree."""
    monkeypatch.setattr(front_ends, "SPOOFED_MM", 300)
    told = run(replace(NOMINAL["freight"], troubles=[Fault("spoofing", "", 800, 1_400)]))
    often = told.fired["arbitration: sources contradict each other"]
    assert often == 3
    named = [
        (out, {out["arbitration.contradicting_first"], out["arbitration.contradicting_second"]})
        for one, out in pairwise(told.outputs)
        if one["arbitration.valid"] and out["arbitration.contradicting_first"]
    ]
    satellite = 1 + CONFIG.arbitration.sources.index("satellite")
    assert [len(both) for _, both in named] == [2] * often
    assert all(satellite in both and 0 not in both and out["delocalized.restrictive"] for out, both in named)
    again = [out for one, out in pairwise(told.outputs) if not one["arbitration.valid"] and out["arbitration.valid"]]
    assert len(again) > 3
    assert all(out["arbitration.reference_accepted"] for out in again)
    assert against_the_sources(told) == []
