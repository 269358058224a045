"""The picture of an approach to a stop point: speeds, orders, window, overrun and repositioning stand where the run has them."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest

from safeloc.railway.pictures import Approach
from safeloc.report.approach import approach_picture, due_mm_s
from safeloc.report.recorded_run import Broken, RecordedRun
from tests.report.drawing_reader import Drawing, across, begin, drawing, end, kinds, points, upright, words
from tests.report.shipped_runs import picture, told

KM_H = 1_000_000 / 3_600
"""mm/s in one km/h."""


@pytest.fixture(scope="module")
def overrun() -> RecordedRun:
    """The shipped overrun: 3 m too far, then back."""
    return told("stop_point", "stop_point-overrun")


def drawn(run: RecordedRun) -> Drawing:
    """The picture of a run."""
    return drawing(approach_picture(picture("stop_point", Approach), run))


def orders(run: RecordedRun) -> list[str]:
    """The order after each step."""
    return run.words("order")


def test_the_curve_is_speed_over_true_place(overrun: RecordedRun) -> None:
    """Its fastest point reads as the fastest step's speed and place."""
    of = drawn(overrun)
    every = [point for line in kinds(of, "run") for point in points(line)]
    x, y = min((point for point in every if point[1] < 300), key=lambda point: point[1])
    speeds = [given["speed_mm_s"] for given in overrun.given]
    fastest = max(range(len(speeds)), key=speeds.__getitem__)
    assert upright(of)(y) == pytest.approx(speeds[fastest] / KM_H, abs=0.2)
    assert across(of)(x) == pytest.approx(float(str(overrun.truth_mm[fastest])) / 1_000, abs=0.5)


def test_the_brake_order_is_marked_where_it_is_given_first(overrun: RecordedRun) -> None:
    """With place, speed and what is left to the stop point in words."""
    of = drawn(overrun)
    step = orders(overrun).index("BRAKE")
    place = float(str(overrun.truth_mm[step]))
    (mark,) = kinds(of, "brake-order")
    ((x, y),) = points(mark)
    assert across(of)(x) == pytest.approx(place / 1_000, abs=0.5)
    assert upright(of)(y) == pytest.approx(overrun.given[step]["speed_mm_s"] / KM_H, abs=0.3)
    left = (350_000 - place) / 1_000
    assert any(f"brake order at {place / 1_000:.1f} m" in text and f"{left:.1f} m before" in text for text in words(of))


def test_each_order_has_its_own_line(overrun: RecordedRun) -> None:
    """Every order that was given is a stretch of the curve, with dashes of its own and a word in the legend."""
    of = drawn(overrun)
    given = list(dict.fromkeys(orders(overrun)))
    assert {"PROCEED", "BRAKE", "HOLD", "REVERSE"} <= set(given)
    dashes = {
        order: {line.get("stroke-dasharray") for line in kinds(of, order) if line in kinds(of, "run")}
        for order in given
    }
    assert all(len(found) == 1 for found in dashes.values())
    assert len({str(*found) for found in dashes.values()}) == len(given)
    numbered = {text.split(" ")[-1] for text in words(of) if text[0].isdigit() and " " in text}
    assert set(given) <= numbered


def test_braking_is_due_on_the_dashed_curves(overrun: RecordedRun) -> None:
    """The brake order comes at the first step on or above the curve of the selected stop point."""
    one = picture("stop_point", Approach)
    step = orders(overrun).index("BRAKE")
    for number, above in ((step, True), (step - 1, False)):
        given = overrun.given[number]
        to_go = 350_000 - given["position_mm"] - (0 if given["position_precise"] else given["margin_above_mm"])
        assert (given["speed_mm_s"] >= due_mm_s(one, to_go)) is above
    assert len(kinds(drawn(overrun), "due")) == 2


def test_the_braking_curve_just_stops_there() -> None:
    """From the drawn speed with its error, reaction and service brake take exactly the distance."""
    one = picture("stop_point", Approach)
    for to_go in (1_000, 50_000, 400_000):
        speed = due_mm_s(one, to_go) + one.speed_error_mm_s
        assert speed * one.reaction_ms / 1_000 + speed * speed / (2 * one.brake_mm_s2) == pytest.approx(to_go)


def test_the_stop_window_stands_at_its_place(overrun: RecordedRun) -> None:
    """In the whole picture along the line; around the stop point from 0.5 m before to 0.5 m beyond."""
    of = drawn(overrun)
    windows = [(across(of)(begin(one)), across(of)(end(one))) for one in kinds(of, "window")]
    assert [sum(ends) / 2 for ends in windows] == pytest.approx([350, 400], abs=0.5)
    (near,) = kinds(of, "near-window")
    assert [across(of, 1)(begin(near)), across(of, 1)(end(near))] == pytest.approx([-0.5, 0.5], abs=0.02)
    assert {"stop point 207 (selected)", "stop point 210", "stop window"} <= set(words(of))


def test_an_overrun_is_marked_and_measured(overrun: RecordedRun) -> None:
    """At its farthest place, in metres beyond the window; none where the vehicle stops in place."""
    of = drawn(overrun)
    (mark,) = kinds(of, "overrun")
    ((x, _),) = points(mark)
    farthest = max(place for place in overrun.truth_mm if place is not None) - 350_000
    assert across(of, 1)(x) == pytest.approx(farthest / 1_000, abs=0.02)
    assert f"overrun: {(farthest - 500) / 1_000:.2f} m beyond the window" in words(of)
    assert not kinds(drawn(told("stop_point", "stop_point-figure-2")), "overrun")


def test_what_comes_after_departure_is_no_overrun() -> None:
    """A vehicle that was served and leaves is beyond the window, as it should be."""
    run = told("stop_point", "stop_point-figure-2")
    assert orders(run)[-1] == "NONE"
    of = drawn(replace(run, truth_mm=(*run.truth_mm[:-1], 360_000)))
    assert not kinds(of, "overrun")
    assert len(kinds(of, "standing")) == 1


def test_a_run_without_a_stop_is_speed_over_place() -> None:
    """Before any stop is pending there is no enlarged part, and no mark of a brake order."""
    run = told("stop_point", "stop_point-figure-2")
    early = replace(run, trace=replace(run.trace, steps=run.trace.steps[:100]), truth_mm=run.truth_mm[:100])
    of = drawn(early)
    assert set(orders(early)) == {"NONE"}
    assert kinds(of, "run")
    assert not [*kinds(of, "near-window"), *kinds(of, "brake-order"), *kinds(of, "standing")]


def test_repositioning_runs_back_below_zero(overrun: RecordedRun) -> None:
    """While the order is to reverse the curve goes from beyond the window back, slower than the reduced speed."""
    of = drawn(overrun)
    back = [points(line) for line in kinds(of, "REVERSE") if line in kinds(of, "run")]
    near = [point for stretch in back for point in stretch if point[1] > 320]
    assert max(across(of, 1)(x) for x, _ in near) > 2
    speeds = [upright(of, 1)(y) for _, y in near]
    assert -3 < min(speeds) < -1.5
    limits = sorted(
        upright(of, 1)(float(str(line.get("d")).split(" ")[1].split("H")[0])) for line in kinds(of, "reduced")
    )
    assert limits == pytest.approx([-3, 3], abs=0.05)


def test_the_reported_interval_at_the_end(overrun: RecordedRun) -> None:
    """A bar from its lower to its upper end, with both in words."""
    of = drawn(overrun)
    (bar,) = kinds(of, "standing")
    last = overrun.given[-2]  # in the last step the vehicle is told to leave
    low, high = (last["position_mm"] + off - 350_000 for off in (-last["margin_below_mm"], last["margin_above_mm"]))
    first, second, *_ = points(bar)
    assert [across(of, 1)(first[0]), across(of, 1)(second[0])] == pytest.approx([low / 1_000, high / 1_000], abs=0.02)


def test_modes_and_orders_over_time(overrun: RecordedRun) -> None:
    """Each piece of the strips begins when its order is given."""
    of = drawn(overrun)
    seconds = across(of, 2)
    starts = [seconds(begin(piece)) for piece in kinds(of, "piece") if "REVERSE" in str(piece.get("class"))]
    changes = [step for step, (before, after) in enumerate(pairwise(orders(overrun)), 1)
               if after == "REVERSE" and before != after]  # fmt: skip
    assert sorted(starts) == pytest.approx([(step + 1) / 10 for step in changes], abs=0.1)


def test_a_violated_statement_is_marked(overrun: RecordedRun) -> None:
    """At the place of its step."""
    of = drawn(replace(overrun, broken=(Broken("never too fast", 100),)))
    (mark,) = kinds(of, "violated")
    assert across(of)(begin(mark)) == pytest.approx(float(str(overrun.truth_mm[99])) / 1_000, abs=0.5)
    assert "× violated at step 100: never too fast" in words(of)
