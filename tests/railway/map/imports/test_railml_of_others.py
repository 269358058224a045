"""railML 3.1 as other programs export it: balises that are groups, no lengths but coordinates, plans without lengths."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from safeloc.cli.entry import app
from safeloc.errors import InputError
from safeloc.railway.guard.inputs import line_of as guarded_line
from safeloc.railway.map.elements import Balise
from safeloc.railway.map.imports.formats import SUFFIXES
from safeloc.railway.map.imports.railml import read_railml
from safeloc.railway.map.projection import Projector
from safeloc.railway.map.toml_files import find_line
from tests.railway.map.imports.documents import STATION, Read, changed

NUMBERS = '<designator register="_NID_C" entry="426"/><designator register="_NID_BG" entry="{}"/>'
ALONE = (
    '<balise id="g31" isBaliseGroup="true" baliseGroupType="fixed">'
    '<spotLocation id="g31_l" netElementRef="b" pos="150.5" applicationDirection="normal"/>'
    + NUMBERS.format(7)
    + "</balise>"
)
PARENT = (
    '<balise id="p31" isBaliseGroup="true" baliseGroupType="fixed">' + NUMBERS.format(8) + "</balise>"
    '<balise id="m1" belongsToParent="p31" positionInGroup="1"><spotLocation id="m1_l" netElementRef="b" pos="200"/></balise>'
    '<balise id="m2" belongsToParent="p31" positionInGroup="2"><spotLocation id="m2_l" netElementRef="b" pos="203"/></balise>'
)


def with_balises(more: str) -> str:
    """The station with these balises as well."""
    return changed("<balises>", f"<balises>{more}")


def test_a_balise_may_be_a_group_by_itself(railml: Read) -> None:
    """Place, identity and direction are its own; that it is linked is assumed, and said."""
    line, notes = railml(with_balises(ALONE))
    found = {group.id: group for group in line.balise_groups}["g31"]
    assert (426, 7, True, "increasing") == (found.country, found.identity, found.linked, found.orientation)
    assert (Balise(position_mm=150_500),) == found.balises
    assert "linked: the document does not say" in [note.text for note in notes if "'g31'" in note.place]


def test_balises_may_belong_to_one_that_is_the_group(railml: Read) -> None:
    """The parent holds the identity, its members the places."""
    line, _ = railml(with_balises(PARENT))
    found = {group.id: group for group in line.balise_groups}["p31"]
    assert (426, 8, "increasing") == (found.country, found.identity, found.orientation)
    assert (Balise(position_mm=200_000), Balise(position_mm=203_000)) == found.balises


def test_a_group_without_an_identity_is_noted(railml: Read) -> None:
    """No number is invented; the note says which designators would do."""
    line, notes = railml(with_balises(ALONE.replace(NUMBERS.format(7), "")))
    assert "g31" not in [group.id for group in line.balise_groups]
    [note] = [note for note in notes if note.text.startswith("no identity")]
    assert "'g31'" in note.place and "NID_C and NID_BG" in note.text


def test_a_balise_that_is_no_group_needs_one(railml: Read) -> None:
    """It is refused; the message names both ways to say it."""
    line, notes = railml(with_balises(ALONE.replace(' isBaliseGroup="true"', ' isBaliseGroup="false"')))
    [note] = [note for note in notes if note.kind == "refused"]
    assert "belongsToBaliseGroup" in note.text and "isBaliseGroup" in note.text
    assert 2 == len(line.balise_groups)


# ------------------------------------------------------------------ coordinates

SYSTEMS = (
    '<geometricPositioningSystems><geometricPositioningSystem id="utm" crsDefinition="epsg:25832"/>'
    '<geometricPositioningSystem id="wgs" crsDefinition="epsg:4326"/></geometricPositioningSystems><linearPositioningSystems>'
)


def at(*points: tuple[float, str], system: str = "utm") -> str:
    """The net element b with coordinates and without a length."""
    inner = "".join(
        f'<intrinsicCoordinate intrinsicCoord="{share}"><geometricCoordinate positioningSystemRef="{system}" {xy}/>'
        "</intrinsicCoordinate>"
        for share, xy in points
    )
    return (
        f'<netElement id="b"><associatedPositioningSystem id="b_aps">{inner}</associatedPositioningSystem></netElement>'
    )


def with_course(net_element: str) -> str:
    """The station whose net element b is given so."""
    document = changed('<netElement id="b" length="400"/>', net_element)
    return changed("<linearPositioningSystems>", SYSTEMS, document)


BENT = at((0, 'x="500000" y="5600000"'), (0.5, 'x="500300" y="5600000"'), (1, 'x="500300" y="5600100"'))


def test_coordinates_give_the_length_that_is_not_stated(railml: Read) -> None:
    """300 m and 100 m in the plane are 400 m; the course serves projections, and the note tells what was assumed."""
    line, notes = railml(with_course(BENT))
    edge = {edge.id: edge for edge in line.edges}["b"]
    assert 400_000 == edge.length_mm
    [note] = [note for note in notes if note.kind == "assumed" and "'b'" in note.place]
    assert "its length is that of straight pieces between 3 coordinates" == note.text
    assert edge.geometry is not None
    assert 150_000 == pytest.approx(
        Projector(line).project(500_150, 5_600_000, crs="EPSG:25832").place.position_mm, abs=50
    )


def test_degrees_are_measured_over_the_ellipsoid_and_heights_count(railml: Read) -> None:
    """A degree of latitude at the equator is 110.574 km; 0.01 of it, rising by 100 m, is 1110.3 m."""
    points = at((0, 'x="9" y="0" z="0"'), (1, 'x="9" y="0.01" z="100"'), system="wgs")
    document = with_course(points).replace('pos="400"', 'pos="1"')
    edge = {edge.id: edge for edge in railml(document).line.edges}["b"]
    assert (1_105_743**2 + 100_000**2) ** 0.5 == pytest.approx(edge.length_mm, abs=2)


def test_a_course_longer_than_the_stated_length_is_doubtful(railml: Read) -> None:
    """Straight pieces are the shortest way, so one of both is wrong; the stated length is taken."""
    line, notes = railml(with_course(BENT.replace('id="b"', 'id="b" length="380"')).replace('pos="400"', 'pos="380"'))
    assert 380_000 == {edge.id: edge for edge in line.edges}["b"].length_mm
    assert "380 m long, but 400.000 m by its coordinates; the former is taken" in [note.text for note in notes]


@pytest.mark.parametrize(
    ("net_element", "reason"),
    [
        (at((0, 'x="1" y="2"'), (1, 'x="1" y="9"'), system="nowhere"), "no geometricPositioningSystem"),
        (at((0, 'x="1" y="2"'), (0.5, 'x="1" y="9"')), "not given from its beginning to its end"),
    ],
)
def test_coordinates_that_tell_no_course_are_noted(railml: Read, net_element: str, reason: str) -> None:
    """The stated length is taken, and the note says what the coordinates lack."""
    line, notes = railml(with_course(net_element.replace('id="b"', 'id="b" length="400"')))
    assert 400_000 == {edge.id: edge for edge in line.edges}["b"].length_mm
    assert [True] == [reason in note.text for note in notes if "coordinates" in note.text]


def test_a_second_set_of_coordinates_is_noted(railml: Read) -> None:
    """The first set is the course."""
    both = BENT.replace(
        "</associatedPositioningSystem>",
        '<intrinsicCoordinate intrinsicCoord="0"><geometricCoordinate positioningSystemRef="wgs" x="9" y="50"/>'
        "</intrinsicCoordinate></associatedPositioningSystem>",
    )
    assert "second set of coordinates 'wgs'" in [note.text for note in railml(with_course(both)).notes]


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("epsg:25832", "epsg:xyz", r"'EPSG:XYZ' is no coordinate system; use one like EPSG:25832"),
        ("epsg:25832", "epsg:4978", r"'EPSG:4978' is neither geographic nor projected"),
        ('x="500300" y="5600000"', 'x="5e999" y="0"', r"expected a number"),
    ],
)
def test_wrong_coordinates_cost_the_course_and_not_the_length(railml: Read, old: str, new: str, reason: str) -> None:
    """With a stated length the map is as it was without coordinates; without one the net element has no length."""
    stated = with_course(BENT.replace('id="b"', 'id="b" length="400"')).replace(old, new)
    line, notes = railml(stated)
    edge = {edge.id: edge for edge in line.edges}["b"]
    assert (400_000, None) == (edge.length_mm, edge.geometry)
    [note] = [note for note in notes if note.text.startswith("its coordinates: ")]
    assert re.search(reason, note.text)
    with pytest.raises(InputError, match=r"netElement 'b' line \d+: has no length"):
        railml(with_course(BENT).replace(old, new))


def test_degrees_that_are_none_are_no_course(railml: Read) -> None:
    """A latitude of 95 degrees is nowhere."""
    points = at((0, 'x="9" y="50"'), (1, 'x="9" y="95"'), system="wgs").replace('id="b"', 'id="b" length="400"')
    line, notes = railml(with_course(points))
    assert None is {edge.id: edge for edge in line.edges}["b"].geometry
    assert [True] == ["outside EPSG:4326" in note.text for note in notes if note.text.startswith("its coordinates: ")]


def test_a_group_with_a_wrong_balise_is_left_out_as_a_whole(railml: Read) -> None:
    """A vehicle would read more balises than the map has; the note names the balise, and nothing else is said of its parts."""
    wrong = changed('netElementRef="a" pos="97.000"', 'netElementRef="a" pos="5000"')
    line, notes = railml(wrong)
    assert ["bg2"] == [group.id for group in line.balise_groups]
    [note] = [note for note in notes if "bg1" in note.place]
    assert ("refused", True) == (note.kind, "balise 'bg1_2'" in note.text)


def test_a_stated_length_of_nothing_counts_as_none(railml: Read) -> None:
    """Where the kilometres tell the length, it is theirs."""
    line, notes = railml(changed('<netElement id="c">', '<netElement id="c" length="0">'))
    assert 499_700 == {edge.id: edge for edge in line.edges}["c"].length_mm
    assert "a stated length of 0; taken is 499.7 m" in [note.text.replace("499.7000", "499.7") for note in notes]


# ------------------------------------------------------------------ at the command line


def test_refused_elements_are_told_first_and_by_the_exit_code(tmp_path: Path) -> None:
    """The map is written without them; whoever goes on at once is stopped."""
    source, out = tmp_path / "s.railml", tmp_path / "s.toml"
    source.write_text(changed('pos="12.345"', 'pos="400.001"'), encoding="utf-8")
    result = CliRunner().invoke(app, ["import", str(source), "--out", str(out)])
    assert 1 == result.exit_code
    assert result.stdout.splitlines()[0].startswith(
        "trainDetectionElement 'ac1' line 120: refused: spotLocation line 121: 400.001 m"
    )
    assert "elements refused 1" in result.stderr
    assert () == find_line(str(out)).axle_counters
    source.write_text(STATION, encoding="utf-8")
    assert 0 == CliRunner().invoke(app, ["import", str(source), "--out", str(out)]).exit_code


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_audit_says_how_to_convert_a_map(suffix: str) -> None:
    """Every suffix of a format that can be imported is known."""
    with pytest.raises(InputError, match=f"safeloc import x{suffix} --out x.toml"):
        find_line(f"x{suffix}")


def test_the_guard_takes_no_map_of_which_elements_are_wrong(tmp_path: Path) -> None:
    """Its owner decides whether it serves without them."""
    path = tmp_path / "s.railml"
    path.write_text(changed('pos="12.345"', 'pos="400.001"'), encoding="utf-8")
    with pytest.raises(InputError, match=r"1 elements are wrong and left out; the first: trainDetectionElement 'ac1'"):
        guarded_line(str(path))
    path.write_text(STATION, encoding="utf-8")
    assert read_railml(path).line == guarded_line(str(path))
