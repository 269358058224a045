"""The witnesses that ship: each is a run of its machine as it is today, and the tool that makes them finds the same again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.catalogue import ENTRIES, load_target
from safeloc.language.interpret import start, taken
from safeloc.language.system import TransitionSystem, environment, first_without_the_world
from safeloc.proof.provers.reachable_targets import targets_of
from safeloc.proof.provers.recorded_witnesses import Recording, shown
from safeloc.proof.verification.witness_files import read_witnesses
from safeloc.target import MODELS, Target, witnesses_of
from tests import onward_runs
from tests import witnesses as tool

MADE = [name for name in ENTRIES if witnesses_of(name)]
AGAIN = "python -m tests.witnesses"


def test_each_stands_in_the_folder_of_its_machine() -> None:
    """A file for a machine, and small ones; there is none of a machine that is gone."""
    files = set(MODELS.rglob("*.jsonl.xz"))
    assert files == {MODELS / ENTRIES[name].folder / f"{name}.witnesses.jsonl.xz" for name in MADE}
    assert sum(path.stat().st_size for path in files) < 420_000


def systems(of: Target) -> dict[str, TransitionSystem]:
    """The whole, and each of its machines alone."""
    return {one.name: one for one in (of.system, *(part.alone for part in of.system.parts))}


def runs_to_its_end(system: TransitionSystem, run: Recording) -> bool:
    """Whether the machine takes every step, whatever the world allows."""
    state = start(replace(system, init=first_without_the_world(system)), dict(run.first))
    steps = taken(system, state, [dict(step) for step in run.steps], while_=environment(system, assume=False))
    return len(list(steps)) == len(run.steps)


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("name", MADE)
def test_each_is_a_run_of_its_machine(name: str) -> None:
    """After an edit of a machine's inputs or ranges they are made anew."""
    known = systems(load_target(name))
    for system, runs in read_witnesses(witnesses_of(name)).items():
        assert all(runs_to_its_end(known[system], run) for run in runs), AGAIN


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", ["delocalized", "arbitration", "route"])
def test_each_shows_something(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The tool, which keeps what still shows something, keeps all of them, and finds nothing new."""
    shipped = witnesses_of(name)
    assert shipped is not None
    monkeypatch.setattr(tool, "MODELS", tmp_path)
    (tmp_path / shipped.parent.name).mkdir()
    tool.main([name])
    assert (tmp_path / shipped.parent.name / shipped.name).read_bytes() == shipped.read_bytes(), AGAIN


def test_what_no_known_run_shows_is_searched_for_from_known_states(monkeypatch: pytest.MonkeyPatch) -> None:
    """From the states of a short run of a composition the search comes to events that this run does not show, and tells them."""
    monkeypatch.setattr(onward_runs, "FURTHER", 2)
    target, told = load_target("supervised_odometry"), list[str]()
    shipped = read_witnesses(witnesses_of("supervised_odometry"))["supervised_odometry"][0]
    short = Recording(shipped.first, shipped.steps[:1])
    names = {one.goal: one.name for one in targets_of(target.system)}
    before = {names[goal] for goal in shown(list(names), [short])}
    runs = onward_runs.onward_runs(target, [short], minutes=0.0, tell=told.append)
    after = {names[goal] for goal in shown(list(names), [Recording(run.initial, run.stream()) for run in runs])}
    assert after - before
    assert all(name in " ".join(told) for name in after - before)
    assert onward_runs.onward_runs(load_target("delocalized"), [short], minutes=0.0) == []
