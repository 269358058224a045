"""A user's module names recordings and a simulation; what is wrong with them is said, with the place."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.errors import InputError
from tests.cli.calling import DOOR_FILE, QUICK_VERIFY, Call

STEPS = "[{'speed': 0, 'released': True, 'blocked': False}, {'speed': 0, 'released': False, 'blocked': False}]"


def door(folder: Path, more: str) -> str:
    """The door with further lines, as the command line names it."""
    path = folder / "door.py"
    path.write_text(f"{DOOR_FILE.read_text(encoding='utf-8')}\n{more}\n", encoding="utf-8")
    return f"{path}:machine"


def test_simulated_and_replayed(call: Call, tmp_path: Path) -> None:
    """`simulate` writes the run of the user's function; `verify` replays the file that the module names, wherever it is called."""
    simulated = call(
        "simulate", door(tmp_path, f"def simulate(seed):\n    return {STEPS}"), "--out", str(tmp_path / "run.jsonl")
    )
    assert 0 == simulated.code, simulated.err
    target = door(tmp_path, "recordings = ['run.jsonl']")
    called = call("verify", target, "--out", str(tmp_path / "report"), *QUICK_VERIFY)
    assert 0 == called.code, called.err
    assert "door/replay/run: opens at speed" in called.err


@pytest.mark.thorough
def test_a_changed_recording_is_replayed_anew(call: Call, tmp_path: Path) -> None:
    """The content of the file is part of the cache's key."""
    target = door(tmp_path, "recordings = ['run.jsonl']")
    run, found = tmp_path / "run.jsonl", []
    for speed in (0, 90_000, 90_000):
        run.write_text(f'{{"speed": {speed}, "released": true, "blocked": false}}\n', encoding="utf-8")
        called = call("verify", target, "--out", str(tmp_path / "r"), "--cache", str(tmp_path / "c"), *QUICK_VERIFY)
        found.append("from the cache" in called.err)
    assert [False, False, True] == found


def test_recordings_of_one_machine_only(tmp_path: Path) -> None:
    """A function of the machine gives the recordings of each."""
    (tmp_path / "run.jsonl").write_text('{"speed": 0}\n')
    target = load_target(door(tmp_path, "def recordings(of):\n    return ['run.jsonl'] if of is machine else []"))
    assert ["run.jsonl"] == [path.name for path in target.streams]


def test_a_recording_that_the_module_names_is_simulated(call: Call, tmp_path: Path) -> None:
    """`simulate` makes the file that `recordings` already names; the second time it says that it replaces it."""
    target = door(tmp_path, f"recordings = ['run.jsonl']\ndef simulate(seed):\n    return {STEPS}")
    told = [call("simulate", target, "--out", str(tmp_path / "run.jsonl")) for _ in range(2)]
    assert [0, 0] == [one.code for one in told]
    assert [False, True] == ["(replaced)" in one.err for one in told]


@pytest.mark.parametrize(
    ("more", "says"),
    [
        (
            "recordings = 'run.jsonl'",
            r"recordings is 'run.jsonl' of type str .*; expected a list, or a function of the machine",
        ),
        ("recordings = [7]", r"door.recordings holds 7 of type int; expected paths of files\.$"),
        (
            "recordings = ['gone.jsonl']",
            r"gone\.jsonl: no such file, but door\.recordings names it; correct the path, or leave",
        ),
        ("recordings = lambda of: 1 / 0", r"door\.recordings fails: ZeroDivisionError"),
        (
            "simulate = 7",
            r"door\.simulate is 7 of type int .*; expected a function of a seed that returns the steps of a run\.$",
        ),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, more: str, says: str) -> None:
    """When the machine is loaded, before anything is proved."""
    with pytest.raises(InputError, match=says):
        load_target(door(tmp_path, more))


@pytest.mark.parametrize("body", ["return 1 / 0", "return [1]", "return None"])
def test_a_simulation_that_fails(call: Call, tmp_path: Path, body: str) -> None:
    """Wrong input, with the place; no file is left."""
    out = tmp_path / "run.jsonl"
    called = call("simulate", door(tmp_path, f"def simulate(seed):\n    {body}"), "--out", str(out))
    assert 2 == called.code
    assert called.err.startswith("safeloc: door.simulate fails: ")
    assert not out.exists()
