"""The report: its data obey the published schema, its page shows what was found and asks nothing of a network."""

from __future__ import annotations

import fcntl
import json
import os
import re
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.assurance.mutation.strength import Strength
from safeloc.catalogue import load_target
from safeloc.errors import InputError
from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.verdict import Held, Proved, Unknown, Violated, word
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.vocabulary.error_law import RADAR
from safeloc.proof.results import Finding
from safeloc.report.certificates import read_archives
from safeloc.report.data import report_data, schema
from safeloc.report.extract import extract
from safeloc.report.file_names import file_names
from safeloc.report.folder import render_folder, write_folder
from safeloc.report.held_in import statements
from safeloc.report.junit import to_junit
from safeloc.report.page import to_html
from safeloc.report.plot import line_chart
from safeloc.runtime.streams.columns import read_runs
from safeloc.shipped_machines import ENTRIES
from safeloc.target import Target
from tests.report.lamp import DOC, UNDECIDED, findings, target

WRONG = "lamp/property/wears & tears"
TRACES = "traces/lamp.js"


@pytest.fixture(scope="module")
def data() -> dict[str, Any]:
    """The report of the lamp."""
    return report_data(findings(), [target()])


@pytest.fixture(scope="module")
def page(data: dict[str, Any]) -> str:
    """Its page."""
    return to_html(data)


def found(name: str) -> Finding:
    """One finding of the lamp."""
    return next(one for one in findings() if one.id == name)


# ------------------------------------------------------------------ data


def test_one_finding_of_each_kind() -> None:
    """The lamp gives a proof, a violation and an undecided statement."""
    assert [word(one.result) for one in findings()] == ["proved", "violated", "unknown"]


def test_data_obey_the_schema(data: dict[str, Any]) -> None:
    """The data validate against the published schema, before and after they were text."""
    jsonschema.Draft202012Validator.check_schema(schema())
    jsonschema.validate(data, schema())
    assert json.loads(json.dumps(data)) == data


def test_the_schema_refuses_strangers(data: dict[str, Any]) -> None:
    """A field that the schema does not know, an unknown verdict, a missing field: each is refused."""
    for wrong in ({**data, "more": 1}, {**data, "verdict": "fine"}, {k: v for k, v in data.items() if k != "results"}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(wrong, schema())


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", ["odometry", "delocalized", "supervised_odometry"])
def test_shipped_machines_obey_the_schema(name: str) -> None:
    """Each shipped machine, with its configuration and composition, is described within the schema."""
    shipped = load_target(name)
    described = report_data([], [shipped])
    jsonschema.validate(described, schema())
    (machine,) = described["machines"]
    assert [part["name"] for part in machine["parts"]] == [one.name for one in shipped.machines]
    assert machine["configuration"]["tolerance_mm"] == 30_000


def test_statistics_of_the_tests_are_given_once() -> None:
    """The first test of a machine notes them; a test that notes something else notes that, and only that."""
    figures = {"runs": "60", "steps": "3600"}
    every = [
        Finding(f"lamp/test/{name}", "lamp", "test", name, Held("Hypothesis", 60, 3600, notes), "Hypothesis", 1.0)
        for name, notes in (
            ("first", figures),
            ("second", dict(figures)),
            ("third", {**figures, "never happened": "the case (mode = ON)"}),
            ("fourth", {**figures, "steps": "3599"}),
            ("fifth", {**figures, "steps": "3599"}),
        )
    ]
    made = report_data(every, [target()])
    assert [row["notes"] for row in made["results"]] == [
        figures,
        {},
        {"never happened": "the case (mode = ON)"},
        {"steps": "3599"},
        {"statistics as of": "fourth"},
    ]
    text = to_html(made)
    assert text.count("<summary>statistics of the property tests</summary>") == 1
    assert "<summary>further notes on the property tests: third</summary>" in text


def test_the_headline_is_the_worst() -> None:
    """One violation makes the report violated, one undecided statement unknown; a test alone is no proof."""
    proved, violated, unknown = findings()
    held = replace(proved, result=Held("tests", 10, 200))
    assert report_data([proved, violated, unknown], [target()])["verdict"] == "violated"
    assert report_data([proved, unknown, held], [target()])["verdict"] == "unknown"
    assert report_data([proved, held], [target()])["verdict"] == "held"
    assert report_data([proved], [target()])["verdict"] == "proved"


def test_requirement_table_goes_both_ways(data: dict[str, Any]) -> None:
    """A requirement lists exactly the results and transitions that name it; its verdict is its worst result's."""
    rows = {row["id"]: row for row in data["requirements"]}
    for row in rows.values():
        assert row["results"] == [one.id for one in findings() if row["id"] in one.requirements]
    for one in findings():
        assert all(one.id in rows[name]["results"] for name in one.requirements)
    assert rows["MRK-1"]["transitions"] == ["lamp: switch <on>", "lamp: burnt out"]
    assert rows["MRK-D1"]["transitions"] == ["lamp: burnt out"]
    assert rows["MRK-1"]["verdict"] == "proved"
    assert rows["MRK-D1"]["verdict"] == "violated"
    assert (rows["SAT-1"]["transitions"], rows["SAT-1"]["results"], rows["SAT-1"]["verdict"]) == ([], [], "")


def test_how_strongly_a_requirement_is_shown() -> None:
    """Where strengths were looked up, each requirement that rows carry tells its own, or that it was not measured."""
    weak = Strength("lamp", 9, 9, 5, 3, 0)
    told = report_data(findings(), [target()], strengths={"MRK-1": [weak]})
    jsonschema.validate(told, schema())
    rows = {row["id"]: row["strength"] for row in told["requirements"]}
    assert ["lamp: of 5 wrong rules 0 noticed by its properties, 3 by any proof", "NOT SHOWN"] == [
        rows["MRK-1"][0], rows["MRK-1"][1].partition(":")[0],
    ]  # fmt: skip
    assert rows["MRK-D1"][0].startswith("not measured: ") and [] == rows["SAT-1"]
    assert "strength: NOT SHOWN: " in to_html(told)
    assert {0} == {len(row["strength"]) for row in report_data(findings(), [target()])["requirements"]}


# ------------------------------------------------------------------ page


def test_page_shows_the_violated_run(page: str) -> None:
    """Each step of the run that breaks the statement is a row: number, transition, inputs and what changed."""
    shown = page[page.index("Violated</h2>") : page.index("Undecided</h2>")]
    assert "lamp/property/wears &amp; tears" in shown
    rows = re.findall(
        r"<tr><td class=\"n\">(\d+)</td><td>(.*?)</td><td><code>(.*?)</code></td>.*?<code>(.*?)</code>", shown
    )
    assert [row[0] for row in rows] == ["0", "1", "2", "3"]
    assert rows[0][3] == "mode=DARK  wear=0"
    assert rows[3] == ("3", "switch &lt;on&gt;", "press=true", "mode=LIT  wear=2")
    assert f"{TRACES} --run &#39;lamp/property/wears &amp; tears&#39;" in shown


def test_page_shows_what_is_undecided(page: str) -> None:
    """An undecided statement stands with its reason and how far it was looked at."""
    shown = page[page.index("Undecided</h2>") : page.index('<h2 id="lamp"')]
    assert "no &lt;i&gt;time&lt;/i&gt;" in shown
    assert '<td class="n">4</td>' in shown


def test_counts_in_the_headline(page: str) -> None:
    """The headline counts each verdict."""
    assert "1 proved, 0 held in tests and replays, 1 undecided, 1 violated" in page


def test_text_of_a_user_is_escaped(page: str) -> None:
    """Nothing that a user wrote becomes markup, in text or in drawings."""
    assert "&lt;script&gt;" in page
    for raw in ("<script", DOC, "<on>", "<b>twice", "<i>time"):
        assert raw not in page
    assert page.count("switch &lt;on&gt;") >= 3


def test_page_stands_alone(page: str) -> None:
    """No address, script, frame, image or style sheet of elsewhere: only the name of the drawing format."""
    addresses = set(re.findall(r"https?://[^\s\"'<]*", page))
    assert addresses == {"http://www.w3.org/2000/svg"}
    assert not re.search(r"<(script|link|iframe|img|object|embed)\b|@import|url\((?!#)|\bon\w+=", page)
    assert {link[:1] for link in re.findall(r'href="([^"]*)"', page)} == {"#"}


def test_links_of_the_page_lead_somewhere(page: str) -> None:
    """Every link names a heading or a requirement of the page."""
    ids = set(re.findall(r'id="([^"]*)"', page))
    links = re.findall(r'href="#([^"]*)"', page)
    places = {link for link in links if not re.match(r"r\d+$|(source|term|law|condition|needs)-", link)}
    assert {"lamp", "conditions", "requirements", "items", "words", "versions", "MRK-1", "MRK-D1"} == places
    assert any(link.startswith("source-lamp-") for link in links)
    assert set(links) <= ids


def test_page_of_data_read_back(data: dict[str, Any], page: str) -> None:
    """report.json alone gives the same page."""
    assert to_html(json.loads(json.dumps(data))) == page


def test_a_requirement_of_the_user_is_text(data: dict[str, Any]) -> None:
    """An id that the catalogue does not have is shown, and leads nowhere."""
    (new, *others) = data["results"]
    shown = to_html({**data, "results": [{**new, "requirements": ["LAMP-7"]}, *others]})
    assert '<span class="id">LAMP-7</span>' in shown
    assert "#LAMP-7" not in shown


def test_requirements_of_other_machines_are_only_counted(page: str) -> None:
    """A user's report is not about machines that are not in it."""
    assert 'id="MRK-1"' in page
    assert 'id="SAT-1"' not in page
    assert "72 requirements of shipped machines that are not in this report" in page


def test_trace_back(page: str) -> None:
    """From a transition or a property back to what it is there for; one that names nothing says so."""
    back = page[page.index('<h2 id="items">') :]
    assert '<td>burnt out</td><td>transition</td><td><a class="id" href="#MRK-1">' in back
    assert "<td>switch off</td><td>transition</td><td>none</td>" in back
    assert '<td>new</td><td>property</td><td><a class="id" href="#MRK-1">' in back


def test_statements_say_where_they_held() -> None:
    """Runs with the same verdict and notes stand together; where a statement was not checked it is said to be not applicable."""
    base = replace(UNDECIDED, result=Held("tests", 1, 10, {"contained": "9"}))
    runs = [
        replace(base, id="lamp/test/new", kind="test", method="Hypothesis"),
        replace(base, id="lamp/replay/run: new", kind="replay", method="replay of run.csv"),
        replace(
            base, id="lamp/replay/far: new", kind="replay", method="replay of far.csv", result=Held("r", 1, 20, {})
        ),
        replace(base, id="lamp/replay/run: truth", kind="replay", method="replay of run.csv"),
    ]
    shown = to_html(report_data(runs, [target()]))
    new, truth = (
        re.sub(r"<[^>]*>", " ", row) for row in re.findall(r'<tr><td class="says"><b>(?:new|truth)</b>.*?</tr>', shown)
    )
    assert re.search(r"held +in property tests, far\.csv +held +in run\.csv +contained: 9", new)
    assert re.search(r"held +in run\.csv +contained: 9 +not applicable +in property tests, far\.csv", truth)
    assert all(len(re.findall("<t[hd]", row)) <= 4 for row in re.findall(r"<tr><td class=\"says\">.*?</tr>", shown))


def test_of_many_runs_the_few_others_are_named() -> None:
    """Of five runs, all, or all but one; of two, the one."""
    rows = [
        {"name": f"r{at}: {name}", "kind": "replay", "method": f"replay of r{at}.csv", "verdict": "held", "notes": {}, "statement": "s"}
        for at in range(5)
        for name in ("everywhere", "not in 3")
        if (at, name) != (3, "not in 3")
    ]  # fmt: skip
    assert {
        "everywhere": ["all 5"],
        "not in 3": ["all 5 but r3.csv", "r3.csv"],
    } == {row["name"]: [one["where"] for one in row["found"]] for row in statements(rows)}


def test_figures_of_the_configuration_have_units_and_sources() -> None:
    """A default names its source, also one of this machine alone; a value set by the user says so."""
    figures = _figures(load_target("odometry"))
    assert figures["tolerance_mm"]["unit"] == "mm"
    assert "OCORA" in figures["tolerance_mm"]["source"]
    assert figures["second_unit.constant_mm"]["source"].startswith("the default here, elsewhere 5000 [S] SUBSET-041")
    assert not any(figure["source"].startswith("set here") for figure in figures.values())
    better = OdometryConfig(second_unit=RADAR.model_copy(update={"constant_mm": 4_000}))
    set_by_user = _figures(ENTRIES["odometry"].make(better))["second_unit.constant_mm"]["source"]
    assert set_by_user.startswith("set here; the default is 6000 [S] SUBSET-041")


def _figures(target: Target) -> dict[str, Any]:
    """The figures of the configuration as the report has them, by name."""
    return {row["name"]: row for row in report_data([], [target])["machines"][0]["figures"]}


def test_a_machine_shown_twice_is_written_once() -> None:
    """The very same machine in a second target is a link to the first."""
    page = to_html(report_data([], [load_target("odometry"), load_target("supervised_odometry")]))
    assert page.count('<table class="transitions">') == 2
    assert 'as shown under <a href="#odometry">odometry</a>' in page


# ------------------------------------------------------------------ file names

IDS = st.text(st.sampled_from("aA-/ :é"), max_size=6)


@given(st.lists(IDS, unique=True))
def test_file_names_are_distinct(ids: list[str]) -> None:
    """Also on a file system to which small and capital letters are the same; the order of the ids alone decides."""
    names = file_names(ids)
    assert list(names) == ids
    assert len({name.casefold() for name in names.values()}) == len(ids)
    assert file_names(ids) == names
    assert all(re.fullmatch(r"[A-Za-z0-9-]*", name) for name in names.values())


def test_file_names_are_short_enough() -> None:
    """For every file system, whatever the length of the id."""
    names = file_names(["a" * 999, "a" * 998])
    assert sorted(map(len, names.values())) == [150, 152]


def test_two_runs_of_like_names_are_two_files(tmp_path: Path) -> None:
    """Neither of two violated statements loses its run."""
    wrong = found(WRONG)
    write_folder(tmp_path, [wrong, replace(wrong, id="lamp/property/wears + tears")], [target()])
    assert [WRONG, "lamp/property/wears + tears"] == list(read_runs(tmp_path / TRACES))
    assert (0, 2) == extract(tmp_path, tmp_path / "plain")
    plain = {path.name for path in (tmp_path / "plain" / "traces").iterdir()}
    assert plain == {"lamp-property-wears---tears.jsonl", "lamp-property-wears---tears-2.jsonl"}


def test_the_run_of_a_recording_keeps_its_truth(tmp_path: Path) -> None:
    """The saved stream, replayed, can show the same violation."""
    wrong = replace(found(WRONG), truth_mm=(5, None, 7))
    write_folder(tmp_path, [wrong], [target()])
    steps = read_runs(tmp_path / TRACES).stream(WRONG).steps
    assert [step.get("truth_mm") for step in steps] == [5, None, 7]


def test_a_long_run_is_folded_but_for_its_end() -> None:
    """What happened last is seen at once, the rest on demand; nothing is lost."""
    data = report_data([found(WRONG)], [target()])
    trace = data["results"][0]["trace"]
    trace["steps"] = trace["steps"] * 20
    page = to_html(data)
    assert "<summary>the 41 rows before</summary>" in page
    shown = page[page.index("Violated</h2>") : page.index('<h2 id="lamp"')]
    assert shown.count('<tr><td class="n">') == 61


def test_a_certificate_is_never_overwritten(tmp_path: Path) -> None:
    """Two different texts under one name are refused; the same text twice is one file."""
    proof = found("lamp/property/new")
    assert isinstance(proof.result, Proved)
    other = replace(proof, id="m/property/x", result=replace(proof.result, certificates={"A.smt2": "(a)"}))
    same = replace(other, id="m/property/y")
    write_folder(tmp_path, [other, same], [target()])
    unlike = replace(other, id="m/property/z", result=replace(proof.result, certificates={"a.smt2": "(b)"}))
    with pytest.raises(InputError, match=r"^m/property/z: another certificate is called a\.smt2; rename machine or"):
        write_folder(tmp_path, [other, unlike], [target()])


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", ["clear", "items", "get", "values"])
def test_a_claim_may_have_any_name(name: str) -> None:
    """Also that of a method of the page's data, which a template could take for an entry of it."""
    page = to_html(report_data([replace(UNDECIDED, id=f"lamp/property/{name}")], [target()]))
    assert f"<b>{name}</b>" in page


# ------------------------------------------------------------------ JUnit


def test_junit_counts() -> None:
    """Violated is a failure with its run, unknown an error, all else passes; counts agree with the cases."""
    held = replace(UNDECIDED, id="other/test/x", machine="other", kind="test", result=Held("tests", 1, 10))
    later = replace(UNDECIDED, id="lamp/property/much later")
    root = ElementTree.fromstring(to_junit([*findings(), later, held]).encode())
    lamp, other = root.findall("testsuite")
    assert (lamp.get("name"), lamp.get("tests"), lamp.get("failures"), lamp.get("errors")) == ("lamp", "4", "1", "2")
    assert (other.get("tests"), other.get("failures"), other.get("errors")) == ("1", "0", "0")
    assert (len(lamp.findall("testcase")), len(lamp.findall(".//failure")), len(lamp.findall(".//error"))) == (4, 1, 2)
    failure = root.find(".//failure")
    assert failure is not None
    assert "   3  switch <on>  [press=true]  mode=LIT wear=2" in str(failure.text)
    ids = {f"{case.get('classname', '').replace('.', '/')}/{case.get('name')}" for case in root.iter("testcase")}
    assert ids == {one.id for one in (*findings(), later, held)}


# ------------------------------------------------------------------ folder


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The lamp's report folder."""
    path = tmp_path_factory.mktemp("report") / "deep" / "folder"
    assert write_folder(path, findings(), [target()]) == path / "index.html"
    return path


def test_folder(folder: Path) -> None:
    """Page, data, JUnit, the proof's certificates in one file, the violation's run in columns, and nothing else."""
    proof = found("lamp/property/new").result
    assert isinstance(proof, Proved)
    assert proof.certificates
    expected = {"index.html", "report.json", "junit.xml", "results.sarif", TRACES, "machines/lamp.json.xz"}
    expected |= {"certificates/lamp.texts.xz", "run.html", "SHA256SUMS"}
    expected |= {"page/lamp.view.js", "page/results.js", "machines/lamp.js"}
    assert {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()} == expected
    jsonschema.validate(json.loads((folder / "report.json").read_text(encoding="utf-8")), schema())
    read = read_archives(folder / "certificates", {"lamp.texts.xz": list(proof.certificates)})
    assert (proof.certificates, {}) == (read.texts, read.damaged)


def test_the_saved_trace_replays(folder: Path) -> None:
    """Read back and run, the saved stream is the same run and breaks the same statement, and no other."""
    stream = read_runs(folder / TRACES).stream(WRONG)
    assert stream.machine == "lamp"
    first = {name: value for name, value in stream.first.items() if name not in ("mode", "wear")}
    again = run(target().system, stream.steps, first=first)
    violated = found(WRONG).result
    assert isinstance(violated, Violated)
    assert violated.trace is not None
    assert [one.state for one in again.steps] == [
        {k: step.state[k] for k in again.initial} for step in violated.trace.steps
    ]
    new, tears = check_all(again, target().properties)
    assert isinstance(new, Held)
    assert isinstance(tears, Violated)


@pytest.mark.parametrize("where", ["whole", "results", "requirements"])
def test_an_unknown_verdict_is_refused(folder: Path, tmp_path: Path, where: str) -> None:
    """A page is never made of a word that is no verdict."""
    data = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    changed = data if where == "whole" else data[where][0]
    changed["verdict"] = "fine"
    (tmp_path / "report.json").write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(InputError, match=r"report.json: does not fit schema .* is 'fine'; there are proved, held"):
        render_folder(tmp_path)
    assert not (tmp_path / "index.html").exists()


def test_a_deeply_nested_report(tmp_path: Path) -> None:
    """Refused, not a crash."""
    (tmp_path / "report.json").write_text("[" * 100_000, encoding="utf-8")
    with pytest.raises(InputError, match=r"nested too deeply to be a report\.$"):
        render_folder(tmp_path)


def test_two_runs_into_one_folder(tmp_path: Path) -> None:
    """While one run writes, another one waits: what comes out is the report of one of them."""
    handle = os.open(tmp_path, os.O_RDONLY)
    fcntl.flock(handle, fcntl.LOCK_EX)
    other = threading.Thread(target=write_folder, args=(tmp_path, [UNDECIDED], [target()]))
    other.start()
    other.join(0.5)
    assert (other.is_alive(), list(tmp_path.iterdir())) == (True, [])
    os.close(handle)
    other.join(30)
    assert (tmp_path / "index.html").is_file()


def test_undecided_leaves_no_evidence(tmp_path: Path) -> None:
    """A statement that was not decided has no trace and no certificate."""
    assert isinstance(UNDECIDED.result, Unknown)
    write_folder(tmp_path, [UNDECIDED], [target()])
    assert [*(tmp_path / "traces").iterdir(), *(tmp_path / "certificates").iterdir()] == []


# ------------------------------------------------------------------ plot


def paths(chart: str) -> list[str]:
    """The line of each series."""
    return re.findall(r'<path d="([^"]*)"', chart)


def test_a_gap_interrupts_the_line() -> None:
    """Where nothing is reported the pen is lifted, and the band is in two pieces."""
    series = [1.0, 2.0, None, 4.0, 5.0]
    chart = line_chart("gap", "mm", {"position": series}, (series, series))
    (line,) = paths(chart)
    assert re.sub(r"[^ML]", "", line) == "MLML"
    assert chart.count("<polygon") == 2
    ElementTree.fromstring(chart)


def test_a_value_between_gaps_is_a_dot() -> None:
    """A line of one point would not be seen, nor a band of one step."""
    series = [None, 2.0, None, 4.0, 5.0]
    drawing = ElementTree.fromstring(line_chart("dot", "mm", {"position": series}, (series, series)))
    assert len(drawing.findall("{*}circle")) == 1
    first, _ = drawing.findall("{*}polygon")
    places = {point.split(",")[0] for point in str(first.get("points")).split()}
    assert len(places) == 2


def test_a_constant_series_is_a_level_line() -> None:
    """A series that never changes is drawn level within the frame; zero as well."""
    for value in (0.0, 7.0, -3e9):
        (line,) = paths(line_chart("level", "mm", {"a": [value] * 3}))
        heights = {point.split(" ")[1] for point in re.split("[ML]", line)[1:]}
        assert len(heights) == 1
        assert 0 < float(heights.pop()) < 240


@pytest.mark.parametrize(
    ("low", "high", "labels"),
    [
        (0.0, 200.0, ["0 count", "50 count", "100 count", "150 count", "200 count"]),
        (0.0, 1.0, ["0 count", "0.2 count", "0.4 count", "0.6 count", "0.8 count", "1 count"]),
        (-3000.0, 1000.0, ["−3000 count", "−2000 count", "−1000 count", "0 count", "1000 count"]),
    ],
)
def test_an_axis_has_round_values(low: float, high: float, labels: list[str]) -> None:
    """No "-0", and none of the frame's own ends; a single line is named once, by the title."""
    drawing = ElementTree.fromstring(line_chart("cycles", "count", {"cycles": [low, high]}))
    texts = [text.text for text in drawing.iter("{http://www.w3.org/2000/svg}text")]
    assert [text for text in texts if text is not None and text.endswith(" count")] == labels
    assert texts.count("cycles") == 1


def test_nothing_to_draw() -> None:
    """Without lines, without values, or with a single step there is no chart."""
    assert line_chart("none", "mm", {}) == ""
    assert line_chart("none", "mm", {"a": [None, None]}) == ""
    assert line_chart("none", "mm", {"a": [1.0]}) == ""


def test_labels_of_a_chart_are_escaped() -> None:
    """Title, unit and names of lines are text."""
    chart = line_chart('<t> "q"', "<u>", {"<n>": [1.0, 2.0]})
    labels = {text.text for text in ElementTree.fromstring(chart).iter() if text.text}
    assert "<n>" in labels
    assert any("<u>" in label for label in labels)
    assert ElementTree.fromstring(chart).get("aria-label") == '<t> "q"'
