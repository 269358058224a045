"""Parts of a map fit together again, and a part that does not fit is refused (RFL-4)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from pydantic import ValidationError

from safeloc.errors import InputError
from safeloc.railway.audit import audit
from safeloc.railway.map.elements import (
    AxleCounter,
    DetectionSection,
    Fibre,
    FibrePoint,
    KilometrePoint,
    LocalizationSection,
    SpeedLimit,
    Stretch,
    TelegramReflector,
    Tunnel,
)
from safeloc.railway.map.model import Line, sealed
from safeloc.railway.map.parts import LinePart, PartialMap, cut
from safeloc.railway.map.toml_files import find_line
from tests.railway.map.made import group, marker, reflector, stop, straight

NAMES = {"e0": "west", "e1": "middle", "e2": "east"}


def whole() -> Line:
    """Three kilometres with something in every part, and a tunnel, a section and a telegram over the seams."""
    edges = straight(1_000_000, 1_000_000, 1_000_000).edges
    counted = tuple(
        edge.model_copy(update={"kilometres": (KilometrePoint(kilometre_mm=1_000_000 * index),)})
        for index, edge in enumerate(edges)
    )
    fibre = Fibre(
        id="f",
        length_mm=900,
        path=(Stretch(edge="e2", from_mm=0, to_mm=800),),
        map_points=(
            FibrePoint(fibre_mm=0, edge="e2", position_mm=0),
            FibrePoint(fibre_mm=900, edge="e2", position_mm=800),
        ),
    )
    line = straight(
        1_000_000,
        1_000_000,
        1_000_000,
        balise_groups=(group(1, "e0", 5), group(2, "e2", 5)),
        reflectors=(reflector("r", "e1", 4_000),),
        markers=(marker(1, "e0", 7), marker(2, "e2", 7)),
        stop_points=(stop("p", "e0", 996_000, "r"),),
        axle_counters=(AxleCounter(id="a", edge="e1", position_mm=1),),
        detection_sections=(DetectionSection(id="d", axle_counters=("a",), stretches=(stretch("e0"), stretch("e1"))),),
        tunnels=(Tunnel(id="t", stretches=(stretch("e1"), stretch("e2"))),),
        fibres=(fibre,),
        localization_sections=(
            LocalizationSection(id="z", fibre="f", from_fibre_mm=5, to_fibre_mm=9, effect="lowers"),
        ),
        speed_limits=(SpeedLimit(edge="e1", from_mm=0, to_mm=9, max_speed_mm_s=5),),
    )
    return line.model_copy(update={"edges": counted})


def stretch(edge: str) -> Stretch:
    """A piece of an edge."""
    return Stretch(edge=edge, from_mm=0, to_mm=1_000)


def three() -> tuple[LinePart, LinePart, LinePart]:
    """The line in three parts, from west to east."""
    parts = {part.part: part for part in cut(whole(), NAMES, ["n1", "n2"])}
    return parts["west"], parts["middle"], parts["east"]


def changed(old: LinePart, **change: Any) -> LinePart:
    """Another part, with a checksum of its own."""
    new = sealed(old.model_copy(update={"checksum": None, **change}))
    return LinePart(**dict(new))


def contents(line: Line) -> dict[str, Any]:
    """What a line holds, whatever the order of elements and of a section's stretches."""
    kinds = {name: value for name, value in line if isinstance(value, tuple)}
    return {name: sorted(map(in_order, value), key=repr) for name, value in kinds.items()}


def in_order(element: Any) -> Any:
    """A section with its stretches in order; anything else as it is."""
    if not hasattr(element, "stretches"):
        return element
    return element.model_copy(update={"stretches": tuple(sorted(element.stretches, key=repr))})


def test_parts_become_the_whole_again() -> None:
    """Put together in any order, the parts are the line that was cut."""
    west, middle, east = three()
    for order in ((west, middle, east), (east, west, middle)):
        assembled = PartialMap(order).line
        assert contents(whole()) == contents(assembled)
        assert ("straight", "1", "") == (assembled.name, assembled.version, assembled.part)


def test_parts_are_loaded_along_the_way() -> None:
    """While a seam is open the map is a part itself; what lies behind is dropped."""
    west, middle, east = three()
    board = PartialMap((west,)).with_part(middle)
    assert ("west+middle", {"e0", "e1"}) == (board.line.part, {edge.id for edge in board.line.edges})
    board = board.with_part(east).without("west")
    assert {"e1", "e2"} == {edge.id for edge in board.line.edges}
    assert {"n1": "seam", "n2": "track"} == {n.id: n.kind for n in board.line.nodes if n.id in ("n1", "n2")}


def test_a_part_holds_what_lies_on_it() -> None:
    """Objects go with their edge, sections are split at the seam."""
    west, middle, east = three()
    assert ["g1", "p"] == [west.balise_groups[0].id, west.stop_points[0].id]
    assert [("e0",), ("e1",)] == [
        tuple(s.edge for s in part.detection_sections[0].stretches) for part in (west, middle)
    ]
    assert ((), ("f",)) == (middle.fibres, tuple(one.id for one in east.fibres))
    assert ["seam", "seam"] == [node.kind for node in middle.nodes]


def test_the_audit_knows_seams() -> None:
    """In a part, a balise may lie behind the seam."""
    _, middle, _ = three()
    rules = {finding.rule for finding in audit(middle).findings}
    assert "reflector after its balise" not in rules
    assert "reflector after its balise" in {finding.rule for finding in audit(whole()).findings}


def test_the_audit_of_a_part_does_not_judge_what_lies_beyond() -> None:
    """A stop point and a telegram whose reflector is on the next part: nothing is known, nothing is found."""
    west, _, _ = three()
    told = TelegramReflector(direction="increasing", reflector="r", distance_mm=1_003_995)
    west = changed(west, balise_groups=(west.balise_groups[0].model_copy(update={"telegram_reflectors": (told,)}),))
    report = audit(west)
    assert {"standstill distance", "distance from balise to reflector"}.isdisjoint(report.cases)
    assert {"odometry stretch"} == {finding.rule for finding in report.findings}


def kilometre_off(part: LinePart) -> LinePart:
    """The part counted one metre off."""
    edge = part.edges[0].model_copy(update={"kilometres": (KilometrePoint(kilometre_mm=1_001_000),)})
    return changed(part, edges=(edge,))


def head_on(part: LinePart) -> LinePart:
    """The part run the other way."""
    return changed(part, edges=(part.edges[0].model_copy(update={"travel": "decreasing"}),))


def moved(part: LinePart) -> LinePart:
    """The part with its seams somewhere else."""
    return changed(part, nodes=tuple(one.model_copy(update={"latitude_deg": 1.0}) for one in part.nodes))


def no_seam(part: LinePart) -> LinePart:
    """The part with plain ends."""
    return changed(part, nodes=tuple(one.model_copy(update={"kind": "track"}) for one in part.nodes))


def renumbered(part: LinePart) -> LinePart:
    """The part with a balise group that the west has as well."""
    return changed(part, balise_groups=(group(1, "e1", 5),))


def resectioned(part: LinePart) -> LinePart:
    """The part with other counters for the common section."""
    section = part.detection_sections[0].model_copy(update={"axle_counters": ("a", "b")})
    return changed(part, detection_sections=(section,))


UNFIT: dict[str, tuple[Callable[[LinePart], LinePart], str]] = {
    "version": (
        lambda part: changed(part, version="2"),
        r"^part 'middle' belongs to 'straight' version '2', the map on board is 'straight' version '1'; the part is refused\.$",
    ),
    "name": (lambda part: changed(part, name="other"), r"^part 'middle' belongs to 'other' version '1'"),
    "checksum": (
        lambda part: part.model_copy(update={"source": "changed on the way"}),
        r"^part 'middle': checksum is sha256:\w+, its content has sha256:\w+; the part is refused\.$",
    ),
    "loaded twice": (lambda part: changed(part, part="west"), r"^part 'west' is on board already; the part is refused"),
    "kilometre": (
        kilometre_off,
        r"^parts 'west' and 'middle' share node 'n1' at different kilometres, \('', 1000000\) and \('', 1001000\)",
    ),
    "direction": (head_on, r"share node 'n1', where the regular directions of travel meet head-on"),
    "coordinates": (moved, r"share node 'n1' at different coordinates"),
    "no seam": (no_seam, r"share node 'n1', which must be a seam in both"),
    "identity": (renumbered, r"^parts west, middle do not fit together: balise_groups: 2 elements are called 'g1'"),
    "section": (resectioned, r"^detection_sections 'd' differs between parts; the part is refused\.$"),
}


@pytest.mark.parametrize("unfit", UNFIT)
def test_a_part_that_does_not_fit_is_refused(unfit: str) -> None:
    """Version, checksum, seams and identities; the map on board stays as it was."""
    spoil, told = UNFIT[unfit]
    west, middle, _ = three()
    board = PartialMap((west,))
    with pytest.raises(InputError, match=told):
        board.with_part(spoil(middle))
    assert {"e0"} == {edge.id for edge in board.line.edges}
    assert {"e0", "e1"} == {edge.id for edge in board.with_part(middle).line.edges}


def test_dangling_references_show_when_the_map_is_whole() -> None:
    """A stop point whose reflector no part brings is refused with the last part."""
    west, middle, east = three()
    board = PartialMap((west, changed(middle, reflectors=())))
    with pytest.raises(InputError, match="stop point 'p': there is no 'r' among reflectors"):
        board.with_part(east)


def test_a_part_needs_name_and_checksum() -> None:
    """A part without either is none."""
    with pytest.raises(ValidationError, match="part: a part of a map needs a name of its own"):
        LinePart(**dict(sealed(straight(5))))
    with pytest.raises(ValidationError, match="checksum: a part of a map needs one"):
        LinePart(**dict(straight(5, part="west")))


def test_an_empty_map_is_none() -> None:
    """There is no map without parts, and no part of an unknown name to drop."""
    with pytest.raises(InputError, match="at least one part"):
        PartialMap(())
    with pytest.raises(InputError, match=r"^there is no part 'east'; on board are west\.$"):
        PartialMap(three()[:1]).without("east")


def test_cuts_that_cannot_be() -> None:
    """At a switch, at an end, without a name, and through a fibre."""
    with pytest.raises(
        InputError, match=r"^node '304': a line is cut where two edges meet without a switch; 3 meet\.$"
    ):
        cut(find_line("fig3"), {}, ["304"])
    with pytest.raises(InputError, match=r"^node 'n0': .*; 1 meet\.$"):
        cut(whole(), NAMES, ["n0"])
    with pytest.raises(InputError, match=r"^the part with edge 'e1' is given 0 names; give it one\.$"):
        cut(whole(), {"e0": "west"}, ["n1"])
    fibre = whole().fibres[0].model_copy(update={"path": (stretch("e1"), stretch("e2"))})
    with pytest.raises(InputError, match=r"^fibre 'f' runs over a seam; cut the line where no fibre continues\.$"):
        cut(whole().model_copy(update={"fibres": (fibre,)}), NAMES, ["n1", "n2"])
