"""Markers on lines: near enough on every route and in both directions, read one by one, and not too many under one vehicle."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.layout_rules.marker_readers import MarkerReaders
from safeloc.railway.audit import audit
from safeloc.railway.audit.findings import Finding
from safeloc.railway.map.elements import Marker, Node, TrackEdge
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import Place
from safeloc.railway.map.routes import Route, through_routes
from safeloc.railway.map.topology import Topology
from tests.railway.map.made import fork, group, marker, straight
from tests.railway.map.random_lines import lines

EXACT = MarkerReaders(
    vehicle_length_tolerance_mm=0, reader_latency_ms=0, measuring_step_mm=0, max_speed_mm_s=10, period_ms=100
)
"""Readers without errors of their own, of a vehicle that measures 1 mm in a cycle."""
READS = LayoutConfig(markers=MarkerReaders())


def found(line: Line, layout: LayoutConfig = READS) -> list[str]:
    """Violated rules, in words."""
    return [_told(finding) for finding in audit(line, layout).violated]


def _told(finding: Finding) -> str:
    assert finding.figures is not None
    return f"{finding.subject}: {finding.figures.actual} {finding.figures.relation} {finding.figures.required}"


def every(
    distance_mm: int, number: int, travel: str = "increasing", accuracy_mm: int = 0, lead_mm: int = 100_000
) -> Line:
    """A straight track with so many markers, one every so far, and as much track before the first as behind the last."""
    places = [lead_mm + index * distance_mm for index in range(number)]
    markers = tuple(marker(index, "e0", place, accuracy_mm) for index, place in enumerate(places, 1))
    return straight(places[-1] + lead_mm, travel=travel, markers=markers)


@pytest.mark.parametrize(
    ("length_mm", "farthest_mm"),
    [(204_700, 674_699), (30_000, 499_999), (469_999, 939_998), (400_000, 869_999), (500_000, 469_999)],
)
@pytest.mark.parametrize("travel", ["increasing", "both"])
def test_the_longest_run_is_that_of_the_closed_form(length_mm: int, farthest_mm: int, travel: str) -> None:
    """Without errors of reading, 5 m + 5 % and 30 m keep the position for 470 m, of which a cycle's millimetre is held back: markers
    every D do where max(L, D - L) is no more, or D itself; and not 1 mm farther (MRK-D5).
    """
    layout = LayoutConfig(markers=EXACT.model_copy(update={"vehicle_length_mm": length_mm}))
    assert [] == found(every(farthest_mm, 4, travel), layout)
    assert found(every(farthest_mm + 1, 4, travel), layout)


def test_the_figures_of_reading_come_off() -> None:
    """Accuracy, length tolerance, latency and a cycle's distance: what is told is what is to be mended."""
    assert [] == found(every(647_459, 3, accuracy_mm=300))
    assert ["the trailing reading of marker m1 to marker m2", "the trailing reading of marker m2 to marker m3"] == [
        one.removeprefix("from ").split(",")[0] for one in found(every(647_460, 3, accuracy_mm=300))
    ]


def test_a_coarse_marker_is_no_reference_and_a_fine_one_carries_over_it() -> None:
    """The machine keeps the better position: a coarse marker between two fine ones that suffice does no harm, nor any good."""
    fine = every(600_000, 3, accuracy_mm=300)
    coarse = Marker(id="c", edge="e0", position_mm=400_000, identity=9, accuracy_mm=25_000)
    assert [] == found(fine.model_copy(update={"markers": (*fine.markers, coarse)}))
    alone = fine.markers[0], coarse.model_copy(update={"position_mm": 700_000}), fine.markers[2]
    assert any(
        "to marker c" in one or "to marker m3" in one for one in found(fine.model_copy(update={"markers": alone}))
    )


def test_markers_without_an_own_figure_have_the_vehicles() -> None:
    """12 m of accuracy leave less of the tolerance than 0.3 m."""
    line = every(500_000, 3, accuracy_mm=300)
    plain = tuple(one.model_copy(update={"accuracy_mm": None}) for one in line.markers)
    assert [] == found(line)
    assert found(line.model_copy(update={"markers": plain}))
    fine = LayoutConfig(markers=MarkerReaders(marker_accuracy_mm=300))
    assert [] == found(line.model_copy(update={"markers": plain}), fine)


def test_balise_groups_serve_as_markers_unless_the_readers_do_not_read_them() -> None:
    """A group is read within its location accuracy and the detection accuracy."""
    line = straight(800_000, balise_groups=(group(1, "e0", 400_000, 403_000),))
    blind = LayoutConfig(markers=MarkerReaders(groups_are_markers=False))
    assert [] == found(line)
    assert ["from the edge of the map at n0 to the end of the map, increasing: 800000 <= 469999"] == found(line, blind)
    assert ["from the edge of the map at n0 to the end of the map, increasing: 800000 <= 469981"] == found(
        line.model_copy(update={"balise_groups": ()}), LayoutConfig()
    )


def test_the_trailing_reader_reads_behind_a_switch_too() -> None:
    """A marker on the stem carries on over either branch, by the trailing reading on it."""
    line = fork(stem_mm=400_000, left_mm=560_000, right_mm=570_000, markers=(marker(1, "stem", 399_000),))
    assert ["from the trailing reading of marker m1 to the end of the map, increasing"] == [
        one.split(":")[0] for one in found(line.model_copy(update={"edges": _longer(line, "right", 653_000)}))
    ]
    assert [] == found(line)


def _longer(line: Line, edge: str, length_mm: int) -> tuple[TrackEdge, ...]:
    return tuple(one.model_copy(update={"length_mm": length_mm}) if one.id == edge else one for one in line.edges)


def test_a_loop_without_markers_has_no_bound() -> None:
    """On a ring the error grows without end; one marker carries as far as a ring may be long."""
    nodes = tuple(Node(id=name) for name in "abc")
    edges = tuple(
        TrackEdge(id=f"{one}{two}", from_node=one, to_node=two, length_mm=100_000, travel="increasing")
        for one, two in (("a", "b"), ("b", "c"), ("c", "a"))
    )
    ring = Line(name="ring", version="1", nodes=nodes, edges=edges)
    assert all("a loop without any marker" in one for one in found(ring))
    assert 3 == len(found(ring))
    assert [] == found(ring.model_copy(update={"markers": (marker(1, "ab", 1_000),)}))
    wide = tuple(edge.model_copy(update={"length_mm": 300_000}) for edge in edges)
    assert found(ring.model_copy(update={"edges": wide, "markers": (marker(1, "ab", 1_000),)}))


def test_markers_are_read_one_by_one() -> None:
    """Two that may lie in the other order, or be passed in one cycle, are too near: 2 x 0.3 m, and 4.445 m of a cycle."""
    apart = [
        straight(300_000, markers=(marker(1, "e0", 100_000), marker(2, "e0", 100_000 + spacing)))
        for spacing in (5_045, 5_046)
    ]
    assert ["marker m1 and marker m2: 5045 > 5045"] == found(apart[0])
    assert [] == found(apart[1])


def test_markers_under_the_vehicle_can_wait() -> None:
    """Four identities wait for the trailing reader; of five markers under the vehicle the first would be forgotten."""
    line = every(51_000, 5, accuracy_mm=0)
    assert ["marker m5 and those behind it, increasing: 5 <= 4"] == found(line)
    assert [] == found(line, LayoutConfig(markers=MarkerReaders(pending_markers=5)))
    assert [] == found(every(51_250, 5, accuracy_mm=0))


def test_a_vehicle_without_readers_is_not_asked() -> None:
    """The rules on markers are for vehicles that read them; those on stretches from group to reflector for the others."""
    line = every(900_000, 3)
    assert not {one for one in audit(line).cases if "marker" in one}
    assert "odometry stretch" not in audit(line, READS).cases
    assert "odometry stretch" in audit(line).cases


def test_readers_nearer_than_a_cycles_run() -> None:
    """They could pass a marker in one cycle, so that the trailing reading does not count."""
    with pytest.raises(ValueError, match="vehicle_length_mm 4000 is within the run of a cycle, 4445 mm"):
        MarkerReaders(vehicle_length_mm=4_000)
    with pytest.raises(ValueError, match="reader_latency_ms must not exceed period_ms"):
        MarkerReaders(reader_latency_ms=200)


# ------------------------------------------------------------------ against all routes

SHORT = LayoutConfig(
    tolerance_mm=12_000,
    odometry_constant_mm=1_000,
    odometry_rate_ppm=50_000,
    markers=MarkerReaders(vehicle_length_mm=70_000, marker_accuracy_mm=2_000, groups_are_markers=False),
)


def kept_for(accuracy_mm: int, held_back_mm: int) -> int:
    """The closed form, in whole numbers: the margin's parts, the longest measured distance, the least true one that is longer."""
    late = 4_459 * 120_000 + 4_459 * 6_000 + 1_500_000
    spare = 11_000 * 10**6 - (accuracy_mm + 300) * 10**6 - late
    too_long = spare // 50_000 + 1 - held_back_mm
    return (too_long * 950_000 - 1_000 * 10**6 - 1_500_000 - 1) // 10**6


def entered_for(held_back_mm: int) -> int:
    """The same from the edge of the map, which the vehicle passes with a position without any error."""
    return ((220_000 + 1 - held_back_mm) * 950_000 - 1_000 * 10**6 - 1_500_000 - 1) // 10**6


def events(route: Route) -> list[tuple[int, int, str, Marker]]:
    """Place of the leading end, order, kind and marker of every reading on this route."""
    met = [(one.position_mm, one.element) for one in route.objects() if isinstance(one.element, Marker)]
    leading = [(place, 0, "leading", one) for place, one in met]
    return sorted([*leading, *((place + 70_000, 1, "trailing", one) for place, one in met)], key=lambda one: one[:2])


def lost_at(route: Route) -> Iterator[Place]:
    """Readings, and the end of the map, that no earlier reading on this route keeps the position for."""
    along = events(route)
    for place, _, kind, one in [*along, (route.length_mm, 0, "end", None)]:
        accuracy, held_back = (0, 0) if one is None else (one.accuracy_mm or 0, 4_459)
        trailing = kind == "trailing"
        spare = [entered_for(held_back) - accuracy - 300 * trailing - place]
        for before, _, how, other in along:
            if before > place or (before == place and (how, trailing) != ("trailing", False)):
                continue
            both = (other.accuracy_mm or 0) + accuracy
            if other is one and trailing and how == "leading":
                both = 0
            apart = both + 300 * (trailing != (how == "trailing"))
            spare.append(kept_for(other.accuracy_mm or 0, held_back) - apart - (place - before))
        if max(spare) < 0 and place <= route.length_mm:
            yield route.place(place)


@st.composite
def marked(draw: st.DrawFn) -> Line:
    """A random line with markers anywhere."""
    line = draw(lines())
    made: list[Marker] = []
    for number in range(draw(st.integers(0, 12))):
        edge = draw(st.sampled_from(line.edges))
        figures: dict[str, Any] = {"accuracy_mm": draw(st.sampled_from([0, 2_000, 5_000]))}
        place = draw(st.integers(0, edge.length_mm // 1_000)) * 1_000
        made.append(Marker(id=f"m{number}", edge=edge.id, position_mm=place, identity=number + 1, **figures))
    return line.model_copy(update={"markers": tuple(made)})


def point(line: Line, place: Place) -> Place | str:
    """The place, or the node if it is the end of an edge: the end of one edge and the beginning of the next are one place."""
    [edge] = [one for one in line.edges if one.id == place.edge]
    return {0: edge.from_node, edge.length_mm: edge.to_node}.get(place.position_mm, place)


@settings(max_examples=40)
@given(marked())
@example(straight(300_000, 30_000, markers=(marker(1, "e0", 300_000, 0),)))
@example(straight(300_000, 30_000, markers=(marker(1, "e1", 0, 0),)))
def test_readings_are_those_of_all_routes(line: Line) -> None:
    """A reading is not reached by the audit exactly where on some route no earlier one keeps the position so long."""
    expected = {point(line, place) for route in through_routes(Topology(line), 10_000) for place in lost_at(route)}
    report = audit(line, SHORT)
    assert expected == {point(line, one.place) for one in report.findings if one.rule == "marker stretch"}
