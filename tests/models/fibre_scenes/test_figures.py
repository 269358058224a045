"""Figures of the source and troubles of one end of a train, replayed from simulated backscatter."""

from __future__ import annotations

from itertools import groupby

import pytest

from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.models import fibre
from safeloc.models.fibre.picture import loud
from safeloc.models.fibre.scenes.figures import END_SCENES, EndScene
from safeloc.models.fibre.scenes.recordings import recorded_end
from safeloc.runtime.streams.steps import Cell, read_steps
from tests.models.fibre_family import labels, mode_labels, replayed
from tests.shipped_recordings import shipped

MACHINE = fibre.machine()
SYSTEM = without_ghosts(lower(MACHINE))
GHOSTS = {var.name for var in MACHINE.world.choices}
BY_NAME = {one.name: one for one in END_SCENES}
ROUNDED_MM = 2
FLIPPED = 0.005
"""Floating-point libraries round in their own ways: a place by a millimetre or two, a level in a few cells by one."""


def run_of(name: str) -> tuple[Trace, list[dict[str, Cell]]]:
    """A shipped recording through the machine, and its steps."""
    steps = [dict(step) for step in read_steps(shipped(f"fibre-{name}")).steps]
    return replayed(SYSTEM, [{key: cell for key, cell in step.items() if key not in GHOSTS} for step in steps]), steps


def course(trace: Trace) -> list[str]:
    """The modes in order."""
    return [mode for mode, _ in groupby(mode_labels(MACHINE, trace))]


def signals_mm(trace: Trace, steps: list[dict[str, Cell]]) -> list[int]:
    """Where the end really was when a position signal was counted."""
    return [
        int(row["truth_mm"])
        for one, row in zip(trace.steps, steps, strict=True)
        if one.outputs["position_signal"]
    ]  # fmt: skip


@pytest.mark.parametrize("name", ["figure-2-rising", "figure-7-falling", "figure-10-reflecting-points"])
def test_each_section_is_counted_once_and_makes_the_place_exact(name: str) -> None:
    """Two sections, two signals, count 2, and a smaller margin after each; no error."""
    trace, steps = run_of(name)
    assert ["WAITING", "LOCATED"] == course(trace)
    places = signals_mm(trace, steps)
    assert [True, True] == [
        low <= place <= low + 100_000 for low, place in zip((1_500_000, 2_300_000), places, strict=True)
    ]
    assert 2 == trace.steps[-1].outputs["count"]
    at = [int(row["truth_mm"]) for row in steps].index(places[0])
    assert trace.steps[at].outputs["margin_above_mm"] < trace.steps[at - 1].outputs["margin_above_mm"] / 2


def test_the_code_tells_the_place_without_a_reference() -> None:
    """Five sections of the six are counted before the word is found; the sixth has its number."""
    trace, steps = run_of("figure-5-code")
    assert not any(row["reference_accepted"] for row in steps)
    assert ["WAITING", "COUNTING", "LOCATED"] == course(trace)
    located = mode_labels(MACHINE, trace).index("LOCATED")
    assert 5 == sum(one.outputs["position_signal"] for one in trace.steps[:located])
    assert 6 == trace.steps[-1].outputs["count"]


def test_reflecting_points_are_seen_where_they_are() -> None:
    """All three coincide with the pattern at some time, and agree although the index of refraction is off."""
    _, steps = run_of("figure-10-reflecting-points")
    seen = {row["reflecting_point_mm"] for row in steps if "reflecting_point_mm" in row}
    assert {1_400_000, 2_200_000, 3_200_000} == seen
    assert not any("flight_position_mm" in row for row in steps)


@pytest.mark.parametrize(
    ("name", "reason", "from_mm", "to_mm"),
    [
        ("missed-section", "MISSED_SECTION", 2_350_000, 2_600_000),
        ("false-section", "FALSE_SECTION", 2_000_000, 2_100_000),
        ("drift-of-n", "FLIGHT_DIFFERS", 2_100_000, 2_600_000),
    ],
)
def test_what_does_not_agree_raises_the_error(name: str, reason: str, from_mm: int, to_mm: int) -> None:
    """Located, then error F with its reason in the place where it has to come; nothing is located afterwards."""
    trace, steps = run_of(name)
    assert ["WAITING", "LOCATED", "FAULTED"] == course(trace)
    at = mode_labels(MACHINE, trace).index("FAULTED")
    assert {reason} == set(labels(trace, "reason")[at:])
    assert from_mm <= int(steps[at]["truth_mm"]) <= to_mm
    assert not any(one.outputs["valid"] for one in trace.steps[at:])


def test_drift_of_the_index_moves_no_position_signal() -> None:
    """The second section is noticed at its place, though the time of flight is some 40 m astray by then."""
    trace, steps = run_of("drift-of-n")
    first, second = signals_mm(trace, steps)[:2]
    assert 0 <= first - 1_500_000 <= 100_000
    assert 0 <= second - 2_200_000 <= 100_000


def test_a_train_longer_than_a_section_is_in_several_at_once() -> None:
    """Both ends count three sections; while the rear is in one, the front is beyond the next."""
    (front, ahead), (rear, behind) = run_of("long-train-front"), run_of("long-train-rear")
    assert (3, 3) == (front.steps[-1].outputs["count"], rear.steps[-1].outputs["count"])
    for row, other in zip(ahead, behind, strict=True):
        assert 790_000 <= int(row["truth_mm"]) - int(other["truth_mm"]) <= 810_000
    counts = [(one.outputs["count"], two.outputs["count"]) for one, two in zip(front.steps, rear.steps, strict=True)]
    assert (2, 1) in counts or (2, 0) in counts


@pytest.mark.parametrize("name", BY_NAME)
def test_every_reported_interval_holds_the_truth(name: str) -> None:
    """In every step of every scene, whatever goes wrong in it."""
    trace, steps = run_of(name)
    for one, row in zip(trace.steps, steps, strict=True):
        told = one.outputs
        if told["valid"]:
            assert (
                told["position_mm"] - told["margin_below_mm"]
                <= int(row["truth_mm"])
                <= told["position_mm"] + told["margin_above_mm"]
            )


def fresh_is_shipped(made: EndScene) -> None:
    """Steps and picture of a simulation made now are those that ship."""
    recording = recorded_end(made)
    stored = read_steps(shipped(recording.name))
    assert recording.first == stored.first
    assert len(recording.steps) == len(stored.steps)
    for now, then in zip(recording.steps, stored.steps, strict=True):
        assert now.keys() == then.keys()
        assert {name: cell for name, cell in now.items() if not near(cell, then[name])} == {}
    picture = loud(recording.name)
    assert picture is not None
    assert (made.title, made.says) == (picture.title, picture.says)
    rows = ["".join(row) for row in picture.rows], recording.picture["rows"]
    cells = [(ord(a), ord(b)) for one, other in zip(*rows, strict=True) for a, b in zip(one, other, strict=True)]
    assert sum(a != b for a, b in cells) <= FLIPPED * len(cells)


def near(now: Cell, then: Cell) -> bool:
    """The same, but for rounding."""
    if isinstance(now, str) or isinstance(then, str) or isinstance(now, bool):
        return now == then
    return abs(now - then) <= ROUNDED_MM or abs(now - then) <= ROUNDED_MM * 1_000_000 < abs(then)


@pytest.mark.thorough
def test_a_shipped_recording_is_a_fresh_simulation() -> None:
    """Figure 2, from the ground's strain to the machine's step."""
    fresh_is_shipped(BY_NAME["figure-2-rising"])


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in BY_NAME if name != "figure-2-rising"])
def test_all_shipped_recordings_are_fresh_simulations(name: str) -> None:
    """As `python -m safeloc.models.fibre.scenes` makes them."""
    fresh_is_shipped(BY_NAME[name])
