"""What a notebook shows of machines, runs and verdicts: tables, in which every text of a user is text."""

from __future__ import annotations

import re
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser

import pytest

from safeloc.language.expr import boolean, number
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Held, NotAsked, Proved, Unknown, Vacuous, Violated
from safeloc.proof.results import Finding, Findings

OFF, ON = modes("OFF", "ON")
go, uses = boolean("go"), number("uses", COUNT, 0, 999)
MACHINE = Machine(
    "lamp <1>",
    modes=(OFF, ON),
    inputs=[go],
    state={uses: 0},
    outputs={},
    transitions=[
        Transition("on & off", OFF, ON, go, {uses: uses + 1}, requirements=("MRK-1",)),
        Transition("off", ON, OFF, ~go),
    ],
    doc="A lamp.\n\nMore of it.",
)


def rows(text: str) -> list[list[str]]:
    """The cells of each row of a table; the text is balanced HTML."""
    Balanced().feed(text)
    return [
        [unescape(cell) for cell in re.findall(r"<t[hd]>(.*?)</t[hd]>", row)]
        for row in re.findall(r"<tr>(.*?)</tr>", text)
    ]


class Balanced(HTMLParser):
    """Asserts that every element is closed where it should be."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: object) -> None:  # noqa: ARG002 # the base class names it
        """Remember it."""
        self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        """It closes the last one."""
        assert self.open.pop() == tag


def test_a_machine_is_its_table() -> None:
    """A row for each transition, with guard and updates."""
    text = MACHINE._repr_html_()
    assert "<b>lamp &lt;1&gt;</b>: machine with the modes OFF, ON" in text
    assert "<p>A lamp.</p>" in text
    assert rows(text) == [
        ["transition", "from", "to", "guard", "sets", "requirements"],
        ["on & off", "OFF", "ON", "go", "uses := uses + 1 count", "MRK-1"],
        ["off", "ON", "OFF", "not go", "", ""],
    ]


def test_a_run_shows_what_changes() -> None:
    """The first state in full, then what fires and what changes."""
    trace = run(lower(MACHINE), [{"go": True}, {"go": True}, {"go": False}])
    assert rows(trace._repr_html_()) == [
        ["step", "fires", "inputs", "state that changes"],
        ["0", "start", "", "mode=OFF  uses=0"],
        ["1", "on & off", "go=true", "mode=ON  uses=1"],
        ["2", "(stay)", "go=true", ""],
        ["3", "off", "go=false", "mode=OFF"],
    ]


def test_a_long_run_says_what_it_leaves_out() -> None:
    """As many steps as a text table has."""
    text = run(lower(MACHINE), [{"go": True}] * 200)._repr_html_()
    left_out = re.search(r"<p>(\d+) more steps are left out.</p>", text)
    assert left_out is not None
    assert len(rows(text)) - 2 + int(left_out[1]) == 200
    assert rows(text)[-1][0] == "200"


@pytest.mark.parametrize(
    ("verdict", "text", "with_run"),
    [
        (Proved(None, "1-induction"), "<b>proved</b>: by 1-induction", False),
        (Violated(run(lower(MACHINE), [{"go": True}]), "bmc"), "<b>violated</b>: found by bmc.", True),
        (Violated(None, "bmc", "a < b"), "<b>violated</b>: found by bmc. a &lt; b", False),
        (Vacuous("never & nowhere"), "<b>vacuous</b>: never &amp; nowhere", False),
        (Unknown("no time"), "<b>unknown</b>: no time", False),
        (NotAsked("nothing"), "<b>not asked</b>: nothing", False),
        (Held("replay", 1, 20), "<b>held</b>: replay, 1 runs, 20 steps", False),
    ],
)
def test_a_verdict_is_its_word_and_evidence(
    verdict: Proved | Violated | Vacuous | Unknown | NotAsked | Held, text: str, *, with_run: bool
) -> None:
    """With the run that shows it, where there is one."""
    made = verdict._repr_html_()
    Balanced().feed(made)
    assert text in made
    assert ("<table>" in made) is with_run


def test_findings_are_a_table_with_their_count() -> None:
    """Names and statements are text, whatever they look like."""
    odd = Finding("door/property/<b>", "door", "property", "it is <i>", Unknown("why"), "search", 0.1)
    found = Findings([odd, replace(odd, id="door/lemma/a/b", kind="lemma", result=Proved(None, "bmc"))])
    text = found._repr_html_()
    assert text.startswith("<p>1 unknown, 1 proved</p>")
    assert rows(text)[1][3:5] == ["<b>", "it is <i>"] and rows(text)[2][3] == "a/b"
    assert "<b>" not in text and Findings()._repr_html_().startswith("<p>no findings</p>")
