"""A simulated run that says where the world begins: recordings, self-checks, campaigns and streams to prove around take it over."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from safeloc import SimulatedRun
from safeloc.campaign.scenes import OwnSimulation
from safeloc.catalogue import load_target
from safeloc.cli.around_stream import given_stream
from safeloc.errors import InputError
from safeloc.proof.drawn_runs.sampled import sampled_runs
from safeloc.simulated import first_values
from safeloc.simulation.many_runs import Drawn
from safeloc.simulation.vehicle_seed import VehicleSeed
from tests.cli.calling import Call

ROLLING = """
from safeloc import ANY, Law, Machine, SimulatedRun, Transition, World, always, modes, number
from safeloc.language.units import MM_S

(ON,) = table = modes("ON")
seen, last = number("seen_mm_s", MM_S, 0, 9_000), number("last_mm_s", MM_S, 0, 9_000)
speed, change = number("speed_mm_s", MM_S, 0, 9_000), number("change_mm_s", MM_S, -100, 100)
machine = Machine(
    name="rolling", modes=table, inputs=[seen], state={last: ANY}, outputs={"last_mm_s": last},
    transitions=[Transition("keep", ON, ON, set={last: seen})],
    world=World(
        ghosts={speed: ANY}, choices=[change], moves={speed: speed + change},
        clauses={
            "the sensor is exact": Law(seen.eq(speed + change), "What it says is so.", owner="supplier"),
            "the speed is in range": Law((speed + change >= 0) & (speed + change <= 9_000), "So it is built."),
        },
    ),
)
properties = [always("what was seen is so", last.eq(speed))]


def simulate(seed):
    return RUN


STEPS = [{"seen_mm_s": 2_000 + 50 * n, "change_mm_s": 50} for n in range(1, 4)]
"""
BEGINS = "RUN = SimulatedRun(STEPS, first={'speed_mm_s': 2_000, 'last_mm_s': 2_000})"


def rolling(folder: Path, run: str = BEGINS) -> str:
    """A machine whose ghost may begin anywhere, with this simulated run, as the command line names it."""
    (folder / "rolling.py").write_text(f"{ROLLING}\n{run}\n", encoding="utf-8")
    return f"{folder / 'rolling.py'}:machine"


def test_it_is_the_sequence_of_its_steps() -> None:
    """Whoever reads steps alone needs to know nothing of it; a plain list chooses no first value."""
    run = SimulatedRun([{"a": 1}, {"a": 2}], first={"x": 7})
    assert [{"a": 1}, {"a": 2}] == list(run)
    assert (2, {"a": 2}, [{"a": 1}]) == (len(run), run[1], run[:1])
    assert ({"x": 7}, {}) == (first_values(run), first_values([{"a": 1}]))


def test_the_recording_begins_there_and_is_checked(call: Call, tmp_path: Path) -> None:
    """`simulate` writes the first values into the header, and `replay` checks the property in every step."""
    path = tmp_path / "run.jsonl"
    assert 0 == call("simulate", rolling(tmp_path), "--out", str(path)).code
    header = json.loads(path.read_text(encoding="utf-8").splitlines()[0])
    assert {"speed_mm_s": 2_000, "last_mm_s": 2_000} == header["first"]
    assert 0 == call("replay", rolling(tmp_path), str(path)).code


def test_a_run_that_does_not_say_it_names_the_broken_law(call: Call, tmp_path: Path) -> None:
    """The law with its owner, the value that was taken, and where to look; a law that holds is not named."""
    target, path = rolling(tmp_path, "RUN = STEPS"), tmp_path / "run.jsonl"
    call("simulate", target, "--out", str(path))
    called = call("replay", target, str(path))
    said = " ".join(called.out.split())
    assert 3 == called.code
    assert "the assumption is broken at step 1: rolling: the sensor is exact (owner: supplier). Nothing" in said
    assert "--assumptions tells by how much" in said
    assert "and speed_mm_s = 0 was taken: `first` in its header" in said


@pytest.mark.parametrize("first", ["{'sped_mm_s': 1}", "{'speed_mm_s': 9_001}"])
def test_a_wrong_first_value_is_refused(tmp_path: Path, first: str) -> None:
    """A misspelt name and a value out of range, before anything is written."""
    simulate = load_target(rolling(tmp_path, f"RUN = SimulatedRun(STEPS, first={first})")).simulate
    assert simulate is not None
    with pytest.raises(InputError, match=r"sped_mm_s|9001"):
        simulate(0)


def test_every_reader_of_a_simulation_begins_there(tmp_path: Path) -> None:
    """The self-check of generated code (on board: without the ghost), vehicles of a campaign, and a stream to prove around."""
    target = load_target(rolling(tmp_path))
    assert {"last_mm_s": 2_000} == next(run.first for run in sampled_runs(target) if run.name == "simulated")
    runs = OwnSimulation(target).runs(Drawn(2, {}, {}, [VehicleSeed(0), VehicleSeed(1)]), 3)
    assert {"last_mm_s": [2_000] * 2, "speed_mm_s": [2_000] * 2} == {
        name: np.asarray(values).tolist() for name, values in runs.first.items()
    }
    _, stream, _ = given_stream(rolling(tmp_path), None, "seed=0", None)
    assert {"speed_mm_s": 2_000, "last_mm_s": 2_000} == stream.first
