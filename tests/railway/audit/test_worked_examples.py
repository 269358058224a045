"""The worked examples keep every rule; each rule, broken in one of them, is found with place and figures (RFL-D1)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.audit import audit
from safeloc.railway.audit.findings import Finding
from safeloc.railway.audit.vehicle import find_layout
from safeloc.railway.map.elements import Balise, Crossing, Node, TrackEdge
from safeloc.railway.map.model import Line
from safeloc.railway.map.toml_files import find_line

FIGURES = ("fig1", "fig2", "fig3")


def changed(line: str, kind: str, identity: str, **change: Any) -> Line:
    """A shipped line with one element changed, checked again as a whole."""
    whole = find_line(line)
    elements = tuple(one.model_copy(update=change) if one.id == identity else one for one in getattr(whole, kind))
    return Line(**(dict(whole) | {kind: elements}))


def without(line: str, kind: str, *identities: str) -> Line:
    """A shipped line without some elements."""
    whole = find_line(line)
    return Line(**(dict(whole) | {kind: tuple(one for one in getattr(whole, kind) if one.id not in identities)}))


def silent(line: Line) -> Line:
    """The line with telegrams that say nothing of reflectors."""
    quiet = tuple(group.model_copy(update={"telegram_reflectors": ()}) for group in line.balise_groups)
    return line.model_copy(update={"balise_groups": quiet})


@pytest.mark.parametrize("name", FIGURES)
@pytest.mark.parametrize("vehicle", [None, "metro", "desiro-br642", "freight-v90"])
def test_worked_examples_keep_every_rule(name: str, vehicle: str | None) -> None:
    """No violation and no advice, for the default figures and every shipped vehicle's."""
    layout = None if vehicle is None else find_layout(vehicle)
    assert () == audit(find_line(name), layout).findings


TELLING = LayoutConfig(tells_track=True)
OF_THE_TRACK = {"edge longer than a cycle's run", "two ways at a joint", "group before a joint"}


def test_rules_of_the_occupied_track_are_for_vehicles_that_tell_it() -> None:
    """Real networks have edges of a few metres; they hurt only a machine that counts joints."""
    asked = set(audit(find_line("fig3"), TELLING).cases) - set(audit(find_line("fig3")).cases)
    assert asked == OF_THE_TRACK


def test_every_rule_is_put_to_the_test() -> None:
    """Together the worked examples exercise all rules but those for balises without orientation, close balises and position codes."""
    tested = {rule for name in FIGURES for rule in audit(find_line(name), TELLING).cases}
    assert tested == {
        "odometry stretch",
        "function test",
        "distance from balise to reflector",
        "search begins in time",
        "view zone in range",
        "reflector after its balise",
        "neighbours told apart",
        "reflectors across tracks",
        "models on branches",
        "switch in view",
        *OF_THE_TRACK,
        "stop window",
        "standstill distance",
        "reflector in view at stop",
        "routes told apart",
    }


BROKEN: dict[str, tuple[Callable[[], Line], str, str]] = {
    "a reflector too far behind the last one": (
        lambda: changed("fig1", "edges", "103", length_mm=1_400_000),
        "odometry stretch",
        "from reflector 111 (B) to the end of the map, increasing, on 103 at 1400000 mm, km 13.400000: "
        "distance 543.000 m, must be <= 464.981 m",
    ),
    "a stretch over switches": (
        lambda: without("fig3", "reflectors", "317"),
        "odometry stretch",
        "from reflector 311 (A) to reflector 318 (D), increasing, on 310 at 50000 mm, km 30.900000: "
        "distance 643.000 m, must be <= 464.731 m",
    ),
    "no balise on the way": (
        lambda: without("fig3", "balise_groups", "319"),
        "reflector after its balise",
        "reflector 315 (D), increasing: on some route no balise with a function test comes before it, on 308 at "
        "210000 mm, km 30.210000: reflectors since balise without bound, must be <= 8",
    ),
    "a telegram that is wrong by a metre": (
        lambda: changed("fig1", "reflectors", "109", position_mm=481_000),
        "distance from balise to reflector",
        "balise group 106, increasing, to reflector 109, on 103 at 400000 mm, km 12.400000: 1.000 m, must be <= 0.050 m",
    ),
    "a telegram about a reflector behind": (
        lambda: changed("fig1", "reflectors", "109", position_mm=300_000),
        "distance from balise to reflector",
        "balise group 106, increasing, to reflector 109: it is not ahead on any route, on 103 at 400000 mm, km 12.400000",
    ),
    "a search that begins too late": (
        lambda: changed("fig1", "reflectors", "109", view_from_mm=85_000).model_copy(
            update={"balise_groups": late_search()}
        ),
        "search begins in time",
        "balise group 106, increasing, to reflector 109, on 103 at 400000 mm, km 12.400000: "
        "search from 0.001 m, must be <= 0.000 m",
    ),
    "a view zone beyond the radar's range": (
        lambda: changed("fig1", "reflectors", "111", view_from_mm=200_000),
        "view zone in range",
        "reflector 111 (B), on 103 at 860000 mm, km 12.860000: view from 200.000 m, must be <= 150.000 m",
    ),
    "equal models too near": (
        lambda: changed("fig2", "reflectors", "208", model="A", position_mm=510_000),
        "neighbours told apart",
        "reflector 205 (A) and then reflector 208 (A), on 103 at 510000 mm, km 20.510000: "
        "spacing 60.000 m, must be > 60.500 m",
    ),
    "equal models with too short an odometry zone between": (
        lambda: changed("fig2", "reflectors", "208", model="C", position_mm=500_000),
        "neighbours told apart",
        "reflector 204 (C) and then reflector 208 (C), on 103 at 500000 mm, km 20.500000: "
        "spacing 140.000 m, must be > 157.050 m",
    ),
    "equal models beside parallel tracks": (
        lambda: changed("fig3", "reflectors", "315", position_mm=330_000),
        "reflectors across tracks",
        "reflector 315 (D) and reflector 312 (D) beside another track, on 302-304 at 60000 mm, km 30.360000: "
        "spacing 30.000 m, must be > 60.500 m",
    ),
    "equal models on branches": (
        lambda: changed("fig3", "reflectors", "317", model="D"),
        "models on branches",
        "behind 302: reflector 312 (D) and reflector 317 (D), on 301 at 300000 mm, km 30.300000",
    ),
    "a stop too near to its reflector": (
        lambda: changed("fig2", "stop_points", "207", position_mm=447_000, standstill_distance_mm=3_000),
        "reflector in view at stop",
        "stop point 207 with reflector 205, on 103 at 447000 mm, km 20.447000",
    ),
    "a stop elsewhere than set": (
        lambda: changed("fig2", "stop_points", "207", position_mm=442_051),
        "standstill distance",
        "stop point 207, on 103 at 442051 mm, km 20.442051: 0.051 m, must be <= 0.050 m",
    ),
    "a stop before another platform's reflector": (
        lambda: changed("fig2", "stop_points", "210", reflector="204"),
        "standstill distance",
        "stop point 210: reflector 204 is not ahead of it, on 103 at 512000 mm, km 20.512000",
    ),
    "a stop window too wide for doors": (
        lambda: changed("fig2", "stop_points", "210", window_after_mm=600),
        "stop window",
        "stop point 210, on 103 at 512000 mm, km 20.512000: window after 0.600 m, must be <= 0.500 m",
    ),
    "a stop against regular travel": (
        lambda: changed("fig2", "stop_points", "210", direction="decreasing"),
        "standstill distance",
        "stop point 210: its direction is against regular travel, on 103 at 512000 mm, km 20.512000",
    ),
    "branches that look alike": (
        lambda: changed("fig3", "reflectors", "318", model="B"),
        "models on branches",
        "behind 306: reflector 314 (B) and reflector 318 (B), on 304-306 at 300000 mm, km 30.800000",
    ),
    "an edge shorter than a cycle's run allows": (
        lambda: changed("fig3", "edges", "302-303", length_mm=9_999),
        "edge longer than a cycle's run",
        "edge 302-303, on 302-303 at 0 mm, km 30.300000: length 9.999 m, must be >= 10.000 m",
    ),
    "a group that is read behind its joint": (
        lambda: changed(
            "fig3", "balise_groups", "106", balises=(Balise(position_mm=291_000), Balise(position_mm=294_506))
        ),
        "group before a joint",
        "balise group 106 before 302, increasing, on 301 at 291000 mm, km 30.291000: to joint 5.494 m, must be >= 5.495 m",
    ),
    "routes that look alike": (
        lambda: changed("fig3", "reflectors", "318", model="B"),
        "routes told apart",
        "301 > 302-304 > 304-306 > 309 and 301 > 302-304 > 304-306 > 306-307 > 310, on 309 at 0 mm, km 30.800000: "
        "faults to confuse 0, must be > 0",
    ),
}


def late_search() -> tuple[Any, ...]:
    """Balise 106 of Fig. 1, whose telegram begins the search a millimetre behind it."""
    (group,) = find_line("fig1").balise_groups
    told = group.telegram_reflectors[0].model_copy(update={"search_from_mm": 1})
    return (group.model_copy(update={"telegram_reflectors": (told,)}),)


@pytest.mark.parametrize("broken", BROKEN)
def test_a_broken_rule_is_found(broken: str) -> None:
    """The finding names subject, place, kilometre, actual and required figure, and the line no longer holds."""
    make, rule, told = BROKEN[broken]
    report = audit(make(), TELLING)
    found = [finding for finding in report.violated if finding.rule == rule]
    assert any(told in finding.as_text() for finding in found), [finding.as_text() for finding in report.findings]
    assert report.as_data()["holds"] is False


def test_a_joint_with_three_ways_is_found() -> None:
    """The occupied track takes two edges at each end of an edge; a three-way switch is drawn as two switches."""
    joint = Line(
        name="fan",
        version="1",
        nodes=tuple(Node(id=name) for name in "abcde"),
        edges=tuple(
            TrackEdge(id=f"{one}{two}", from_node=one, to_node=two, length_mm=200_000)
            for one, two in ("ab", "bc", "bd", "be")
        ),
        crossings=(Crossing(id="x", node="b", movements=(("ab", "bc"), ("ab", "bd"), ("ab", "be"))),),
    )
    found = [one.as_text() for one in audit(joint, TELLING).violated if one.rule == "two ways at a joint"]
    assert any("b from ab to bc, bd, be, on ab at 200000 mm: ways 3, must be <= 2" in one for one in found), found


def advice(line: Line, layout: LayoutConfig | None = None) -> list[Finding]:
    """What is advised; nothing may be violated beside it."""
    report = audit(line, layout)
    assert () == report.violated
    return list(report.findings)


def test_a_switch_out_of_view_is_advice() -> None:
    """The source calls a switch in the view zone an advantage (l. 296): its absence is told, not refused."""
    (found,) = advice(changed("fig3", "reflectors", "314", view_from_mm=59_000))
    assert ("switch in view", ("RFL-12",)) == (found.rule, found.requirements)
    assert "306 before reflector 314 (B), on 304-306 at 300000 mm" in found.as_text()


def test_a_balise_without_function_test_is_advice_while_another_has_it() -> None:
    """A second balise far before its reflector resets the position but cannot test the radar."""
    whole = find_line("fig1")
    second = whole.balise_groups[0].model_copy(
        update={
            "id": "late",
            "identity": 7,
            "balises": tuple(
                one.model_copy(update={"position_mm": one.position_mm + 200_000})
                for one in whole.balise_groups[0].balises
            ),
            "telegram_reflectors": (),
        }
    )
    (found,) = advice(Line(**(dict(whole) | {"balise_groups": (*whole.balise_groups, second)})))
    assert "function test [RFL-6] balise group late with reflector 111 (B)" in found.as_text()
    assert "view from 100.000 m, must be >= 261.350 m" in found.as_text()


def test_a_reflector_without_function_test_is_a_violation() -> None:
    """Where the only balise cannot test the radar, precise positioning is never entered (RFL-6, RFL-7)."""
    line = silent(changed("fig1", "reflectors", "109", position_mm=510_000))
    assert {"reflector after its balise"} == {finding.rule for finding in audit(line).violated}


def test_too_many_reflectors_since_a_balise() -> None:
    """The limit is the vehicle's: with one reflector a balise, the second is one too many."""
    found = audit(find_line("fig1"), LayoutConfig(reflectors_per_balise=1)).violated
    assert ["violated  reflector after its balise [RFL-7] reflector 111 (B), on 103 at 860000 mm, km 12.860000: "
            "reflectors since balise 2, must be <= 1"] == [one.as_text() for one in found]  # fmt: skip


def test_a_distance_prescribed_by_the_system() -> None:
    """A variable of the system is held against the map as the telegram is (source l. 205)."""
    assert [] == advice(find_line("fig1"), LayoutConfig(prescribed_distance_mm=80_000))
    found = audit(find_line("fig1"), LayoutConfig(prescribed_distance_mm=60_000)).violated
    assert ["distance from balise to reflector"] == [one.rule for one in found]


def test_more_faults_to_withstand() -> None:
    """Figure 3 withstands no misread reflector: ADAB and ADAD, ADAD and ADCD differ in one."""
    report = audit(find_line("fig3"), LayoutConfig(route_faults_withstood=1))
    assert {"routes told apart"} == {finding.rule for finding in report.violated}
    assert 2 == len(report.violated)


def test_bare_track_is_told_as_such() -> None:
    """Without any reference every stretch is too long and no routes can be told apart."""
    bare = find_line("fig3").model_copy(update={"balise_groups": (), "reflectors": ()})
    report = audit(bare)
    assert {"odometry stretch", "routes told apart"} == {finding.rule for finding in report.violated}
    assert 10 == sum(finding.rule == "routes told apart" for finding in report.violated)
