"""The page of runs in a browser: why something is so, what breaks a claim, and runs that go on with other inputs."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlencode

import pytest

from safeloc.catalogue import configured, load_target
from safeloc.explain.pytest_file import run_file, run_file_pieces
from safeloc.language.expr import number, optional
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import lower
from safeloc.language.units import MM
from safeloc.language.verdict import Proved
from safeloc.language.world import Law, World
from safeloc.proof.results import Finding
from safeloc.report.folder import write_folder
from safeloc.report.recordings_page import recordings_page
from safeloc.report.run_page import machine_script
from safeloc.runtime.scripts import read_script
from safeloc.runtime.streams.steps import read_steps, write_steps
from safeloc.target import Target
from tests.report import keeper, tandem
from tests.report.browser import DESK, ENTER, PHONE, RIGHT, Page, opened
from tests.started_pytest import run_pytest

NARROW_SPACE, FIXED_SPACE = "\u202f", "\xa0"


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a run in which nothing is violated and of one that violates a claim."""
    folder = tmp_path_factory.mktemp("keeper")
    streams = [keeper.stream(folder, "quiet", keeper.QUIET), keeper.stream(folder, "busy", keeper.BUSY)]
    path = folder / "page.html"
    path.write_text(recordings_page(keeper.target, streams, made="now"), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def odometry(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of the recorded service of the odometry."""
    target = load_target("odometry")
    service = [path for path in target.streams if "service" in path.name]
    path = tmp_path_factory.mktemp("odometry") / "page.html"
    path.write_text(recordings_page(target, service, made="now"), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def composition(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a recording of two machines, which leaves one of their inputs out."""
    folder = tmp_path_factory.mktemp("tandem")
    stream = folder / "ride.jsonl"
    write_steps(stream, tandem.RUN, machine="tandem")
    path = folder / "page.html"
    path.write_text(recordings_page(tandem.target, [stream], made="now"), encoding="utf-8")
    return path


def at(page: Page, path: Path, run: str, step: int, more: str = "") -> None:
    """Open a run of the machine at a step, with the machine itself."""
    name = path.parent.name.rstrip("0123456789")
    opened(page, path, f"#result={name}%2Frecording%2F{run}&step={step}{more}")
    page.until("!document.getElementById('run-if-open').hidden || document.getElementById('run').classList.contains('branching')")  # fmt: skip


def chosen(page: Page, field: str, value: str) -> None:
    """Choose a value in a list of the form."""
    page.js("(e => { e.value = arguments[1]; e.dispatchEvent(new Event('change')) })(document.getElementById(arguments[0]))", field, value)  # fmt: skip


def filled(page: Page, field: str, value: str) -> None:
    """Fill a field of the form, as typing does."""
    page.js("(e => { e.value = arguments[1]; e.dispatchEvent(new Event('input', {bubbles: true})) })(document.getElementById(arguments[0]))", field, value)  # fmt: skip


def branched(page: Page) -> None:
    """Branch off where the cursor is."""
    page.click("#run-if-open")
    page.until("!document.getElementById('run-if').hidden")


def parts(page: Page, selector: str) -> list[str]:
    """The parts that are open below an element, each with its own line alone."""
    return [str(one) for one in page.js(
        "[...document.querySelectorAll(arguments[0] + ' .parts > li')].map(e => (e.querySelector('summary') ?? e).textContent)", selector)]  # fmt: skip


# ------------------------------------------------------------------ why


ROW = "#run-rows li:nth-child(1)"


def test_names_stay_names_and_unfold_level_by_level(page: Page, pages: Path) -> None:
    """First the part that refuses, by its name; a click says what the name stands for, with its values; the others are one fold away."""
    at(page, pages, "quiet", 2)
    page.click(f"{ROW} summary")
    page.until(f"document.querySelector('{ROW} .parts') !== null")
    assert page.text(f"{ROW} .meaning") == f"false may start and (counted < 900{FIXED_SPACE}count)"
    assert parts(page, ROW) == ["false may start"]
    page.click(f"{ROW} .parts summary")
    page.until(f"document.querySelectorAll('{ROW} .parts > li').length === 2")
    assert page.text(f"{ROW} .parts .meaning") == "is go and age within limit"
    value = f"1{NARROW_SPACE}200{FIXED_SPACE}ms"
    assert parts(page, ROW)[1] == f"false age within limit (age_ms = {value})"
    page.click(f"{ROW} .parts .parts summary")
    page.until(f"document.querySelectorAll('{ROW} .parts > li').length === 3")
    assert page.text(f"{ROW} .parts .parts .meaning") == f"is age_ms ≤ 1{NARROW_SPACE}000{FIXED_SPACE}ms"
    assert page.js(f"document.querySelectorAll('{ROW} .others').length") == 2
    assert "\u2026" not in page.text(ROW)
    assert page.said() == []


def test_what_was_unfolded_stays_open(page: Page, pages: Path) -> None:
    """From step to step, with the keyboard on it and the page where it was; what was closed stays closed."""
    page.size(*PHONE)
    at(page, pages, "quiet", 1)
    page.click(f"{ROW} summary")
    page.until(f"document.querySelector('{ROW} .parts') !== null")
    page.click(f"{ROW} .parts summary")
    page.until(f"document.querySelectorAll('{ROW} .parts > li').length === 3")
    page.js("scrollTo(0, 250)")
    before = page.js("scrollY")
    assert before > 0
    page.press(RIGHT)
    page.until("document.getElementById('run-said').textContent.startsWith('step 2 ')")
    assert parts(page, ROW) == [
        "false may start",
        f"false age within limit (age_ms = 1{NARROW_SPACE}200{FIXED_SPACE}ms)",
    ]
    assert page.js("scrollY") == before
    assert "may start" in page.js("document.activeElement.textContent")
    page.click(f"{ROW} summary")
    page.press(RIGHT)
    page.until("document.getElementById('run-said').textContent.startsWith('step 3 ')")
    assert not page.js(f"document.querySelector('{ROW} details').open")


def test_a_violation_shows_the_part_that_fails(page: Page, pages: Path) -> None:
    """At the step that breaks a claim stands its term with the values of its parts, of a late response the response."""
    at(page, pages, "busy", 4)
    page.until("document.querySelector('#run-fired .violated + details .parts') !== null")
    assert page.text("#run-fired .violated") == f"violated here: at most 3 counts, in 1{NARROW_SPACE}000{FIXED_SPACE}ms"
    assert page.text("#run-verdict") == "violated at steps 4 and 7 of 10"
    told = page.text("#run-fired details")
    assert f"counted = 4{FIXED_SPACE}count" in told
    assert "mode = ON" in told
    assert "false, but must be true" not in told
    at(page, pages, "busy", 7)
    page.until("document.querySelector('#run-fired .violated + details') !== null")
    assert "has not come within 6 steps" in page.text("#run-fired")
    assert "(mode = ON)" in page.text("#run-fired")
    assert page.said() == []


# ------------------------------------------------------------------ other inputs


def test_a_branch_is_checked(page: Page, pages: Path) -> None:
    """A violated property is said with its name, step and failing parts; it stops there; the jump leads to it; the words claim no proof."""
    at(page, pages, "quiet", 3)
    branched(page)
    assert page.js("document.getElementById('run-violating').hidden")
    assert "2 properties are checked in every step. That none is violated is no proof." in page.text("#run-if-says")
    filled(page, "run-input-age_ms", "500")
    page.click("#run-if-on")
    page.until("document.getElementById('run-if-broken').textContent !== ''")
    assert "3 steps taken: a property is violated." in page.text("#run-if-says")
    assert "violated: four counts, at most 3 counts" in page.text("#run-if-broken")
    assert "no proof speaks of it" in page.text("#run-verdict")
    assert page.js("document.querySelector('#run-verdict .verdict')") is None
    assert f"counted = 4{FIXED_SPACE}count" in page.text("#run-fired details")
    page.click("#run-start")
    page.click("#run-violating")
    page.until("document.getElementById('run-slider').value === '6'")
    page.click("#run-if-back")
    page.until("document.getElementById('run-if-broken').textContent === ''")
    assert page.js("document.getElementById('run-violating').hidden")
    page.click("#run-if-take")
    page.until("document.getElementById('run-if-broken').textContent !== ''")
    assert page.said() == []


def test_as_recorded_except_what_is_yours(page: Page, pages: Path) -> None:
    """Inputs that nobody set follow the recording; the one that was set stays until it is given back; the recording's end is said."""
    at(page, pages, "quiet", 0)
    branched(page)
    assert page.js("document.getElementById('run-if-how').value") == "recorded"
    filled(page, "run-input-age_ms", "5000")
    filled(page, "run-if-most", "4")
    page.click("#run-if-on")
    page.until("document.getElementById('run-slider').value === '4'")
    inputs = page.js("[...document.querySelectorAll('#run-steps tbody tr')].slice(1).map(r => r.cells[2].textContent)")
    assert [f"age_ms = 5{NARROW_SPACE}000" in one for one in inputs] == [True] * 4
    assert ["go = true" in one for one in inputs] == [bool(one["go"]) for one in keeper.QUIET[:4]]
    page.click("#run-if-inputs .own:not([hidden])")
    assert page.js("document.getElementById('run-input-age_ms').value") == "1500"
    filled(page, "run-if-most", "100")
    page.click("#run-if-on")
    page.until("document.getElementById('run-if-note').textContent !== ''")
    assert page.text("#run-if-note") == "The recording ends with step 25."
    assert page.js("document.getElementById('run-if-flaw').hidden")
    assert page.js("getComputedStyle(document.getElementById('run-if-note')).color === getComputedStyle(document.getElementById('run-if-title').parentNode).color")  # fmt: skip
    assert page.js("document.getElementById('run-slider').max") == "25"
    chosen(page, "run-if-until", "mode")
    page.click("#run-if-on")
    assert page.text("#run-if-note") == "The recording ends with step 25; no mode changed."
    page.click("#run-if-back")
    assert page.js("document.getElementById('run-if-note').hidden")
    filled(page, "run-if-most", "0")
    page.click("#run-if-on")
    assert page.text("#run-if-flaw") == f"at most 1 to 10{NARROW_SPACE}000 steps can be taken at once."


def test_until_a_mode_or_an_output_changes(page: Page, pages: Path) -> None:
    """It stops at the step that does what was asked for, and says how many were taken."""
    at(page, pages, "quiet", 0)
    branched(page)
    chosen(page, "run-if-how", "recorded")
    chosen(page, "run-if-until", "mode")
    page.click("#run-if-on")
    page.until("document.getElementById('run-if-says').textContent.startsWith('3 steps taken: a mode changes.')")
    chosen(page, "run-if-until", "output counted")
    page.click("#run-if-on")
    page.until("document.getElementById('run-if-says').textContent.startsWith('1 step taken: counted changes.')")
    assert page.js("document.getElementById('run-slider').value") == "4"


@pytest.mark.thorough(ordinary=1)
def test_until_the_position_is_withdrawn(page: Page, odometry: Path) -> None:
    """Both wheels fall silent in a recorded journey, all else goes on as recorded: the position is withdrawn in the end."""
    at(page, odometry, "odometry-service", 400)
    branched(page)
    chosen(page, "run-if-how", "recorded")
    for name in ("front_wheel_mm", "rear_wheel_mm"):
        filled(page, f"run-input-{name}", "")
    chosen(page, "run-if-until", "withdrawn")
    filled(page, "run-if-most", "1000")
    page.click("#run-if-on")
    page.until(
        "/^\\d+ steps taken: the position is withdrawn/.test(document.getElementById('run-if-says').textContent)"
    )
    assert 420 < int(page.js("document.getElementById('run-slider').value"))
    page.click("#run-if-on")
    assert "no position is valid at step" in page.text("#run-if-flaw")
    assert page.said() == []


@pytest.mark.thorough(ordinary=1)
def test_a_position_that_is_not_withdrawn_is_said(page: Page, odometry: Path) -> None:
    """Where the recording ends before the position is withdrawn, the page says both."""
    at(page, odometry, "odometry-service", 100)
    last = int(page.js("document.getElementById('run-slider').max"))
    at(page, odometry, "odometry-service", last - 2)
    branched(page)
    chosen(page, "run-if-until", "withdrawn")
    page.click("#run-if-on")
    page.until("!document.getElementById('run-if-note').hidden")
    assert page.text("#run-if-note") == f"The recording ends with step {last}; the position was not withdrawn."


# ------------------------------------------------------------------ a composition


def saved(page: Page, button: str) -> str:
    """Press a button that saves, and return the text of the file."""
    page.js("(window.kept = null, window.made ??= URL.createObjectURL, URL.createObjectURL = b => (b.text().then(t => (window.kept = t)), window.made.call(URL, b)))")  # fmt: skip
    page.click(button)
    return str(page.until("window.kept"))


def test_a_step_of_a_composition_is_taken_back(page: Page, composition: Path, tmp_path: Path) -> None:
    """With an input that no recording has: it goes one step back, also of a chosen machine, and what is saved holds every step."""
    at(page, composition, "ride", 4)
    branched(page)
    chosen(page, "run-if-how", "repeat")
    filled(page, "run-input-counter.moved_mm", "250")
    filled(page, "run-if-most", "3")
    page.click("#run-if-on")
    page.until("document.getElementById('run-slider').max === '7'")
    filled(page, "run-input-watcher.extra_mm", "12")
    for _ in range(2):
        page.click("#run-if-take")
    page.until("document.getElementById('run-slider').max === '9'")
    page.click("#run-if-back")
    page.until("document.getElementById('run-slider').max === '8'")
    for machine in ("watcher", "counter"):
        chosen(page, "run-part", machine)
        assert page.js("document.getElementById('run-slider').value") == "8"
        assert "NaN" not in page.js("document.getElementById('run').innerHTML")
    page.click("#run-if-back")
    page.until("document.getElementById('run-slider').max === '7'")
    page.click("#run-if-take")
    page.until("document.getElementById('run-slider').max === '8'")
    stream = tmp_path / "saved.jsonl"
    stream.write_text(saved(page, "#run-if-stream"), encoding="utf-8")
    taken = {**tandem.row(250), "watcher.extra_mm": 12}
    assert [dict(one) for one in read_steps(stream).steps] == [*tandem.RUN[:4], *[tandem.row(250)] * 3, taken]
    assert "warn" in saved(page, "#run-if-test")
    assert page.said() == []


# ------------------------------------------------------------------ the link


def place(page: Page) -> dict[str, list[str]]:
    """What the address holds."""
    return parse_qs(str(page.js("location.hash.slice(1)")))


def test_a_branch_is_in_its_link(page: Page, pages: Path) -> None:
    """The link has the steps of departure and what differs; opening it makes the same run."""
    at(page, pages, "quiet", 3)
    branched(page)
    filled(page, "run-input-age_ms", "500")
    filled(page, "run-if-most", "2")
    page.click("#run-if-on")
    page.until("new URLSearchParams(location.hash.slice(1)).get('take') !== null && location.hash.includes('step=5')")
    link = place(page)
    assert link["from"] == ["3"]
    assert json.loads(link["take"][0]) == [[1, {"age_ms": 500}], [1, {"age_ms": 500}]] or json.loads(
        link["take"][0]
    ) == [[2, {"age_ms": 500}]]
    shown = page.js("document.getElementById('run-steps').textContent")
    opened(page, pages, str(page.js("location.hash")))
    page.until("document.getElementById('run').classList.contains('branching')")
    assert page.js("document.getElementById('run-steps').textContent") == shown
    assert page.js("document.getElementById('run-slider').value") == "5"
    assert page.said() == []


WRONG_LINKS = {
    "another version": ({"of": "0123456789abcdef"}, "it is of another version of keeper"),
    "an unknown input": ({"take": '[[1,{"speed":1}]]'}, 'keeper: unknown inputs "speed"'),
    "out of range": ({"take": '[[1,{"age_ms":-1}]]'}, "age_ms: -1"),
    "no list": ({"take": '{"a":1}'}, "its changes are damaged"),
    "no JSON": ({"take": "[[1,"}, "its changes are damaged"),
    "too many steps": ({"take": "[[100000000,{}]]"}, f"it has more than 10{NARROW_SPACE}000 steps"),
    "no such step": ({"from": "99"}, "this run has no step 99"),
    "markup": ({"take": '[[1,{"<img src=x onerror=alert(1)>":1}]]'}, "unknown inputs"),
}


@pytest.fixture(scope="module")
def right_link(browser: Page, pages: Path) -> dict[str, str]:
    """The link of a branch of one step."""
    browser.size(*DESK)
    at(browser, pages, "quiet", 3)
    declared = browser.js("JSON.parse(document.getElementById('run-known').textContent)")
    assert declared["alone"]
    branched(browser)
    browser.click("#run-if-take")
    browser.until("location.hash.includes('take=')")
    return {name: one[0] for name, one in place(browser).items()}


@pytest.mark.parametrize("wrong", WRONG_LINKS)
def test_a_link_that_cannot_be_followed_is_refused(
    page: Page, pages: Path, right_link: dict[str, str], wrong: str
) -> None:
    """The reason stands above the stored run, and no step of the branch is shown."""
    changed, message = WRONG_LINKS[wrong]
    opened(page, pages, f"#{urlencode({**right_link, **changed})}")
    page.until("!document.getElementById('run-flaw').hidden")
    assert message in page.text("#run-flaw")
    assert "The stored run stands below." in page.text("#run-flaw")
    assert not page.js("document.getElementById('run').classList.contains('branching')")
    assert page.js("document.querySelectorAll('#run img').length") == 0
    assert page.text("#run-of") == "of 25"


def test_a_branch_too_long_for_a_link_says_so(page: Page, pages: Path) -> None:
    """It offers the stream; the link leads to the step of departure."""
    at(page, pages, "quiet", 3)
    branched(page)
    changes = json.dumps([[1, {"age_ms": 1001 + at % 7}] for at in range(700)])
    link = {**{name: one[0] for name, one in place(page).items()}, "from": "3", "take": changes, "step": "20"}
    page.click("#run-if-take")
    page.until("location.hash.includes('of=')")
    link["of"] = place(page)["of"][0]
    opened(page, pages, f"#{urlencode(link)}")
    page.until("document.getElementById('run-if-link').textContent.includes('save it as a stream')")
    assert "take" not in place(page)
    assert place(page)["step"] == ["3"]


# ------------------------------------------------------------------ how it looks


@pytest.mark.parametrize("width", [(1400, 900), DESK, PHONE], ids=["wide", "desk", "phone"])
def test_large_numbers_stay_in_their_cells(page: Page, composition: Path, width: tuple[int, int]) -> None:
    """A true position in nanometres has its whole width, on a desk in one line, and no text runs over its neighbour."""
    page.size(*width)
    at(page, composition, "ride", 2)
    number = NARROW_SPACE.join(("4", "421", "563", "453", "103"))
    cells = "[...document.querySelectorAll('#run-values td.n')]"
    assert number in page.js(f"{cells}.map(e => e.textContent)")
    assert page.js(f"{cells}.filter(e => e.scrollWidth > e.clientWidth).map(e => e.textContent)") == []
    lines = "(e => { const r = document.createRange(); r.selectNodeContents(e); return new Set([...r.getClientRects()].map(b => b.top)).size })"
    if width != PHONE:
        assert page.js(f"{lines}({cells}.find(e => e.textContent === arguments[0]))", number) == 1
    page.size(*DESK)


@pytest.mark.parametrize("width", [(1400, 900), PHONE], ids=["desk", "phone"])
def test_line_and_chart_are_seen_beside_the_form(page: Page, pages: Path, width: tuple[int, int]) -> None:
    """At a desk it stays beside the form; on a phone it stands above it and does not follow: the form has the screen. Nothing is wider."""
    page.size(*width)
    at(page, pages, "quiet", 3)
    branched(page)
    page.js("document.getElementById('run-if-take').scrollIntoView({block: 'start'})")
    box: Any = page.js(
        "(({top, bottom}) => [top, bottom])(document.querySelector('#run-charts svg').getBoundingClientRect())"
    )
    assert 0 <= box[0] < width[1] - 60 if width != PHONE else box[1] <= 0
    assert page.js("document.documentElement.scrollWidth") <= width[0]
    assert page.barriers() == []
    page.size(*DESK)


def test_enter_opens_the_first_name(page: Page, pages: Path) -> None:
    """In the filter of values it charts the first name that is left."""
    at(page, pages, "quiet", 3)
    page.type("#run-filter", "age", ENTER)
    page.until("[...document.querySelectorAll('#run-charts figcaption')].some(e => e.textContent.startsWith('age_ms'))")
    assert page.js("document.activeElement.getAttribute('aria-label')") == "chart of age_ms"


def test_a_defence_is_called_so(page: Page, tmp_path: Path) -> None:
    """In the list of runs and above the run: it shows no fault of the machine, but its answer to a law that is broken."""
    withstood = run(keeper.target.system, keeper.QUIET)
    method = "a defence: witness of 25 steps with its assumption broken"
    found = [
        Finding("keeper/obligation/withstands", "keeper", "obligation", "it withstands", Proved(None, "bmc", witness=withstood), method, 0.1),
        Finding("keeper/property/shown", "keeper", "property", "it comes", Proved(None, "bmc", witness=withstood), "witness", 0.1),
    ]  # fmt: skip
    folder = write_folder(tmp_path, found, [keeper.target]).parent
    opened(page, folder / "run.html", "#result=keeper%2Fobligation%2Fwithstands")
    assert "a defence: a run of 25 steps that breaks a law of the world" in page.text("#run-verdict")
    options = page.js("[...document.querySelectorAll('#run-choice option')].map(e => e.textContent)")
    assert sorted(options) == ["obligation/withstands (25, defence)", "property/shown (25)"]


def test_a_run_of_a_machine_by_itself_has_labels_and_units(page: Page, tmp_path: Path) -> None:
    """Of its modes and of wired inputs, which the composition has not; that it is a defence, and of which machine, is said."""
    alone = run(lower(tandem.watcher), [{"at_mm": 200, "quiet": False, "extra_mm": 7}])
    alone = replace(alone, system=replace(alone.system, name="tandem watcher"))
    method = "of the machine by itself, a defence: witness of 1 steps that breaks one law: 'x' in step 1"
    whole = run(tandem.target.system, tandem.RUN)
    found = [
        Finding("tandem/obligation/warns", "tandem", "obligation", "it warns", Proved(None, "bmc", witness=alone), method, 0.1),
        Finding("tandem/property/moves", "tandem", "property", "it moves", Proved(None, "bmc", witness=whole), "witness", 0.1),
    ]  # fmt: skip
    folder = write_folder(tmp_path, found, [tandem.target]).parent
    opened(page, folder / "run.html", "#result=tandem%2Fobligation%2Fwarns&step=1")
    assert "a defence: a run of 1 step of watcher by itself that breaks a law of the world" in page.text("#run-verdict")
    assert "watcher: warn CALM \u2192 ALERT" in page.text("#run-fired")
    rows = page.js(
        "[...document.querySelectorAll('#run-values tbody tr')].filter(e => !e.hidden && e.cells.length > 1).map(e => [...e.cells].slice(0, 4).map(c => c.textContent))"
    )
    assert ["at_mm", "\u2013", "200", "mm"] in rows and ["mode", "CALM", "ALERT", ""] in rows
    assert not page.js("document.getElementById('run').classList.contains('branching')")
    assert page.js("document.getElementById('run-if').hidden")
    assert page.said() == []


def test_inputs_are_filtered_and_what_was_set_stands_first(page: Page, composition: Path) -> None:
    """Grouped by machine; the filter has a label and takes keys; of few inputs there is none."""
    at(page, composition, "ride", 3)
    branched(page)
    groups = "[...document.querySelectorAll('#run-if-inputs [role=group]')].filter(e => !e.hidden).map(e => [e.ariaLabel, ...[...e.querySelectorAll('p')].filter(p => !p.hidden).map(p => p.querySelector('label').textContent)])"
    assert page.js(groups) == [["counter", "counter.moved_mm"], ["watcher", "watcher.quiet", "watcher.extra_mm"]]
    filled(page, "run-input-watcher.extra_mm", "9")
    page.click("#run-if-take")
    assert page.js(groups)[0] == ["set by you", "watcher.extra_mm"]
    assert page.js("document.getElementById('run-if-filters').hidden")
    page.js("document.getElementById('run-if-filters').hidden = false")
    page.type("#run-if-filter", "QUIET")
    assert page.js(groups) == [["watcher", "watcher.quiet"]]
    assert page.text("#run-if-found") == "1 of 3"
    assert page.js("document.getElementById('run-if-filter').labels[0].textContent") == "inputs with"


def test_a_link_holds_how_the_run_goes_on(page: Page, composition: Path) -> None:
    """The inputs that were set by hand, where the others come from, until what, and how many steps at most."""
    at(page, composition, "ride", 3)
    branched(page)
    chosen(page, "run-if-how", "recorded")
    filled(page, "run-input-watcher.extra_mm", "9")
    page.click("#run-if-take")
    chosen(page, "run-if-until", "mode")
    filled(page, "run-if-most", "4")
    page.until("location.hash.includes('until=mode') && location.hash.includes('most=4')")
    link = page.js("location.hash")
    opened(page, composition, link)
    page.until("!document.getElementById('run-if').hidden")
    values = page.js("['how', 'until', 'most'].map(name => document.getElementById(`run-if-${name}`).value)")
    assert values == ["recorded", "mode", "4"]
    assert page.js("document.getElementById('run-input-watcher.extra_mm').value") == "9"
    assert page.js("document.querySelector('#run-if-inputs [role=group]').ariaLabel") == "set by you"


def test_a_law_that_a_step_breaks_is_explained(page: Page, tmp_path: Path) -> None:
    """Which law, with its id and its words, and the parts of its term with their values; in the form its name."""
    (on,) = modes("ON")
    truth, heard = number("truth_mm", MM, 0, 100), optional("heard_mm", MM, 0, 200)
    law = Law(heard.present & (heard.value <= truth + 5), "Something is heard, within 5 mm of the truth.")
    world = World({truth: 50}, [], {truth: truth}, {"it hears the truth": law})
    ear = Machine("ear", (on,), [heard], {}, {}, [Transition("stay", on, on)], world=world)
    target = Target("ear", (ear,), lower(ear), ())
    witness = run(target.system, [{"heard_mm": 51}])
    finding = Finding(
        "ear/property/hears", "ear", "property", "it hears", Proved(None, "bmc", witness=witness), "", 0.1
    )
    folder = write_folder(tmp_path, [finding], [target]).parent
    opened(page, folder / "run.html", "#result=ear%2Fproperty%2Fhears&step=0")
    page.until("!document.getElementById('run-if-open').hidden")
    branched(page)
    filled(page, "run-input-heard_mm", "")
    page.click("#run-if-take")
    page.until("document.querySelector('#run-fired .parts') !== null")
    assert "this step breaks a law of the world" in page.text("#run-fired")
    assert f"broken: it hears the truth ear/A1Something is heard, within 5{FIXED_SPACE}mm of the truth." in page.text(
        "#run-fired"
    )
    assert any(part.startswith("false heard_mm.present") for part in parts(page, "#run-fired"))
    assert "Step 1 breaks ear: it hears the truth" in page.text("#run-if-broken")
    assert page.said() == []


# ------------------------------------------------------------------ tests of configurations


def test_a_named_configuration_can_be_saved_as_a_test(tmp_path: Path) -> None:
    """The page of a machine in a named configuration or with a file has the text of a test that loads it so."""
    for name, target in configured("emitter", ["one pattern is enough"]):
        path = tmp_path / "emitter.js"
        path.write_text(machine_script("emitter", target), encoding="utf-8")
        text = read_script(path, "safelocScript").decode()
        pieces = run_file_pieces(target, None)
        assert f'configured("emitter", ["{name}"])' in pieces[0]
        assert json.dumps(list(pieces)).replace(", ", ",")[1:40] in text.replace(", ", ",")
        trace = run(target.system, [{"test_requested": False, "next_chain_works": True}] * 4)
        made, [fired, *_] = run_file(target, trace, None), trace.steps[0].fired.values()
        saved = tmp_path / "test_saved.py"
        for content in (made, made.replace(f'["{fired}"]', '["another"]')):
            saved.write_text(content, encoding="utf-8")
            done = run_pytest("-q", "--rootdir", str(tmp_path), "test_saved.py", folder=tmp_path)
            assert ("2 passed" in done.stdout) == (content == made), done.stdout


def test_a_link_drives_a_machine(page: Page, odometry: Path) -> None:
    """It stands where a position is valid, is ready to go on until that is withdrawn, and does so when the sensors are emptied."""
    opened(page, odometry, "#result=odometry%2Frecording%2Fodometry-service&drive=")
    page.until("document.getElementById('run').classList.contains('branching')")
    valid = "[...document.querySelectorAll('#run-values tbody tr')].find(r => r.querySelector('code')?.textContent === 'valid').cells[2].textContent"
    assert "true" == page.js(valid)
    assert "empty its field" in page.text("#run-if-note")
    assert ("withdrawn", "recorded") == tuple(
        page.js(f"document.getElementById('{one}').value") for one in ("run-if-until", "run-if-how")
    )
    page.driver.execute_script(
        "for (const label of document.querySelectorAll('#run-if-inputs label')) if (/_(wheel|radar)_mm$/.test(label.textContent)) {"
        " const field = document.getElementById(label.htmlFor); field.value = ''; field.dispatchEvent(new Event('input', {bubbles: true})) }"
    )
    page.click("#run-if-on")
    page.until("document.getElementById('run-if-says').textContent.includes('the position is withdrawn')")
    assert "false" == page.js(valid)
    assert [] == page.said()
