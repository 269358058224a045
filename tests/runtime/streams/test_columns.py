"""Runs in columns: what comes back is what was kept, and a file that is not what it was is refused by name."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import StreamError
from safeloc.language.interpret import run
from safeloc.report.data import trace_data
from safeloc.runtime.scripts import read_script, script
from safeloc.runtime.streams.columns import FUNCTION, Shown, read_runs, runs_file
from safeloc.runtime.streams.steps import read_steps
from tests.report.test_page import door

ROW = st.fixed_dictionaries(
    {"speed": st.integers(0, 3), "blocked": st.booleans(), "released": st.booleans()},
)


def kept(folder: Path, rows: list[dict[str, Any]], truth_mm: tuple[int | None, ...] = ()) -> tuple[Path, Shown]:
    """A file of one run of the door, which shows two results."""
    one = Shown(["door/property/a", "door/property/b"], run(door().system, rows), truth_mm)
    path = folder / "door.js"
    path.write_text(runs_file([one], "door"))
    return path, one


@given(st.lists(ROW, max_size=12))
def test_a_run_comes_back(tmp_path_factory: pytest.TempPathFactory, rows: list[dict[str, Any]]) -> None:
    """Steps, first state and types of values; 1 and true are told apart."""
    path, one = kept(tmp_path_factory.getbasetemp(), rows)
    runs = read_runs(path)
    assert list(one.results) == list(runs)
    assert repr(trace_data(one.trace)) == repr(runs.plain("door/property/b"))
    stream = runs.stream("door/property/a")
    assert repr(one.trace.stream()) == repr([dict(step) for step in stream.steps])
    assert (dict(one.trace.initial), "door") == (stream.first, stream.machine)


def test_the_truth_of_a_recording_comes_back(tmp_path: Path) -> None:
    """With gaps, as a remark in the step."""
    row = {"speed": 0, "blocked": False, "released": True}
    path, _ = kept(tmp_path, [row] * 3, (5, None, 7))
    assert [5, None, 7] == read_runs(path).plain("door/property/a")["truth_mm"]
    assert [5, None, 7] == [step.get("truth_mm") for step in read_runs(path).stream("door/property/a").steps]


def test_runs_of_unlike_systems_share_a_file(tmp_path: Path) -> None:
    """A name that one of the runs does not have is not in its steps."""
    row = {"speed": 0, "blocked": False, "released": True}
    whole = run(door().system, [row] * 2)
    path = tmp_path / "door.js"
    path.write_text(runs_file([Shown(["a"], whole), Shown(["b"], run(door().system, []))], "door"))
    assert [2, 0] == [len(read_runs(path).plain(name)["steps"]) for name in "ab"]


@given(st.lists(st.lists(st.booleans(), max_size=6), min_size=1, max_size=8))
def test_runs_with_like_beginnings(tmp_path_factory: pytest.TempPathFactory, blocked: list[list[bool]]) -> None:
    """Each comes back in full, and steps in common are kept once."""
    rows = [[{"speed": 1, "blocked": now, "released": True} for now in one] for one in blocked]
    shown = [Shown([str(number)], run(door().system, one)) for number, one in enumerate(rows)]
    path = tmp_path_factory.getbasetemp() / "door.js"
    path.write_text(runs_file(shown, "door"))
    runs = read_runs(path)
    assert [repr(trace_data(one.trace)) for one in shown] == [repr(runs.plain(name)) for name in runs]
    described = json.loads(read_script(path, FUNCTION))["runs"]
    distinct = {tuple(one[: number + 1]) for one in blocked for number in range(len(one))}
    assert len(distinct) == sum(one["steps"] - one["like"][1] for one in described)


@pytest.mark.parametrize("large", [2**53 - 1, 2**53 + 1, -(2**62)])
def test_numbers_that_javascript_cannot_hold(tmp_path: Path, large: int) -> None:
    """They come back exactly, and no number of the file is beyond those that it can."""
    path, one = kept(tmp_path, [{"speed": 0, "blocked": False, "released": True}] * 3, (0, large, -large))
    assert [0, large, -large] == read_runs(path).plain("door/property/a")["truth_mm"]
    columns = json.loads(read_script(path, FUNCTION))["columns"]
    lists = [column for column in columns if isinstance(column, list)]
    assert all(abs(value) < 2**53 for column in lists for value in column if isinstance(value, int))
    assert one.truth_mm == (0, large, -large)


def spoilt(folder: Path, change: Callable[[dict[str, Any]], object]) -> Path:
    """A file of which something was changed."""
    path, _ = kept(folder, [{"speed": 0, "blocked": False, "released": True}] * 3)
    data = json.loads(read_script(path, FUNCTION))
    change(data)
    path.write_text(script(FUNCTION, "door", data=json.dumps(data).encode()))
    return path


@pytest.mark.parametrize(
    "change",
    [
        lambda data: data.pop("runs"),
        lambda data: data["names"].pop("state"),
        lambda data: data["runs"][0].pop("like"),
        lambda data: data["runs"][0].update(like=[1, 0]),
        lambda data: data["runs"][0].update(like=[0, 1]),
        lambda data: data["runs"][0].update(like=[0, -1]),
        lambda data: data["runs"].append({**data["runs"][0], "like": [0, 4]}),
        lambda data: data["runs"][0].update(steps=4),
        lambda data: data["runs"][0].update(steps="3"),
        lambda data: data["columns"].pop(),
        lambda data: data["runs"][0]["first"].pop(),
        lambda data: data["columns"].__setitem__(0, [1, -1, 2, 4]),
        lambda data: data["columns"].__setitem__(0, [1, True, 2, 2]),
        lambda data: data["columns"].__setitem__(0, 3),
    ],
)
def test_what_is_no_run(tmp_path: Path, change: Callable[[dict[str, Any]], object]) -> None:
    """Columns that do not fit together are refused with the file, never filled up."""
    path = spoilt(tmp_path, change)
    with pytest.raises(StreamError, match=r"door\.js: does not fit schema safeloc-runs/2: "):
        read_runs(path).plain("door/property/a")


def test_another_schema(tmp_path: Path) -> None:
    """A later form is refused by name."""
    with pytest.raises(StreamError, match=r"schema is 'safeloc-runs/9'; this version reads 'safeloc-runs/2'\.$"):
        read_runs(spoilt(tmp_path, lambda data: data.update(schema="safeloc-runs/9")))


def test_a_run_of_too_many_steps(tmp_path: Path) -> None:
    """A small file that stands for more cells than are read is refused before it is unfolded."""
    path = spoilt(tmp_path, lambda data: data["runs"][0].update(steps=10**9))
    with pytest.raises(StreamError, match="more than 10000000 steps"):
        read_runs(path).stream("door/property/a")


def test_a_result_without_a_run(tmp_path: Path) -> None:
    """Said with what there is."""
    path, _ = kept(tmp_path, [])
    with pytest.raises(StreamError, match=r"no run of 'c'; it holds 2: 'door/property/a', 'door/property/b'\.$"):
        read_runs(path).stream("c")


def test_a_file_of_runs_is_no_recording(tmp_path: Path) -> None:
    """Which of the runs is meant has to be said."""
    path, _ = kept(tmp_path, [])
    with pytest.raises(StreamError, match="choose one with --run"):
        read_steps(path)
