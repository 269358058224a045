"""A campaign's kept streams as a regression test: a file for pytest beside the streams, to be taken over with them."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from safeloc.language.trace import Trace
from safeloc.proof.verification.replay import read_recording, run_of
from safeloc.reported import Standing
from safeloc.target import Target

NAME = "test_found.py"


def standing_at(target: Target, path: Path, cycle: int) -> Standing:
    """Replay a stream with its truth; return how the interval stands to the truth after a cycle (from 1 on)."""
    stream, _ = read_recording(target, path)
    return _standing_in(target, run_of(target.system, path, stream), cycle)


def _standing_in(target: Target, run: Trace, cycle: int) -> Standing:
    """Return how the interval stands to the truth after a cycle (from 1 on) of a run, exactly: the truth is in nm."""
    reported, step = target.reported, run.steps[cycle - 1]
    assert reported is not None
    interval = reported.interval_mm(step.outputs)
    if interval is None:
        return "INVALID"
    low, high = (end * 1_000_000 for end in interval)
    return "contained" if low <= step.state[reported.truth] <= high else "WRONG"


def regression_test(target: Target, kept: Sequence[Mapping[str, Any]], folder: Path) -> str:
    """Return the text of the test file for kept streams (`kept.keep_streams`), which lies in the same folder.

    A wrong interval although every law was kept fails until the machine is mended; one after a broken law is expected, and a machine that
    withstands it is told (strict); a near miss must stay contained.
    """
    rows = "".join(f"    {_row(one, folder)},\n" for one in kept)
    address = target.spec or target.name
    file, colon, name = address.rpartition(":")
    spec = f"{Path(file).resolve()}{colon}{name}" if file.endswith(".py") else address
    return f'''"""Runs of {target.name} that a campaign found. Take this file and the streams beside it over into your tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.campaign.regression import standing_at
from safeloc.catalogue import load_target

HERE = Path(__file__).parent
BROKEN = pytest.mark.xfail(strict=True, reason="a law was broken before, so no proof speaks of it")


@pytest.mark.parametrize(
    ("stream", "cycle", "config"),
    [
{rows}    ],
)
def test_no_interval_misses_the_truth(stream: str, cycle: int, config: str | None) -> None:
    """What is reported in the cycle for which the stream is kept holds the truth."""
    target = load_target({json.dumps(spec)}, None if config is None else HERE / config)
    assert "WRONG" != standing_at(target, HERE / stream, cycle)
'''


def _row(one: Mapping[str, Any], folder: Path) -> str:
    config = None if one["config"] is None else str(Path(one["config"]).relative_to(folder))
    values = f"{json.dumps(Path(one['file']).name)}, {one['cycle']}, {json.dumps(config) if config else None}"
    marks = ", marks=BROKEN" if one["kind"] == "broken-wrong" else ""
    return f"    pytest.param({values}{marks}, id={json.dumps(Path(one['file']).name.partition('.')[0])})"
