"""A line that contradicts itself is refused, and every contradiction is named."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from pydantic import ValidationError

from safeloc.railway.map.elements import (
    AxleCounter,
    Balise,
    BaliseGroup,
    Crossing,
    DetectionSection,
    Fibre,
    FibrePoint,
    KilometrePoint,
    LocalizationSection,
    Node,
    ReflectingPoint,
    SpeedLimit,
    Stretch,
    Switch,
    TelegramReflector,
    TrackEdge,
    Tunnel,
    VirtualSection,
)
from safeloc.railway.map.model import Line
from tests.railway.map.made import fork, group, marker, reflector, stop, straight

N = tuple(Node(id=name) for name in "abc")


def edge(name: str = "e", start: str = "a", end: str = "b", **more: Any) -> TrackEdge:
    """One metre of track."""
    return TrackEdge(id=name, from_node=start, to_node=end, length_mm=1_000, **more)


def line(**more: Any) -> Line:
    """A line of the given elements."""
    return Line(name="l", version="1", **more)


def kilometre(place: int) -> KilometrePoint:
    """A kilometre point."""
    return KilometrePoint(position_mm=place, kilometre_mm=0)


def fibre(**more: Any) -> Fibre:
    """A fibre along e0."""
    points = (FibrePoint(fibre_mm=0, edge="e0", position_mm=0), FibrePoint(fibre_mm=900, edge="e0", position_mm=800))
    figures: dict[str, Any] = {"path": (Stretch(edge="e0", from_mm=0, to_mm=800),), "map_points": points, **more}
    return Fibre(id="f", length_mm=1_000, **figures)


def section(kind: type[Any], *stretches: tuple[str, int, int], **more: Any) -> Any:
    """A section of the given kind."""
    pieces = tuple(Stretch(edge=name, from_mm=start, to_mm=end) for name, start, end in stretches)
    return kind(id="x", stretches=pieces, **more)


THREE = tuple(edge(f"e{index}", start, end) for index, (start, end) in enumerate((("a", "m"), ("m", "b"), ("m", "c"))))
NODES = (*N, Node(id="m"))
FIRST, SECOND = group(1, "e0", 5), group(2, "e0", 6)
SECTION = LocalizationSection(id="z", fibre="f", from_fibre_mm=5, to_fibre_mm=5, effect="raises")
FAR = LocalizationSection(id="z", fibre="f", from_fibre_mm=5, to_fibre_mm=5_000, effect="raises")
BACK = FibrePoint(fibre_mm=0, edge="e0", position_mm=9)
LATE = FibrePoint(fibre_mm=2_000, edge="e0", position_mm=9)

WRONG: dict[str, tuple[Callable[[], Line], str]] = {
    "one identity twice": (
        lambda: straight(1_000, reflectors=(reflector("r", "e0", 1), reflector("r", "e0", 2))),
        "reflectors: 2 elements are called 'r'",
    ),
    "one telegram identity twice": (
        lambda: straight(1_000, balise_groups=(FIRST, SECOND.model_copy(update={"identity": 1}))),
        "balise_groups: 2 groups send NID_C 0, NID_BG 1",
    ),
    "one marker identity twice": (
        lambda: straight(1_000, markers=(marker(1, "e0", 1), marker(2, "e0", 2).model_copy(update={"identity": 1}))),
        "markers: 2 markers have the identity 1, so a reading would not tell which one was passed",
    ),
    "one marker name twice": (
        lambda: straight(1_000, markers=(marker(1, "e0", 1), marker(2, "e0", 2).model_copy(update={"id": "m1"}))),
        "markers: 2 elements are called 'm1'",
    ),
    "a marker beside no track": (
        lambda: straight(1_000, markers=(marker(1, "e9", 1),)),
        "marker 'm1': there is no edge 'e9'",
    ),
    "a marker beyond its edge": (
        lambda: straight(1_000, markers=(marker(1, "e0", 1_001),)),
        "marker 'm1': 1001 mm lies beyond edge 'e0' of 1000 mm",
    ),
    "no such node": (lambda: line(nodes=N[:1], edges=(edge(),)), "edge 'e': there is no node 'b'"),
    "an edge in a ring": (
        lambda: line(nodes=N[:1], edges=(edge(end="a"),)),
        "edge 'e': begins and ends at node 'a'; put a node in between",
    ),
    "a lonely node": (lambda: line(nodes=N, edges=(edge(),)), "node 'c': no edge ends there"),
    "three edges and no switch": (
        lambda: line(nodes=NODES, edges=THREE),
        "node 'm': 3 edges meet without a switch or crossing",
    ),
    "a buffer stop within the track": (
        lambda: line(nodes=(N[0], Node(id="b", kind="buffer_stop"), N[2]), edges=(edge(), edge("f", "b", "c"))),
        "node 'b': is a buffer_stop and must end one edge, not 2",
    ),
    "two switches at one node": (
        lambda: line(
            nodes=NODES,
            edges=THREE,
            switches=tuple(Switch(id=name, node="m", stem="e0", left="e1", right="e2") for name in "st"),
        ),
        "node 'm': belongs to 2 switches or crossings; it may belong to one",
    ),
    "a switch of two edges": (
        lambda: line(nodes=NODES, edges=THREE, switches=(Switch(id="s", node="m", stem="e0", left="e1", right="e1"),)),
        "switch 's': stem, left and right must be three edges, not e0, e1, e1",
    ),
    "a switch elsewhere": (
        lambda: line(nodes=NODES, edges=THREE, switches=(Switch(id="s", node="a", stem="e0", left="e1", right="e2"),)),
        "switch 's': joins e0, e1, e2, but at node 'a' meet: e0",
    ),
    "a crossing that leaves an edge out": (
        lambda: line(nodes=NODES, edges=THREE, crossings=(Crossing(id="x", node="m", movements=(("e0", "e1"),)),)),
        "crossing 'x': moves between e0, e1, but at node meet: e0, e1, e2",
    ),
    "a movement to where one comes from": (
        lambda: line(
            nodes=NODES,
            edges=THREE,
            crossings=(Crossing(id="x", node="m", movements=(("e0", "e0"), ("e1", "e2"))),),
        ),
        "crossing 'x': a movement must be between two edges",
    ),
    "kilometres out of order": (
        lambda: line(nodes=N[:2], edges=(edge(kilometres=(kilometre(0), kilometre(0))),)),
        "edge 'e': kilometre points must be in order of position",
    ),
    "kilometres from nowhere": (
        lambda: line(nodes=N[:2], edges=(edge(kilometres=(kilometre(5),)),)),
        "edge 'e': the first kilometre point must be at position 0",
    ),
    "kilometres beyond the edge": (
        lambda: line(nodes=N[:2], edges=(edge(kilometres=(kilometre(0), kilometre(5_000))),)),
        "edge 'e': a kilometre point lies beyond its length 1000 mm",
    ),
    "beyond the edge": (
        lambda: straight(1_000, reflectors=(reflector("r", "e0", 1_001),)),
        "reflector 'r': 1001 mm lies beyond edge 'e0' of 1000 mm",
    ),
    "no such edge": (
        lambda: straight(1_000, balise_groups=(group(1, "nowhere", 5),)),
        "balise group 'g1': there is no edge 'nowhere'",
    ),
    "an empty tunnel": (
        lambda: straight(1_000, tunnels=(section(Tunnel, ("e0", 5, 5)),)),
        "tunnel 'x': from_mm 5 must lie before to_mm 5",
    ),
    "a speed limit beyond the edge": (
        lambda: straight(1_000, speed_limits=(SpeedLimit(edge="e0", from_mm=0, to_mm=2_000, max_speed_mm_s=5),)),
        "speed limit on 'e0': 2000 mm lies beyond edge 'e0' of 1000 mm",
    ),
    "balises out of order": (
        lambda: straight(1_000, balise_groups=(group(1, "e0", 5, 9, 7),)),
        "balise group 'g1': its balises must lie in the order of their numbers",
    ),
    "a direction against the balises": (
        lambda: straight(1_000, balise_groups=(group(1, "e0", 5, 9, nominal_direction="decreasing"),)),
        "balise group 'g1': nominal_direction contradicts the order of its balises",
    ),
    "an unlinked single balise": (
        lambda: straight(1_000, balise_groups=(group(1, "e0", 5, linked=False),)),
        "balise group 'g1': an unlinked group has at least two balises",
    ),
    "a stop without reflector": (
        lambda: straight(1_000, stop_points=(stop("p", "e0", 1, "r"),)),
        "stop point 'p': there is no 'r' among reflectors",
    ),
    "a telegram about nothing": (
        lambda: straight(
            1_000,
            balise_groups=(
                BaliseGroup(
                    id="g1",
                    edge="e0",
                    identity=1,
                    balises=(Balise(position_mm=5),),
                    telegram_reflectors=(TelegramReflector(direction="increasing", reflector="r", distance_mm=5),),
                ),
            ),
        ),
        "balise group 'g1': there is no 'r' among reflectors",
    ),
    "a duplicate of nothing": (
        lambda: straight(1_000, balise_groups=(group(1, "e0", 5, duplicate_of="g2"),)),
        "balise group 'g1': there is no 'g2' among balise_groups",
    ),
    "a section without its counters": (
        lambda: straight(
            1_000,
            axle_counters=(AxleCounter(id="a", edge="e0", position_mm=1),),
            detection_sections=(section(DetectionSection, ("e0", 0, 9), axle_counters=("a", "b")),),
        ),
        "detection section 'x': there is no 'b' among axle_counters",
    ),
    "a virtual section of nothing": (
        lambda: straight(1_000, virtual_sections=(section(VirtualSection, ("e0", 0, 9), detection_section="d"),)),
        "virtual section 'x': there is no 'd' among detection_sections",
    ),
    "a section of no fibre": (
        lambda: straight(1_000, localization_sections=(FAR,)),
        "localization section 'z': there is no 'f' among fibres",
    ),
    "an empty localization section": (
        lambda: straight(1_000, fibres=(fibre(),), localization_sections=(SECTION,)),
        "localization section 'z': from_fibre_mm must lie before to_fibre_mm",
    ),
    "a localization section beyond the fibre": (
        lambda: straight(1_000, fibres=(fibre(),), localization_sections=(FAR,)),
        "localization section 'z': lies beyond the end of fibre 'f'",
    ),
    "map points out of order": (
        lambda: straight(1_000, fibres=(fibre(map_points=(BACK, BACK)),)),
        "fibre 'f': map points must be in order of the cable",
    ),
    "a map point beyond the fibre": (
        lambda: straight(1_000, fibres=(fibre(map_points=(BACK, LATE)),)),
        "fibre 'f': a map point lies beyond its length 1000 mm",
    ),
    "a map point off the path": (
        lambda: straight(1_000, fibres=(fibre(path=(Stretch(edge="e0", from_mm=700, to_mm=0),)),)),
        "fibre 'f': its path does not lead by 800 mm on edge 'e0'",
    ),
    "a reflecting point beyond the fibre": (
        lambda: straight(1_000, fibres=(fibre(reflecting_points=(ReflectingPoint(id="p", fibre_mm=2_000),)),)),
        "fibre 'f': a reflecting point lies beyond its length 1000 mm",
    ),
    "an empty piece of fibre path": (
        lambda: straight(1_000, fibres=(fibre(path=(Stretch(edge="e0", from_mm=5, to_mm=5),)),)),
        "fibre 'f': a stretch of its path is empty",
    ),
    "a fibre off the edge": (
        lambda: straight(1_000, fibres=(fibre(path=(Stretch(edge="e0", from_mm=2_000, to_mm=5),)),)),
        "fibre 'f': 2000 mm lies beyond edge 'e0' of 1000 mm",
    ),
    "a view zone the wrong way": (
        lambda: straight(1_000, reflectors=(reflector("r", "e0", 5, view_to_mm=100_000),)),
        "reflector 'r': its view zone begins 100000 mm before it and must end nearer to it, not 100000 mm before it",
    ),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_contradictions_are_refused(wrong: str) -> None:
    """A line with this one contradiction is refused, and told what it is."""
    make, told = WRONG[wrong]
    with pytest.raises(ValidationError) as refused:
        make()
    assert told in str(refused.value).replace("\n", " ")


def test_every_contradiction_is_told() -> None:
    """Two contradictions are both in the message, and a great number is counted."""
    many = tuple(reflector(f"r{index}", "nowhere", 1) for index in range(12))
    with pytest.raises(ValidationError, match=r"'r0'.*'r9'.*and 2 more") as refused:
        straight(1_000, reflectors=many)
    assert "'r10'" not in str(refused.value).splitlines()[1]


def test_a_part_may_speak_of_another_part() -> None:
    """References across parts are checked when the parts are put together, not before."""
    part = straight(1_000, stop_points=(stop("p", "e0", 1, "elsewhere"),), part="west")
    assert "elsewhere" == part.stop_points[0].reflector


def test_sound_lines_are_accepted() -> None:
    """A straight line, a fork and a fibre against the edge contradict nothing."""
    backwards = fibre(path=(Stretch(edge="e0", from_mm=800, to_mm=0),))
    assert "f" == straight(1_000, fibres=(backwards,)).fibres[0].id
    assert "s" == fork(stem_mm=5, left_mm=5, right_mm=5).switches[0].id
