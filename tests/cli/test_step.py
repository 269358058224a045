"""`safeloc step` as a script on standard input drives it."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

from tests.cli.calling import Call, Called
from tests.started_pytest import run_pytest

LAMP = """
from safeloc.language.expr import boolean, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import never
from safeloc.language.units import COUNT
from safeloc.language.world import World

OFF, ON = modes("OFF", "ON")
go, uses = boolean("go"), number("uses", COUNT, 0, 9)
machine = Machine(
    name="lamp", modes=(OFF, ON), inputs=[go], state={uses: 0}, outputs={"uses_left": 9 - uses},
    transitions=[Transition("on", OFF, ON, go & (uses < 9), {uses: uses + 1}), Transition("off", ON, OFF, ~go)],
    world=World(clauses={"nobody switches": ~go}),
)
properties = [never("worn", uses > 0)]
"""


@pytest.fixture
def lamp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The address of a user's machine in the present folder."""
    monkeypatch.chdir(tmp_path)
    Path("lamp.py").write_text(LAMP, encoding="utf-8")
    return "lamp.py:machine"


def typed(call: Call, monkeypatch: pytest.MonkeyPatch, *arguments: str, lines: str) -> Called:
    """The command with these lines on standard input."""
    monkeypatch.setattr("sys.stdin", io.StringIO(lines))
    return call("step", *arguments)


def test_a_session(call: Call, lamp: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each command answers; the saved run replays."""
    lines = "rows\nset go=true\nstep\nwatch uses_left\nbroken\nback\nstate\nset go=true\nstep 2\nsave run.jsonl\nquit\nrows\n"
    called = typed(call, monkeypatch, lamp, lines=lines)
    assert called.code == 0
    told = [line.strip() for line in called.out.splitlines()]
    assert told == [
        "step 1, the next one, with the inputs as they stand:",
        "refused  lamp: on -> ON",
        "false go and (uses < 9 count)",
        "false go",
        "inputs: go=true",
        "1  on",
        "breaks the law lamp: nobody switches",
        "no proof speaks of what follows",
        "mode=ON",
        "watched after each step: uses_left",
        "claim nothing since step 1, which broke their assumption: worn",
        "no property is broken so far",
        "mode=OFF",
        "state: mode=OFF  uses=0",
        "inputs: go=true",
        "1  on",
        "uses_left=8",
        "2  off",
        "every law is kept again",
        "uses_left=8",
        "mode=OFF",
        "2 steps: run.jsonl",
    ]
    replayed = call("replay", lamp, "run.jsonl")
    assert (replayed.code, "the assumption is broken" in replayed.out) == (3, True)


def test_a_run_is_saved_as_a_test(call: Call, lamp: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """It passes, and fails where the machine moves otherwise."""
    lines = "set go=true\nstep\nstep\nset go=true\nstep\nsave test_run.py\nsave test_run.py\n"
    called = typed(call, monkeypatch, lamp, lines=lines)
    assert (called.code, "test_run.py exists; give another file" in called.out) == (2, True)
    for passed in (True, False):
        done = run_pytest("-q", "--rootdir", ".", "test_run.py")
        assert ("2 passed" if passed else "1 failed, 1 passed") in done.stdout, done.stdout
        weak = LAMP.replace("uses < 9", "uses < 1")
        assert weak != LAMP
        Path("lamp.py").write_text(weak, encoding="utf-8")


def test_an_absent_output_is_watched(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    """Odometry has no position before its first marker; the output is there, and absent."""
    called = typed(call, monkeypatch, "odometry", lines="watch position_mm\nstep\n")
    assert called.code == 0
    assert [line.strip() for line in called.out.splitlines()[-2:]] == ["position_mm=absent", "mode=DELOCALIZED"]


def test_a_recording_is_gone_through(call: Call, lamp: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its remarks are left out."""
    Path("run.jsonl").write_text('{"go": true, "truth_mm": 3}\n{"go": false}\n', encoding="utf-8")
    called = typed(call, monkeypatch, lamp, "run.jsonl", lines="step 2\nbroken\n")
    assert (called.code, [line.strip() for line in called.out.splitlines()][:1]) == (0, ["1  on"])
    assert "   2  off" in called.out


def test_a_stream_of_another_machine_is_refused(call: Call, lamp: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its inputs would be left out, and each step be one without any."""
    head = '{"schema": "safeloc-stream/1", "machine": "torch", "first": {}}'
    Path("run.jsonl").write_text(f'{head}\n{{"go": true}}\n', encoding="utf-8")
    called = typed(call, monkeypatch, lamp, "run.jsonl", lines="step\n")
    assert (called.code, "torch" in called.err) == (2, True)


def test_a_recording_ends(call: Call, lamp: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """No step is taken with invented inputs before the user is told; then they are his."""
    Path("run.jsonl").write_text('{"go": true}\n', encoding="utf-8")
    called = typed(call, monkeypatch, lamp, "run.jsonl", lines="step 5\nstep\n")
    assert called.code == 0
    told = "the recording ends at step 1: 1 of 5 steps taken; further steps take what you set, and all else is at rest"
    assert called.out.count(told) == 1
    assert "   2  off" in called.out
    assert "   3  " not in called.out


def test_a_file_that_cannot_be_written(call: Call, lamp: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Says why, with the line of the script."""
    called = typed(call, monkeypatch, lamp, lines="step\n\nsave none/run.jsonl\n")
    assert called.code == 2
    assert "safeloc: line 3: none/run.jsonl: cannot be written: No such file or directory." in called.out


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("jump", "'jump' is no command; `help` lists them"),
        ("step two", "step 'two': give a number of steps, 1 or more"),
        ("step 0", "give a number of steps"),
        ("set go", "'go': write NAME=VALUE"),
        ("set went=1", "lamp has no input 'went'"),
        ("watch nothing", "no variable or output 'nothing'"),
        ("state colour", "no name of state has 'colour' in it"),
        ("back 2", "there are 0 steps to take back"),
        ("save", "save needs the name of a file"),
    ],
)
def test_a_wrong_line_of_a_script_ends_it(
    call: Call, lamp: str, monkeypatch: pytest.MonkeyPatch, line: str, message: str
) -> None:
    """Nobody reads on a script that went wrong: exit code 2, and nothing after the line is done."""
    called = typed(call, monkeypatch, lamp, lines=f"{line}\nstep\n")
    assert called.code == 2
    assert message in called.out
    assert "   1  " not in called.out


def test_help_lists_every_command(call: Call, lamp: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """By name."""
    called = typed(call, monkeypatch, lamp, lines="help\n")
    for name in (
        "step",
        "set",
        "hold",
        "release",
        "rows",
        "inputs",
        "state",
        "outputs",
        "watch",
        "broken",
        "back",
        "save",
        "quit",
    ):
        assert name in called.out
    called = typed(call, monkeypatch, lamp, lines="help save\n")
    assert (
        called.out
        == "save FILE             write the run as a stream for `safeloc replay`; save FILE.py: as a test for pytest\n"
    )


PUMP = str(Path(__file__).parents[1] / "explain" / "pump.py")


@pytest.fixture
def pump(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A machine whose optional input a recording has, and that breaks a property in its third step."""
    monkeypatch.chdir(tmp_path)
    text = Path(PUMP).read_text(encoding="utf-8")
    Path("pump.py").write_text(f"{text}\n\nproperties = [TOO_MANY]\n", encoding="utf-8")
    return "pump.py:machine"


def test_a_violation_is_told_at_once(call: Call, pump: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the step that breaks it, its name, and the parts that fail; not again in later steps."""
    Path("run.jsonl").write_text(
        '{"schema": "safeloc-stream/1", "first": {"label": 1}}\n{"go": true}\n' + '{"go": false}\n' * 6
    )
    called = typed(call, monkeypatch, pump, "run.jsonl", lines="step 7\nback 3\nstep 3\n")
    told = [line.strip() for line in called.out.splitlines()]
    assert 2 == told.count("VIOLATED too many strokes")
    at = told.index("VIOLATED too many strokes")
    assert "5  count" == told[at - 1]
    assert "strokes = 4" in " ".join(told[at : at + 6])


def test_an_input_is_held_absent(call: Call, pump: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Over what is recorded, in every step, until it is released; what can never be absent is refused."""
    head = '{"schema": "safeloc-stream/1", "first": {"label": 1}}\n'
    Path("run.jsonl").write_text(head + '{"go": false, "extra": 2}\n' * 4)
    lines = "hold extra=absent\nstep 2\ninputs\nrelease extra\ninputs\nsave kept.jsonl\nrelease extra\n"
    called = typed(call, monkeypatch, pump, "run.jsonl", lines=lines)
    told = [line.strip() for line in called.out.splitlines()]
    assert "held: extra=absent" == told[0]
    assert ["inputs: go=false", "held: none", "inputs: extra=2  go=false"] == told[4:7]
    assert "extra" not in Path("kept.jsonl").read_text(encoding="utf-8").partition("\n")[2]
    assert told[-1].endswith("input 'extra' is not held; held are none.")
    wrong = typed(call, monkeypatch, pump, lines="hold go=absent\n")
    assert (wrong.code, "input 'go' is never absent" in wrong.out) == (2, True)
