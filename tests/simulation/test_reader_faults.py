"""Faults of marker readers in step streams: each is seen in the readings, and the odometry machine rejects it."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.language.interpret import run
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace, shown
from safeloc.models import odometry
from safeloc.models.odometry.simulate import Steps, simulate
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg
from safeloc.simulation.reader_faults import with_faults
from safeloc.simulation.sensors import FOREIGN, Reading

MARKERS = [(number, number * 100_000) for number in range(1, 9)]
READINGS = [
    Reading(cycle, 0, number, number * 100_000, 200, 3) for number, cycle in ((1, 10), (2, 20), (3, 21), (4, 40))
]
CONFIG = OdometryConfig(trust_first_marker=True)


def struck(kind: str, **figures: int) -> list[tuple[int, int, int | None]]:
    """Cycle, identity and place of every reading with the fault in it."""
    found = with_faults("front_marker", READINGS, MARKERS, [Fault(kind, "front_marker", 15, 30, figures)])
    return [(one.cycle, one.marker, one.place_mm) for one in found]


def test_a_missed_marker_gives_no_reading() -> None:
    """Those before and after stay."""
    assert struck("missed") == [(10, 1, 100_000), (40, 4, 400_000)]


def test_a_repeated_reading_comes_once_more() -> None:
    """Unchanged, in the next cycle that has no reading of its own; the readings stay in order of time."""
    assert [(cycle, marker) for cycle, marker, _ in struck("repeated")] == [
        (10, 1), (20, 2), (21, 3), (22, 2), (23, 3), (40, 4),
    ]  # fmt: skip


def test_a_misplaced_marker_is_another_one_of_this_line() -> None:
    """Identity and place agree with the map; only the vehicle is not there."""
    assert struck("misplaced")[1:3] == [(20, 4, 400_000), (21, 5, 500_000)]
    assert struck("misplaced", reach=-1)[1:3] == [(20, 1, 100_000), (21, 2, 200_000)]


def test_a_foreign_marker_has_no_place() -> None:
    """Its identity is one of another line."""
    foreign = struck("foreign")[1]
    assert foreign == (20, FOREIGN + 20, None)


def test_a_foreign_reading_is_not_misplaced() -> None:
    """It stands nowhere on this line already."""
    foreign = [Reading(20, 0, FOREIGN, None, 200, 0)]
    assert with_faults("a", foreign, MARKERS, [Fault("misplaced", "a", 0, 30)]) == foreign


def test_another_reader_is_left_alone() -> None:
    """A fault strikes the reader that it names."""
    assert with_faults("rear_marker", READINGS, MARKERS, [Fault("missed", "front_marker", 0, 99)]) == READINGS


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        (
            Fault("missed", "front_marker", 30, 40),
            r"hits no reading; readings are in cycles \[10, 20, 21, 40\]\.$",
        ),
        (
            Fault("misplaced", "front_marker", 0, 99, {"reach": 7}),
            r"marker 2 has no other one 7 markers further on this line\.$",
        ),
        (
            Fault("misplaced", "front_marker", 0, 99, {"reach": 0}),
            r"marker 1 has no other one 0 markers further on this line\.$",
        ),
    ],
)
def test_a_fault_that_would_test_nothing_is_refused(fault: Fault, message: str) -> None:
    """No reading in its time, or no marker to take its place."""
    with pytest.raises(InputError, match=message):
        with_faults("front_marker", READINGS, MARKERS, [fault])


# ------------------------------------------------------------------ in the streams of the odometry machine


def stream(*faults: Fault) -> Steps:
    """Forty-five seconds past a marker every hundred metres, with perfect readers but for the faults."""
    places = [(number + 1, (number - 9) * 100_000) for number in range(40)]
    legs = [Leg(30_000, 45)]
    return simulate(CONFIG, seed=9, legs=legs, markers=places, missed=0.0, foreign=0.0, dropout=0.0, faults=faults)


def verdicts(steps: Steps) -> tuple[Trace, list[str]]:
    """The run and the front reader's verdicts on what was read."""
    system = without_ghosts(lower(odometry.machine(CONFIG)))
    names = {var.name for var in system.inputs}
    trace = run(system, [{name: value for name, value in step.items() if name in names} for step in steps])
    verdict = next(var for var in system.state if var.name == "front_reading")
    return trace, [shown(verdict, step.state["front_reading"]) for step in trace.steps]


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("kind", "figures", "verdict"),
    [
        ("repeated", {}, {"REPEATED"}),
        ("misplaced", {"reach": 2}, {"OUT_OF_WINDOW"}),
        ("misplaced", {"reach": -2}, {"OUT_OF_ORDER", "OUT_OF_WINDOW", "REPEATED"}),
        ("foreign", {}, {"FOREIGN"}),
    ],
)
def test_the_machine_rejects_it_and_stays_right(kind: str, figures: dict[str, int], verdict: set[str]) -> None:
    """With the reason that fits, and while anything is reported the interval holds the truth."""
    steps = stream(Fault(kind, "front_marker", 250, 350, figures))
    trace, said = verdicts(steps)
    sound = verdicts(stream())[1]
    new = {one for one, other in zip(said, sound, strict=True) if one != other and one not in ("NONE", "ACCEPTED")}
    assert new
    assert new <= verdict
    for step, out in zip(steps, (one.outputs for one in trace.steps), strict=True):
        if out["valid"]:
            assert out["position_mm"] - out["margin_below_mm"] <= step["truth_mm"] + 1
            assert step["truth_mm"] <= out["position_mm"] + out["margin_above_mm"]


def test_a_reader_that_is_not_there_is_refused() -> None:
    """A wheel misses no marker, and there are two readers."""
    with pytest.raises(InputError, match=r"a distance sensor has no such fault; it has stuck, "):
        stream(Fault("missed", "front_wheel", 0, 9))
    with pytest.raises(InputError, match=r"a marker reader has no such fault; it has missed, repeated, "):
        stream(Fault("slide", "rear_marker", 0, 9))


def test_a_reading_repeated_after_the_end_is_lost() -> None:
    """The run has its length, whatever is delivered late."""
    legs = [Leg(10_000, 3.0)]
    bare = simulate(CONFIG, seed=1, legs=legs, markers=[], missed=0.0, foreign=0.0)
    last = [(7, int(bare[-1]["truth_mm"]))]
    fault = Fault("repeated", "front_marker", len(bare) - 1, len(bare))
    steps = simulate(CONFIG, seed=1, legs=legs, markers=last, missed=0.0, foreign=0.0, faults=[fault])
    assert len(steps) == len(bare)
    assert [number for number, step in enumerate(steps) if step.get("front_marker") == 7] == [len(bare) - 1]
