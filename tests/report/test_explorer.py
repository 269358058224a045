"""The pages in a browser: search, stepping through runs, links, keys, paper, colours, phones, and texts that try to act."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.language.interpret import run
from safeloc.proof.provers import portfolio
from safeloc.proof.provers.limits import Limits
from safeloc.proof.verification.calls import prove_target
from safeloc.report import page as page_module
from safeloc.report.folder import write_folder
from safeloc.report.recordings_page import recordings_page
from safeloc.report.run_page import OVERVIEW, RUNS, SHARED, asset, scripts
from safeloc.runtime.streams.steps import read_steps
from tests.explain import pump
from tests.report.browser import (
    DESK,
    DOWN,
    END,
    ENTER,
    ESCAPE,
    LEFT,
    PHONE,
    RIGHT,
    SHIFT,
    Page,
    opened,
    runs_of,
)
from tests.report.test_page import door, findings
from tests.started_pytest import run_pytest

WRONG = "#result=door%2Fproperty%2Fbad+%3Cb%3E"


@pytest.fixture(scope="module", params=["parts", "whole", "single"])
def report(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a report in each of its forms."""
    folder = tmp_path_factory.mktemp(request.param)
    most = page_module.MOST_OF_ONE_PAGE
    page_module.MOST_OF_ONE_PAGE = 0 if request.param == "parts" else most
    try:
        return write_folder(folder, findings(), [door()], single=request.param == "single")
    finally:
        page_module.MOST_OF_ONE_PAGE = most


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a machine's shipped recordings, with everything in it."""
    target = load_target("odometry")
    path = tmp_path_factory.mktemp("odometry") / "page.html"
    path.write_text(recordings_page(target, target.streams[:2], made="now"), encoding="utf-8")
    return path


def test_a_name_is_declared_once() -> None:
    """In each group of scripts with those that all share: a second function of a name would replace the first without a word."""
    for group in (OVERVIEW, RUNS):
        text = "\n".join(asset(f"explorer/{name}.js") for name in (*SHARED, *group))
        names = re.findall(r"^(?:async )?(?:function\*?|class|const|let) (\w+)", text, re.MULTILINE)
        assert len(names) > 10
        assert sorted(set(names)) == sorted(names)


def test_remarks_and_indentation_are_left_out() -> None:
    """Every statement stays in its line."""
    text = str(scripts(RUNS))
    assert not [line for line in text.splitlines() if line.startswith(("/*", " "))]
    for name in (*SHARED, *RUNS):
        lines = [line.strip() for line in asset(f"explorer/{name}.js").splitlines()]
        code = [line for line in lines if re.match(r"(?:async )?(?:function|class|const|let|return|if|for) ", line)]
        assert [line for line in code if line not in text.splitlines()] == []


# ------------------------------------------------------------------ overview


def found(page: Page) -> list[str]:
    """The rows of the search."""
    return [
        str(text) for text in page.js("[...document.querySelectorAll('#overview-found summary')].map(e => e.innerText)")
    ]


@pytest.mark.thorough(ordinary=1)
def test_search_and_filter(page: Page, report: Path) -> None:
    """By words of a claim, by kind and by verdict; what does not hold comes first; nothing is said on the console."""
    page.open(report)
    page.type("body", "/")
    page.press("statement")
    page.until("document.getElementById('overview-count').textContent === '4 found'")
    assert [row.split("\n")[0] for row in found(page)] == ["violated", "unknown", "shown by a run", "held"]
    page.js("document.getElementById('overview-verdict').focus()")
    page.js(
        "(e => { e.value = 'shown by a run'; e.dispatchEvent(new Event('change')) })(document.getElementById('overview-verdict'))"
    )
    page.until("document.getElementById('overview-count').textContent === '1 found'")
    assert "good" in found(page)[0]
    page.type("#overview-words", ESCAPE)
    page.until("document.getElementById('overview-count').textContent === ''")
    page.press("start to close")
    page.until("document.querySelector('#overview-found')?.innerText.includes('transition')")
    assert page.said() == []


def test_a_result_leads_to_its_evidence(page: Page, report: Path) -> None:
    """By keys from the search to its statement, certificate and source lines, and by one click to its run; the link remembers the search."""
    page.open(report, "#search=good")
    page.until("document.getElementById('overview-count').textContent === '1 found'")
    page.type("#overview-words", DOWN)
    page.press(ENTER)
    page.until("document.querySelector('#overview-found .leads') !== null")
    assert "statement of good" in page.text("#overview-found li")
    links = page.js(
        "[...document.querySelectorAll('#overview-found .leads a')].map(a => [a.textContent, a.getAttribute('href')])"
    )
    assert {"run of 3 steps", "certificates good.smt2", "in the report"} <= {words for words, _ in links}
    page.follow("run of 3 steps")
    page.until("document.getElementById('run-title')?.textContent === 'good'")
    page.until("document.getElementById('run-said').textContent !== ''")
    assert page.said() == []


@pytest.mark.thorough(ordinary=1)
def test_enter_opens_the_first_hit(page: Page, report: Path) -> None:
    """From the search field itself, as it is typed: the first result is open and has the keyboard."""
    page.open(report)
    page.type("#overview-words", "good", ENTER)
    page.until("document.querySelector('#overview-found .leads') !== null")
    assert page.js("document.activeElement === document.querySelector('#overview-found summary')")
    assert "statement of good" in page.text("#overview-found li")


_EARLIER_IS_LATER = """(() => {
    const plain = Response.prototype.text;
    window.unpacked = 0;
    Response.prototype.text = async function () {
        const text = await plain.call(this);
        await new Promise(done => setTimeout(done, 600 - 200 * Math.min(window.unpacked++, 2)));
        return text;
    };
})()"""


@pytest.mark.thorough(ordinary=1)
def test_a_search_that_was_overtaken_closes_nothing(page: Page, report: Path) -> None:
    """Each key searches, before the results have been read; those of the last one stay, and they are read once."""
    page.open(report)
    page.js(_EARLIER_IS_LATER)
    page.type("#overview-words", "good", ENTER)
    page.until("document.querySelector('#overview-found .leads') !== null")
    page.driver.execute_async_script("setTimeout(arguments[0], 700)")
    assert page.js("document.querySelector('#overview-found details[open] .leads') !== null")
    assert page.js("window.unpacked") == 1


def test_a_place_in_a_part_is_found(page: Page, report: Path) -> None:
    """A link to the row of a result opens the part in which it is, and the fold around it."""
    page.open(report, "#search=tried")
    page.until("document.getElementById('overview-count').textContent === '1 found'")
    page.click("#overview-found summary")
    page.follow("in the report")
    page.until("document.getElementById('door').getBoundingClientRect().top < innerHeight")
    assert page.said() == []


def test_a_part_of_another_report_hides_the_verdict(
    page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No verdict is shown beside evidence of another report; the reason is."""
    monkeypatch.setattr(page_module, "MOST_OF_ONE_PAGE", 0)
    path = write_folder(tmp_path, findings(), [door()])
    (tmp_path / "page" / "beside.js").write_text('safelocBeside("0123456789abcdef");\n', encoding="utf-8")
    page.open(path)
    page.until("document.documentElement.classList.contains('unfit')")
    assert "of another report" in page.text("#beside")
    assert page.js("[...document.querySelectorAll('.verdict')].every(e => e.offsetParent === null)")


# ------------------------------------------------------------------ a run


def test_step_through_a_violation(page: Page, report: Path) -> None:
    """It opens at the step that violates; keys and buttons move; the link follows; values, row and diagram are those of the step."""
    opened(page, runs_of(report), WRONG)
    page.until("document.getElementById('run-slider').value === '3'")
    assert page.text("#run-verdict") == "violated at step 3 of 3"
    assert "violated here: statement of bad <b>" in page.text("#run-fired")
    page.press(LEFT)
    page.until("document.getElementById('run-said').textContent === 'step 2 of 3: start to close'")
    assert page.js("document.querySelector('.diagram .now').dataset.mode") == "CLOSING"
    assert page.js("[...document.querySelectorAll('.diagram .taken')].map(e => e.dataset.from)") == ["OPEN"]
    assert page.text('#run-steps [aria-current="step"] td') == "2"
    page.until("location.hash.endsWith('&step=2')")
    page.press("v")
    page.until("document.getElementById('run-slider').value === '3'")
    page.click("#run-start")
    page.until("document.getElementById('run-said').textContent === 'step 0 of 3: start'")
    assert page.said() == []


def value(page: Page, name: str) -> list[str]:
    """What the table says of a name: before and after."""
    return [str(cell) for cell in page.js(
        "Array.from([...document.querySelectorAll('#run-values tr')].find(r => r.cells[0].textContent === arguments[0] && !r.hidden)"
        "?.cells ?? [], cell => cell.textContent)", name)][1:3]  # fmt: skip


@pytest.mark.thorough(ordinary=1)
def test_values_before_and_after(page: Page, report: Path) -> None:
    """Labels, truth values and numbers; only what changed; names by a word."""
    opened(page, runs_of(report), f"{WRONG}&step=2")
    assert value(page, "mode") == ["OPEN", "CLOSING"]
    assert value(page, "released") == ["true", "false"]
    page.click("#run-only")
    assert value(page, "speed") == []
    page.type("#run-filter", "released")
    assert value(page, "mode") == []
    assert value(page, "released") == ["true", "false"]


@pytest.mark.thorough(ordinary=1)
def test_nothing_is_before_the_first_step(page: Page, report: Path) -> None:
    """Inputs and outputs have a dash there, not the word for an absent value; the table fits into half of a laptop's screen."""
    page.size(1280, 800)
    opened(page, runs_of(report), f"{WRONG}&step=1")
    assert "\u2013" == value(page, "speed")[0] == value(page, "released")[0]
    assert "LOCKED" == value(page, "mode")[0]
    assert page.js("document.querySelector('.values').scrollWidth <= document.querySelector('.values').clientWidth")


@pytest.mark.thorough(ordinary=1)
def test_why_a_transition_is_refused(page: Page, report: Path) -> None:
    """The machine itself says which part of the guard is false, with the values that it reads."""
    opened(page, runs_of(report), f"{WRONG}&step=1")
    page.until("document.querySelector('#run-rows .tag')?.textContent === 'fired'")
    opened(page, runs_of(report), f"{WRONG}&step=3")
    page.until("document.querySelectorAll('#run-rows .tag').length === 3")
    rows = page.js("[...document.querySelectorAll('#run-rows ol > li')].map(e => e.textContent)")
    assert "obstacle" in rows[0] and "fired" in rows[0]
    assert "lock" in rows[1] and "refused" in rows[1]
    page.click("#run-rows li:nth-child(2) summary")
    page.until("document.querySelector('#run-rows li:nth-child(2) .meaning') !== null")
    page.click("#run-rows li:nth-child(2) .others summary")
    page.until("document.querySelector('#run-rows li:nth-child(2) .parts .parts') !== null")
    assert "closing_for = 0" in page.text("#run-rows li:nth-child(2) details")
    assert page.said() == []


@pytest.mark.thorough(ordinary=1)
def test_watch_expressions(page: Page, report: Path) -> None:
    """Names and whole numbers, exactly; what makes no sense is said in its place; the link remembers them."""
    opened(page, runs_of(report), f"{WRONG}&step=2&watch=closing_for+%2B+2+*+%28speed+-+3%29+%3C+0+and+not+blocked")
    assert page.js("[...document.querySelectorAll('#run-watched td')].map(e => e.textContent).slice(0, 2)") == [
        "true",
        "true",
    ]
    for text, expected in (("mode", "CLOSING"), ('mode = "OPEN"', "false"), ("speed + 9007199254740993", "9\u202f007\u202f199\u202f254\u202f740\u202f993"),
                           ("1 +", "something is missing at the end"), ("speed and 1", "0 is neither true nor false"), ("none", "no none"), ("(1", "a parenthesis is not closed")):  # fmt: skip
        page.type("#run-expression", text, ENTER)
        shown = page.js("document.querySelector('#run-watched tr:last-child').cells[2].textContent")
        assert shown.startswith(expected), text
    page.until("new URLSearchParams(location.hash.slice(1)).getAll('watch').includes('mode')")
    assert page.said() == []


@pytest.mark.thorough(ordinary=1)
def test_branch_off_with_other_inputs(page: Page, report: Path, tmp_path: Path) -> None:
    """The machine goes on in the page as the interpreter does; the run is saved as a stream and as a test; no verdict speaks of it."""
    opened(page, runs_of(report), f"{WRONG}&step=1")
    page.until("!document.getElementById('run-if-open').hidden")
    page.driver.execute_script(
        "window.saved = []; HTMLAnchorElement.prototype.click = () => {};"
        "const make = URL.createObjectURL; URL.createObjectURL = (blob) => (blob.text().then((t) => saved.push(t)), make(blob))"
    )
    page.click("#run-if-open")
    page.js("(document.getElementById('run-if-how').value = 'repeat')")
    assert "violated" not in page.text("#run-verdict")
    assert page.js("document.querySelector('#run-verdict .verdict')") is None
    page.js("document.getElementById('run-input-released').value = 'true'")
    page.click("#run-if-take")
    page.js("(document.getElementById('run-input-released').value = 'false')")
    page.type("#run-input-speed", "7")
    page.click("#run-if-on")
    page.until("document.getElementById('run-said').textContent.startsWith('step 12 of 12')")
    page.click("#run-if-back")
    page.type("#run-input-speed", "metres")
    page.click("#run-if-take")
    assert page.text("#run-if-flaw") == "speed: 07metres is no whole number."
    page.js("(document.getElementById('run-input-speed').value = '100001')")
    page.click("#run-if-take")
    assert "100\u202f001\xa0mm/s is outside 0..100\u202f000" in page.text("#run-if-flaw")
    rows = [{"speed": 0, "blocked": False, "released": True}] * 2 + [
        {"speed": 7, "blocked": False, "released": False}
    ] * 9
    rows[1] = {**rows[1], "speed": 0}
    expected = run(door().system, rows)
    assert value(page, "closing_for")[1].replace("\u202f", "") == str(expected.steps[-1].state["closing_for"])
    assert next(iter(expected.steps[-1].fired.values())) in page.text("#run-said")
    page.click("#run-if-stream")
    page.until("window.saved.length === 1")
    (tmp_path / "mine.jsonl").write_text(page.js("window.saved[0]"), encoding="utf-8")
    assert rows == [dict(step) for step in read_steps(tmp_path / "mine.jsonl").steps]
    page.click("#run-if-test")
    page.until("window.saved.length === 2")
    (tmp_path / "test_mine.py").write_text(page.js("window.saved[1]"), encoding="utf-8")
    done = run_pytest("-q", "--rootdir", str(tmp_path), "test_mine.py", folder=tmp_path)
    assert "2 passed" in done.stdout, done.stdout + done.stderr
    page.click("#run-if-close")
    page.until("document.getElementById('run-said').textContent === 'step 1 of 3: open'")
    assert "violated" in page.text("#run-verdict")


def test_a_run_from_any_state_is_not_saved(page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A counterexample to induction begins where no run begins: a stream of it would be another run."""
    monkeypatch.setattr(portfolio, "_ENGINES", portfolio._QUICK)  # Spacer would prove it
    undecided = pump.target(pump.OPEN)
    folder = write_folder(tmp_path, prove_target(undecided, limits=Limits(depth=3), jobs=1), [undecided]).parent
    opened(page, runs_of(folder / "index.html"), "#result=pump%2Fproperty%2Fcounted+too+high&step=1")
    page.until("!document.getElementById('run-if-open').hidden")
    page.click("#run-if-open")
    page.click("#run-if-stream")
    assert "begins in a state that is no first state of the machine" in page.text("#run-if-flaw")
    assert page.said() == []


def test_recordings_of_a_machine(page: Page, recordings: Path) -> None:
    """Hundreds of steps: jumps to the next fired transition and to the change of a variable, another recording, zoom, play."""
    opened(page, recordings)
    last = page.js("document.getElementById('run-slider').max")
    page.press(SHIFT, RIGHT, RIGHT)
    page.until("Number(document.getElementById('run-slider').value) > 1")
    assert "candidate" in page.text("#run-said")
    page.type("#run-variable", "mode")
    page.click("#run-change-next")
    page.until("!document.getElementById('run-fired').textContent.includes(' in ')")
    page.js("document.activeElement.blur()")
    page.press(END)
    page.until("document.getElementById('run-slider').value === arguments[0]", last)
    assert page.text('#run-steps [aria-current="step"] td') == last
    before = page.js("document.querySelector('#run-charts .line').getAttribute('d')")
    page.press("+")
    assert before != page.js("document.querySelector('#run-charts .line').getAttribute('d')")
    page.click("#run-start")
    page.click("#run-play")
    page.until("Number(document.getElementById('run-slider').value) > 2")
    page.click("#run-play")
    page.js(
        "(e => { e.value = e.options[1].value; e.dispatchEvent(new Event('change')) })(document.getElementById('run-choice'))"
    )
    page.until("document.getElementById('run-title').textContent === 'odometry-service'")
    assert page.said() == []


def test_the_line_at_a_step(page: Page, recordings: Path) -> None:
    """The train is drawn at its recorded place, within the interval that is stated; without a valid position there is no interval."""
    stream = load_target("odometry").streams[0]
    truths = [step["truth_mm"] for step in read_steps(stream).steps]
    opened(page, recordings)
    seen = set()
    for step in range(1, len(truths), max(1, len(truths) // 12)):
        page.js(
            "(e => { e.value = arguments[0]; e.dispatchEvent(new Event('input')) })(document.getElementById('run-slider'))",
            step,
        )
        words = str(page.js("document.querySelector('#run-line svg').getAttribute('aria-label')"))
        words = words.replace("\u202f", "").replace("\u2212", "-")
        stated = re.search(r"reported (\S+) m to (\S+) m", words)
        at_m = float(re.findall(r"train at (\S+) m", words)[0])
        assert abs(1000 * at_m - int(str(truths[step - 1]))) <= 1
        seen.add(stated is not None)
        assert stated is None or float(stated[1]) <= at_m <= float(stated[2])
    assert seen == {True, False}


def test_what_is_missing_or_damaged_is_said(page: Page, tmp_path: Path) -> None:
    """A file of runs that is gone, is no script, or is of another report; a result without a run."""
    folder = write_folder(tmp_path, findings(), [door()]).parent
    page.open(folder / "run.html", "#result=door%2Fproperty%2Fnone")
    assert "has no run of door/property/none" in page.until("document.getElementById('run-flaw').textContent")
    page.open(folder / "run.html", "#result=window%2Fproperty%2Fnone")
    assert "no run of window/property/none" in page.until("document.getElementById('run-flaw').textContent")
    runs = folder / "traces" / "door.js"
    runs.write_text(re.sub(r'"H4s.*"', '"AAAA"', runs.read_text()), encoding="utf-8")
    page.open(folder / "run.html", WRONG)
    assert "traces/door.js is damaged" in page.until("document.getElementById('run-flaw').textContent")
    runs.unlink()
    page.open(folder / "run.html", WRONG)
    assert "traces/door.js is missing" in page.until("document.getElementById('run-flaw').textContent")


# ------------------------------------------------------------------ paper, colours, phones, screen readers


def test_paper_has_every_step(page: Page, recordings: Path) -> None:
    """All steps in full, without buttons; the screen has what it had before."""
    opened(page, recordings)
    page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        page.js("dispatchEvent(new Event('beforeprint'))")
        steps = int(page.js("document.getElementById('run-slider').max"))
        assert steps + 1 == page.js("document.querySelectorAll('#run-steps tbody tr').length")
        assert page.js("document.querySelector('.bar').offsetParent") is None
        assert page.js(
            "document.getElementById('run-steps-box').scrollHeight <= document.getElementById('run-steps-box').clientHeight"
        )
        page.js("dispatchEvent(new Event('afterprint'))")
        assert steps + 1 > page.js("document.querySelectorAll('#run-steps tbody tr').length")
    finally:
        page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})


def test_paper_has_every_part(page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Parts that were not open are opened before the page is printed."""
    monkeypatch.setattr(page_module, "MOST_OF_ONE_PAGE", 0)
    page.open(write_folder(tmp_path, findings(), [door()]))
    page.driver.execute_script(
        "window.print = () => (window.printed = document.querySelectorAll('details.part:not([data-shown])').length)"
    )
    page.click("#print-all")
    assert page.until("window.printed !== undefined")
    assert page.js("window.printed") == 0


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("width", [DESK, PHONE], ids=["desk", "phone"])
def test_no_barrier_for_anybody(page: Page, report: Path, recordings: Path, dark: bool, width: tuple[int, int]) -> None:
    """Axe finds nothing serious, and nothing is wider than the screen: the report with search, a violation, a recording."""
    page.dark(dark)
    page.size(*width)
    page.open(report, "#search=door")
    page.until("document.querySelectorAll('#overview-found summary').length > 3")
    page.click("#overview-found summary")
    assert page.barriers() == []
    assert page.js("document.documentElement.scrollWidth") <= width[0]
    for path, place in ((runs_of(report), WRONG), (recordings, "")):
        opened(page, path, place)
        page.until("document.querySelector('#run-rows .tag') !== null")
        page.click("#run-if-open")
        page.type("#run-expression", "mode", ENTER)
        assert page.barriers() == []
        assert page.js("document.documentElement.scrollWidth") <= width[0]


def test_a_barrier_is_found(page: Page, tmp_path: Path) -> None:
    """An input without a name and grey words on grey are serious, so the check above can fail."""
    path = tmp_path / "bad.html"
    path.write_text(
        '<html lang="en"><title>t</title><main><input><p style="color:#999;background:#aaa">grey</p></main>'
    )
    page.open(path)
    assert {"label", "color-contrast"} == {one.partition(":")[0] for one in page.barriers()}
