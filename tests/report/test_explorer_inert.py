"""Texts that try to act, in a browser: whatever a machine, a claim, a configuration, a stream or a link says stays text."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.catalogue import Target, load_target
from safeloc.language.expr import boolean, number
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import never
from safeloc.language.system import lower
from safeloc.language.units import MM
from safeloc.language.verdict import Violated
from safeloc.proof.results import Finding
from safeloc.report.folder import write_folder
from safeloc.report.recordings_page import recordings_page
from safeloc.runtime.streams.steps import write_steps
from tests.report.browser import ENTER, Page, opened, runs_of
from tests.report.test_page import DOOR

EVIL = "\"'><script>window.acted = 1</script><img src=x onerror='window.acted = 2'>"


def evil() -> Target:
    """A machine whose every text tries to act."""
    on, off = modes("ON", "OFF")
    there, far = boolean("there"), number("far", MM, 0, 100)
    machine = Machine(
        "evil",
        modes=(on, off),
        inputs=[there, far],
        state={},
        outputs={},
        transitions=[Transition(f"go {EVIL}", on, off, there), Transition(f"back {EVIL}", off, on, ~there)],
        doc=f"doc {EVIL}",
    )
    claims = (never(f"claim {EVIL}", machine.fired(f"go {EVIL}"), statement=f"statement {EVIL}"),)
    return Target("evil", (machine,), lower(machine), claims, doc=machine.doc, spec=f"evil:{EVIL}", given={EVIL: EVIL})


def quiet(page: Page) -> None:
    """Nothing acted, and nothing tried to load."""
    assert page.js("window.acted === undefined")
    assert page.js("document.querySelectorAll('img').length") == 0
    assert page.said() == []


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("single", [False, True])
def test_texts_of_a_machine_are_inert(page: Page, tmp_path: Path, single: bool) -> None:
    """Names of transitions and properties, statements, reasons, documentation, the configuration, and the place asked for."""
    target = evil()
    trace = run(target.system, [{"there": True, "far": 1}, {"there": False, "far": 2}])
    wrong = Finding(
        f"evil/property/claim {EVIL}",
        "evil",
        "property",
        f"statement {EVIL}",
        Violated(trace, EVIL, EVIL),
        EVIL,
        1.0,
        (),
        EVIL,
    )
    path = write_folder(tmp_path, [wrong], [target], single=single)
    page.open(path, "#search=claim")
    page.until("document.querySelectorAll('#overview-found summary').length > 0")
    page.click("#overview-found summary")
    quiet(page)
    page.follow("run of 2 steps")
    page.until("document.getElementById('run-said')?.textContent")
    page.until("document.querySelector('#run-rows .tag') !== null")
    assert f"go {EVIL}" in page.text("#run-steps")
    page.type("#run-expression", EVIL, ENTER)
    quiet(page)
    page.open(runs_of(path), f"#result={EVIL}&step={EVIL}&chart={EVIL}&watch={EVIL}")
    page.until("document.getElementById('run-flaw').textContent")
    assert page.js("window.acted === undefined")


def test_texts_of_a_stream_are_inert(page: Page, tmp_path: Path) -> None:
    """The name of the file and remarks in its steps."""
    stream = tmp_path / "<img src=x onerror=window.acted=3>'\".jsonl"
    write_steps(stream, [{"speed": 0, "released": True, "blocked": False}] * 3, machine="door")
    path = tmp_path / "page.html"
    path.write_text(recordings_page(load_target(DOOR), [stream], made=f"{EVIL}"), encoding="utf-8")
    opened(page, path)
    assert "<img src=x" in page.text("#run-title")
    quiet(page)
