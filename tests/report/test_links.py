"""From a verdict to its evidence: certificates, runs and source lines are one click away, and every link leads to a file or a place."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.language.verdict import Held, NotAsked, Proved, Violated
from safeloc.proof.results import Finding
from safeloc.report import page as page_module
from safeloc.report.data import report_data
from safeloc.report.declared import excerpt, place
from safeloc.report.folder import render_folder, write_folder
from safeloc.report.links import anchor, linked
from safeloc.report.page import to_html, to_pages
from tests.report.test_page import door, finding, findings, opening


def proved(*texts: str) -> Proved:
    """A proof with certificates of these names."""
    return Proved(None, "1-induction", certificates={f"{text}.smt2": f"; {text}" for text in texts})


def some() -> list[Finding]:
    """Two proofs of declared properties that share a certificate, one with a run, and a violated one."""
    first, second, third = (one.name for one in door().properties[:3])
    return [
        finding(first, proved("first", "both")),
        finding(second, replace(proved("both", "second"), witness=opening())),
        finding(third, Violated(opening(), "bmc")),
    ]


def not_held() -> list[Finding]:
    """A test of a requirement whose case never occurred, and a replay that violates a property."""
    return [
        finding("never occurs", NotAsked("no case of it occurred"), "test", requirements=("MRK-D1",)),
        finding("run: bad <b>", Violated(opening(), "replay of run.jsonl"), "replay"),
    ]


def test_a_result_leads_to_its_evidence(tmp_path: Path) -> None:
    """To its own certificates, to the run in the folder of traces, and to the lines that declare it; each is there."""
    page = write_folder(tmp_path, some(), [door()]).read_text(encoding="utf-8")
    rows = dict(re.findall(r'<tr id="(r\d+)">(.*?)</tr>', page, re.DOTALL))
    [(file, names)] = re.findall(r'href="(certificates/[^"]*)">certificates ([^<]*)<', rows["r0"])
    assert (tmp_path / file).is_file()
    assert "first.smt2" == names
    assert [(file, "second.smt2")] == re.findall(r'href="(certificates/[^"]*)">certificates ([^<]*)<', rows["r1"])
    assert 'href="run.html#result=door%2Fproperty%2Fclock+at+rest">run of 3 steps</a>' in rows["r1"]
    assert re.search(r'href="#(source-door-\d+)">[^<]*door_controller\.py:\d+</a>', rows["r1"])
    assert '<a href="certificates/door.texts.xz">certificates of door</a>' in page


def test_every_link_leads_to_a_file_or_a_place(tmp_path: Path) -> None:
    """In one page, and again when it is rendered from the folder's data alone."""
    every = [*findings(), *some()[:2], *not_held()]
    first = write_folder(tmp_path, every, [door()]).read_text(encoding="utf-8")
    assert render_folder(tmp_path).read_text(encoding="utf-8") == first
    links = set(re.findall(r'href="([^"]*)"', first))
    assert any(link.startswith("run.html#") for link in links)
    for link in links:
        assert f'id="{link[1:]}"' in first if link.startswith("#") else (tmp_path / link.partition("#")[0]).is_file(), (
            link
        )
    ids = re.findall(r'<[^>]* id="([^"]*)"', first)
    assert len(ids) == len(set(ids))
    assert [f"r{at}" for at, one in enumerate(every) if one in every[-2:]] == re.findall(r'<span id="(r\d+)">', first)


def test_data_without_a_folder_have_no_links_to_files() -> None:
    """The page of `to_html` may lie anywhere."""
    assert not re.search(r'href="(?!#)', to_html(report_data(some(), [door()])))


def test_a_page_in_parts_leads_into_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each place to which a row of the page leads is in the page or in a part."""
    monkeypatch.setattr(page_module, "MOST_OF_ONE_PAGE", 0)
    data = report_data(some(), [door(), load_target("odometry")])
    pages = to_pages(data)
    page, parts = pages.page, pages.parts
    assert len(parts) > 3
    whole = to_html(data)
    links = re.findall(r'href="#([^"]*)"', page)
    assert any(f'id="{link}"' not in page for link in links)
    for link in links:
        assert f'id="{link}"' in whole


def test_a_requirement_leads_to_its_properties() -> None:
    """By the name that stands there."""
    data = report_data([finding("known", proved("a"), requirements=("MRK-D1",))], [load_target("odometry"), door()])
    assert '<a href="#r0">door: known</a> <span class="proved">proved</span>' in to_html(data)


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize(
    ("kinds", "verdict"),
    [
        ({"property": proved("a"), "test": Held("t", 1, 1), "replay": Held("r", 1, 1)}, "proved"),
        ({"test": Held("t", 1, 1), "replay": Held("r", 1, 1)}, "held"),
        ({"property": proved("a"), "replay": Violated(None, "replay")}, "violated"),
        ({"property": Violated(None, "bmc"), "test": Held("t", 1, 1)}, "violated"),
    ],
)
def test_a_requirement_is_proved_if_its_properties_are(kinds: dict[str, object], verdict: str) -> None:
    """Tests that held besides take nothing from it; anything that did not hold does, and tests alone prove nothing."""
    found = [finding("it", result, kind, ("MRK-D1",)) for kind, result in kinds.items()]  # type: ignore[arg-type]
    rows = {row["id"]: row for row in report_data(found, [load_target("odometry")])["requirements"]}
    assert rows["MRK-D1"]["verdict"] == verdict


def test_numbers_of_terms_are_links() -> None:
    """Everything else of a term is text."""
    assert linked("#3 < a & b", "term-door") == '<a href="#term-door-3">#3</a> &lt; a &amp; b'
    assert anchor("law", "odometry", "odometry/A1") == "law-odometry-odometry-A1"


# ------------------------------------------------------------------ source lines


def test_an_excerpt_is_the_declaration(tmp_path: Path) -> None:
    """From its first line to the end of the longest call that begins there, without the indent."""
    path = tmp_path / "own.py"
    path.write_text("x = 1\nrows = [\n    row(\n        f(1),\n    ),\n    last(2), more(\n    3)]\n", encoding="utf-8")
    assert excerpt(f"{path}:3") == "row(\n    f(1),\n),"
    assert excerpt(f"{path}:6") == "last(2), more(\n3)]"
    assert excerpt(f"{path}:1") == "x = 1"


def test_an_excerpt_of_a_long_declaration_ends(tmp_path: Path) -> None:
    """After sixty lines, and says how many follow."""
    path = tmp_path / "long.py"
    path.write_text("f(\n" + "1,\n" * 98 + ")\n", encoding="utf-8")
    assert excerpt(f"{path}:1").splitlines()[-1] == "... 40 more lines"
    assert len(excerpt(f"{path}:1").splitlines()) == 61


@pytest.mark.parametrize("src", ["nowhere.py:3", "<string>:1", "", "{own}:99", "{own}:x", "{broken}:1"])
def test_without_the_file_there_is_no_excerpt(tmp_path: Path, src: str) -> None:
    """The place is told all the same; no link leads to lines that are not there."""
    own, broken = tmp_path / "short.py", tmp_path / "broken.py"
    own.write_text("x = 1\n", encoding="utf-8")
    broken.write_text("x = (\n", encoding="utf-8")
    assert excerpt(src.format(own=own, broken=broken)) == ""


def test_a_place_names_no_folder_of_the_computer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """From the package, from the working folder, or the file's name."""
    monkeypatch.chdir(tmp_path)
    assert place(f"{tmp_path / 'own' / 'door.py'}:7") == "own/door.py:7"
    assert place("/elsewhere/door.py:7") == "door.py:7"
    shipped = place(load_target("odometry").machines[0].transitions[0].src)
    assert re.fullmatch(r"(safeloc/)?models/odometry/__init__\.py:\d+", shipped)
