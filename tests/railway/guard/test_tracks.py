"""On which track a fix lies: continuity decides between tracks, and only legal movements join them."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.railway.guard.tracks import Laid, Match, Tracks, Window
from safeloc.railway.map.elements import TrackEdge
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import Place
from safeloc.railway.map.routes import Route
from safeloc.railway.map.topology import Run, Topology
from tests.railway.guard.made import edge, fork, place, tracks

pytest.importorskip("shapely")
pytest.importorskip("pyproj")
STEM, MAIN, SIDE = (Run(name, "increasing") for name in ("stem", "main", "side"))


def match(on: Tracks, x: float, y: float = 0.0, window: Window | None = None, *, alone: bool = False) -> Match:
    """Where a position lies."""
    return on.match(*place(x, y), window, alone=alone)


def on_the(*laid: Laid) -> Tracks:
    """Tracks of the fork on which the vehicle was last on these pieces."""
    made = tracks()
    made.roots = laid
    return made


def test_a_place_on_plain_track() -> None:
    """The nearest place, its distance off rounded up, and nothing ambiguous."""
    found = match(tracks(), 100, 3)
    assert (Place("stem", 100_000), 3_001, 100_000, False) == (
        found.place, found.offset_mm, found.position_mm, found.ambiguous,
    )  # fmt: skip


@pytest.mark.parametrize(("x", "ambiguous"), [(480, False), (495, True), (530, True), (600, False)])
def test_both_branches_near_a_switch(x: float, ambiguous: bool) -> None:
    """Where the other branch is within the limit, the track is not clear."""
    assert ambiguous is match(tracks(), x).ambiguous


def test_off_every_track() -> None:
    """The nearest place and how far it is: the machine withholds it."""
    found = match(tracks(), 200, -80)
    assert (Place("stem", 200_000), 80_001) == (found.place, found.offset_mm)


def test_a_parallel_track_is_excluded_by_continuity() -> None:
    """Beside a parallel track a fix is ambiguous at first, and clear once the vehicle is known to be on one of both."""
    line = fork(edge("beside", "A", "B", (0, 4), (1_000, 4)))
    anew, known = tracks(line), tracks(line)
    known.roots = (Laid(0, STEM),)
    window = Window(90_000, 110_000)
    assert match(anew, 100, 1.9).ambiguous
    assert (False, "stem") == (
        match(known, 100, 2.1, window).ambiguous, match(known, 100, 2.1, window).place.edge,
    )  # fmt: skip


def test_a_row_of_doubtful_fixes_excludes_no_track() -> None:
    """While recovering, a parallel track counts although the row so far was on the other."""
    line = fork(edge("beside", "A", "B", (0, 4), (1_000, 4)))
    known = tracks(line)
    known.roots = (Laid(0, STEM),)
    assert match(known, 100, 1, Window(90_000, 110_000), alone=True).ambiguous


def test_the_way_goes_on_over_a_switch() -> None:
    """Behind the switch the position counts on from the stem, on either branch."""
    window = Window(450_000, 700_000)
    on = on_the(Laid(0, STEM))
    assert 700_000 == match(on, 700, 0, window).position_mm
    assert "side" == match(on, 750, 43, window).place.edge


def test_no_way_leads_from_branch_to_branch() -> None:
    """A vehicle that is known to be on the main track, beyond the switch, cannot be on the side track."""
    on = on_the(Laid(500_000, MAIN))
    found = match(on, 800, 50, Window(780_000, 820_000))
    assert found.elsewhere


def test_back_over_the_switch_the_other_branch_is_open_again() -> None:
    """With the window reaching back over the switch, both branches are possible."""
    on = on_the(Laid(500_000, MAIN))
    window = Window(470_000, 640_000)
    found = match(on, 640, 23, window)
    assert ("side", False) == (found.place.edge, found.elsewhere)


def test_a_vehicle_that_only_went_forwards_did_not_go_back_over_the_switch() -> None:
    """What the speed excludes is not followed."""
    on = on_the(Laid(500_000, MAIN))
    window = Window(470_000, 640_000, forwards=True, backwards=False)
    assert match(on, 640, 23, window).elsewhere


def test_beyond_reach() -> None:
    """A place farther along than the vehicle can be is elsewhere."""
    assert match(on_the(Laid(0, STEM)), 400, 0, Window(90_000, 110_000)).elsewhere


def test_what_was_taken_becomes_the_way() -> None:
    """Of the pieces within the window those that are on one way with the fix are kept."""
    on = on_the(Laid(0, STEM))
    window = Window(480_000, 720_000)
    on.took(match(on, 700, 0, window), window)
    assert (Laid(0, STEM), Laid(500_000, MAIN)) == on.roots
    assert (Place("stem", 490_000), Place("main", 100_000)) == (on.place(490_000), on.place(600_000))


def test_a_place_ahead_of_a_switch_that_may_be_taken_either_way() -> None:
    """Beyond what is known of the way there is no place to name."""
    on = on_the(Laid(0, STEM))
    assert on.place(600_000) is None


def test_on_a_route_positions_count_along_it() -> None:
    """A route begun within its first edge, run against the edges' direction."""
    topology = Topology(fork())
    route = Route(topology, (Run("side", "decreasing"), Run("stem", "decreasing")), 100_000, 500_000)
    on = tracks(route=route)
    assert route.positions_of(Place("stem", 200_000)) == [match(on, 200, 0).position_mm]
    assert not match(on, 495, 0).ambiguous


def test_a_way_that_comes_by_twice() -> None:
    """Within a hairpin a fix lies near two places of one edge: ambiguous at first, clear with a window."""
    loop: TrackEdge = edge("loop", "A", "B", (0, 200), (300, 200), (310, 206), (300, 212), (0, 212))
    line = Line(name="hairpin", version="1", nodes=fork(loop).nodes[:2], edges=(loop,))
    on = tracks(line)
    assert match(on, 100, 206).ambiguous
    on.roots = (Laid(0, Run("loop", "increasing")),)
    found = match(on, 100, 205, Window(90_000, 110_000))
    assert (False, 100_000) == (found.ambiguous, found.position_mm)


def test_tracks_without_a_course_are_refused() -> None:
    """A track that no fix can lie on could not make one ambiguous."""
    bare = TrackEdge(id="bare", from_node="A", to_node="B", length_mm=1_000)
    with pytest.raises(InputError, match="1 edges have no course"):
        tracks(fork(bare))


def test_no_position_in_the_coordinate_system() -> None:
    """Coordinates that the system does not have are refused by name."""
    with pytest.raises(InputError, match="is no position in"):
        match(tracks(), float("inf"))
