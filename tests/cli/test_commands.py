"""Commands: what they print, what they refuse, and with which exit code."""

from __future__ import annotations

import gzip
import json
import re
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from safeloc.assurance.requirements import requirements
from safeloc.catalogue import ENTRIES, Target, load_target
from safeloc.report.data import schema
from safeloc.report.file_names import file_names
from safeloc.runtime.streams.columns import read_runs
from tests.cli.calling import DOOR, QUICK_VERIFY, Call
from tests.shipped_recordings import shipped

REVERSAL = shipped("odometry-reversal")


def test_list_machines(call: Call) -> None:
    """The shipped machines by name, in plain lines and as JSON."""
    assert "odometry  odometry between markers" in call("list").out
    names = [row["name"] for row in json.loads(call("list", "machines", "--json").out)]
    assert names == list(ENTRIES)


def test_list_shared_terms(call: Call) -> None:
    """What claims and clauses share with rows, as lines and as data; other choices are wrong usage."""
    assert (0, "nothing is shared.") == (
        call("list", "shared", "--machine", DOOR).code,
        call("list", "shared", "--machine", DOOR).out.strip(),
    )
    data = json.loads(call("list", "shared", "--machine", DOOR, "--json").out)
    assert {"shared": [], "reads_machine": []} == data
    assert 2 == call("list", "shared", "--text", "x").code
    lines = call("list", "shared", "--machine", "odometry").out.splitlines()
    assert lines[0].startswith("odometry  ")
    assert lines[1].startswith("    computed for  ")
    assert lines[2].startswith("    shared by     ")
    assert lines[3].startswith("    because       ")
    assert (
        "guard  clause 'the vehicle moves within its figures' of guard  reads mode"
        in call("list", "shared", "--machine", "guard").out
    )
    assert 2 == call("list", "lines", "--machine", "x").code


def test_list_assumptions(call: Call) -> None:
    """The register of a machine, as lines and as data: each law with what is said of it, and the figures to confirm."""
    listed = call("list", "assumptions", "--machine", "delocalized").out
    assert "delocalized/A1  " in listed and "    assumed by: delocalized\n" in listed
    assert "figures are from memory: the operator has to confirm them." in listed
    data = json.loads(call("list", "assumptions", "--machine", "delocalized", "--json").out)
    assert ["delocalized/A1", "border/B1"] == [one["id"] for one in data["assumptions"]]
    assert [{"no: only with the truth": ["delocalized"]}, {"as a whole": ["every target on records"]}] == [
        one["observable"] for one in data["assumptions"]
    ]
    assert "    observable: no: only with the truth" in listed and "    observable: as a whole" in listed
    assert "2 assumptions, that of records among them; 1 of them observable in operation; " in listed
    assert 2 == call("list", "assumptions", "--text", "x").code


@pytest.mark.thorough
def test_list_requirements(call: Call) -> None:
    """Every requirement with what carries and shows it, and every transition and property back."""
    data = json.loads(call("list", "requirements", "--json").out)
    rows = {row["id"]: row for row in data["requirements"]}
    assert list(rows) == [one.id for one in requirements()]
    assert "odometry: tolerance exceeded" in rows["MRK-D1"]["transitions"]
    assert "odometry: containment" in rows["MRK-1"]["properties"]
    back = {(item["machine"], item["name"]): item["requirements"] for item in data["items"]}
    assert "MRK-D1" in back["odometry", "tolerance exceeded"]
    assert isinstance(data["gaps"], list)


def test_list_one_requirement(call: Call) -> None:
    """With what leads to it alone, and without the gaps of others; in whatever case."""
    data = json.loads(call("list", "requirements", "--id", "fva-4", "--json").out)
    assert ["FVA-4"] == [row["id"] for row in data["requirements"]]
    assert {"axle_head", "counting_head"} <= {item["machine"] for item in data["items"]}
    assert all("FVA-4" in item["requirements"] for item in data["items"])
    assert [] == data["gaps"]
    assert "FVA-4" in call("list", "requirements", "--text", "SAFE IN THE SIGNALLING SENSE").out.split()


@pytest.mark.thorough
def test_list_requirements_as_text(call: Call) -> None:
    """Plain lines: a requirement, below it its transitions, properties and tests, and then the way back."""
    lines = call("list", "requirements").out.splitlines()
    start = next(number for number, line in enumerate(lines) if line.startswith("MRK-D1  done  delocalized  "))
    assert "    transition  odometry: tolerance exceeded" in lines[start:]
    assert any(line.startswith("    test        tests/") for line in lines)
    back = lines[lines.index("Reverse traceability, from transitions and properties to requirements:") :]
    assert any(line.startswith("transition  odometry: tolerance exceeded  MRK-D1") for line in back)
    assert lines[-1].startswith("gap: ")


@pytest.mark.thorough
def test_list_properties(call: Call) -> None:
    """Properties are listed by machine with the requirements they answer for."""
    rows = json.loads(call("list", "properties", "--json").out)
    tolerance = next(row for row in rows if (row["machine"], row["name"]) == ("odometry", "tolerance"))
    assert "MRK-D1" in tolerance["requirements"]


def test_a_machine_without_a_simulation_is_refused_at_once(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    """The message names the machines that have one, and none of them is made for it."""
    made: list[str] = []

    def load(name: str, _: object, **options: Any) -> Target:
        made.append(name)
        return load_target(name, None, **options)

    monkeypatch.setattr("safeloc.cli.simulate.load_target", load)
    called = call("simulate", "delocalized", "--out", "x.jsonl")
    assert called.code == 2
    assert ["delocalized"] == made
    assert "delocalized has no simulation; these machines have one: odometry, marker_device, " in called.err
    assert all(name in called.err for name, entry in ENTRIES.items() if entry.simulates)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["prove", "odometri"], "no machine 'odometri'; there are odometry, delocalized, "),
        (["prove", "odometri"], "Did you mean 'odometry'?"),
        (["prove", "no_such_package:machine"], "cannot import 'no_such_package'"),
        (["prove", "no_such_file.py:machine"], "no_such_file.py: no such Python file."),
        (["prove", "door.py"], "For a machine in this file give its name as well: door.py:machine."),
        (["prove", DOOR.replace(":machine", ":door")], "machines in it: ['machine']"),
        (["prove", DOOR, "--property", "none"], "has no property 'none'"),
        (["prove", "odometry", "--config", "no_such.toml"], "no_such.toml: no such file."),
        (["list", "trains"], "choose one of machines, properties, config, recordings, assumptions, shared"),
        (
            ["replay", "odometry", "no_such.jsonl"],
            "no_such.jsonl: no such file, and no recording of that name; shipped with",
        ),
        (["replay", "odometry", "odometry-servise"], "Did you mean 'odometry-service'?"),
        (
            ["replay", "delocalized", "odometry-service"],
            "odometry-service: a recording of another machine, odometry; delocalized",
        ),
        (["replay", DOOR, "none.jsonl"], "no recording of that name; none ships with door"),
        (["replay", DOOR, "x.jsonl", "--format", "xml"], "choose table or jsonl"),
        (["export", DOOR, "--to", "pdf"], "choose one of python, mermaid"),
        (["export", DOOR, "--to", "svg", "--out", "no/such/folder/x.svg"], "no/such/folder/x.svg: cannot be written"),
        (["simulate", DOOR, "--out", "x.jsonl"], "door has no simulation; declare a function `simulate` of a seed"),
        (["verify", DOOR, "odometry", "--config", "x.toml"], "--config is for one machine; 2 are given: "),
        (["verify", DOOR, "--out", "/dev/null/report"], "/dev/null/report: the report cannot be written here: "),
        (["replay", DOOR, "x.jsonl", "--period-ms", "0"], "--period-ms"),
        (["report", "no_such_folder"], "cannot be read as a report"),
        (["verify", DOOR, DOOR], "two machines have the name 'door'"),
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


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("import no_such_module", "own.py: No module named 'no_such_module'. Install it, or start safeloc where"),
        ("machine = 3", "own.py:machine is of type int; expected a Machine, a Composition or a function"),
        ("machine = 1 / 0", "own.py fails: ZeroDivisionError: division by zero ("),
        ("machine = (", "own.py fails: SyntaxError: "),
    ],
)
def test_a_file_of_the_user_that_is_wrong(call: Call, tmp_path: Path, text: str, message: str) -> None:
    """It is wrong input, told without a trace of safeloc's own insides."""
    path = tmp_path / "own.py"
    path.write_text(text, encoding="utf-8")
    called = call("prove", f"{path}:machine")
    assert (called.code, called.out) == (2, "")
    assert message in called.err
    assert "Traceback" not in called.err


def test_wrong_configuration(call: Call, tmp_path: Path) -> None:
    """A field of the wrong type and a field that does not exist are both named, with the file."""
    path = tmp_path / "line.toml"
    path.write_text('tolerance_mm = "wide"\ncolour = "red"\n', encoding="utf-8")
    called = call("prove", "odometry", "--config", str(path))
    assert called.code == 2
    assert f"{path}: 2 fields are wrong" in called.err
    assert "- tolerance_mm: has to be a whole number (got 'wide') (line 1)" in called.err
    assert "- colour: " in called.err and "(line 2)" in called.err


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("", "the stream has no steps."),
        ('{"speed": NaN}', "stream.jsonl:1: speed is nan, no measurement; leave the input out"),
        ('{"spede": 3}', "stream.jsonl:1: door has no input 'spede'; it has ['blocked', 'released', 'speed']. Did you"),
        ('{"speed": 100001, "released": false, "blocked": false}', "speed: 100001 mm/s is outside 0..100000. (line 1)"),
    ],
)
def test_a_stream_that_cannot_be_replayed(call: Call, tmp_path: Path, line: str, message: str) -> None:
    """An empty one, a NaN, a misspelt name, a value out of range: no verdict, and the line to mend."""
    path = tmp_path / "stream.jsonl"
    path.write_text(line, encoding="utf-8")
    called = call("replay", DOOR, str(path))
    assert (called.code, called.out) == (2, "")
    assert message in called.err


def test_a_recording_that_ships_is_replayed_by_its_name(call: Call) -> None:
    """As `safeloc list recordings` names it; wherever the package is installed."""
    listed = call("list", "recordings", "--machine", "axle_head").out.split()
    assert "axle_head" == listed[0]
    called = call("replay", "axle_head", listed[1], "--json")
    assert 0 == called.code
    assert "replay" in {found["kind"] for found in json.loads(called.out)["results"]}


def test_replay_as_a_table(call: Call, tmp_path: Path) -> None:
    """Columns stand under their names."""
    path = tmp_path / "run.csv"
    path.write_text("speed,released,blocked\n0,true,false\n100,false,false\n", encoding="utf-8")
    _, heading, first, second = call("replay", DOOR, str(path)).out.splitlines()[:4]
    place = heading.index("fired")
    assert heading.split()[:2] == ["step", "mode"]
    assert (first.split()[:2], first[place:].split()) == (["1", "OPEN"], ["open"])
    assert second[place:].strip()
    assert second.split()[0] == "2"


RECORDS = """{"kind": "value", "time_ms": 50, "name": "speed", "value": 0}
{"kind": "value", "time_ms": 60, "name": "released", "value": true}
{"kind": "value", "time_ms": 60, "name": "blocked", "value": false}
{"kind": "distance", "time_ms": 60, "end": "front", "unit": "wheel", "distance_mm": 5}
"""


def test_a_recording_of_single_records_replays(call: Call, tmp_path: Path) -> None:
    """Grouped into steps; what is not used, unknown channels among it, is counted by channel and reason, and is no input."""
    path = tmp_path / "run.jsonl"
    path.write_text(RECORDS, encoding="utf-8")
    called = call("replay", DOOR, str(path))
    assert (called.code, "single records, not steps: say how long a cycle is" in " ".join(called.err.split())) == (
        2,
        True,
    )
    late = '{"kind": "distance", "time_ms": 40, "end": "front", "unit": "wheel", "distance_mm": NaN}\n'
    path.write_text(RECORDS + late, encoding="utf-8")
    called = call("replay", DOOR, str(path), "--period-ms", "100")
    assert called.code == 0
    assert "front_wheel: older than the last one delivered: 1" in called.out
    data = json.loads(call("replay", DOOR, str(path), "--period-ms", "100", "--json").out)
    jsonschema.validate(data, schema())
    (border,) = [row for row in data["results"] if row["id"] == "door/replay/run: border"]
    assert border["notes"] == {
        "front_wheel: no channel of this machine": "1",
        "front_wheel: older than the last one delivered": "1",
    }


def test_a_simulated_run_as_records_replays_like_its_steps(call: Call, tmp_path: Path) -> None:
    """Over records, border and cycles the odometry machine sees the same inputs."""
    path = tmp_path / "run.jsonl"
    lines = [
        {"kind": "distance", "time_ms": 100 * n, "end": end, "unit": unit, "distance_mm": 1000 + n}
        for n in range(1, 40)
        for end in ("front", "rear")
        for unit in ("wheel", "radar")
    ]
    path.write_text("\n".join(map(json.dumps, lines)), encoding="utf-8")
    rows = call("replay", "odometry", str(path), "--period-ms", "100", "--format", "jsonl").out.splitlines()
    assert len(rows) == 39
    assert {json.loads(row)["mode"]["mode"] for row in rows} == {"DELOCALIZED"}


def test_replay_jsonl(call: Call) -> None:
    """One JSON line a step, with mode, fired transition, interval and how it stands to the truth."""
    called = call("replay", "odometry", str(REVERSAL), "--format", "jsonl")
    rows = [json.loads(line) for line in called.out.splitlines()]
    assert called.code == 0
    assert [row["step"] for row in rows] == list(range(1, len(rows) + 1))
    assert {"contained", "INVALID"} == {row["truth"] for row in rows}
    assert all(row["valid"] == (row["truth"] == "contained") for row in rows)
    assert rows[0]["fired"]
    assert {"mode", "position_mm", "margin_above_mm", "margin_below_mm", "reason", "unit"} <= set(rows[0])


def test_replay_finds_a_wrong_interval(call: Call, tmp_path: Path) -> None:
    """A truth beside the interval is a violation with its step; the machine's ghosts are left out of such a stream."""
    lines = [json.loads(line) for line in gzip.decompress(REVERSAL.read_bytes()).splitlines()]
    for line in lines[1:]:
        for name in [name for name in line if name.endswith(("_nm", "_stray"))]:
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
    assert "does not contain truth_mm at steps " in wrong[0]["reason"]


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
    assert data["made_by"]["command"].startswith("safeloc verify ")
    assert {"property", "obligation", "test"} == {row["kind"] for row in data["results"]}
    page = (tmp_path / "index.html").read_bytes()
    (tmp_path / "index.html").unlink()
    assert call("report", str(tmp_path)).code == 0
    assert (tmp_path / "index.html").read_bytes() == page


@pytest.mark.thorough
def test_one_page_and_plain_files(call: Call, tmp_path: Path) -> None:
    """verify can write one page; report writes out what is packed, and a run named by its result is replayed."""
    folder, plain = tmp_path / "report", tmp_path / "plain"
    assert call("verify", DOOR, "--out", str(folder), "--single-file", *QUICK_VERIFY).code == 0
    assert not re.search(r"<(script|link|img)[^>]* (src|href)=", (folder / "index.html").read_text(encoding="utf-8"))
    assert call("report", str(folder), "--single-file").code == 0
    called = call("report", str(folder), "--extract", str(plain))
    names = json.loads((folder / "report.json").read_text(encoding="utf-8"))["certificates"].values()
    written = {path.name for path in (plain / "certificates").iterdir()}
    assert written == {name for own in names for name in own}
    runs = sorted((plain / "traces").iterdir())
    assert f"{plain}: {len(written)} certificates, {len(runs)} traces" in called.err
    shown = next(one for one in read_runs(folder / "traces" / "door.js") if "/transition " in one)
    of_report = call("replay", DOOR, str(folder / "traces" / "door.js"), "--run", shown, "--format", "jsonl")
    plainly = call("replay", DOOR, str(plain / "traces" / f"{file_names([shown])[shown]}.jsonl"), "--format", "jsonl")
    assert (of_report.code, of_report.out) == (plainly.code, plainly.out)
    assert call("report", str(folder), "--extract", str(plain), "--single-file").code == 2
    wrong = call("replay", DOOR, str(folder / "traces" / "door.js"), "--run", "door/property/none")
    assert (wrong.code, "no run of 'door/property/none'; it holds " in wrong.err) == (2, True)
    assert call("replay", DOOR, str(runs[0]), "--run", shown, "--period-ms", "100").code == 2
