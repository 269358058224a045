"""Lines as TOML and JSON: what is written is what is read, and what does not fit is named with line and key."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.errors import InputError
from safeloc.railway.audit.vehicle import find_layout
from safeloc.railway.map.model import sealed
from safeloc.railway.map.toml_files import find_line, from_json, from_toml, load_line, shipped_lines, to_toml
from safeloc.runtime.toml_place import line_of
from tests.railway.map.made import marker, straight

TEXT = """# a line
name = "l"
version = "1"

[[nodes]]
id = "a"

[[nodes]]
id = "b"

[[edges]]
id = "e"
from_node = "a"
to_node = "b"
length_mm = 1_000
kilometres = [{ kilometre_mm = 5 }]

[[edges.kilometres]]
"""
SOUND = TEXT.removesuffix("\n[[edges.kilometres]]\n") + "\n"


@pytest.mark.parametrize("name", ["fig1", "fig2", "fig3"])
def test_shipped_lines_come_back_as_written(name: str) -> None:
    """Written and read again, a worked example is the same line, sealed or not."""
    line = find_line(name)
    assert line == from_toml(to_toml(line), name)
    assert sealed(line) == from_toml(to_toml(sealed(line)), name)
    assert line == from_json(line.model_dump_json(), name)


def test_markers_come_back_as_written() -> None:
    """With a figure of their own, and without."""
    line = straight(1_000, markers=(marker(1, "e0", 5), marker(2, "e0", 900, None)))
    assert line == from_toml(to_toml(line), "l")
    assert line == from_json(line.model_dump_json(), "l")


def test_shipped_lines_are_the_worked_examples() -> None:
    """Figures 1 to 3 ship."""
    assert {"fig1", "fig2", "fig3"} <= set(shipped_lines())


WRONG = {
    "not TOML": (SOUND + "length_mm = \n", r"^l\.toml: not TOML: .*line 18"),
    "a missing key": (SOUND.replace('from_node = "a"\n', ""), r"^l\.toml:11: edges\.0\.from_node: Field required\.$"),
    "an unknown key": (
        SOUND.replace("length_mm", "lenght_mm = 5\nlength_mm"),
        r"^l\.toml:15: edges\.0\.lenght_mm: Extra inputs are not permitted \(got 5\)\.$",
    ),
    "a wrong type": (
        SOUND.replace("1_000", '"1 km"'),
        r"^l\.toml:15: edges\.0\.length_mm: Input should be a valid integer \(got '1 km'\)\.$",
    ),
    "a wrong value in a table": (
        SOUND.replace("kilometre_mm = 5", 'kilometre_mm = 5, direction = "up"'),
        r"^l\.toml:16: edges\.0\.kilometres\.0\.direction: Input should be 'increasing' or 'decreasing' \(got 'up'\)\.$",
    ),
    "two mistakes": (
        SOUND.replace("1_000", "-1").replace('version = "1"', "version = 1"),
        r"^l\.toml:3: version: Input should be a valid string \(got 1\)\. \(1 more\)$",
    ),
    "a contradiction": (
        SOUND.replace('to_node = "b"', 'to_node = "c"'),
        r"^l\.toml:14: edge 'e': there is no node 'c'; l\.toml:8: node 'b': no edge ends there\.$",
    ),
    "a checksum of something else": (
        SOUND.replace('version = "1"', f'version = "1"\nchecksum = "sha256:{"0" * 64}"'),
        r"^l\.toml:4: checksum is sha256:0+, but the content has sha256:\w+: do not use it\.$",
    ),
    "one id twice": (
        SOUND + '[[nodes]]\nid = "b"\n',
        r"^l\.toml:19: nodes: 2 elements are called 'b' \(l\.toml:19, l\.toml:9\)\.$",
    ),
    "one identity of two markers": (
        SOUND
        + '[[markers]]\nid = "m"\nedge = "e"\nposition_mm = 5\nidentity = 7\n'
        + '[[markers]]\nid = "n"\nedge = "e"\nposition_mm = 6\nidentity = 7\n',
        r"^l\.toml:27: markers: 2 markers have the identity 7, .* \(l\.toml:27, l\.toml:22\)\.$",
    ),
    "an element beyond its edge": (
        SOUND + '[[markers]]\nid = "m"\nedge = "e"\nposition_mm = 5_000\nidentity = 7\n',
        r"^l\.toml:21: marker 'm': 5000 mm lies beyond edge 'e' of 1000 mm\.$",
    ),
    "a reference to nothing": (
        SOUND
        + '[[virtual_sections]]\nid = "v"\ndetection_section = "d"\n'
        + "[[virtual_sections.stretches]]\n"
        + 'edge = "e"\nfrom_mm = 9\nto_mm = 9\n',
        r"^l\.toml:21: virtual section 'v': from_mm 9 must lie before to_mm 9; l\.toml:20: virtual section 'v': there is no 'd' "
        r"among detection_sections\.$",
    ),
    "a marker without an identity": (
        SOUND + '[[markers]]\nid = "m"\nedge = "e"\nposition_mm = 5\n',
        r"^l\.toml:18: markers\.0\.identity: Field required\.$",
    ),
    "a marker that no reader can tell": (
        SOUND + '[[markers]]\nid = "m"\nedge = "e"\nposition_mm = 5\nidentity = 0\n',
        r"^l\.toml:22: markers\.0\.identity: Input should be greater than or equal to 1 \(got 0\)\.$",
    ),
    "infinity": (
        SOUND.replace("length_mm", "geometry = { points = [[0, 0], [inf, 0]] }\nlength_mm"),
        r"^l\.toml:15: edges\.0\.geometry\.points\.1\.0: Input should be a finite number \(got inf\)\.$",
    ),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_what_does_not_fit_is_named(wrong: str) -> None:
    """File, line, key, what is wrong and what was given."""
    text, told = WRONG[wrong]
    with pytest.raises(InputError, match=told):
        from_toml(text, "l.toml")


def test_the_sound_text_is_a_line() -> None:
    """The text that the mistakes are made in has none."""
    assert 5 == from_toml(SOUND, "l.toml").edges[0].kilometres[0].kilometre_mm


def test_json_mistakes_are_named() -> None:
    """JSON has keys but no lines to tell, unless it is no JSON at all."""
    with pytest.raises(InputError, match=r"^l\.json: name: Field required\. \(3 more\)$"):
        from_json("{}", "l.json")
    twice = from_toml(SOUND, "l").model_dump_json().replace('"id":"b"', '"id":"a"').replace('"b"', '"a"')
    with pytest.raises(
        InputError, match=r"^l\.json: nodes: 2 elements are called 'a'; edge 'e': begins and ends at node"
    ):
        from_json(twice, "l.json")
    with pytest.raises(InputError, match=r"^l\.json:1: not JSON: "):
        from_json("{", "l.json")
    with pytest.raises(InputError, match=r"^l\.json: a line is a table of keys, not list\.$"):
        from_json("[]", "l.json")
    with pytest.raises(InputError, match=r"^l\.json: key 'name' is given twice\.$"):
        from_json('{"name": "a", "name": "b"}', "l.json")


def test_files_are_found_or_not(tmp_path: Path) -> None:
    """A name is a shipped line or a file; anything else is told what there is."""
    path = tmp_path / "own.toml"
    path.write_text(to_toml(straight(5)), encoding="utf-8")
    assert straight(5) == find_line(str(path)) == load_line(path)
    with pytest.raises(InputError, match=r"shipped are .*valley\. Did you mean 'valley'\?$"):
        find_line("valey")
    with pytest.raises(InputError, match=r"^nowhere: no such file, and no shipped line; shipped are fig1, fig2, fig3"):
        find_line("nowhere")
    with pytest.raises(InputError, match="a folder, not a file"):
        load_line(tmp_path)


def test_lines_of_nested_tables() -> None:
    """`[[edges.kilometres]]` belongs to the edge before it; what is not there is found at what holds it."""
    text = (
        "[[edges]]\nid = 1\n[[edges]]\nid = 2\n[[edges.kilometres]]\nx = 1\n[[edges.kilometres]]\nx = 2\n[end]\ny = 1\n"
    )
    assert [2, 4, 3, 8, 7, 10] == [
        line_of(text, path)
        for path in (
            ("edges", 0, "id"),
            ("edges", 1, "id"),
            ("edges", 1, "nothing"),
            ("edges", 1, "kilometres", 1, "x"),
            ("edges", 1, "kilometres", 1, "z"),
            ("end", "y"),
        )
    ]
    assert 1 == line_of(text, ("absent",))


def test_lines_of_arrays_and_quoted_names() -> None:
    """An entry of an array has the line where it begins; brackets in comments and strings are none, and rows no headers."""
    text = (
        "[areas.\"west:1\"]\nm = [\n  [0, 5], # x, [\n  ['a]'],\n  # nothing\n\n  [5,\n   6],\n]\n"
        "q = [1, 2]\nk = [\n  1,\n  2]\nz = 3\n"
    )
    places: tuple[tuple[str | int, ...], ...] = (
        (),
        ("m", 0),
        ("m", 1),
        ("m", 2),
        ("m", 2, 1),
        ("m", 3),
        ("q", 1),
        ("k", 1),
        ("z",),
    )
    assert [2, 3] == [line_of('a = 1\nb.c = 5\nb."d.e".f = 6\n', one) for one in (("b", "c"), ("b", "d.e", "f"))]
    assert [1, 3, 4, 7, 8, 2, 10, 13, 14] == [line_of(text, ("areas", "west:1", *one)) for one in places]


@pytest.mark.parametrize("depth", [150, 900, 100_000])
@pytest.mark.parametrize("name", ["deep.toml", "deep.json"])
def test_deep_nesting(tmp_path: Path, name: str, depth: int) -> None:
    """Refused with the file's name, however deep; as a vehicle, too."""
    left = "a = " if name == "deep.toml" else '{"a": '
    text = left + "[" * depth + "]" * depth + ("" if name == "deep.toml" else "}")
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    for read in (load_line, lambda path: find_layout(str(path))):
        with pytest.raises(InputError, match=f"{name}.*"):
            read(path)
