"""Claims around a stream: known answers of a small machine, nearest violations, empty tubes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import pytest

from safeloc.errors import EngineError
from safeloc.language.spec import Property, always
from safeloc.language.system import lower
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Unknown, Vacuous, Violated
from safeloc.proof.around import hand_over
from safeloc.proof.around.claims import Asked
from safeloc.proof.around.course import Course
from safeloc.proof.around.deviations import deviations
from safeloc.proof.around.proving import Around
from safeloc.proof.cores.clauses import ClauseId, without
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from tests.proof.around.small import PLACE, around, given, machine, steady


def violated(finding: Finding) -> Trace:
    """The run of a verdict that is `violated`."""
    assert isinstance(finding.result, Violated)
    assert finding.result.trace is not None
    return finding.result.trace


def reason(finding: Finding) -> str:
    """The reason of a verdict that is `violated`."""
    assert isinstance(finding.result, Violated)
    return finding.result.reason


def test_a_bound_holds_up_to_the_cycle_in_which_it_is_reached() -> None:
    """Fifty steps of 10 ± 2 mm sum to 600 mm at most."""
    [holds, tighter] = around(steady(50), "place_mm <= 600", "place_mm <= 599", within={"distance_mm": 2})
    assert isinstance(holds.result, Proved)
    assert holds.result.certificates
    assert len(violated(tighter).steps) == 50


def test_the_factor_is_the_one_at_which_the_bound_is_reached() -> None:
    """Fifty steps exceed 600 mm from 3 mm of the 10 mm of width on."""
    [found] = around(steady(50), "place_mm <= 600", within={"distance_mm": 10})
    assert "holds at 0.299 of the widths (proved), broken at 0.300 of the widths (this run)" in reason(found)
    assert all(step.inputs["distance_mm"] <= 13 for step in violated(found).steps)


def test_without_a_deviation_the_stream_itself_is_asked() -> None:
    """The sum of fifty steps is known exactly, and folding alone tells it."""
    [holds, broken] = around(steady(50), "place_mm <= 500", "place_mm < 500")
    assert isinstance(holds.result, Proved)
    assert holds.result.by_construction
    assert len(violated(broken).steps) == 50


def test_a_missing_value_breaks_a_claim() -> None:
    """With one of the fixes missing nine cycles pass without one."""
    [four, nine] = around(steady(50), "age_cycles <= 8", "age_cycles <= 9", drop={"fix_mm": 1})
    assert max(step.state["age_cycles"] for step in violated(four).steps) == 9
    assert isinstance(nine.result, Proved)


def test_a_late_value_breaks_a_claim() -> None:
    """With a fix two cycles late six cycles pass without one."""
    [five, six] = around(steady(50), "age_cycles <= 5", "age_cycles <= 6", delay={"fix_mm": 2})
    assert "fix_mm" not in violated(five).stream()[4]
    assert isinstance(six.result, Proved)


@pytest.mark.thorough
def test_losses_and_delays_come_together() -> None:
    """One fix missing and the next two cycles late: eleven cycles without one."""
    [ten, eleven] = around(steady(50), "age_cycles <= 10", "age_cycles <= 11", drop={"fix_mm": 1}, delay={"fix_mm": 2})
    violated(ten)
    assert isinstance(eleven.result, Proved)


def test_an_input_that_is_never_absent_is_read_late() -> None:
    """A step of 20 mm in cycle 3 may be read again in the two cycles after it."""
    stream = [{"distance_mm": 20 if cycle == 3 else 10} for cycle in range(1, 7)]
    [holds, broken] = around(stream, "place_mm <= 90", "place_mm <= 89", delay={"distance_mm": 2})
    assert isinstance(holds.result, Proved)
    violated(broken)


def test_claims_are_judged_in_the_cycles_asked() -> None:
    """The bound is broken from cycle 51 on only."""
    assert isinstance(around(steady(60), "place_mm <= 500", last=50)[0].result, Proved)
    [found] = around(steady(60), "place_mm <= 500")
    assert len(violated(found).steps) == 51
    [late] = around(steady(60), "distance_mm > 10 or place_mm > 100", first=20)
    assert isinstance(late.result, Proved)


def test_the_truth_is_free_within_the_laws() -> None:
    """The truth goes 5 mm apart from the place in every step, and no more."""
    [holds, broken] = around(
        steady(20), "truth_mm - place_mm <= 100", "truth_mm - place_mm <= 99", within={"distance_mm": 3}
    )
    assert isinstance(holds.result, Proved)
    assert "for all streams of the tube that obey the laws" in holds.method
    assert violated(broken).steps[-1].state["truth_mm"] == 100 + violated(broken).steps[-1].state["place_mm"]


def test_laws_exclude_streams_of_the_tube() -> None:
    """No lawful step is above 55 mm, however wide the tube; without the law that says so, one is."""
    stream = steady(3, distance_mm=50)
    [found] = around(stream, "distance_mm <= 55", within={"distance_mm": 20})
    assert isinstance(found.result, Proved)
    free = without(lower(machine()), [ClauseId("integrator", "the vehicle is slow")])
    [found] = around(stream, "distance_mm <= 55", within={"distance_mm": 20}, system=free)
    assert violated(found).steps[-1].inputs["distance_mm"] == 56


def test_an_empty_tube_is_vacuous() -> None:
    """A step of 70 mm breaks the laws together, and no width of 5 mm helps; the cycle and the laws are named."""
    stream = [*steady(7), {"distance_mm": 70}, *steady(3)]
    [found] = around(stream, "place_mm <= 9999", within={"distance_mm": 5})
    assert isinstance(found.result, Vacuous)
    assert found.result.reason == (
        "the tube is empty from cycle 8 on: no stream of it obeys 'the step is measured' and 'the vehicle is slow' so far; "
        "widen the tube, or leave a law out with --without"
    )
    [found] = around(stream, "place_mm <= 9999", within={"distance_mm": 15})
    assert isinstance(found.result, Proved)


def test_a_claim_that_is_never_judged_is_vacuous() -> None:
    """Without any fix a claim on fixes says nothing."""
    [found] = around([{"distance_mm": 1}] * 4, "fix_mm <= 3")
    assert isinstance(found.result, Vacuous)
    assert "in no cycle of the stream given all of fix_mm are there" in found.result.reason


def test_a_wrong_hand_over_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bounds that some stream leaves are refused by the solvers, not handed over."""
    monkeypatch.setattr(hand_over, "_kept", lambda _, bounds: (bounds[0], bounds[1] - 1))
    with pytest.raises(EngineError, match="a stream leaves the states handed over"):
        around(steady(50), "place_mm <= 600", within={"distance_mm": 2})


def test_too_little_effort_leaves_a_claim_open(monkeypatch: pytest.MonkeyPatch) -> None:
    """A hand-over that the solvers do not settle gives `unknown`, with the cycle and what to try."""

    def unsettled(*_: object) -> None:
        raise hand_over.UnsettledError("limit reached")

    monkeypatch.setattr("safeloc.proof.around.windows.hand_over", unsettled)
    [found] = around(steady(50), "place_mm <= 600", within={"distance_mm": 2})
    assert isinstance(found.result, Unknown)
    assert "undecided in cycle" in found.result.reason
    assert "narrower widths" in found.result.reason


def test_what_is_left_when_the_whole_time_is_over_is_open() -> None:
    """With next to no time the claim is undecided, for this reason; with enough it is proved; one broken at a corner is found first."""
    ask = ("place_mm <= 650", "place_mm <= 649")
    [open_, broken] = around(steady(50), *ask, within={"distance_mm": 3}, seconds_in_all=1e-9)
    assert isinstance(open_.result, Unknown)
    assert "undecided in cycle 1: the time for the whole question is over; try narrower widths" in open_.result.reason
    assert open_.result.reason.endswith("or a greater --timeout")
    assert "broken at 1.000 of the widths (this run)" in reason(broken)
    [proved, _] = around(steady(50), *ask, within={"distance_mm": 3}, seconds_in_all=60)
    assert isinstance(proved.result, Proved)


def test_cycles_after_the_last_one_that_is_judged_are_not_run() -> None:
    """A claim up to cycle 20 is proved within the time that the first windows take."""
    courses: list[Course] = []
    [found] = around(steady(50), "place_mm <= 260", within={"distance_mm": 3}, last=20, watched=courses.append)
    assert isinstance(found.result, Proved)
    assert max(one.end for one in courses) == 20


def test_a_general_proof_is_looked_for_first() -> None:
    """Of declared properties, all at once; what is proved for all lawful streams is asked of no window, unless a law is left out."""
    whole = lower(machine())
    known, other = (always(name, PLACE <= 600, statement="It is so.") for name in ("known", "other"))
    asked_for: list[Sequence[Property]] = []

    def general(properties: Sequence[Property]) -> Mapping[Property, Mapping[str, str]]:
        asked_for.append(properties)
        return {known: {}}

    near, asked = deviations(whole, {"distance_mm": 2}, {}, {}), [Asked(known), Asked(other)]
    around_ = Around(whole.name, whole, "steady", given(whole, steady(50)), near, asked, Limits(), general=general)
    methods = [finding.method for finding in around_.findings()]
    assert methods[0].startswith("it follows from the proof for all lawful streams")
    assert methods[1].startswith("windows with proved hand-over states")
    assert asked_for == [[known, other]]
    [first, _] = replace(around_, without=("the vehicle is slow",)).findings()
    assert first.method.startswith("windows with proved hand-over states")
    assert len(asked_for) == 1


def test_the_stream_itself_breaks_a_claim() -> None:
    """Then it is the nearest one, whatever the widths: it is told with the truth that was recorded, and nothing is searched."""
    [found] = around(steady(50), "place_mm <= 300", within={"distance_mm": 10})
    assert len(violated(found).steps) == 31
    assert reason(found).endswith(
        "broken at 0.000 of the widths (this run): the stream given breaks it without any width"
    )
    [with_losses] = around(steady(50), "age_cycles <= 3", within={"distance_mm": 10}, drop={"fix_mm": 1})
    assert "the stream given, with the losses and delays allowed, breaks it without any width" in reason(with_losses)
