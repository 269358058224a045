"""`safeloc simulate LINE`: streams that `replay` takes, for the vehicles, routes, machines and faults asked for."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from safeloc.railway.map.toml_files import find_line, to_toml
from tests.cli.calling import Call
from tests.railway.map.made import group, reflector, straight

SHORT = ("--from", "103@380000", "--to", "103@490000")


def listed(folder: Path) -> list[dict[str, Any]]:
    """The runs that runs.json tells of."""
    data = json.loads((folder / "runs.json").read_text(encoding="utf-8"))
    assert "safeloc-line-runs/1" == data["schema"]
    return list(data["runs"])


def replayed(call: Call, command: str) -> int:
    """The exit code of a replay command as it was printed."""
    words = command.split()
    assert words[:2] == ["safeloc", "replay"]
    return call(*words[1:]).code


def test_streams_replay_with_the_commands_that_are_printed(call: Call, tmp_path: Path) -> None:
    """Of two machines, one of them with a configuration of its own: every property holds."""
    folder = tmp_path / "runs"
    called = call("simulate", "fig1", "--out", str(folder), *SHORT, "--trust-first", "--machine", "odometry",
                  "--machine", "reflector")  # fmt: skip
    assert 0 == called.code
    commands = [line for line in called.err.splitlines() if line.startswith("safeloc replay")]
    assert [
        f"safeloc replay odometry {folder / 'odometry-1-A.jsonl'} --config {folder / 'odometry-config.json'}",
        f"safeloc replay reflector {folder / 'reflector-1-A.jsonl'}",
    ] == commands
    assert [0, 0] == [replayed(call, command) for command in commands]


def test_runs_are_listed_with_all_that_made_them(call: Call, tmp_path: Path) -> None:
    """Route, vehicle, seed, stop, and each fault with where it struck and what is to come of it."""
    call(
        "simulate", "fig2", "--out", str(tmp_path), "--machine", "stop_point", "--faults", "stop-overrun", "--seed", "7"
    )
    first, second = listed(tmp_path)
    assert ("207", "210") == (first["stop"], second["stop"])
    assert (["103 increasing"], 0, 700_000, "CAB", 7, "default figures", None) == tuple(
        first[key] for key in ("route", "start_mm", "length_mm", "models", "seed", "vehicle", "config")
    )
    (fault,) = first["faults"]
    assert ("stop-overrun", "overrun: hold, then backwards at reduced speed into the window") == (
        fault["name"], fault["outcome"],
    )  # fmt: skip
    assert {"stop_point-1-CAB-207.jsonl", "stop_point-1-CAB-210.jsonl", "runs.json"} == {
        path.name for path in tmp_path.iterdir()
    }


def test_several_vehicles_have_their_own_seeds_and_files(call: Call, tmp_path: Path) -> None:
    """Two of one kind and another one: three streams, no two alike, each with its vehicle's configuration."""
    vehicles = ("--vehicle", "desiro-br642", "--vehicle", "desiro-br642", "--vehicle", "freight-v90")
    assert 0 == call("simulate", "fig1", "--out", str(tmp_path), *SHORT, "--machine", "reflector", *vehicles).code
    runs = listed(tmp_path)
    assert [("desiro-br642", 0), ("desiro-br642", 1), ("freight-v90", 2)] == [(r["vehicle"], r["seed"]) for r in runs]
    assert 3 == len({(tmp_path / run["file"]).read_bytes() for run in runs})
    assert all((tmp_path / run["config"]).is_file() for run in runs)


def test_the_same_seed_writes_the_same_folder(call: Call, tmp_path: Path) -> None:
    """Byte by byte; another seed writes another stream."""
    for name, seed in (("one", "3"), ("same", "3"), ("other", "4")):
        call("simulate", "fig1", "--out", str(tmp_path / name), *SHORT, "--machine", "route", "--seed", seed)
    one, same, other = (
        {p.name: p.read_bytes() for p in (tmp_path / name).iterdir()} for name in ("one", "same", "other")
    )
    assert one == same
    assert one.keys() == other.keys()
    assert one != other


def test_all_routes_or_the_one_named(call: Call, tmp_path: Path) -> None:
    """Without a route all five of Fig. 3; with its edges one, still among the five; between two places those there are."""
    call("simulate", "fig3", "--out", str(tmp_path / "all"), "--machine", "route")
    call("simulate", "fig3", "--out", str(tmp_path / "one"), "--machine", "route", "--route", "308,303-305,305-307,310")
    call(
        "simulate",
        "fig3",
        "--out",
        str(tmp_path / "two"),
        "--machine",
        "route",
        "--from",
        "302-304@0",
        "--to",
        "310@90000",
    )
    models = [[run["models"] for run in listed(tmp_path / name)] for name in ("all", "one", "two")]
    assert sorted(["ADAB", "ACD", "ADCD", "ADAD", "DCD"]) == sorted(models[0])
    assert [["DCD"], ["DAD", "DCD"]] == [models[1], sorted(models[2])]
    first = json.loads((tmp_path / "one" / "route-1-DCD.jsonl").read_text(encoding="utf-8").splitlines()[1])
    assert [True] * 5 == [first[f"route_{number}_candidate"] for number in range(1, 6)]


def test_faults_tell_what_they_are(call: Call) -> None:
    """`--faults help` lists every name, what it is, and what each machine makes of it."""
    told = call("simulate", "fig1", "--faults", "help")
    assert 0 == told.code
    assert "  group-missed: the vehicle passes a balise group and reads nothing, at group NAME:ID\n" in told.out
    assert "      route: no route fits: no report until the next start\n" in told.out


def test_a_single_group_is_told_to_be_no_more_than_a_candidate(call: Call, tmp_path: Path) -> None:
    """Whoever drives odometry over one group learns why nothing will be reported."""
    arguments = ("simulate", "fig1", "--out", str(tmp_path), *SHORT, "--machine", "odometry")
    assert "the first is only a candidate" in call(*arguments).err
    assert "candidate" not in call(*arguments, "--trust-first").err


def unfit(folder: Path) -> str:
    """A line whose first balise is followed by 900 m without a reference."""
    line = straight(
        1_200_000, balise_groups=(group(1, "e0", 100_000, 103_000),), reflectors=(reflector("R", "e0", 1_100_000),)
    )
    path = folder / "unfit.toml"
    path.write_text(to_toml(line), encoding="utf-8")
    return str(path)


def test_a_line_that_fails_its_audit_is_refused(call: Call, tmp_path: Path) -> None:
    """With what is violated, and why it counts; --unaudited drives it, and runs.json says so."""
    path, folder = unfit(tmp_path), tmp_path / "runs"
    refused = call("simulate", path, "--out", str(folder), "--machine", "odometry")
    assert 2 == refused.code
    assert "straight does not pass its audit for default figures (" in refused.err
    assert "violated  odometry stretch [RFL-D1]" in refused.err
    assert "drive it all the same with --unaudited" in refused.err
    assert not folder.exists()
    assert 0 == call("simulate", path, "--out", str(folder), "--machine", "odometry", "--unaudited").code
    assert json.loads((folder / "runs.json").read_text(encoding="utf-8"))["audited"] is False


def test_a_line_from_a_file(call: Call, tmp_path: Path) -> None:
    """The same line as a file of one's own gives the same stream."""
    path = tmp_path / "own.toml"
    path.write_text(to_toml(find_line("fig1")), encoding="utf-8")
    for line, name in ((str(path), "own"), ("fig1", "shipped")):
        assert 0 == call("simulate", line, "--out", str(tmp_path / name), *SHORT, "--machine", "route").code
    own, shipped = ((tmp_path / name / "route-1-A.jsonl") for name in ("own", "shipped"))
    assert own.read_bytes() == shipped.read_bytes()


REFUSED = {
    ("fig1",): "--out FOLDER for a line",
    ("fig1", "--out", "x", "--config", "c.json"): "--vehicle configures the machines",
    ("odometry", "--out", "x.jsonl", "--machine", "balise"): "--machine is for lines, and 'odometry' is no line",
    ("fig1", "--out", "x", "--machine", "door"): "no machine 'door' to drive on a line; there are odometry, balise",
    ("fig1", "--out", "x", "--machine", "turn_off"): "nothing to drive: the chosen machines have no data source",
    ("fig1", "--out", "x", "--vehicle", "tram"): "tram: no such file, and no shipped vehicle; shipped are desiro",
    ("fig1", "--out", "x", "--faults", "gremlins"): "no fault 'gremlins'. Faults (NAME, or NAME:PLACE):",
    ("fig1", "--out", "x", "--machine", "balise", "--faults", "decoy"): "fault decoy is for reflector",
    ("fig3", "--out", "x", "--machine", "odometry", "--route", "308,303-305,305-307,310", "--faults", "group-missed:106"):
        "fault group-missed:106 does not occur on the driven routes of fig3",
    ("fig3", "--out", "x", "--machine", "odometry", "--route", "308,303-305,305-307,310", "--faults",
     "group-missed:319,group-missed:106"): "fault group-missed:106 does not occur",
    ("fig1", "--out", "x", "--seed", "-1"): "should be greater than or equal to 0",
    ("fig1", "--out", "x", "--from", "103@0"): "--from and --to belong together",
    ("fig1", "--out", "x", "--from", "103", "--to", "103@9"): "--from '103': expected EDGE@MM",
    ("fig1", "--out", "x", "--from", "103@9", "--to", "103@0"): "no route leads from 103@9 to 103@0",
    ("fig1", "--out", "x", "--route", "103", *SHORT): "by --route, or by --from and --to, not by both",
    ("fig3", "--out", "x", "--route", "301,310"): "no vehicle can run over '301', '310' in this order",
    ("fig9", "--out", "x"): "no machine 'fig9'",
}  # fmt: skip


@pytest.mark.parametrize("arguments", REFUSED, ids=range(len(REFUSED)))
def test_wrong_usage_is_refused_and_nothing_written(
    call: Call, arguments: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With exit code 2, what is wrong, and what there is instead."""
    monkeypatch.chdir(tmp_path)
    called = call("simulate", *arguments)
    assert 2 == called.code
    assert REFUSED[arguments] in " ".join(called.err.replace("│", " ").split())
    assert [] == list(tmp_path.iterdir())
