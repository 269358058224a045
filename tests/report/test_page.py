"""The page is rendered from the data of a report alone: rows, charts, machines, and the folder written again."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from safeloc.catalogue import Target, load_target
from safeloc.errors import InputError
from safeloc.language.interpret import run
from safeloc.language.trace import Trace
from safeloc.language.verdict import Held, Proved, Result, Unknown, Violated
from safeloc.proof.cache import engine
from safeloc.proof.results import Finding
from safeloc.report import data as data_module
from safeloc.report.data import report_data, versions
from safeloc.report.folder import render_folder, usable, write_folder
from safeloc.report.page import to_html
from safeloc.report.shared_lines import texts_of
from safeloc.report.traces import shown_value, trace_charts
from safeloc.runtime.packed import read_packed
from safeloc.runtime.streams.columns import read_runs

DOOR = f"{Path(__file__).parents[1] / 'data' / 'door_controller.py'}:machine"


@cache
def door() -> Target:
    """The user's door controller."""
    return load_target(DOOR)


def opening() -> Trace:
    """The door opens, starts to close, and an obstacle opens it again."""
    rows = [{"released": True}, {"released": False}, {"released": False, "blocked": True}]
    return run(door().system, [{"speed": 0, "blocked": False, **row} for row in rows])


def finding(name: str, result: Result, kind: Any = "property", requirements: tuple[str, ...] = ()) -> Finding:
    """A finding about the door."""
    return Finding(f"door/{kind}/{name}", "door", kind, f"statement of {name}", result, "by hand", 0.5, requirements)


def findings() -> list[Finding]:
    """One finding of each verdict."""
    return [
        finding("good", Proved(None, "bmc", witness=opening(), certificates={"good.smt2": "(check-sat)"})),
        finding("bad <b>", Violated(opening(), "bmc", "shown by hand"), requirements=("MRK-D1",)),
        finding("open question", Unknown("time is up", 7)),
        finding("tried", Held("Hypothesis", 3, 90, {"deepest run": "41"}), "test"),
    ]


def data() -> dict[str, Any]:
    """The report's data of these findings."""
    return report_data(findings(), [door()])


def test_headline_is_the_worst_verdict() -> None:
    """One violation makes the report violated; without it and the open question, all holds."""
    assert '<span class="verdict">not all holds</span>' in to_html(data())
    assert '<span class="verdict">undecided: at least one' in to_html(report_data(findings()[2:], [door()]))
    assert '<span class="verdict">all holds</span>' in to_html(report_data(findings()[:1], [door()]))
    assert '<span class="verdict">not asked: there was no property to check</span>' in to_html(
        report_data([], [door()])
    )


def test_a_long_witness_is_in_its_file_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its place in the data says so; a run that breaks something always stands there, however long."""
    monkeypatch.setattr(data_module, "MOST_CELLS", 2)
    good, bad, *_ = report_data(findings(), [door()])["results"]
    assert good["trace"] is None
    assert good["notes"] == {"witness": "a run of 3 steps, in the folder of traces only"}
    assert len(bad["trace"]["steps"]) == 3
    write_folder(tmp_path, findings(), [door()])
    assert len(read_runs(tmp_path / "traces" / "door.js").stream("door/property/good").steps) == 3


def test_machine_is_shown() -> None:
    """Transitions with file and line, variables with unit and range, and statistics of the tests are on the page."""
    page = to_html(data())
    line = next(n for n, text in enumerate(_source().splitlines(), 1) if '"obstacle"' in text)
    assert f"door_controller.py:{line}" in page
    assert "<td>input</td><td>mm/s</td><td>0 .. 100000</td>" in page
    assert "<td>deepest run</td><td>41</td>" in page


def _source() -> str:
    return Path(DOOR.rpartition(":")[0]).read_text(encoding="utf-8")


def test_chart_of_a_reported_interval() -> None:
    """A machine with an interval gets truth and margins; gaps where nothing is reported, and without a ghost."""
    target = load_target("delocalized")
    machine = report_data([], [target])["machines"][0]
    outputs = {"restrictive": False, "position_mm": 100, "margin_below_mm": 5, "margin_above_mm": 7, "reason": 0}
    step = {"inputs": {}, "fired": {}, "state": {"truth_nm": 110_000_000}, "outputs": outputs}
    lost = {**step, "outputs": {**outputs, "restrictive": True}}
    trace = {"first": {"truth_nm": 100_000_000}, "steps": [step, step, lost, step], "truth_mm": []}
    chart = trace_charts(trace, machine)
    assert "truth - position" in chart
    assert chart.count("<polygon") == 4
    recorded = {"first": {}, "steps": [step, step], "truth_mm": [101, None]}
    drawn = trace_charts(recorded, machine)
    assert "reported position" in drawn
    assert drawn.count("<circle") == 2  # the one truth, and how far it is from the position


def test_values_are_shown_as_labels() -> None:
    """Enumerations by label, truth values in lower case, variables of an observer as they are."""
    signals = data()["machines"][0]["signals"]
    assert shown_value(signals, "mode", 2) == "CLOSING"
    assert shown_value(signals, "released", True) == "true"
    assert shown_value(signals, "no such", 3) == "3"


def test_folder(tmp_path: Path) -> None:
    """Page, data, JUnit, certificates and traces are written; the page can be rendered again from the data."""
    page = write_folder(tmp_path, findings(), [door()])
    first = page.read_text(encoding="utf-8")
    packed = read_packed(tmp_path / "certificates" / "door.texts.xz").decode()
    assert texts_of(packed, 100) == {"good.smt2": "(check-sat)"}
    assert ["door/property/good", "door/property/bad <b>"] == list(read_runs(tmp_path / "traces" / "door.js"))
    page.unlink()
    assert render_folder(tmp_path).read_text(encoding="utf-8") == first
    suite = ElementTree.parse(tmp_path / "junit.xml").getroot()[0]
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("4", "1", "1")


def test_old_evidence_goes(tmp_path: Path) -> None:
    """A second report in the same folder leaves no trace of the first; files of others stay."""
    write_folder(tmp_path, findings(), [door()])
    (tmp_path / "notes.txt").write_text("mine", encoding="utf-8")
    write_folder(tmp_path, findings()[2:], [door()])
    assert [] == [*(tmp_path / "traces").iterdir(), *(tmp_path / "certificates").iterdir()]
    assert (tmp_path / "notes.txt").is_file()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "cannot be read as a report"),
        ("[]", "not a report of schema safeloc-report/5"),
        (json.dumps({"schema": "safeloc-report/2"}), "not a report of schema safeloc-report/5; write it with"),
        (
            json.dumps({"schema": "safeloc-report/5"}),
            "does not fit schema safeloc-report/5: KeyError: 'certificates'",
        ),
    ],
)
def test_no_report(tmp_path: Path, text: str, message: str) -> None:
    """What is no report is refused by file name."""
    (tmp_path / "report.json").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message):
        render_folder(tmp_path)


def test_the_digest_covers_the_whole_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Any changed file changes it, also one behind the link that a checkout has where a wheel has a folder."""
    for place in ("wheel/safeloc/models", "checkout/safeloc", "checkout/models"):
        (tmp_path / place).mkdir(parents=True)
    (tmp_path / "checkout" / "safeloc" / "models").symlink_to(tmp_path / "checkout" / "models")
    found = []
    for place, text in (("wheel", "a = 1"), ("checkout", "a = 1"), ("checkout", "a = 2")):
        package = tmp_path / place / "safeloc"
        (package / "models" / "train.py").write_text(text, encoding="utf-8")
        monkeypatch.setattr(engine, "PACKAGE", package)
        found.append(engine.source_digest.__wrapped__())
    wheel, checkout, changed = found
    assert wheel == checkout != changed


def test_a_version_that_cannot_be_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Something that is not installed as a package is named as such."""
    monkeypatch.setattr(data_module, "VERSIONED", ("no such package",))
    assert versions()["no such package"] == "not installed as a package"


def test_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    """Told before the proofs, and when it is written."""
    (tmp_path / "file").write_text("", encoding="utf-8")
    for attempt in (usable, lambda folder: write_folder(folder, findings(), [door()])):
        with pytest.raises(InputError, match=r"report: the report cannot be written here: "):
            attempt(tmp_path / "file" / "report")
    usable(tmp_path / "new" / "report")
    assert not (tmp_path / "new").exists()  # the folder is made with the report, not by asking


def test_a_long_assumption_is_said_once() -> None:
    """The row of the first claim has its text, each further one refers to that row; short ones are said each time."""
    long, short = "a train that is assumed to be long; " * 6, "a short one"
    names = {"first": long, "second": long, "third": short, "fourth": short}
    rows = [replace(finding(name, Proved(None, "bmc")), assumption=assumption) for name, assumption in names.items()]
    page = to_html(report_data(rows, [door()]))
    assert (1, 2) == (page.count(f'<td data-head="assumption">{long}'), page.count(f">{short}<"))
    assert 1 == page.count('<td data-head="assumption">that of <a href="#')
    [at] = re.findall(r'assumption">that of <a href="#([^"]+)">first</a>', page)
    assert f'id="{at}"' in page
