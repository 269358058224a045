"""`safeloc prove --around`: the examples of docs/around.md, what is written, and what is refused."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tests.cli.calling import Call

ROOT = Path(__file__).parents[2]
BLOCKS = re.findall(
    r"```text\n\$ safeloc (.*?)\n(.*?)```", (ROOT / "docs" / "around.md").read_text(encoding="utf-8"), re.DOTALL
)
NEAR = f"{ROOT / 'docs' / 'examples' / 'near.py'}:machine"


def arguments(line: str) -> list[str]:
    """A command line as the shell splits it."""
    words = re.findall(r'"([^"]*)"|(\S+)', line)
    return [quoted or plain.replace("docs/examples/near.py:machine", NEAR) for quoted, plain in words]


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("line", "shown"), BLOCKS, ids=[str(number) for number in range(len(BLOCKS))])
def test_the_page_shows_what_is_printed(call: Call, line: str, shown: str) -> None:
    """Every line of an example's output is a part of what the command prints."""
    called = call(*arguments(line))
    assert [part for part in shown.splitlines() if part not in called.out] == []
    assert called.code == (
        0
        if "violated" not in shown and "empty" not in shown and "broken" not in shown
        else 3
        if "empty" in shown
        else 1
    )


def test_every_example_is_tried() -> None:
    """There are as many as the page has commands on the example."""
    assert len(BLOCKS) == 4


def test_pictures_streams_and_certificates_are_written(call: Call, tmp_path: Path) -> None:
    """The stream replays and breaks the claim; the picture has the band; certificates are those of the proved claim."""
    out = tmp_path / "out"
    ask = ("prove", NEAR, "--simulate", "seed=0", "--within", "distance_mm=10", "--out", str(out))
    broken = call(*ask, "--claim", "place_mm <= 600", "--claim", "place_mm <= 1000")
    assert (broken.code, "safeloc explain" in broken.out) == (1, False)  # which knows no claim that is written here
    assert 'class="band"' in (out / "tube-place-mm.svg").read_text()
    deviation = (out / "tube-distance-mm-deviation.svg").read_text()
    # the tube that was asked for, not the widest one in which the claim holds
    assert {">10 mm<", ">\N{MINUS SIGN}10 mm<"} <= set(re.findall(r">[^<>]+<", deviation))
    assert list((out / "certificates").glob("*.smt2"))
    rows = [json.loads(line) for line in (out / "place-mm----600.jsonl").read_text().splitlines()[1:]]
    assert sum(row["distance_mm"] for row in rows) > 600
    assert call("replay", NEAR, str(out / "place-mm----600.jsonl")).code in (0, 3)


def test_results_as_json(call: Call) -> None:
    """The schema is that of all results."""
    called = call(
        "prove", NEAR, "--simulate", "seed=0", "--within", "distance_mm=1", "--claim", "place_mm <= 550", "--json"
    )
    [row] = json.loads(called.out)["results"]
    assert (row["id"], row["verdict"], row["depth"]) == ("near/around simulated seed=0/place_mm <= 550", "proved", 50)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--within", "distance_mm=2"], "--within speaks of streams near one: give it with --around or --simulate."),
        (["--simulate", "seed=0", "--within", "distance_mm=x"], "--within 'distance_mm=x': expected NAME=NUMBER"),
        (["--simulate", "seed=0", "--within", "distance_mm=1,distance_mm=2"], "--within: distance_mm is given twice."),
        (["--simulate", "sead=0"], "--simulate: no setting 'sead'; there are line, seed, faults, vehicle. Did you mean 'seed'?"),
        (["--simulate", "line="], "--simulate line=: there is no value behind it; give one, or leave it out."),
        (["--simulate", "line=fig3"], "no machine 'near' to drive on a line; there are odometry, balise"),
        (["--timeout", "9"], "--timeout speaks of streams near one"),
        (["--simulate", "seed=x"], "--simulate seed=x: a seed is a whole number from 0 on."),
        (["--simulate", "faults=slip"], "--simulate faults: only a line has it; give line=NAME too."),
        (["--simulate", "seed=0", "--around", "a"], "--around and --simulate exclude each other"),
        (["--around", "nowhere"], "nowhere: no such file, and no recording of that name"),
        (["--simulate", "seed=0", "--from", "3"], "--from and --until say in which cycles a --claim is judged"),
        (["--simulate", "seed=0", "--claim", "true", "--until", "51"], "the stream has the cycles 1 to 50."),
        (["--simulate", "seed=0", "--without", "the vehicle is slo"], "Did you mean 'the vehicle is slow'?"),
        (["--simulate", "seed=0", "--within", "distance_m=1", "--claim", "true"], "Did you mean 'distance_mm'?"),
        (["--simulate", "seed=0"], "near declares no property; write a claim"),
    ],
)  # fmt: skip
def test_what_is_refused(call: Call, options: list[str], said: str) -> None:
    """With the option, what is wrong, and what to do."""
    called = call("prove", NEAR, *options)
    assert called.code == 2
    assert said in " ".join(called.err.replace("│", " ").split())


@pytest.mark.thorough
def test_a_vehicle_on_a_line(call: Call, tmp_path: Path) -> None:
    """The machine has the vehicle's figures; a stream that breaks a claim replays with them, which are written beside it."""
    ask = ("prove", "balise", "--simulate", "line=fig3,seed=7,vehicle=metro", "--out", str(tmp_path))
    called = call(*ask, "--claim", 'mode != "DELOCALIZED"', "--until", "30")
    assert called.code == 1, called.err
    assert "violated balise/around simulated line=fig3,seed=7,vehicle=metro/" in " ".join(called.out.split())
    [replay] = [line for line in called.err.splitlines() if line.startswith("safeloc replay")]
    assert replay.endswith(f"--config {tmp_path / 'configuration.json'}")
    assert call(*replay.split()[1:]).code in (0, 3)


def test_a_claim_is_proved_up_to_the_last_cycle_in_which_it_is_judged(call: Call) -> None:
    """The cycles after --until are not run."""
    words = ("prove", NEAR, "--simulate", "seed=0", "--within", "distance_mm=1", "--claim", "place_mm <= 220", "--json")
    [row] = json.loads(call(*words, "--until", "20").out)["results"]
    assert (row["verdict"], row["depth"]) == ("proved", 20)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("machine", "stream", "within", "claim", "first"),
    [
        ("odometry", "odometry-service", "front_wheel_mm=2,front_radar_mm=2", "valid", "420"),
        ("balise", "balise-service", "odometer_mm=2", 'mode != "DELOCALIZED"', "500"),
        ("axle_counter", "axle_counter-service", "axle_speed_low_mm_s=5,axle_speed_high_mm_s=5", "record_axles <= 20", "1"),
    ],
)  # fmt: skip
def test_recordings_that_ship(call: Call, machine: str, stream: str, within: str, claim: str, first: str) -> None:
    """A claim on a whole recorded journey, around which inputs deviate, is proved."""
    called = call("prove", machine, "--around", stream, "--within", within, "--claim", claim, "--from", first)
    assert called.code == 0, called.out


def test_a_ghost_needs_a_recorded_truth(call: Call, tmp_path: Path) -> None:
    """A stream without the truth cannot hold a ghost near it."""
    stream = tmp_path / "measured.jsonl"
    stream.write_text('{"distance_mm": 10}\n{"distance_mm": 11}\n', encoding="utf-8")
    called = call("prove", NEAR, "--around", str(stream), "--within", "truth_mm=1", "--claim", "place_mm < 30")
    assert called.code == 2
    assert "--within truth_mm: it is a ghost, and measured does not hold the truth; leave it out." in called.err
