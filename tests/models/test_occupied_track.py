"""Which track the vehicle is on: what is carried over switches, what ends a track, and what the host is told."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from safeloc.catalogue import load_target
from safeloc.errors import InputError
from safeloc.models.occupied_track import OccupiedTrackConfig
from safeloc.models.occupied_track.look_up import LookUp
from safeloc.models.occupied_track.simulate import RUNS, drawn
from safeloc.proof.provers.replayed_evidence import admissible_run
from safeloc.railway.map.elements import TrackEdge
from safeloc.railway.map.model import Line
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Topology
from safeloc.runtime.streams.steps import read_steps
from tests.models.track_board import Board

BRANCHES = {"302-304", "302-303"}


def on_both() -> Board:
    """A vehicle 30 m behind switch 302, at coordinate 300 m; it may be on either branch."""
    board = Board()
    board.start()
    for place in (200_000, 295_000, 330_000):
        told = board.at(place)
    assert told == ("", BRANCHES)
    return board


# ------------------------------------------------------------------ beginning


def test_nothing_is_told_before_a_start() -> None:
    """A position alone names no track."""
    assert Board().at(100_000) == ("NO_START", set())


def test_a_start_tells_its_track() -> None:
    """In the same cycle, with the place on the edge."""
    board = Board()
    assert board.start(place_mm=100_000) == ("301", {"301"})
    outputs = board.outputs
    assert (outputs["position_mm"], outputs["margin_below_mm"], outputs["margin_above_mm"]) == (100_000, 10_000, 10_000)


def test_a_start_off_its_own_edge_begins_nothing() -> None:
    """The whole interval lies beyond the edge that the start names."""
    assert Board().start(place_mm=311_000) == ("NO_START", set())
    assert Board().start(place_mm=310_000) == ("301", {"301"})


# ------------------------------------------------------------------ over a facing switch


def test_both_branches_are_carried_and_none_is_told() -> None:
    """Before the switch one edge, over it three, behind it two; the one coordinate would hold on either."""
    board = Board()
    board.start()
    assert board.at(290_000) == ("301", {"301"})
    assert board.at(290_001) == ("", {"301", *BRANCHES})
    assert board.at(310_000) == ("", {"301", *BRANCHES})
    assert board.at(310_001) == ("", BRANCHES)
    assert board.outputs["position_mm"] < -(10**9)


def test_a_group_tells_the_branch() -> None:
    """The group stands on one branch, and the interval meets the place that it gives."""
    board = on_both()
    assert board.at(340_000, board.group("302-304", 40_000)) == ("302-304", {"302-304"})
    assert board.at(345_000) == ("302-304", {"302-304"})


def test_a_group_out_of_reach_contradicts() -> None:
    """It stands on a branch that is carried, but 12 m before what the interval and its own error allow is the limit."""
    assert on_both().at(340_000, Board().group("302-304", 28_000)) == ("302-304", {"302-304"})
    assert on_both().at(340_000, Board().group("302-304", 27_999)) == ("CONTRADICTION", set())


def test_a_group_elsewhere_contradicts() -> None:
    """No carried track has it: nothing is told until the next start, whatever the position does."""
    board = on_both()
    assert board.at(340_000, board.group("308", 100_000)) == ("CONTRADICTION", set())
    assert board.at(341_000, board.group("302-304", 41_000)) == ("CONTRADICTION", set())
    assert board.start("302-304", 300_000, 50_000) == ("302-304", {"302-304"})


@pytest.mark.parametrize(("course", "edge"), [("STRAIGHT", "302-304"), ("RIGHT", "302-303")])
def test_a_turn_tells_the_branch(course: str, edge: str) -> None:
    """The map has the course of each branch at the watched switch."""
    assert on_both().at(332_000, watched="302", course_taken=course) == (edge, {edge})


def test_a_turn_at_an_unknown_switch_tells_nothing() -> None:
    """Without a course on the map both branches stay."""
    assert on_both().at(332_000, course_taken="RIGHT") == ("", BRANCHES)


def test_a_turn_that_no_branch_takes_contradicts() -> None:
    """The switch has no leg to the left."""
    assert on_both().at(332_000, watched="302", course_taken="LEFT") == ("CONTRADICTION", set())


@pytest.mark.parametrize("edge", sorted(BRANCHES))
def test_stated_points_leave_one_branch(edge: str) -> None:
    """While the vehicle may pass the switch; behind it what was entered stays, without them."""
    board = Board()
    board.start()
    board.at(290_000)
    assert board.at(300_000, points={"302": edge}) == ("", {"301", edge})
    assert board.at(311_000, points={"302": edge}) == (edge, {edge})
    assert board.at(320_000) == (edge, {edge})


def test_points_that_are_no_longer_stated_leave_both() -> None:
    """The vehicle may have been before the switch until then, and passed it since."""
    board = Board()
    board.start()
    board.at(290_000)
    board.at(300_000, points={"302": "302-303"})
    assert board.at(320_000) == ("", BRANCHES)


# ------------------------------------------------------------------ tracks that meet, part and turn back


def test_tracks_that_meet_are_one() -> None:
    """Two ways of one length lead to 305-307: it is carried once, and told when no other is possible."""
    board = on_both()
    for place in (365_000, 420_000, 495_000, 520_000):
        board.at(place)
    assert board.told == ("", {"303-305", "304-305", "304-306"})
    board.at(525_000, watched="304", course_taken="RIGHT")
    assert board.told == ("", {"303-305", "304-305"})
    board.at(555_000)
    assert board.told == ("", {"303-305", "304-305", "305-307"})
    assert board.at(565_000) == ("305-307", {"305-307"})


def test_rolling_back_over_a_trailing_switch_parts_the_tracks_again() -> None:
    """Both edges from which it is reached are possible, unless the vehicle surely did not run back."""
    board = Board()
    board.start("305-307", 550_000, 15_000)
    still = Board()
    still.start("305-307", 550_000, 15_000)
    assert still.at(555_000, surely_not_back=True) == ("305-307", {"305-307"})
    assert board.at(555_000) == ("", {"305-307", "303-305", "304-305"})
    assert board.at(535_000) == ("", {"303-305", "304-305"})


def test_a_vehicle_that_surely_does_not_run_ahead_enters_nothing() -> None:
    """The interval reaches over the switch, the vehicle does not."""
    board = Board()
    board.start()
    board.at(285_000)
    assert board.at(295_000, surely_not_ahead=True) == ("301", {"301"})


# ------------------------------------------------------------------ nothing is told


def test_more_tracks_than_are_carried_is_no_position() -> None:
    """With room for two, the two edges behind the switch and the one before it are one too many."""
    board = Board(tracks=2)
    board.start()
    assert board.at(300_000) == ("NOT_ALL_CARRIED", set())
    assert board.at(340_000, board.group("302-304", 40_000)) == ("NOT_ALL_CARRIED", set())


def test_a_map_that_leaves_a_branch_out_is_no_position() -> None:
    """The machine does not believe the offers."""
    board = Board()
    board.start()
    assert board.at(295_000, left_out="302-303") == ("NOT_ALL_CARRIED", set())


def test_a_map_that_invents_a_track_is_not_believed() -> None:
    """An offer that no carried track leads to is not taken."""
    board = Board()
    board.start()
    other = {"next_2_edge": board.number("308"), "next_2_origin_mm": 0, "next_2_length_mm": 350_000}
    assert board.at(110_000, other) == ("301", {"301"})


def test_an_entry_of_another_edge_is_no_position() -> None:
    """The joint ahead is not known, and may have been passed."""
    board = Board()
    board.start()
    board.at(285_000)
    assert board.at(288_000, track_1_of_edge=board.number("308")) == ("301", {"301"})
    assert board.at(295_000, track_1_of_edge=board.number("308")) == ("NOT_ALL_CARRIED", set())


@pytest.mark.parametrize("lost", [{"located": False}, {"front_low_mm": 120_001, "front_high_mm": 120_000}])
def test_without_a_position_nothing_is_told(lost: dict[str, int | bool]) -> None:
    """Nor when it comes back: a start is needed."""
    board = Board()
    board.start()
    assert board.at(120_000, lost) == ("NO_POSITION", set())
    assert board.at(121_000) == ("NO_POSITION", set())
    assert board.start(place_mm=130_000) == ("301", {"301"})


def test_a_start_elsewhere_contradicts() -> None:
    """It names a track that is not carried: which of both is wrong is not known."""
    board = Board()
    board.start()
    assert board.start("308", 0, 110_000) == ("CONTRADICTION", set())


# ------------------------------------------------------------------ the map


def test_edges_are_numbered_by_direction() -> None:
    """Each number is one edge in one direction, and back."""
    seen = LookUp(Topology(find_line("fig3")), OccupiedTrackConfig())
    runs = list(seen.topology.graph)
    assert len(runs) == 11
    assert [seen.run(seen.number(run)) for run in runs] == runs
    with pytest.raises(InputError, match="edge 12 is not on the map, which has 11"):
        seen.run(12)


def fig3(**changed: object) -> Topology:
    """The line with other parts."""
    return Topology(find_line("fig3").model_copy(update=changed))


def three_legs() -> Line:
    """Three edges at one node that is no switch, so a vehicle may go on along any of them."""
    line = find_line("fig3")
    edges = [TrackEdge(id=f"leg {n}", from_node="306", to_node="east-1", length_mm=50_000) for n in (1, 2)]
    return line.model_copy(
        update={"edges": (*line.edges, *edges), "switches": tuple(s for s in line.switches if s.node != "306")}
    )


def test_maps_that_the_machine_cannot_take_are_refused() -> None:
    """With the place and what to do."""
    topology = Topology(find_line("fig3"))
    with pytest.raises(InputError, match="the map has 11 edges, counted by direction; edges is 10: raise it"):
        LookUp(topology, OccupiedTrackConfig(edges=10))
    with pytest.raises(InputError, match="is 50000 mm long, not 60000 to 100000000"):
        LookUp(topology, OccupiedTrackConfig(shortest_edge_mm=60_000))
    with pytest.raises(InputError, match="a joint has two ways at most"):
        LookUp(Topology(three_legs()), OccupiedTrackConfig())


def test_an_edge_that_a_cycle_can_pass_whole_is_refused() -> None:
    """160 km/h in 0.1 s are 4.4445 m."""
    OccupiedTrackConfig(shortest_edge_mm=4_445)
    with pytest.raises(ValidationError, match="shortest_edge_mm 4444 is below 4445, which the vehicle runs in a cycle"):
        OccupiedTrackConfig(shortest_edge_mm=4_444)
    with pytest.raises(ValidationError, match="longest_edge_mm must not be below shortest_edge_mm"):
        OccupiedTrackConfig(shortest_edge_mm=20_000, longest_edge_mm=10_000)


def test_straight_on_is_the_branch_with_the_stems_track() -> None:
    """And without one, the only branch that belongs to a track."""
    topology = Topology(find_line("fig3"))
    taken = {}
    for before in topology.graph:
        for after in topology.after(before):
            passage = topology.passage(before, after)
            if passage is not None and passage.facing:
                taken[after.edge] = topology.course(passage)
    assert taken == {
        "302-304": "STRAIGHT", "302-303": "RIGHT", "304-306": "STRAIGHT", "304-305": "RIGHT", "309": "STRAIGHT", "306-307": "RIGHT",
    }  # fmt: skip


# ------------------------------------------------------------------ recordings and runs


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", RUNS)
def test_recordings_ship_as_they_are_made(name: str) -> None:
    """From the run of that name, with the figures of the defaults."""
    target = load_target("occupied_track")
    [path] = [one for one in target.streams if one.name.startswith(f"{name}.")]
    kept, made = read_steps(path), RUNS[name]
    assert [dict(step) for step in made.steps(OccupiedTrackConfig())] == [dict(step) for step in kept.steps]
    assert dict(made.first) == dict(kept.first)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("seed", range(6))
def test_drawn_runs_keep_what_is_assumed_and_never_tell_a_wrong_track(seed: int) -> None:
    """The true edge is carried in every cycle in which any is, and an edge that is told is the true one."""
    target = load_target("occupied_track")
    simulated = drawn(OccupiedTrackConfig(), seed)
    steps = [{name: cell for name, cell in step.items() if name != "truth_mm"} for step in simulated]
    trace = admissible_run(target.system, simulated.first, steps)
    told = [one for one in trace.steps if one.outputs["valid"]]
    assert told
    assert [one for one in told if one.outputs["edge"] != one.state["true_edge"]] == []
    carried = [{one.outputs[f"track_{slot}_edge"] for slot in range(1, 5)} for one in trace.steps]
    assert [
        one
        for one, edges in zip(trace.steps, carried, strict=True)
        if edges != {0} and one.state["true_edge"] not in edges
    ] == []
