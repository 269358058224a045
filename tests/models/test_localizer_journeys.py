"""Worked journeys: nominal ones are located and never wrong; what goes wrong has the outcome that is told of it."""

from __future__ import annotations

from functools import cache

import pytest

from safeloc.interpret import holds, read_inputs, start, step
from safeloc.models.localizer import compose_machines
from safeloc.models.localizer_journeys import CASES, NOMINAL, Case, pairs, with_troubles
from safeloc.models.localizer_streams import first_state, simulate
from safeloc.system import environment
from tests.models.localizer_runs import CONFIG, Told, run

LOCATED_FROM = {"metro": 250, "main-line": 370, "freight": 470}
"""The cycle by which each journey is located, at its first absolute reference that is confirmed."""
TOO_WIDE = {"metro": range(0), "main-line": range(0), "freight": range(1_460, 1_492)}
"""Cycles in which nothing is tolerable: beyond fibre and satellites balises alone are left, and the odometer checked at its price."""


@cache
def nominal(name: str) -> Told:
    """A journey on which nothing goes wrong."""
    return run(NOMINAL[name])


@pytest.mark.parametrize("name", NOMINAL)
def test_a_nominal_journey_is_located_and_never_wrong(name: str) -> None:
    """From the first confirmed reference on a position is given out, but where none is tolerable, and it holds the truth."""
    told = nominal(name)
    assert told.standings["WRONG"] == 0
    located = [not out["delocalized.restrictive"] for out in told.outputs]
    lost = {cycle for cycle, one in enumerate(located) if not one and cycle >= LOCATED_FROM[name]}
    assert lost <= set(TOO_WIDE[name])
    assert not any(located[:100])


def test_sources_lead_where_they_are_best() -> None:
    """Metro: reflector and odometry; main line: satellites, but in the tunnel balises and odometry."""
    fired = {name: set(nominal(name).fired) for name in NOMINAL}
    assert {"arbitration: reflector leads first", "arbitration: odometry takes over"} <= fired["metro"]
    assert {"arbitration: satellite takes over", "arbitration: odometry takes over"} <= fired["main-line"]
    assert "downlink: report grows older" in fired["freight"]


@pytest.mark.parametrize("name", NOMINAL)
@pytest.mark.slow
def test_a_nominal_journey_keeps_what_is_assumed(name: str) -> None:
    """Its ghosts obey every source's law, cycle by cycle, in the reference interpreter."""
    system = compose_machines(CONFIG).composition.system
    names, law = {var.name for var in system.inputs}, environment(system)
    state = start(system, first_state(CONFIG, NOMINAL[name]))
    for cycle, one in enumerate(simulate(CONFIG, NOMINAL[name], seed=3)):
        inputs = read_inputs(system, {key: cell for key, cell in one.items() if key in names})
        assert holds(law, {**state, **inputs}), cycle
        state, _ = step(system, state, inputs)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name.replace(" ", "-"))
def test_what_goes_wrong_is_noticed_as_told(case: Case) -> None:
    """What is told of it fires, more often than on the nominal journey; no interval is wrong that could be right."""
    told = run(with_troubles([case]))
    often = nominal(case.journey).fired
    assert [name for name in case.fires if not told.fired[name]] == []
    assert any(told.fired[name] != often[name] for name in told.fired) or case.trouble.kind == "multipath"
    assert told.standings["WRONG"] == 0 or case.undetectable


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


def test_spoofing_is_wrong_for_a_while_and_said_to_be() -> None:
    """The freight train's interval is wrong while the drift is smaller than what the others leave open."""
    case = next(one for one in CASES if one.name == "freight: spoofing")
    assert run(with_troubles([case])).standings["WRONG"] > 0
