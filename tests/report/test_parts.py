"""A large report: the page holds what is looked at first, and its parts lie beside it; one page on demand."""

from __future__ import annotations

import base64
import gzip
import json
import re
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.errors import InputError
from safeloc.report import page as page_module
from safeloc.report.data import report_data
from safeloc.report.extract import extract
from safeloc.report.folder import render_folder, write_folder
from safeloc.report.page import to_html, to_pages
from safeloc.runtime.streams.steps import read_steps
from tests.report.test_page import door, findings

PART = re.compile(r'safelocPart\("([^"]+)", "([0-9a-f]{16})", "([A-Za-z0-9+/=]+)"\);\n')


@pytest.fixture(autouse=True)
def _small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every report is a large one."""
    monkeypatch.setattr(page_module, "MOST_OF_ONE_PAGE", 0)


def unpacked(script: str) -> tuple[str, str, str]:
    """Name, report and HTML of a part."""
    found = PART.fullmatch(script)
    assert found is not None
    return found[1], found[2], gzip.decompress(base64.b64decode(found[3])).decode()


def test_nothing_is_lost() -> None:
    """Page and parts together are the one page."""
    data = report_data(findings(), [door(), load_target("odometry")])
    whole = to_html(data)
    pages = to_pages(data)
    page, parts = pages.page, pages.parts
    assert set(parts) == {"door.js", "odometry.js", "trace-back.js", "conditions.js", "beside.js", "results.js"}
    html = {
        name: re.sub(r' data-in="[^"]*"', "", unpacked(text)[2])
        for name, text in parts.items()
        if name not in ("beside.js", "results.js")
    }
    for text in html.values():
        assert text.strip() in whole
        assert text.strip() not in page
    left = re.sub(
        r'<details class="part" data-part="page/([a-z-]+\.js)"[^>]*>.*?</details>', lambda m: html[m[1]], page
    )
    assert words(left) == words(whole)


def words(page: str) -> list[str]:
    """The text of a page without markup, scripts, and what speaks of parts."""
    page = re.sub(
        r"<(script|style|noscript|search|nav)\b.*?</\1>|<p><button.*?</p>|<button class=.print-one.*?</button>",
        "",
        page,
        flags=re.DOTALL,
    )
    return re.sub(r"<[^>]*>", " ", page).split()


def test_parts_are_of_their_page(tmp_path: Path) -> None:
    """Each is named in the page, says of which report it is, and goes when another report is written."""
    first = write_folder(tmp_path, findings(), [door()]).read_text(encoding="utf-8")
    made = re.findall(r'data-made="([0-9a-f]{16})"', first)
    for name in re.findall(r'data-part="([^"]*)"', first):
        assert unpacked((tmp_path / name).read_text(encoding="utf-8"))[:2] == (name, *made)
    assert (tmp_path / "page" / "beside.js").read_text(encoding="utf-8") == f'safelocBeside("{made[0]}");\n'
    (tmp_path / "page" / "gone.js").write_text("", encoding="utf-8")
    write_folder(tmp_path, findings()[2:], [door()])
    assert {path.name for path in (tmp_path / "page").iterdir()} == {
        "door.js",
        "trace-back.js",
        "conditions.js",
        "beside.js",
        "results.js",
    }
    assert made != re.findall(r'data-made="([0-9a-f]{16})"', (tmp_path / "index.html").read_text(encoding="utf-8"))


def test_one_page_on_demand(tmp_path: Path) -> None:
    """It loads nothing and has the runs and their view in it; the parts come back with the other form."""
    write_folder(tmp_path, findings(), [door()], single=True)
    assert not (tmp_path / "page").exists()
    single = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "<script src" not in single
    assert not (tmp_path / "run.html").exists()
    for called in ("safelocResults(", "safelocRuns(", "safelocView("):
        assert f"\n{called}" in single
    page = render_folder(tmp_path).read_text(encoding="utf-8")
    assert "safelocRuns(" not in page
    assert page.count("<script>") == 1
    assert (tmp_path / "run.html").is_file()
    assert (tmp_path / "page" / "door.js").is_file()
    assert render_folder(tmp_path, single=True).read_text(encoding="utf-8") == single
    assert list((tmp_path / "page").iterdir()) == []


def test_a_page_rendered_again_is_the_same(tmp_path: Path) -> None:
    """From what is kept: machines, pictures, and the run of what is violated; parts as well."""
    write_folder(tmp_path, findings(), [door()])
    before = {path: path.read_bytes() for path in (tmp_path / "index.html", *(tmp_path / "page").iterdir())}
    for path in before:
        path.unlink()
    render_folder(tmp_path)
    assert before == {path: path.read_bytes() for path in before}


@pytest.mark.parametrize(
    ("name", "why"),
    [("machines/door.json.xz", "it ends too early"), ("traces/door.js", "it is no complete call of safelocRuns")],
)
def test_a_damaged_file(tmp_path: Path, name: str, why: str) -> None:
    """What the page is made of is refused by name where it was cut or is gone."""
    write_folder(tmp_path, findings(), [door()])
    whole = (tmp_path / name).read_bytes()
    (tmp_path / name).write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match=rf"{name}: damaged, {why}\."):
        render_folder(tmp_path)
    (tmp_path / name).unlink()
    with pytest.raises(InputError, match=rf"{name}: (cannot be read|no such file)"):
        render_folder(tmp_path)


@pytest.mark.parametrize(("key", "place"), [("certificates", 99), ("certificates", -1), ("results", -1)])
def test_a_place_that_there_is_not(tmp_path: Path, key: str, place: int) -> None:
    """A number that names no certificate or result is refused."""
    write_folder(tmp_path, findings(), [door()])
    data = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    data["results" if key == "certificates" else "requirements"][0][key] = [place]
    (tmp_path / "report.json").write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(InputError, match=r"report\.json: does not fit schema safeloc-report/5: IndexError"):
        render_folder(tmp_path)


def test_what_is_packed_can_be_written_out(tmp_path: Path) -> None:
    """Certificates as text and runs as streams, each under its own name; a damaged file is refused by name."""
    write_folder(tmp_path, findings(), [door()])
    assert (1, 2) == extract(tmp_path, tmp_path / "plain")
    assert (tmp_path / "plain" / "certificates" / "good.smt2").read_text(encoding="utf-8") == "(check-sat)"
    bad = read_steps(tmp_path / "plain" / "traces" / "door-property-bad--b-.jsonl")
    assert ("door", [True, False, False]) == (bad.machine, [step["released"] for step in bad.steps])
    path = tmp_path / "certificates" / "door.texts.xz"
    path.write_bytes(path.read_bytes()[:-4])
    with pytest.raises(InputError, match=r"door\.texts\.xz: damaged, it ends too early"):
        extract(tmp_path, tmp_path / "again")
