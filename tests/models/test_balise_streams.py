"""Simulated and shipped streams of the balise machine: lawful, faulty, and as generated code runs them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safeloc.catalogue import load_target
from safeloc.codegen.compiled import compile_system
from safeloc.errors import InputError
from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.system import lower
from safeloc.language.verdict import Held
from safeloc.models import balise
from safeloc.models.balise.recorded_runs import FOLDER, RUNS, recorded
from safeloc.models.balise.simulate import RouteSet, line, simulate
from safeloc.models.balise.variables import BaliseConfig, parts
from safeloc.proof.verification.replay import replay_stream
from safeloc.properties.balise import properties
from safeloc.runtime.streams.gzipped import name_of
from safeloc.runtime.streams.steps import Cell, read_steps
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg
from tests.models.balise_runs import board_only, label, on_board, out, wrong


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("free", [False, True])
def test_simulated_groups_keep_the_assumption(free: bool) -> None:
    """The simulation with its ghosts satisfies the assumption in every step, and every property holds on it."""
    model = balise.build(parts(BaliseConfig(free_references=free, trust_first_group=free)))
    stream = simulate(model.own.config, seed=int(free), legs=[Leg(35_000, 35)], groups=line(60_000, 80_000))
    trace = run(lower(model.machine), [{k: v for k, v in record.items() if k != "truth_mm"} for record in stream])
    assert "ACCEPTED" in {label(trace, "telegram", index) for index in range(len(trace.steps))}
    every = [prop for prop in properties(model) if prop.kind != "reachable"]
    for prop, result in zip(every, check_all(trace, every), strict=True):
        assert isinstance(result, Held), prop.name


FAULTS = {
    "missed": "NONE",
    "corrupted": "CORRUPTED",
    "incomplete": "INCOMPLETE",
    "wrong way": "WRONG_DIRECTION",
    "early": "TOO_EARLY",
    "late": "TOO_LATE",
    "duplicate": "REPEATED",
    "stale": "STALE",
    "malformed": "MALFORMED",
    "other identity": "NOT_ANNOUNCED",
}


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize("kind", FAULTS)
def test_a_faulty_group_never_makes_the_interval_wrong(kind: str) -> None:
    """Each named fault is rejected with its reason, and the reported interval holds the truth all the way."""
    groups = line(60_000, 80_000, 8)
    faults = [Fault(kind, 6)]
    stream = simulate(BaliseConfig(), seed=3, legs=[Leg(39_000, 37)], groups=groups, missed=0, foreign=0, faults=faults)
    trace = run(on_board(BaliseConfig()), [board_only(record) for record in stream])
    verdicts = [label(trace, "telegram", index) for index in range(len(trace.steps))]
    assert FAULTS[kind] in verdicts
    assert verdicts.count("ACCEPTED") >= 4
    assert wrong(stream, trace) == []


@pytest.mark.thorough
@given(
    seed=st.integers(0, 2**16),
    faults=st.dictionaries(st.integers(1, 8), st.sampled_from(list(FAULTS)), max_size=6),
    speed=st.sampled_from([5_000, 20_000, 39_000]),
    national=st.sampled_from([None, 0, 2_000, 63_000]),
    groups=st.integers(2, 4),
)
@settings(max_examples=5, deadline=None, derandomize=True, database=None)
def test_any_mixture_of_faulty_groups_keeps_every_property(
    seed: int, faults: dict[int, str], speed: int, national: int | None, groups: int
) -> None:
    """Any groups faulty in any way, at any speed and accuracy: the assumption is kept, and all properties hold."""
    model = balise.build(parts(BaliseConfig(announced_groups=groups, trust_first_group=seed % 2 == 0)))
    named = [Fault(kind, group) for group, kind in faults.items()]
    stream = simulate(
        model.own.config, seed=seed, legs=[Leg(speed, 36)], groups=line(20_000, 60_000, 8), missed=0.1, foreign=0.02,
        faults=named, national_accuracy_mm=national,
    )  # fmt: skip
    trace = run(lower(model.machine), [{k: v for k, v in record.items() if k != "truth_mm"} for record in stream])
    every = [prop for prop in properties(model) if prop.kind != "reachable"]
    for prop, result in zip(every, check_all(trace, every), strict=True):
        assert isinstance(result, Held), prop.name


def test_a_wheel_that_begins_to_slide_is_not_believed() -> None:
    """The sudden change is beyond what the vehicle can do: its distances are refused, and the top speed is added to the error."""
    stream = simulate(
        BaliseConfig(), seed=3, legs=[Leg(39_000, 35)], groups=line(60_000, 80_000, 9), missed=0, dropout=0,
        sensor_faults=[Fault("slide", "odometer", 250, 300)],
    )  # fmt: skip
    trace = run(on_board(BaliseConfig()), [board_only(record) for record in stream])
    assert out(trace, 249)["valid"] is True
    assert label(trace, "odometer", 250) == "JUMP"
    assert out(trace, 260)["valid"] is False
    assert wrong(stream, trace) == []


def test_simulation_refuses_faults_of_unknown_groups() -> None:
    """A fault of a group that the line does not have would test nothing."""
    with pytest.raises(
        InputError, match=r"^missed of 9, 0 to the end: no such place; of a balise group there are 1\.$"
    ):
        simulate(BaliseConfig(), seed=1, seconds=1, groups=line(count=1), faults=[Fault("missed", 9)])


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", [f"balise-{run}" for run in RUNS])
def test_shipped_streams_hold(name: str) -> None:
    """Every property, and the truth beside it, holds on the shipped streams."""
    target = load_target("balise")
    path = next(stream for stream in target.streams if name_of(stream) == name)
    _, findings = replay_stream(target, Path(path))
    assert len(findings) == len([prop for prop in target.properties if prop.kind != "reachable"]) + 1
    assert [finding.id for finding in findings if not isinstance(finding.result, Held)] == []


@pytest.mark.parametrize("name", RUNS)
def test_shipped_recordings_come_out_the_same(name: str) -> None:
    """The recording is what its run gives."""
    assert recorded(RUNS[name]) == list(read_steps(FOLDER / f"balise-{name}.jsonl.gz").steps)


def test_compiled_machine_follows_the_interpreter() -> None:
    """The whole machine, generated, agrees with the interpreter on a simulated service."""
    config = BaliseConfig()
    code, stream = compile_system(on_board(config)), simulate(config, seed=11, seconds=60, foreign=0.02)
    state = code.first()
    for record, one in zip(stream, run(on_board(config), [board_only(r) for r in stream]).steps, strict=True):
        state, fired = code.step(state, code.read(board_only(record)))
        assert dict(zip(code.state_names, state, strict=True)) == one.state
        assert code.fired(fired) == one.fired
        assert code.named_outputs(state) == one.outputs


def routed(*routes: RouteSet) -> list[dict[str, Cell]]:
    """A run over the line's groups while the map announces what the routes have."""
    return simulate(BaliseConfig(), seed=5, seconds=60, legs=[Leg(20_000, 60)], foreign=0, missed=0, routes=routes)


def test_a_route_that_is_set_replaces_linking() -> None:
    """One REPLACE names the new route's next group, and its groups follow; a group that is not on it is read without a place."""
    other = [replace(group, identity=500 + group.identity) for group in line()]
    steps = routed(RouteSet(300, other))
    assert [n for n, step in enumerate(steps) if step.get("linking_order") == "REPLACE"] == [300]
    assert all(int(step["linking_group"]) > 500 for step in steps[300:] if "linking_group" in step)
    read = [step for step in steps[300:] if "telegram_group" in step]
    assert len(read) > 1
    assert not any("telegram_position_mm" in step for step in read)
    assert all("telegram_position_mm" in step for step in steps[:300] if "telegram_group" in step)


def test_a_route_without_groups_withdraws_linking() -> None:
    """There is nothing to replace it with."""
    steps = routed(RouteSet(300, []))
    assert [n for n, step in enumerate(steps) if step.get("linking_order") == "WITHDRAW"] == [300]
    assert not any("linking_order" in step for step in steps[301:])


def test_two_routes_in_one_cycle_are_refused() -> None:
    """It would not be told which one is set."""
    with pytest.raises(
        InputError, match=r"^routes are set in cycles \[300, 300\]: only one can be set in a cycle; .*$"
    ):
        routed(RouteSet(300, []), RouteSet(300, line()))
