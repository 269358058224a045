"""The picture of the architecture is the one that the imports give, and its page speaks of what is there."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import networkx as nx
import pytest

from safeloc.cli.commands import COMMANDS
from tests.architecture_picture import COMMAND, PICTURE, drawn
from tests.rooms import DIVIDED, ROOT, TARGETS, arrows, downward, files, heights, home, room_of, rooms, upward

PAGE = ROOT / "docs" / "architecture.md"


def test_the_committed_picture_is_the_one_of_the_imports() -> None:
    """Drawn anew it is the same, letter for letter."""
    assert drawn() == PICTURE.read_text(encoding="utf-8"), f"imports between rooms changed: run `{COMMAND}`"


def test_each_room_has_its_box_with_all_that_it_imports() -> None:
    """Also what no arrow shows, since a chain of others implies it."""
    texts = [text.text or "" for text in ET.fromstring(drawn()).iter("{http://www.w3.org/2000/svg}text")]
    said = " ".join(texts)
    graph = rooms()
    assert len(graph) > 8
    for room in graph:
        assert room in texts
        named = ", ".join(sorted(graph.successors(room))) or "nothing"
        assert f"{room} imports {named}" in said


def test_arrows_say_as_much_as_the_imports() -> None:
    """Along them one comes to the same rooms; each runs downwards, and what closes a circle stands apart."""
    graph = rooms()
    order: nx.DiGraph[str] = downward(graph)
    shown: nx.DiGraph[str] = nx.DiGraph(arrows(graph))
    height = heights(graph)
    assert {(a, b) for a in shown for b in nx.descendants(shown, a)} == {
        (a, b) for a in order for b in nx.descendants(order, a)
    }
    assert all(height[above] > height[below] for above, below in order.edges)
    assert set(graph.edges) == set(order.edges) | set(upward(graph))


def test_the_rarer_import_of_a_circle_runs_upwards() -> None:
    """It is the one to look at."""
    graph: nx.DiGraph[str] = nx.DiGraph()
    graph.add_edge("report", "language", times=9)
    graph.add_edge("language", "report", times=1)
    assert [("language", "report")] == upward(graph)
    assert {"report": 1, "language": 0} == heights(graph)


def test_only_what_closes_a_circle_runs_upwards() -> None:
    """A rare import in the direction of all others does not, although it lies on the circle."""
    graph: nx.DiGraph[str] = nx.DiGraph()
    for above, below, times in (("cli", "report", 9), ("report", "language", 8), ("cli", "language", 1)):
        graph.add_edge(above, below, times=times)
    graph.add_edge("language", "cli", times=2)
    assert [("language", "cli")] == upward(graph)


def test_rooms_are_read_from_the_folders() -> None:
    """Every folder of safeloc/ with code in it is a room; an import leads to the room of the longest known name."""
    folders = {path.name for path in (ROOT / "safeloc").iterdir() if path.is_dir() and any(path.rglob("*.py"))}
    assert "railway.map" == room_of(ROOT / "safeloc" / "railway" / "map" / "model.py")
    assert "errors" == room_of(ROOT / "safeloc" / "errors.py")
    assert folders - {DIVIDED} <= set(rooms())
    assert {room_of(path) for path in files()} == set(rooms())
    assert home("safeloc.cli.show.a", {"safeloc.cli": "cli", "safeloc.cli.show": "found"}) == "found"
    assert home("numpy.random", {"safeloc.cli": "cli"}) is None


def test_the_page_has_a_sentence_for_each_room() -> None:
    """In the table of rooms, and for no other ones."""
    named = re.findall(r"^\| `(?:safeloc/)?([\w/<>]+?)(?:/|\.py)` \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    names = [TARGETS if name == "models/<machine>/target" else name.replace("/", ".") for name in named]
    assert sorted(rooms()) == sorted(names)


PAGES = ["docs/architecture.md", "docs/glossary.md", "CONTRIBUTING.md"]
DECISIONS = sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "docs" / "decisions").glob("*.md"))


def test_every_page_of_decisions_is_in_the_index() -> None:
    """With what it decides about."""
    index = (ROOT / "docs" / "decisions" / "README.md").read_text(encoding="utf-8")
    named = re.findall(r"^\| \[.+\]\((\w+\.md)\) \| .+ \|$", index, re.MULTILINE)
    assert sorted({Path(page).name for page in DECISIONS} - {"README.md"}) == sorted(named)


@pytest.mark.parametrize("page", [*PAGES, *DECISIONS])
def test_every_path_that_is_named_is_there(page: str) -> None:
    """Files and folders in backquotes, from the repository's root; and the targets of links, from the page."""
    text = (ROOT / page).read_text(encoding="utf-8")
    tops = "safeloc|models|properties|tests|docs|benchmarks"
    paths = re.findall(rf"`((?:{tops})/[\w./-]*)`", text)
    links = re.findall(r"\]\((?!http|#)([^)#]+)", text)
    missing = [path for path in paths if not (ROOT / path).exists()]
    assert [] == missing + [link for link in links if not ((ROOT / page).parent / link).exists()]


def test_the_commands_that_contributing_names_are_there() -> None:
    """Targets of make, commands of safeloc, modules and test files."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    lines = "\n".join(re.findall(r"^```\n(.*?)^```", text, re.MULTILINE | re.DOTALL))
    targets = re.findall(r"^make (\S+)", lines, re.MULTILINE)
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8").replace("$(READY)", ".venv/ready")
    assert len(targets) > 3
    assert [] == [one for one in targets if not re.search(rf"^[\w -]*{re.escape(one)}\b.*:", makefile, re.MULTILINE)]
    used = re.findall(r"^safeloc (\w+)", lines, re.MULTILINE)
    assert {"prove", "verify"} <= set(used) <= set(COMMANDS)
    modules = set(re.findall(r"^python -m (tests\S+)", lines, re.MULTILINE))
    assert {COMMAND.removeprefix("python -m ")} == modules
    assert all((ROOT / path).is_file() for path in re.findall(r"tests/\S+\.py", text))
