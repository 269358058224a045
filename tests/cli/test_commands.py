"""Commands: what they print, what they refuse, and with which exit code."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

from safeloc.report.data import schema
from safeloc.requirements import requirements
from tests.cli.calling import DOOR, QUICK_VERIFY, Call

REVERSAL = Path(__file__).parents[2] / "models" / "streams" / "odometry-reversal.jsonl"


def test_list_machines(call: Call) -> None:
    """The shipped machines by name, in plain lines and as JSON."""
    assert "odometry  odometry between markers" in call("list").out
    names = [row["name"] for row in json.loads(call("list", "machines", "--json").out)]
    assert names == ["odometry", "delocalized", "supervised_odometry"]


def test_list_requirements(call: Call) -> None:
    """Every requirement is listed with its status."""
    rows = json.loads(call("list", "requirements", "--json").out)
    assert [row["id"] for row in rows] == [one.id for one in requirements()]
    assert {row["status"] for row in rows} == {"done", "planned"}


def test_list_properties(call: Call) -> None:
    """Properties are listed by machine with the requirements they answer for."""
    rows = json.loads(call("list", "properties", "--json").out)
    tolerance = next(row for row in rows if (row["machine"], row["name"]) == ("odometry", "tolerance"))
    assert "MRK-D1" in tolerance["requirements"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["prove", "odometri"], "no machine 'odometri'; there are odometry, delocalized, supervised_odometry"),
        (["prove", "odometri"], "Did you mean 'odometry'?"),
        (["prove", "no_such_package:machine"], "cannot import 'no_such_package'"),
        (["prove", "no_such_file.py:machine"], "no_such_file.py: no such Python file."),
        (["prove", DOOR.replace(":machine", ":door")], "machines in it: ['machine']"),
        (["prove", DOOR, "--property", "none"], "has no property 'none'"),
        (["prove", "odometry", "--config", "no_such.toml"], "no_such.toml: cannot be read as TOML"),
        (["list", "trains"], "choose one of machines, properties, requirements"),
        (["replay", "odometry", "no_such.jsonl"], "no_such.jsonl: no such file."),
        (["replay", DOOR, "x.jsonl", "--format", "xml"], "choose table or jsonl"),
        (["export", DOOR, "--to", "pdf"], "choose one of python, mermaid"),
        (["export", DOOR, "--to", "svg", "--out", "no/such/folder/x.svg"], "no/such/folder/x.svg: cannot be written"),
        (["simulate", DOOR, "--out", "x.jsonl"], "door has no simulation; odometry has."),
        (["report", "no_such_folder"], "cannot be read as a report"),
        (["verify", DOOR, DOOR], "two machines are called 'door'"),
        (["prove"], "Missing argument"),
    ],
)
def test_wrong_usage(call: Call, monkeypatch: pytest.MonkeyPatch, arguments: list[str], message: str) -> None:
    """Wrong usage and wrong input: exit code 2, one clear message on standard error, nothing on standard output."""
    monkeypatch.setenv("COLUMNS", "300")
    called = call(*arguments)
    assert called.code == 2
    assert message in called.err
    assert "Traceback" not in called.err
    assert called.out == ""


def test_wrong_configuration(call: Call, tmp_path: Path) -> None:
    """A field of the wrong type and a field that does not exist are both named, with the file."""
    path = tmp_path / "line.toml"
    path.write_text('tolerance_mm = "wide"\ncolour = "red"\n', encoding="utf-8")
    called = call("prove", "odometry", "--config", str(path))
    assert called.code == 2
    assert f"{path}: 2 fields are wrong" in called.err
    assert "- tolerance_mm: " in called.err
    assert "- colour: " in called.err


def test_replay_jsonl(call: Call) -> None:
    """One JSON line a step, with mode, fired transition, interval and how it stands to the truth."""
    called = call("replay", "odometry", str(REVERSAL), "--format", "jsonl")
    rows = [json.loads(line) for line in called.out.splitlines()]
    assert called.code == 0
    assert [row["step"] for row in rows] == list(range(1, len(rows) + 1))
    assert {"contained", "INVALID"} == {row["truth"] for row in rows}
    assert all(row["valid"] == (row["truth"] == "contained") for row in rows)
    assert rows[0]["fired"]
    assert {"mode", "position_mm", "over_mm", "under_mm", "reason", "unit"} <= set(rows[0])


def test_replay_finds_a_wrong_interval(call: Call, tmp_path: Path) -> None:
    """A truth beside the interval is a violation with its step; the machine's ghosts are left out of such a stream."""
    lines = [json.loads(line) for line in REVERSAL.read_text(encoding="utf-8").splitlines()]
    for line in lines[1:]:
        for name in [name for name in line if name.endswith("_nm")]:
            del line[name]
        line["truth_mm"] += 1_000_000
    path = tmp_path / "moved.jsonl"
    path.write_text("\n".join(map(json.dumps, [{**lines[0], "first": {}}, *lines[1:]])), encoding="utf-8")
    called = call("replay", "odometry", str(path), "--json")
    data = json.loads(called.out)
    jsonschema.validate(data, schema())
    assert called.code == 1
    wrong = [row for row in data["results"] if row["verdict"] == "violated"]
    assert [row["id"] for row in wrong] == ["odometry/replay/moved: truth"]
    assert "misses truth_mm at steps " in wrong[0]["reason"]


def test_simulated_streams_replay(call: Call, tmp_path: Path) -> None:
    """The same seed writes the same stream, another seed another one."""
    paths = [tmp_path / f"{name}.jsonl" for name in ("one", "same", "other")]
    for path, seed in zip(paths, ("3", "3", "4"), strict=True):
        assert call("simulate", "odometry", "--seed", seed, "--out", str(path)).code == 0
    one, same, other = (path.read_bytes() for path in paths)
    assert one == same
    assert one != other


def test_verify_and_report(call: Call, tmp_path: Path) -> None:
    """verify writes the folder and a count; report writes the same page again."""
    called = call("verify", DOOR, "--out", str(tmp_path), *QUICK_VERIFY)
    assert called.code == 0
    assert "proved" in called.out
    assert f"report: {tmp_path / 'index.html'}" in called.err
    data = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    jsonschema.validate(data, schema())
    assert {"property", "obligation", "test"} == {row["kind"] for row in data["results"]}
    page = (tmp_path / "index.html").read_bytes()
    (tmp_path / "index.html").unlink()
    assert call("report", str(tmp_path)).code == 0
    assert (tmp_path / "index.html").read_bytes() == page
