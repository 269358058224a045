"""Figures for Prometheus, and the log of each cycle."""

from __future__ import annotations

import os
import urllib.request
from pathlib import Path

import pytest

from safeloc.errors import InputError
from safeloc.runtime.service.address import address
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.metrics import Metrics
from safeloc.runtime.service.tracing import Tracer
from tests.runtime.service.processes import numbered, read, running


def shown(port: int) -> dict[str, float]:
    """What the page says."""
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics", timeout=30) as page:
        lines = page.read().decode().splitlines()
    return {name: float(value) for name, _, value in (one.rpartition(" ") for one in lines if one[0] != "#")}


def test_the_figures_are_those_that_were_noted() -> None:
    """And nothing of the process itself, which nobody asked for."""
    metrics = Metrics(address("0"))
    try:
        metrics.note({"lines": 5, "cycles": 2, "vehicles": 1, "wrong": 0, "something": 3})
        metrics.observe(0.003)
        found = shown(metrics.port)
        assert (found["safeloc_lines_total"], found["safeloc_cycles_total"], found["safeloc_vehicles"]) == (5, 2, 1)
        assert found['safeloc_cycle_seconds_bucket{le="0.005"}'] == 1
        assert found['safeloc_cycle_seconds_bucket{le="0.002"}'] == 0
        assert all(name.startswith("safeloc_") for name in found)
        assert not any("something" in name for name in found)
        with pytest.raises(InputError, match="not available"):
            Metrics(address(str(metrics.port)))
    finally:
        metrics.close()


def test_a_cycle_is_logged_with_its_lines(tmp_path: Path) -> None:
    """From the first line to the report; a cycle without lines is not."""
    observed: list[float] = []
    with (tmp_path / "log").open("wb") as file:
        tracer = Tracer(Journal(file.fileno()), observed.append)
        for number in (5, 6, 7):
            tracer.line("12", number)
        tracer.line("13", 1)
        tracer.reported("12", 3, 4_200)
        tracer.reported("12", 4, 4_300)
        os.fsync(file.fileno())
    (told,) = read((tmp_path / "log").read_bytes())
    assert (told["event"], told["id"], told["first"], told["last"]) == ("cycle", "12:3@4200", 5, 7)
    assert [told["ms"]] == [round(one * 1_000, 3) for one in observed]


@pytest.mark.thorough
def test_a_process_shows_and_logs(tmp_path: Path) -> None:
    """As a user asks for it: over a pipe, with the ids of its reports."""
    said = "".join(numbered(5, "7")).encode()
    with running(tmp_path, "--metrics", "0", "--log-cycles", stdin=-1, stdout=-1) as run:
        port = int(run.logged("metrics")["port"])
        run.logged("started")
        assert run.process.stdin is not None
        run.process.stdin.write(said)
        while shown(port).get("safeloc_cycles_total", 0) < 5:
            pass
        found = shown(port)
        assert (found["safeloc_lines_total"], found["safeloc_localized"]) == (said.count(b"\n"), 1)
        assert found["safeloc_cycle_seconds_count"] == 5
        run.process.stdin.close()
        run.end()
        assert run.process.stdout is not None
        reports = [one for one in read(run.process.stdout.read()) if "mode" in one]
    told = [f"7:{one['cycle']}@{one['time_ms']}" for one in reports]
    assert 5 == len(set(told))
    assert [one["id"] for one in run.log if one["event"] == "cycle"] == told
