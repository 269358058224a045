"""`safeloc docs`: what is installed beside the program, by name."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import pytest

from safeloc.cli import docs as docs_module
from safeloc.cli.docs import folder, pages, title
from tests.cli.calling import Call

DOCS = Path(__file__).parents[2] / "docs"


def test_every_page_and_example_is_listed(call: Call) -> None:
    """With its title; pictures are found, but not listed."""
    listed = call("docs").out.splitlines()
    rows = {row["name"]: row["title"] for row in json.loads(call("docs", "--json").out)}
    assert listed == [f"{name}  {words}" for name, words in rows.items()]
    assert rows["language"] == "Writing a machine"
    assert rows["decisions"]
    assert "examples/beacons.py" in rows
    assert {path.relative_to(DOCS).with_suffix("").as_posix() for path in DOCS.glob("*.md")} <= set(rows)
    assert not any(name.endswith(".svg") for name in rows)
    assert [name for name, words in rows.items() if name.rpartition(".")[2] != "jsonl" and not words.strip()] == []


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("language", "language.md"),
        ("language.md", "language.md"),
        ("docs/localizer.md#a-source-of-your-own", "localizer.md"),
        ("decisions", "decisions/README.md"),
        ("docs/decisions/", "decisions/README.md"),
        ("decisions/proof", "decisions/proof.md"),
        ("examples/beacons.py", "examples/beacons.py"),
        ("odometry.svg", "odometry.svg"),
    ],
)
def test_a_page_by_its_name(call: Call, name: str, file: str) -> None:
    """As listed, or as a link to it is written; the path alone is printed, for a pager or an editor."""
    called = call("docs", name)
    assert (called.code, called.out) == (0, f"{DOCS / file}\n")
    assert json.loads(call("docs", name, "--json").out) == {"name": name, "path": str(DOCS / file)}


def test_pages_lead_nowhere_that_is_not_installed() -> None:
    """Their folder is all that an install has of them; only the page for developers leads to the sources."""
    found = {(page.name, link) for page in DOCS.rglob("*.md") for link in links_out_of_the_folder(page)}
    assert {("architecture.md", "../CONTRIBUTING.md")} == found


def links_out_of_the_folder(page: Path) -> list[str]:
    """The files outside of the documentation to which a page links."""
    links = re.findall(r"\]\(([^)#\s]+)", page.read_text(encoding="utf-8"))
    places = [os.path.normpath(page.parent / link) for link in links if "://" not in link]
    return [os.path.relpath(place, DOCS) for place in places if not Path(place).is_relative_to(DOCS)]


def test_the_text_of_a_page(call: Call) -> None:
    """`--print` gives it in place of the path, for whoever reads in the terminal; it is of one page."""
    assert (DOCS / "tutorial.md").read_text(encoding="utf-8") == call("docs", "tutorial", "--print").out
    assert 2 == call("docs", "--print").code == call("docs", "tutorial", "--print", "--json").code


def test_the_readme_is_no_page(call: Call) -> None:
    """It is the description of the package; whoever asks for it wants to begin."""
    assert "there is no page 'README'; `safeloc docs` lists all. Begin with the tutorial." in call("docs", "README").err


@pytest.mark.parametrize(("name", "meant"), [("langage", "language"), ("decisions/prof", "decisions/proof")])
def test_a_wrong_name_is_refused(call: Call, name: str, meant: str) -> None:
    """With the nearest one."""
    called = call("docs", name)
    assert called.code == 2
    assert f"there is no page {name!r}; `safeloc docs` lists all. Did you mean {meant!r}?" in called.err


def test_without_documentation_there_is_an_error(call: Call, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A folder `docs` of somebody else beside the package is not taken for it."""
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "index.md").write_text("# Other\n", encoding="utf-8")
    monkeypatch.setattr(docs_module, "_PACKAGE", tmp_path / "safeloc")
    called = call("docs")
    assert called.code == 2
    assert "the documentation is missing; install safeloc again" in called.err


def test_names_are_those_of_the_files() -> None:
    """No two files have one name; each title is a heading or a first line."""
    found = pages(folder())
    assert len(found) == len([path for path in DOCS.rglob("*") if path.is_file() and "__pycache__" not in path.parts])
    assert title(DOCS / "examples" / "beacons.py")
    assert not re.search('[#"]', title(DOCS / "language.md"))
