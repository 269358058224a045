"""railML 3: what is carried over, exactly; what is not, by name; what is wrong, with identity and line."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import pytest

from safeloc.errors import EngineError, InputError
from safeloc.railway.map.elements import AxleCounter, Balise, KilometrePoint, Signal, SpeedLimit, Stretch, Switch
from safeloc.railway.map.imports.notes import Note
from safeloc.railway.map.imports.railml import read_railml
from tests.railway.map.imports.documents import RAILML, STATION, Read, changed, line_of


def test_topology(railml: Read) -> None:
    """Three net elements meet in a switch that has the name and the sides of the document; the ends are told."""
    line = railml(STATION).line
    assert [("a", 1_000_250), ("b", 400_000), ("c", 499_700)] == [(edge.id, edge.length_mm) for edge in line.edges]
    assert (Switch(id="w1", node="w1", stem="a", left="b", right="c"),) == line.switches
    kinds = {node.id: node.kind for node in line.nodes}
    assert {"a begin": "border", "w1": "track", "b end": "buffer_stop", "c begin": "track"} == kinds


def test_kilometres_and_tracks(railml: Read) -> None:
    """Kilometres in km become mm, rising or falling along the edge; a track names the edges it runs over."""
    a, b, c = railml(STATION).line.edges
    assert (KilometrePoint(kilometre_mm=10_000_000, line="km"),) == a.kilometres
    assert () == b.kilometres
    assert (KilometrePoint(kilometre_mm=11_500_000, direction="decreasing", line="km"),) == c.kilometres
    assert ["1", "1", ""] == [edge.track for edge in (a, b, c)]


def test_balise_groups(railml: Read) -> None:
    """Balises lie in the order of their numbers; a single one has the direction that the kilometres tell."""
    two, one = railml(STATION).line.balise_groups
    assert (426, 139, True) == (two.country, two.identity, two.linked)
    assert (Balise(position_mm=100_000), Balise(position_mm=97_000)) == two.balises
    assert "decreasing" == two.orientation
    assert (Balise(position_mm=249_850),) == one.balises
    assert "decreasing" == one.orientation  # nominal is along rising kilometres, and those fall along c


def test_what_stands_along_the_track(railml: Read) -> None:
    """Signals by kilometre, axle counters by metre, tunnels over two edges, speed limits rounded down."""
    line = railml(STATION).line
    assert (Signal(id="s1", edge="a", position_mm=950_000, direction="increasing", kind="main"),) == line.signals
    assert (AxleCounter(id="ac1", edge="b", position_mm=12_345),) == line.axle_counters
    (tunnel,) = line.tunnels
    assert (
        Stretch(edge="a", from_mm=900_000, to_mm=1_000_250),
        Stretch(edge="b", from_mm=0, to_mm=50_500),
    ) == tunnel.stretches
    limit = SpeedLimit(edge="b", from_mm=0, to_mm=400_000, max_speed_mm_s=27_777, direction="increasing")
    assert (limit,) == line.speed_limits


def test_a_whole_document_leaves_only_these_notes(railml: Read) -> None:
    """Nothing else is lost: attributes without a place, and an end of track of which nothing is told."""
    found = railml(STATION).notes
    assert {"assumed", "not carried over"} == {note.kind for note in found}
    assert [
        "netElement 'c': track ends without a buffer stop or an open border",
        "linearPositioningSystem 'km' line 6: attribute 'startMeasure'",
        "linearPositioningSystem 'km' line 6: attribute 'endMeasure'",
        "linearPositioningSystem 'km' line 6: attribute 'linearReferencingMethod'",
        "border 'bo1' line 74: attribute 'type'",
        "switchIS 'w1' line 105: attribute 'type'",
        "switchIS 'w1' line 105: attribute 'continueCourse'",
        "switchIS 'w1' line 105: attribute 'branchCourse'",
        "track 'tr1' line 112: attribute 'type'",
        "name line 113: attribute 'language'",
    ] == [f"{note.place}: {note.text}" for note in found]


def test_lengths_are_exact_decimals(railml: Read) -> None:
    """A length that binary fractions cannot hold is exact; what is no whole mm is rounded and said to be."""
    exact = railml(changed('length="400"', 'length="400.001"').replace('pos="400"', 'pos="400.001"'))
    assert 400_001 == exact.line.edges[1].length_mm
    assert [] == [note for note in exact.notes if note.kind == "rounded"]
    rounded = railml(changed('pos="12.345"', 'pos="12.34551"'))
    assert 12_346 == rounded.line.axle_counters[0].position_mm
    assert ["position to the nearest mm"] == [note.text for note in rounded.notes if note.kind == "rounded"]


def test_the_length_of_a_track_counts_for_its_net_element(railml: Read) -> None:
    """Where the net element has none and is the whole track; of a longer track it tells nothing."""
    document = changed('<netElement id="b" length="400"/>', '<netElement id="b"/>')
    own = '<track id="tr2" type="mainTrack"><linearLocation><associatedNetElement netElementRef="b"/></linearLocation>'
    own += '<length type="physical" value="400.5"/></track></tracks>'
    line, notes = railml(changed('pos="400"', 'pos="400.5"', changed("</tracks>", own, document)))
    assert 400_500 == line.edges[1].length_mm
    told = f"its length is that of its track, line {line_of('</tracks>')}"
    assert Note("assumed", "netElement 'b' line 25", told) in notes


# ------------------------------------------------------------------ what is not carried over

NOTED: Mapping[str, tuple[str, str, Note]] = {
    "an unknown element": (
        "<balises>",
        '<hyperloops><tube id="x"/></hyperloops><balises>',
        Note("not understood", "hyperloops line 55", "element hyperloops"),
    ),
    "an element of another namespace": (
        "<bufferStops>",
        '<x:thing xmlns:x="urn:x"/><bufferStops>',
        Note("not understood", "thing line 78", "element thing of 'urn:x'"),
    ),
    "an unknown attribute": (
        'id="ac1" type',
        'id="ac1" colour="red" type',
        Note("not understood", "trainDetectionElement 'ac1' line 120", "attribute 'colour'"),
    ),
    "members of a known list": (
        "<balises>",
        '<stoppingPlaces><stoppingPlace id="sp1"/><stoppingPlace id="sp2"/></stoppingPlaces><balises>',
        Note("not carried over", "stoppingPlace 'sp2' line 55", "stoppingPlace: the map has no place for it"),
    ),
    "another detector": (
        'type="axleCounter"',
        'type="trackCircuit"',
        Note(
            "not carried over", "trainDetectionElement 'ac1' line 120", "train detection element of type trackCircuit"
        ),
    ),
    "a one-way relation": (
        'id="ab" navigability="Both"',
        'id="ab" navigability="AB"',
        Note("not carried over", "netRelation 'ab' line 38", "one way only; the map allows both ways"),
    ),
    "a signal for no direction": (
        'netElementRef="a" applicationDirection="normal">',
        'netElementRef="a">',
        Note("not carried over", "signalIS 's1' line 90", "signal without applicationDirection"),
    ),
    "a switch whose sides are not told": (
        '<leftBranch netRelationRef="ab"/>',
        "",
        Note(
            "not carried over",
            "netRelation 'ab' line 38",
            "which branch is left is not known; the switch is a crossing",
        ),
    ),
    "kilometres that do not fit": (
        'measure="11.00025"',
        'measure="11.5"',
        Note(
            "doubtful",
            "netElement 'a' line 13",
            "1500.0 m of kilometres on 1000.250 m of track; counted from its lower end on",
        ),
    ),
    "coordinates that contradict each other": (
        'netElementRef="b" pos="12.345"',
        'netElementRef="b" pos="12.345" intrinsicCoord="0.5"',
        Note(
            "doubtful",
            "trainDetectionElement 'ac1' line 120: spotLocation line 121",
            "its coordinates are more than 1 m apart (12.345 m, 200.0 m); the first is taken",
        ),
    ),
    "directions that contradict each other": (
        'id="bg2_l" netElementRef="c"',
        'id="bg2_l" applicationDirection="normal" netElementRef="c"',
        Note(
            "doubtful", "baliseGroup 'bg2' line 68", "mileageDirection against applicationDirection; taken as unknown"
        ),
    ),
    "an order against the direction": (
        'mileageDirection="reverse"',
        'mileageDirection="nominal"',
        Note("doubtful", "baliseGroup 'bg1' line 64", "order of its balises against its direction; the order is taken"),
    ),
    "balises that lie elsewhere than their group": (
        'id="bg1_l" netElementRef="a" pos="100.000"',
        'id="bg1_l" netElementRef="a" pos="200.000"',
        Note(
            "doubtful",
            "baliseGroup 'bg1' line 64",
            "balise number 1 lies at 100000 mm, the group at 200000 mm; the balise is taken",
        ),
    ),
    "a missing balise": (
        'numberInGroup="2"',
        'numberInGroup="3"',
        Note("doubtful", "baliseGroup 'bg1' line 64", "numbers of its balises are [1, 3]; their order is taken"),
    ),
    "no micro level": (
        'descriptionLevel="Micro"',
        'descriptionLevel="Macro"',
        Note(
            "assumed",
            "infrastructure 'is' line 10",
            "no network names the micro level; taken are all net elements that are no collection of others",
        ),
    ),
    "an untold link": (
        'groupID="140" isLinked="true"',
        'groupID="140"',
        Note("assumed", "baliseGroup 'bg2' line 68", "linked: the document does not say"),
    ),
    "an unlinked single balise": (
        'groupID="140" isLinked="true"',
        'groupID="140" isLinked="false"',
        Note("not carried over", "baliseGroup 'bg2' line 68", "unlinked group of which one balise is known"),
    ),
    "balises whose places are not told": (
        '<baliseGroup id="bg2"',
        '<baliseGroup id="bg2" numberOfBalisesInGroup="3"',
        Note("not carried over", "baliseGroup 'bg2' line 68", "numberOfBalisesInGroup 3: places of 1 are known"),
    ),
    "reactions to a missed group": (
        'groupID="140"',
        'groupID="140" linkReactionNominal="trainTrip"',
        Note("not carried over", "isEurobaliseGroup line 70", "attribute 'linkReactionNominal'"),
    ),
    "a second place": (
        '<spotLocation id="ac1_l"',
        '<spotLocation id="ac1_m" netElementRef="b" pos="1"/><spotLocation id="ac1_l"',
        Note("not carried over", "trainDetectionElement 'ac1' line 120", "2 spot locations"),
    ),
    "a buffer stop in the middle": (
        '<spotLocation id="bu1_l" netElementRef="b" pos="400"/>',
        '<spotLocation id="bu1_l" netElementRef="b" pos="300"/>',
        Note("not carried over", "bufferStop 'bu1' line 79", "does not stand where the track ends"),
    ),
}


@pytest.mark.parametrize("case", NOTED)
def test_what_is_not_carried_over_is_noted(railml: Read, case: str) -> None:
    """Each with element, identity and line."""
    old, new, note = NOTED[case]
    assert note in railml(changed(old, new)).notes


def test_net_elements_of_coarser_levels_stay_behind(railml: Read) -> None:
    """Only the micro level is a map; what lies on another level is noted, not refused."""
    macro = '<netElement id="station"><elementCollectionUnordered/></netElement></netElements>'
    document = changed("</netElements>", macro)
    document = changed('id="ac1_l" netElementRef="b" pos="12.345"', 'id="ac1_l" netElementRef="station"', document)
    line, notes = railml(document)
    assert ["a", "b", "c"] == [edge.id for edge in line.edges]
    assert () == line.axle_counters
    texts = [note.text for note in notes]
    assert {"net element of a coarser level", "place on a coarser level"} < set(texts)


def test_a_signal_for_both_directions_is_two(railml: Read) -> None:
    """The map's signals are for one direction."""
    line, notes = railml(
        changed('netElementRef="a" applicationDirection="normal">', 'netElementRef="a" applicationDirection="both">')
    )
    assert [("s1 increasing", "increasing"), ("s1 decreasing", "decreasing")] == [
        (one.id, one.direction) for one in line.signals
    ]
    assert "applies to both directions; carried over as two signals" in [note.text for note in notes]


# ------------------------------------------------------------------ what is refused

REFUSED: Mapping[str, tuple[str, str, str]] = {
    "a relation to no element": (
        '<elementA ref="b"/><elementB ref="c"/>',
        '<elementA ref="b"/><elementB ref="q"/>',
        "netRelation 'bc' line 44: elementB: there is no netElement 'q'.",
    ),
    "a net element that names no relation": (
        '<relation ref="ab"/>',
        '<relation ref="zz"/>',
        "relation line 14: there is no netRelation 'zz'.",
    ),
    "a missing length": (
        '<netElement id="b" length="400"/>',
        '<netElement id="b"/>',
        "netElement 'b' line 25: has no length: no attribute 'length' above 0, no kilometres or coordinates at both ends, no track. "
        "A plan without lengths is no map: export it with lengths, or add them from the survey.",
    ),
    "a negative length": (
        '<netElement id="b" length="400"/>',
        '<netElement id="b" length="-1"/>',
        "netElement 'b' line 25: its length -1 m must be positive.",
    ),
    "a length that is no number": (
        '<netElement id="b" length="400"/>',
        '<netElement id="b" length="NaN"/>',
        "netElement 'b' line 25: length: expected a finite number, got 'NaN'.",
    ),
    "a double identity": (
        '<netElement id="b" length="400"/>',
        '<netElement id="a" length="400"/>',
        "netElement 'a' line 25: the identity was given in line 13 already.",
    ),
    "an end that is none": (
        'id="ac" navigability="Both" positionOnA="1" positionOnB="1"',
        'id="ac" navigability="Both" positionOnA="1" positionOnB="2"',
        "netRelation 'ac' line 41: positionOnB must be 0 or 1, not '2'.",
    ),
    "an unknown unit": (
        'id="km" units="km"',
        'id="km" units="mi"',
        "linearPositioningSystem 'km' line 6: units 'mi' are not known; use m or km.",
    ),
    "a length of nothing": (
        '<netElement id="b" length="400"/>',
        '<netElement id="b" length="0"/>',
        "netElement 'b' line 25: has no length: no attribute 'length' above 0, no kilometres or coordinates at both ends, no track. "
        "A plan without lengths is no map: export it with lengths, or add them from the survey.",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_wrong_input_is_refused(railml: Read, tmp_path: Path, case: str) -> None:
    """With file, element, identity and line."""
    old, new, message = REFUSED[case]
    with pytest.raises(InputError) as refused:
        railml(changed(old, new))
    assert f"{tmp_path / 'station.railml'}: {message}" == str(refused.value)


LEFT_OUT: Mapping[str, tuple[str, str, Note]] = {
    "a place on no element": (
        'id="ac1_l" netElementRef="b"',
        'id="ac1_l" netElementRef="q"',
        Note("refused", "trainDetectionElement 'ac1' line 120", "spotLocation line 121: there is no netElement 'q'"),
    ),
    "a place off its element": (
        'pos="12.345"',
        'pos="400.001"',
        Note(
            "refused",
            "trainDetectionElement 'ac1' line 120",
            "spotLocation line 121: 400.001 m lies outside net element 'b' of 400 m",
        ),
    ),
    "no place at all": (
        'netElementRef="b" pos="12.345"',
        'netElementRef="b"',
        Note(
            "refused",
            "trainDetectionElement 'ac1' line 120",
            "spotLocation line 121: gives neither pos, nor intrinsicCoord, nor a linearCoordinate",
        ),
    ),
    "a switch without its relation": (
        '<rightBranch netRelationRef="ac"/>',
        '<rightBranch netRelationRef="zz"/>',
        Note("refused", "switchIS 'w1' line 105", "rightBranch line 108: there is no netRelation 'zz'"),
    ),
    "two balises of one number": (
        'numberInGroup="2"',
        'numberInGroup="1"',
        Note("refused", "baliseGroup 'bg1' line 64", "two of its balises have the same number; numbers are [1, 1]"),
    ),
    "a balise of no group": (
        'id="bg1_2" belongsToBaliseGroup="bg1"',
        'id="bg1_2" belongsToBaliseGroup="bg9"',
        Note("refused", "balise 'bg1_2' line 56", "there is no balise group 'bg9'"),
    ),
    "an unknown kilometre line": (
        '<linearCoordinate positioningSystemRef="km" measure="10.95"/>',
        '<linearCoordinate positioningSystemRef="mi" measure="10.95"/>',
        Note("refused", "signalIS 's1' line 90", "linearCoordinate line 92: there is no linearPositioningSystem 'mi'"),
    ),
    "an identity beyond NID_BG": (
        'groupID="140"',
        'groupID="20000"',
        Note(
            "refused",
            "baliseGroup 'bg2' line 68",
            "field identity: Input should be less than or equal to 16383 (got 20000)",
        ),
    ),
    "a truth value that is none": (
        'groupID="140" isLinked="true"',
        'groupID="140" isLinked="perhaps"',
        Note(
            "refused",
            "baliseGroup 'bg2' line 68",
            "isEurobaliseGroup line 70: isLinked must be true or false, not 'perhaps'",
        ),
    ),
    "an intrinsic coordinate beyond the end": (
        'netElementRef="c" intrinsicCoord="0.5"',
        'netElementRef="c" intrinsicCoord="1.5"',
        Note(
            "refused", "baliseGroup 'bg2' line 68", "spotLocation 'bg2_l' line 69: intrinsicCoord 1.5 is outside 0..1"
        ),
    ),
}


@pytest.mark.parametrize("case", LEFT_OUT)
def test_wrong_objects_along_the_track_are_left_out_and_told(railml: Read, case: str) -> None:
    """One bad place refuses its element and not the map; everything else is as before."""
    old, new, note = LEFT_OUT[case]
    line, notes = railml(changed(old, new))
    assert [note] == [one for one in notes if one.kind == "refused"]
    whole, kinds = railml(STATION).line, ("balise_groups", "signals", "axle_counters", "switches", "tunnels", "edges")
    fewer = {kind for kind in kinds if len(getattr(line, kind)) < len(getattr(whole, kind))}
    assert len(fewer) == (0 if case == "a balise of no group" else 1), fewer


def test_a_ring_of_one_edge_is_refused(railml: Read) -> None:
    """The map needs a node in between; the message says so."""
    document = changed('<elementA ref="b"/><elementB ref="c"/>', '<elementA ref="b"/><elementB ref="b"/>')
    document = changed('id="bc" navigability="None"', 'id="bc" navigability="Both"', document)
    with pytest.raises(InputError, match=r"'ab' line 38: both ends of edge 'b' meet at one node; divide it into two"):
        railml(document)


@pytest.mark.parametrize(
    ("document", "message"),
    [
        (
            '<railml xmlns="https://www.railml.org/schemas/2021"/>',
            "expected a railML 3.1 to 3.3 document, got <railml>",
        ),
        ('<railML xmlns="https://www.railml.org/schemas/4.0"/>', "expected a railML 3.1 to 3.3 document"),
        ("<railML/>", "expected a railML 3.1 to 3.3 document, got <railML> of ''"),
        (f"{RAILML}</railML>", "the document has no infrastructure."),
        (f"{RAILML}<infrastructure/></railML>", "topology/netElements holds no net element"),
        (f"{RAILML}<infrastructure>", "not well-formed XML"),
        ("", "not well-formed XML"),
        ("no XML", "not well-formed XML"),
    ],
)
def test_other_documents_are_refused(railml: Read, document: str, message: str) -> None:
    """railML 2, other things, and nothing at all."""
    with pytest.raises(InputError, match=re.escape(message)):
        railml(document)


def test_an_unreadable_file_is_refused(tmp_path: Path) -> None:
    """A folder or a missing file is named."""
    with pytest.raises(InputError, match=f"^{re.escape(str(tmp_path / 'none.xml'))}: cannot be read: No such file"):
        read_railml(tmp_path / "none.xml")


# ------------------------------------------------------------------ attacks

LAUGHS = "".join(f'<!ENTITY l{n} "{f"&l{n - 1};" * 10}">' for n in range(1, 10))
DOCTYPES = {
    "external entity": '<!DOCTYPE railML [<!ENTITY x SYSTEM "file:///etc/passwd">]>',
    "external document type": '<!DOCTYPE railML SYSTEM "http://localhost:1/railml.dtd">',
    "parameter entity": '<!DOCTYPE railML [<!ENTITY % p SYSTEM "http://localhost:1/p"> %p;]>',
    "a billion laughs": f'<!DOCTYPE railML [<!ENTITY l0 "ha">{LAUGHS}]>',
    "empty document type": "<!DOCTYPE railML>",
}


@pytest.mark.parametrize("attack", DOCTYPES)
@pytest.mark.parametrize("entity", ["l9", "x"])
def test_document_types_are_refused_before_anything_is_expanded(
    railml: Read, tmp_path: Path, attack: str, entity: str
) -> None:
    """Whatever the document type declares and wherever the entity is used."""
    document = changed('<name name="1"', f'<name name="&{entity};"')
    document = changed(RAILML, f"{DOCTYPES[attack]}\n{RAILML}", document)
    with pytest.raises(InputError) as refused:
        railml(document)
    told = "has a document type; none is needed, and entities are refused. Remove the <!DOCTYPE ...>."
    assert re.fullmatch(f"{re.escape(str(tmp_path / 'station.railml'))}:2: {re.escape(told)}", str(refused.value))


def test_an_undeclared_entity_is_refused(railml: Read) -> None:
    """Without a document type there is no entity either."""
    with pytest.raises(InputError, match="not well-formed XML"):
        railml(changed('<name name="1"', '<name name="&x;"'))


def test_the_prolog_is_read_in_any_encoding(tmp_path: Path) -> None:
    """UTF-16 does not hide a document type, and is read where there is none."""
    path = tmp_path / "station.railml"
    path.write_bytes(STATION.replace("UTF-8", "UTF-16").encode("utf-16"))
    assert 3 == len(read_railml(path).line.edges)
    path.write_bytes(changed(RAILML, f"<!DOCTYPE railML>{RAILML}").replace("UTF-8", "UTF-16").encode("utf-16"))
    with pytest.raises(InputError, match="has a document type"):
        read_railml(path)


def test_without_lxml_the_remedy_is_told(railml: Read, monkeypatch: pytest.MonkeyPatch) -> None:
    """The heavy libraries are an extra."""
    monkeypatch.setitem(__import__("sys").modules, "lxml", None)
    with pytest.raises(EngineError, match=r"^reading railML needs lxml; install safeloc\[geo\]\.$"):
        railml(STATION)


def test_name_and_version(railml: Read, tmp_path: Path) -> None:
    """By default the file's name and "1"; else what the caller says."""
    line = railml(STATION).line
    assert ("station", "1", "station.railml") == (line.name, line.version, line.source)
    named = read_railml(tmp_path / "station.railml", name="Here", version="2026-1").line
    assert ("Here", "2026-1") == (named.name, named.version)


def test_lines_in_these_tests_are_right() -> None:
    """The line numbers above are those of the document."""
    assert (120, 13) == (line_of('<trainDetectionElement id="ac1"'), line_of('<netElement id="a"'))
