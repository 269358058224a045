"""What replay says of a stream: what it did not check, and which machine a stream is for."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import pytest

from tests.cli.calling import DOOR, Call
from tests.shipped_recordings import shipped

STREAM = shipped("odometry-reversal")
NOTE = (
    "3 properties (containment; front reader over its marker is inside the window; rear reader over its marker is inside the "
    "window), the stream has no ghosts"
)


def without_ghosts(folder: Path, *, machine: str = "odometry", steps: int = 20) -> str:
    """The first steps of a shipped stream, as a vehicle would record them."""
    lines = [json.loads(line) for line in gzip.decompress(STREAM.read_bytes()).splitlines()[1 : steps + 1]]
    kept = [{k: v for k, v in line.items() if not k.endswith(("_nm", "_stray")) and k != "truth_mm"} for line in lines]
    header = {"schema": "safeloc-stream/1", "machine": machine}
    path = folder / "recorded.jsonl"
    path.write_text("\n".join(map(json.dumps, [header, *kept])), encoding="utf-8")
    return str(path)


def test_what_is_not_checked_is_told(call: Call, tmp_path: Path) -> None:
    """A property that speaks of the truth is named, and is not among what held."""
    called = call("replay", "odometry", without_ghosts(tmp_path))
    assert called.code == 0
    assert f"\nnot checked: {NOTE}\n" in called.out
    assert "recorded: containment" not in called.out


def test_what_is_not_checked_in_json(call: Call, tmp_path: Path) -> None:
    """Once, in the notes of the first finding of the replay; a simulated stream leaves nothing out."""
    rows = json.loads(call("replay", "odometry", without_ghosts(tmp_path), "--json").out)["results"]
    assert [row["notes"].get("not checked") for row in rows] == [NOTE, *[None] * (len(rows) - 1)]
    whole = json.loads(call("replay", "odometry", str(STREAM), "--json").out)["results"]
    assert not any("not checked" in row["notes"] for row in whole)


def test_a_stream_of_another_machine(call: Call, tmp_path: Path) -> None:
    """Refused by its header; a header without a machine is for any."""
    wrong = call("replay", "odometry", without_ghosts(tmp_path, machine="balise"))
    assert (wrong.code, wrong.out) == (2, "")
    assert ":1: the stream is for machine 'balise', not for 'odometry'; replay it with that machine" in wrong.err
    assert call("replay", "odometry", without_ghosts(tmp_path, machine="")).code == 0


@pytest.mark.parametrize("seconds", ["inf", "nan"])
def test_no_time_limit(call: Call, seconds: str) -> None:
    """A limit is a number of seconds; the option is named."""
    called = call("prove", DOOR, "--seconds", seconds)
    assert called.code == 2
    assert "--seconds" in called.err


def test_help_shows_brackets(call: Call) -> None:
    """A name in brackets is text, not a style."""
    assert "[localization]" in call("audit", "--help").out


def test_a_run_beyond_the_assumption_is_no_search(call: Call, tmp_path: Path) -> None:
    """The properties say nothing from there on; no number of searched runs and no page on undecided proofs is told."""
    lines = [json.loads(line) for line in gzip.decompress(STREAM.read_bytes()).splitlines()[:20]]
    lines[9]["true_cycle_distance_nm"] = 4 * lines[9]["true_cycle_distance_nm"]  # faster than any vehicle
    path = tmp_path / "beyond.jsonl"
    path.write_text("\n".join(map(json.dumps, lines)), encoding="utf-8")
    called = call("replay", "odometry", str(path))
    assert called.code == 3
    assert "the assumption is broken at step 9" in called.out
    assert "searched" not in called.out and "What to try" not in called.out
