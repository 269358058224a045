"""`safeloc explain TARGET PROPERTY STREAM`: where a recording violates a property and by which inputs, or how near it comes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.calling import Call
from tests.started_pytest import run_pytest

PUMP = Path(__file__).parents[1] / "explain" / "pump.py"
HEAD = '{"schema": "safeloc-stream/1", "first": {"label": 3}}\n'
LONG = HEAD + '{"go": true, "extra": 2}\n' + '{"go": false, "extra": 1}\n' * 8
GHOSTS = """
from safeloc.language.expr import number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always
from safeloc.language.units import MM
from safeloc.language.world import World

ON, OFF = modes("ON", "OFF")
wheel, far, truth, run = (number(name, MM, 0, 100) for name in ("wheel", "far", "truth", "run"))
machine = Machine(
    "cart", modes=(ON, OFF), inputs=[wheel], state={far: 0}, outputs={"far": far},
    transitions=[Transition("roll", ON, ON, wheel >= 1, {far: wheel})],
    world=World(ghosts={truth: 0}, choices=[run], moves={truth: run}),
)
properties = [always("near", far <= 50), always("true", far <= truth)]
"""


@pytest.fixture
def pump(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The pump in the present folder, with a recording of nine steps."""
    monkeypatch.chdir(tmp_path)
    text = PUMP.read_text(encoding="utf-8")
    Path("pump.py").write_text(
        f"{text}\n\nproperties = [TOO_MANY, FEW_LEFT, COMES, LATE, OPEN, FALLS]\n", encoding="utf-8"
    )
    Path("run.jsonl").write_text(LONG, encoding="utf-8")
    return "pump.py:machine"


def test_a_violation_is_told_with_what_matters(call: Call, pump: str) -> None:
    """The first step that violates it, the one input that matters of those recorded, the broken term, and a test that fails."""
    called = call("explain", pump, "too many strokes", "run.jsonl", "--pytest", "test_pump.py")
    assert (called.code, called.err) == (1, "test: test_pump.py\n")
    told = called.out.splitlines()
    assert "  violated: first in step 5 of 9 steps of run.jsonl" in told
    assert "  go in step 1; go=true in step 1" in told
    assert "     1  begin  [go=true]" in told
    assert "extra" not in called.out
    assert "    true  3 count < strokes    strokes = 4" in told
    assert 1 == run_pytest("-q", "test_pump.py").returncode


def test_without_a_violation_the_least_margin_is_told(call: Call, pump: str) -> None:
    """0 would still hold; no test is written, and the exit code is that of what was held."""
    called = call("explain", pump, "counted too high", "run.jsonl", "--pytest", "none.py")
    assert (called.code, Path("none.py").exists()) == (0, False)
    assert "  held: not violated in 9 steps of run.jsonl; this is no proof\n" in called.out
    assert "  12 count in step 9: not (20 count < counted)    counted = 8\n" in called.out
    assert "no run that violates 'counted too high' was found" in called.err
    called = call("explain", pump, "strokes never fall", "run.jsonl")
    assert (called.code, "least margin" in called.out, "  0 count in step 1: " in called.out) == (0, True, True)


def test_what_a_state_reached_is_told(call: Call, pump: str) -> None:
    """In which step, or that this recording does not."""
    called = call("explain", pump, "cools", "run.jsonl")
    assert (called.code, "unknown: not reached in this trace" in called.out) == (3, True)
    Path("run.jsonl").write_text(LONG + '{"go": false}\n' * 3, encoding="utf-8")
    called = call("explain", pump, "cools", "run.jsonl")
    assert (called.code, "reached: first in step 11 of run.jsonl" in called.out) == (0, True)


def test_the_first_state_and_a_late_response(call: Call, pump: str) -> None:
    """No input matters for the first; of the second, the step in which the time was over."""
    first = call("explain", pump, "six left", "run.jsonl")
    assert (first.code, "violated: first in the first state of 9 steps" in first.out) == (1, True)
    assert "none: with all inputs at rest it is violated as well" in first.out
    late = call("explain", pump, "off soon", "run.jsonl", "--json")
    assert 1 == late.code
    sections = {one["heading"]: one["lines"] for one in json.loads(late.out)["sections"]}
    assert ["violated: first in step 4 of 9 steps of run.jsonl"] == sections["On this recording"]
    assert 4 == len(json.loads(late.out)["run"]["steps"])


def test_a_recording_without_the_truth(call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What needs no truth is explained, and its test runs the machine on board; what needs it is not asked."""
    monkeypatch.chdir(tmp_path)
    Path("cart.py").write_text(GHOSTS, encoding="utf-8")
    Path("run.jsonl").write_text('{"wheel": 3}\n{"wheel": 70}\n', encoding="utf-8")
    called = call("explain", "cart.py:machine", "near", "run.jsonl", "--pytest", "test_cart.py")
    assert (called.code, "far = 70" in called.out) == (1, True)
    done = run_pytest("-q", "test_cart.py")
    assert (done.returncode, "1 failed" in done.stdout) == (1, True)
    called = call("explain", "cart.py:machine", "true", "run.jsonl")
    assert (called.code, "not asked: the property reads the truth" in called.out) == (3, True)


def test_a_recording_that_is_not_there(call: Call, pump: str) -> None:
    """The name is told; nothing is proved instead."""
    called = call("explain", pump, "cools", "walk.jsonl")
    assert (called.code, "walk.jsonl: no such file" in called.err, called.out) == (2, True, "")


def test_replay_begins_and_ends_with_the_verdict(call: Call, pump: str) -> None:
    """Between them stand the steps, and of each violation the part that fails in its first step."""
    called = call("replay", pump, "run.jsonl")
    told = called.out.splitlines()
    assert called.code == 1
    assert "not all holds: 2 held in tests and replays, 3 violated" == told[0] == told[-1]
    assert "too many strokes: the part that fails in step 5, with its values" in told
    assert "    true  3 count < strokes    strokes = 4" in told
