"""Where nothing is asked the command line says so, with what to do and exit code 3: silence is no good news."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.calling import DOOR_FILE, QUICK, QUICK_VERIFY, Call

DECLARED = "properties = ["
BRIEF = ("--examples", "5", "--steps", "10", "--jobs", "1")


def door(folder: Path, declared: str) -> str:
    """The door with its properties declared otherwise."""
    text = DOOR_FILE.read_text(encoding="utf-8")
    assert DECLARED in text
    path = folder / "door.py"
    path.write_text(text[: text.index(DECLARED)] + declared + "\n", encoding="utf-8")
    return f"{path}:machine"


NAMES = [
    ("", "no `properties` in it; declare what must hold"),
    ("properties = []", "the list `properties` is empty"),
    ("def properties(machine): return []", "the function `properties` returned none"),
    ("property = [never('it', machine.fired('open'))]", "there is 'property'; make it a list called `properties`"),
    ("Properties = [never('it', machine.fired('open'))]", "there is 'Properties'; make it"),
    ("propertys = []", "there is 'propertys'; make it"),
    ("props = []", "there is 'props'; make it"),
    ("def Properties(machine): return []", "there is 'Properties'; make it"),
    ("safety = [never('it', machine.fired('open'))]", "there is 'safety'; make it"),
    ("it = never('it', machine.fired('open'))", "there is 'it'; make it"),
]


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("declared", "said"), NAMES)
def test_what_was_looked_for_is_said(call: Call, tmp_path: Path, declared: str, said: str) -> None:
    """Without properties, or under another name: which name was found, in which file, and how it must be called."""
    called = call("test", door(tmp_path, declared), *BRIEF)
    assert called.code == 3
    assert "not asked door/test/nothing tested" in called.out
    assert f"door.py: {'there is no `properties`, but ' if 'there is' in said else ''}{said}" in called.out
    assert called.out.splitlines()[-1] == "not asked: there was no property to check: 1 not asked"


def test_obligations_alone_are_not_all(call: Call, tmp_path: Path) -> None:
    """Proved obligations do not make up for properties that nobody wrote."""
    called = call("prove", door(tmp_path, ""), *QUICK)
    assert called.code == 3
    assert "not asked door/property/nothing asked" in called.out
    assert called.out.splitlines()[-1].startswith("not asked: at least one machine had no property")
    assert "all holds" not in called.out


def test_verify_says_it_on_the_page(call: Call, tmp_path: Path) -> None:
    """The page, the data and the exit code of `verify` say that no property was asked."""
    out = tmp_path / "report"
    called = call("verify", door(tmp_path, "props = []"), "--out", str(out), *QUICK_VERIFY)
    assert called.code == 3
    assert "not asked: at least one machine had no property" in called.out
    data = json.loads((out / "report.json").read_text(encoding="utf-8"))
    assert "not asked" == data["verdict"]
    (row,) = [row for row in data["results"] if row["verdict"] == "not asked"]
    assert "there is 'props'; make it a list called `properties`" in row["reason"]
    assert "all holds" not in (out / "index.html").read_text(encoding="utf-8")
    assert data["machines"][0]["spec"].endswith("door.py:machine")


def test_a_violation_is_worse(call: Call, tmp_path: Path) -> None:
    """What is not asked never hides a violation."""
    wrong = door(tmp_path, "").replace(":machine", "")
    text = Path(wrong).read_text(encoding="utf-8").replace("closing_for + CYCLE_MS}", "closing_for + 7 * CYCLE_MS}")
    Path(wrong).write_text(text, encoding="utf-8")
    assert call("prove", f"{wrong}:machine", *QUICK).code == 1


ONLY_REACHABLE = "properties = [reachable('opens', machine.mode.eq(OPEN))]"


def test_nothing_left_to_test(call: Call, tmp_path: Path) -> None:
    """Properties that are all `reachable` are proved, and leave tests and replays nothing to check."""
    target = door(tmp_path, ONLY_REACHABLE)
    assert call("prove", target, *QUICK).code == 0
    tested = call("test", target, *BRIEF)
    assert tested.code == 3
    assert "the only property is of kind reachable" in tested.out
    stream = tmp_path / "run.jsonl"
    stream.write_text(json.dumps({"speed": 0, "released": True, "blocked": False}), encoding="utf-8")
    replayed = call("replay", target, str(stream))
    assert replayed.code == 3
    assert "not asked door/replay/run: nothing checked" in replayed.out


def test_a_replay_does_not_say_all_holds(call: Call, tmp_path: Path) -> None:
    """What held on a recording says so, with what never happened on it; nothing was proved."""
    stream = tmp_path / "run.jsonl"
    stream.write_text(json.dumps({"speed": 0, "released": True, "blocked": False}), encoding="utf-8")
    called = call("replay", f"{DOOR_FILE}:machine", str(stream))
    assert called.code == 0
    assert "held on recordings: 3 checks; nothing was proved: 3 held" in called.out
    assert "run: closes: never happened: its trigger (fired = start to close)" in called.out


@pytest.mark.thorough
def test_a_trigger_that_never_comes(call: Call, tmp_path: Path) -> None:
    """Proved and saying nothing: vacuous in `prove` and in `test`, exit code 3."""
    declared = "properties = [always('v', (closing_for > 2_900).implies(machine.mode.eq(OPEN)))]"
    target = door(tmp_path, declared)
    for command, options in (("prove", QUICK), ("test", BRIEF)):
        called = call(command, target, *options)
        assert called.code == 3
        assert "vacuous" in called.out
        assert "the case (2900 ms < closing_for) never occur" in called.out
