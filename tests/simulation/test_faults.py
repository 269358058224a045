"""A fault is what a simulation understands, or it is refused: one that does nothing would test nothing."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.errors import InputError
from safeloc.models.balise import simulate as balise
from safeloc.models.line_runs.faults import FAULTS
from safeloc.models.localizer.simulation import simulate as localizer
from safeloc.models.localizer.simulation.journeys import CASES
from safeloc.models.reflector import simulate as reflector
from safeloc.simulation import reader_faults, record_faults, sensors
from safeloc.simulation.faults import Fault, Kinds, plain

KINDS = Kinds("a lamp", {**plain("dark"), "dim": {"by_percent": 50}})


def test_it_is_active_from_its_beginning_up_to_its_end() -> None:
    """Not at its end any more; without one it stays. As a slice it says the same."""
    some, good = Fault("dark", "", 2, 4), Fault("dark", "", 2)
    assert [False, False, True, True, False] == [some.active(at) for at in range(5)]
    assert [False, False, True, True, True] == [good.active(at) for at in range(5)]
    for one in (some, good):
        assert [at for at in range(5) if one.active(at)] == np.arange(5)[one.span].tolist()


def test_it_strikes_the_place_that_it_names() -> None:
    """One place, or several; all of them if it names none."""
    assert [True, False] == [Fault("dark", "hall").strikes(place) for place in ("hall", "stair")]
    assert [True, False] == [Fault("dark", 7).strikes(place) for place in (7, 8)]
    assert [True, True, False] == [
        Fault("dark", frozenset({"hall", "stair"})).strikes(place) for place in ("hall", "stair", "loft")
    ]
    assert Fault("dark").strikes("loft")


@pytest.mark.parametrize(
    ("told", "fault"),
    [
        ("dark, 0 to the end", Fault("dark")),
        ("dim of hall, 3 to 9, by_percent 20", Fault("dim", "hall", 3, 9, {"by_percent": 20})),
        ("dark of hall, stair, 0 to 1", Fault("dark", frozenset({"stair", "hall"}), 0, 1)),
    ],
)
def test_it_tells_what_it_is(told: str, fault: Fault) -> None:
    """For the messages."""
    assert told == str(fault)


def test_a_figure_that_is_left_out_is_the_default() -> None:
    """What the simulation says of that kind."""
    assert [50, 20] == [KINDS.figure(Fault("dim", figures=own), "by_percent") for own in ({}, {"by_percent": 20})]


@pytest.mark.parametrize(
    ("message", "fault"),
    [
        (r"^bright, 0 to the end: a lamp has no such fault; it has dark, dim\.$", Fault("bright")),
        (r"no figure 'by'; dim has by_percent\.$", Fault("dim", figures={"by": 1})),
        (r"no figure 'by_percent'; dark has none\.$", Fault("dark", figures={"by_percent": 1})),
        (r": no such place; of a lamp there are hall\.$", Fault("dark", "loft")),
        (r": needs 0 <= begin < end\.$", Fault("dark", "hall", -1)),
        (r": needs 0 <= begin < end\.$", Fault("dark", "hall", 4, 4)),
        (r": begins after the run, which is 5 long\.$", Fault("dark", "hall", 5)),
    ],
)
def test_what_a_simulation_does_not_understand_is_refused(message: str, fault: Fault) -> None:
    """With what it does understand."""
    with pytest.raises(InputError, match=message):
        KINDS.require([Fault("dark", "hall", 4), fault], places=["hall"], length=5)


def test_a_fault_that_is_there_for_good_has_no_time() -> None:
    """A time would be left out of account in silence."""
    KINDS.require([Fault("dark")], timed=False)
    for timed in (Fault("dark", begin=1), Fault("dark", end=1)):
        with pytest.raises(InputError, match=r"is permanent; give neither begin nor end\.$"):
            KINDS.require([timed], timed=False)


def test_what_is_passed_on_is_understood_there() -> None:
    """Kinds of journeys and of lines are kinds of the simulations that make them, and all of them strike something."""
    of = {"motion": sensors, "odometry": reader_faults, "balise": balise, "reflector": reflector}
    for machine, kinds in localizer.PASSED_ON.items():
        of[machine].KINDS.require(kinds.values())
        localizer.KINDS.require(map(Fault, kinds))
    line = {"group": balise, "reader": reader_faults, "distance": sensors, "radar": reflector}
    for fault in FAULTS.values():
        for simulation, kind in fault.kinds.items():
            assert kind in line[simulation].KINDS
    localizer.KINDS.require(case.trouble for case in CASES)


def test_a_journey_refuses_what_it_does_not_know() -> None:
    """Before anything is simulated."""
    with pytest.raises(InputError, match=r"^snow, 0 to the end: a journey has no such fault; it has odometer silent, "):
        localizer.KINDS.require([Fault("snow")])


def test_no_channel_is_no_place_of_records() -> None:
    """Where there are no records there is no channel either."""
    with pytest.raises(InputError, match=r"no such place; of a stream of records there is none\.$"):
        record_faults.disturb([], [Fault("drop")])
