"""The picture of route recognition: the plan of the line, and for each route where it is refuted by what."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.railway.pictures import PlanMark, Recognition, TrackPlan
from safeloc.report.recognition import recognition_picture
from safeloc.report.recorded_run import Broken, RecordedRun
from tests.report.drawing_reader import Drawing, across, begin, drawing, end, kinds, points, words
from tests.report.shipped_runs import picture, told

SECOND_MISSED = "route-adcd-second-missed"


def drawn(run: RecordedRun) -> Drawing:
    """The picture of a run."""
    return drawing(recognition_picture(picture("route", Recognition), run))


@pytest.fixture(scope="module")
def missed() -> RecordedRun:
    """ADCD with its D missed: what is seen reads like ACD."""
    return told("route", SECOND_MISSED)


def carried(run: RecordedRun, number: int) -> list[int]:
    """The steps, from 0 on, after which a route is possible."""
    return [step for step, possible in enumerate(run.flags(f"route_{number}_possible")) if possible]


def test_every_element_stands_at_its_distance(missed: RecordedRun) -> None:
    """Switches 302 to 307, balises 106 and 319 and the eight reflectors, read against the axis below."""
    of = drawn(missed)
    place = across(of)
    switches = sorted(round(place(points(mark)[0][0])) for mark in kinds(of, "switch"))
    assert switches == [300, 350, 500, 550, 800, 850]
    assert sorted(round(place(begin(mark))) for mark in kinds(of, "balise")) == [100, 150]
    names = [text for text in words(of) if text.isdigit() and len(text) == 3]
    assert set(map(str, (*range(302, 308), 106, 319, *range(311, 319)))) - {"312"} <= set(names)
    assert "312 not seen" in words(of)
    on_track = sorted(round(place(begin(mark))) for mark in kinds(of, "reflector"))
    assert len(on_track) == 8
    assert {160, 210, 360, 380, 560, 860, 900} <= set(on_track)


def test_tracks_join_at_the_switches(missed: RecordedRun) -> None:
    """The connections run from one track to the other, between their switches."""
    of = drawn(missed)
    place = across(of)
    for name, ends in (("302-303", (300, 350)), ("304-305", (500, 550)), ("306-307", (800, 850))):
        (line,) = kinds(of, f"track-{name}")[-1:]
        (x0, y0), (x1, y1) = points(line)
        assert (round(place(x0)), round(place(x1))) == ends
        assert y1 - y0 == pytest.approx(74)


def test_markers_are_drawn_where_the_plan_has_them(missed: RecordedRun) -> None:
    """As upright lines at their distance, with their names; the legend explains them only where there are any."""
    own = picture("route", Recognition)

    def plan(key: str) -> TrackPlan | None:
        known = own.plan(key)
        mark = PlanMark("marker", "M7", 700_000, 0.0)
        return None if known is None else replace(known, marks=(*known.marks, mark))

    of = drawing(recognition_picture(replace(own, plan=plan), missed))
    assert [700] == [round(across(of)(begin(mark))) for mark in kinds(of, "marker")]
    assert {"M7", "marker"} <= set(words(of))
    assert "marker" not in words(drawn(missed))


def test_the_stated_route_is_drawn_under_its_tracks(missed: RecordedRun) -> None:
    """ADCD: along 301 to switch 304, over to the second track, and to the end."""
    stated = {str(line.get("class")).split()[1] for line in kinds(drawn(missed), "stated")}
    assert stated == {"track-301", "track-302-304", "track-304-305", "track-305-307", "track-310"}


@pytest.mark.parametrize("stem", [SECOND_MISSED, "route-acd-every-reflector"])
def test_each_route_ends_where_it_is_refuted(stem: str) -> None:
    """The bar reaches from the start to the step of the refutation, and there is the cross."""
    run = told("route", stem)
    of = drawn(run)
    for number in range(1, 6):
        steps = carried(run, number)
        bars = kinds(of, f"route-{number}")
        last = min(steps[-1] + 1, len(run.truth_mm) - 1)
        ends = [float(str(run.truth_mm[step])) / 1_000 for step in (steps[0], last)]
        found = [min(map(begin, bars)), max(map(end, bars))]
        assert [across(of)(x) for x in found] == pytest.approx(ends, abs=1.5)
        refuted = kinds(of, f"refuted-{number}")
        assert len(refuted) == (steps[-1] < len(run.truth_mm) - 1)
        for mark in refuted:
            assert across(of)(begin(mark) + 6) == pytest.approx(ends[1], abs=1.5)


def test_it_is_told_what_refutes(missed: RecordedRun) -> None:
    """By the place of C, ACD; for having no A, DCD; for having no C, the routes with B and second A."""
    said = " ".join(words(drawn(missed)))
    assert "reflector A seen at about 160 m: none of model A on this route" in said
    assert "the nearest C of this route is at 380 m" in said
    assert said.count("none of model C on this route") == 2


def test_what_is_seen_is_shown_where_it_is_seen(missed: RecordedRun) -> None:
    """A, C and D in view; D of the missed reflector is not there."""
    of = drawn(missed)
    pieces: dict[str, list[int]] = {}
    for piece in kinds(of, "piece"):
        name = str(piece.get("class")).split()[1]
        pieces.setdefault(name, []).append(round(across(of)(begin(piece))))
    assert {"A", "C", "D"} <= set(pieces)
    assert all(place > 700 for place in pieces["D"])
    assert len(kinds(of, "unseen")) == 1


def test_the_only_route_left_is_another_colour(missed: RecordedRun) -> None:
    """From the step on at which no other is possible."""
    of = drawn(missed)
    (only,) = kinds(of, "only")
    decided = missed.words("mode").index("DECIDED")
    assert across(of)(begin(only)) == pytest.approx(float(str(missed.truth_mm[decided])) / 1_000, abs=1.5)
    assert "route-3" in str(only.get("class"))


def test_given_up_routes_say_why() -> None:
    """Where tolerance is exceeded no route is refuted by a sighting, and none is stated."""
    of = drawn(told("route", "route-adcd-first-missed"))
    assert sum("all given up: tolerance exceeded" in text for text in words(of)) == 5
    assert not kinds(of, "stated")
    assert not kinds(of, "unseen")


def test_without_a_plan_the_strips_remain(missed: RecordedRun) -> None:
    """A recording of another line is told without a drawing of the line."""
    of = drawn(replace(missed, name="mine"))
    assert not kinds(of, "track")
    assert len(kinds(of, "refuted-4")) == 1
    assert "route 4" in words(of)


def test_a_violated_statement_is_marked(missed: RecordedRun) -> None:
    """At the place of its step."""
    of = drawn(replace(missed, broken=(Broken("containment", 200),)))
    (mark,) = kinds(of, "violated")
    assert across(of)(begin(mark)) == pytest.approx(float(str(missed.truth_mm[199])) / 1_000, abs=1.5)
