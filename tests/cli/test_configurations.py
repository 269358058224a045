"""`safeloc prove --configurations` and `safeloc list splits`."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.catalogue import DEFAULTS, configured, load_target
from safeloc.cli.prove import changed_figures
from safeloc.errors import StreamError
from safeloc.proof.provers.limits import Limits
from safeloc.proof.verification.one import Plan, Work
from tests.cli.calling import QUICK, Call, wrong_door

ONE = ("--property", "only the own pattern passes", "--cache")


def test_each_configuration_is_proved_and_told(call: Call, tmp_path: Path) -> None:
    """With the figures that are not the defaults, and a line for each at the end."""
    called = call("prove", "emitter", "--configurations", "all", *ONE, str(tmp_path))
    assert 0 == called.code
    assert "emitter, the defaults: all figures are defaults" in called.out
    assert "emitter, one pattern is enough: passes_to_recover = 1" in called.out
    first, second = called.out.splitlines()[-2:]
    assert first.startswith("the defaults ")
    assert second.startswith("one pattern is enough ")
    assert first.endswith(" all holds: 5 proved, 1 shown by a run")
    assert second.endswith(" all holds: 5 proved, 1 shown by a run")


def test_a_configuration_of_another_kind_tells_its_figures() -> None:
    """What differs from the machine's defaults, although all are defaults of its own class: a laser is no radar."""
    named = dict(configured("reflector", ["laser in place of the radar", "radar behind the front end"]))
    laser, radar = (
        changed_figures(named[name].config) for name in ("laser in place of the radar", "radar behind the front end")
    )
    assert laser.startswith(
        "echo_slots = 1, range_limit_mm = 250000, near_range_mm = 2000, minimum_intensity_cdb = -6500, frame_latency_ms = 40"
    )
    assert "tolerance_mm" not in laser
    assert "radar_offset_mm = 2500" == radar


def test_one_configuration_by_name(call: Call, tmp_path: Path) -> None:
    """As JSON, a report for each name."""
    called = call(
        "prove", "emitter", "--configurations", "one pattern is enough", *ONE, str(tmp_path), "--json"
    )  # fmt: skip
    (name, report), = json.loads(called.out)["configurations"].items()  # fmt: skip
    assert "one pattern is enough" == name
    assert {"proved"} == {one["verdict"] for one in report["results"]}


def test_a_property_is_explained_in_a_configuration_by_name(call: Call, tmp_path: Path) -> None:
    """Of one configuration, and of no two."""
    asked = ("explain", "emitter", "only the own pattern passes", "--cache", str(tmp_path), "--configuration")
    told = call(*asked, "one pattern is enough")
    assert (told.code, "re-checked by" in told.out) == (0, True)
    every = call(*asked, "all")
    assert (every.code, "give the name of one" in " ".join(every.err.replace("│", " ").split())) == (2, True)
    both = call(*asked, "one pattern is enough", "--config", "own.toml")
    assert (both.code, "exclude each other" in " ".join(both.err.split())) == (2, True)


def test_a_violation_in_a_configuration_says_how_to_have_it_explained(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the configuration's name, since it has no file."""
    wrong = replace(load_target(wrong_door(tmp_path)), spec="door", configuration="the wide one")
    monkeypatch.setattr("safeloc.cli.prove.configured", lambda *_: [("the wide one", wrong)])
    called = call("prove", "door", "--configurations", "the wide one", "--property", "opens at speed", *QUICK)
    assert called.code == 1
    assert "Why: safeloc explain door 'opens at speed' --configuration 'the wide one'" in called.out


def test_what_is_no_configuration_is_refused(call: Call, tmp_path: Path) -> None:
    """An unknown name, a machine of one's own, and a file besides."""
    unknown = call("prove", "emitter", "--configurations", "none such")
    assert 2 == unknown.code
    assert "emitter has no configuration 'none such'; it has all, the defaults, one pattern is enough." in unknown.err
    own = call("prove", "file.py:machine", "--configurations", "all")
    assert (2, True) == (own.code, "only shipped machines declare configurations" in own.err)
    file = tmp_path / "own.toml"
    file.write_text("", encoding="utf-8")
    both = call("prove", "emitter", "--configurations", "all", "--config", str(file))
    assert (2, True) == (both.code, "exclude each other" in " ".join(both.err.split()))


def test_folded_cases_are_listed(call: Call) -> None:
    """Where each stands, what folds it, and where it is live or why it never is."""
    emitter = call("list", "splits", "--machine", "emitter").out
    assert "branch where it fails  models/emitter/__init__.py:" in emitter
    assert "no code takes it; live in emitter, one pattern is enough" in emitter
    assert "1 cases are folded away by defaults; 0 of them are live in no configuration." in emitter
    (row,) = json.loads(call("list", "splits", "--machine", "transmission", "--json").out)
    assert "the ranges of its variables decide it" == row["folded"]
    assert row["live"].startswith("never live: ")


def test_splits_of_an_unknown_machine_are_refused(call: Call) -> None:
    """Only shipped machines declare configurations."""
    called = call("list", "splits", "--machine", "none_such")
    assert (2, True) == (called.code, "no shipped machine 'none_such'" in called.err)


def test_the_defaults_keep_their_recordings() -> None:
    """Recordings are of the defaults: what only they show is shown there, and they are no runs of another configuration."""
    shipped = load_target("emitter").streams
    by_name = {name: target.streams for name, target in configured("emitter", ["all"])}
    assert shipped
    assert by_name.pop(DEFAULTS) == shipped
    assert by_name
    assert set(by_name.values()) == {()}


@pytest.mark.thorough
def test_recordings_of_other_figures_are_left_out_and_named(call: Call, tmp_path: Path) -> None:
    """A vehicle with a reader at one end alone: a recording of both ends is no evidence about it, and no failure."""
    one_end = tmp_path / "one_end.toml"
    one_end.write_text("devices = 1\n", encoding="utf-8")
    called = call("verify", "odometry", "--quick", "--config", str(one_end), "--out", str(tmp_path / "report"))
    assert called.code == 3  # quick
    assert "leaving out odometry-service, recorded with other figures" in called.err
    results = json.loads((tmp_path / "report" / "report.json").read_text(encoding="utf-8"))["results"]
    assert "replay" not in {one["kind"] for one in results}
    [note] = [one["notes"]["recordings left out"] for one in results if "recordings left out" in one.get("notes", {})]
    assert note.startswith("odometry-reversal, odometry-service, odometry-wheel-slide: recorded with figures")


def test_a_recording_that_the_defaults_cannot_take_is_an_error(tmp_path: Path) -> None:
    """It was made for them, so something is broken."""
    stream = tmp_path / "odometry-broken.jsonl"
    stream.write_text(
        '{"schema": "safeloc-stream/1", "machine": "odometry", "first": {}}\n{"no_such_input": 1}\n', encoding="utf-8"
    )
    target = replace(load_target("odometry"), streams=(stream,))
    with pytest.raises(StreamError, match="no_such_input"):
        Work(target, 1, lambda *_: None, lambda _: None).verified(
            Plan(Limits(), examples=1, steps=1, seed=0, quick=True)
        )


def test_a_recording_of_other_figures_says_so(call: Call, tmp_path: Path) -> None:
    """The range that it leaves is one of this configuration; a recording of one's own is meant."""
    shorter = tmp_path / "shorter.toml"
    shorter.write_text("vehicle_length_mm = 75400\n", encoding="utf-8")
    called = call("replay", "odometry", "odometry-service", "--config", str(shorter))
    assert called.code == 2
    told = " ".join(called.err.split())
    assert "is outside 0.." in told
    assert "odometry-service was made with other figures than those of" in told


def test_the_figures_of_a_file_are_listed(call: Call, tmp_path: Path) -> None:
    """As they are set, beside the default; and only of one machine."""
    shorter = tmp_path / "shorter.toml"
    shorter.write_text("vehicle_length_mm = 75400\n", encoding="utf-8")
    called = call("list", "config", "odometry", "--config", str(shorter), "--json")
    rows = {row["name"]: row for row in json.loads(called.out)}
    assert rows["vehicle_length_mm"]["value"] == "75400"
    assert rows["vehicle_length_mm"]["source"].startswith("set here; the default is 204700")
    assert [name for name, row in rows.items() if row["source"].startswith("set here")] == ["vehicle_length_mm"]
    assert call("list", "config", "--config", str(shorter)).code == 2
    assert call("list", "properties", "odometry", "--config", str(shorter)).code == 2


def test_a_misspelt_machine_leaves_no_folder_behind(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The folder is made with the report."""
    monkeypatch.chdir(tmp_path)
    called = call("verify", "odomtry")
    assert called.code == 2
    assert "Did you mean 'odometry'?" in " ".join(called.err.split())
    assert list(tmp_path.iterdir()) == []
