"""The localizer's shipped recordings: short journeys that hold what they say, and come out the same again."""

from __future__ import annotations

import gzip
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer.simulation.recorded_runs import FOLDER, RUNS, simulated, write
from safeloc.proof.verification.replay import run_with_truth
from tests.models.localizer_runs import run

LEADS = {
    "metro": {"ODOMETRY", "REFLECTOR"},
    "main-line": {"ODOMETRY"},
    "freight": {"BALISE", "FIBRE"},
    "metro-silent-odometer-corrupted-balise": {"ODOMETRY", "BALISE"},
    "metro-three-groups-turned": {"ODOMETRY", "BALISE"},
    "freight-fibre-error-no-satellites": {"BALISE", "FIBRE"},
}


@pytest.mark.thorough
def test_recordings_come_out_the_same(tmp_path: Path) -> None:
    """Written anew they are what ships, byte for byte when unpacked, and each is small."""
    for path in write(tmp_path):
        assert gzip.decompress((FOLDER / path.name).read_bytes()) == gzip.decompress(path.read_bytes())
        assert path.stat().st_size < 50_000


@pytest.mark.parametrize("name", RUNS)
def test_no_interval_misses_the_truth(name: str) -> None:
    """On every recording something is located, nothing wrongly, and those that are to lead do."""
    told = run(RUNS[name].journey)
    leads = {str(out["arbitration.lead"]) for out in told.outputs}
    assert (told.standings["WRONG"], told.standings["contained"] > 50) == (0, True)
    assert set(LEADS[name]) <= {MEMBERS[int(one)] for one in leads}


MEMBERS = ("NONE", "ODOMETRY", "BALISE", "REFLECTOR", "SATELLITE", "FIBRE")


@pytest.mark.slow
@pytest.mark.parametrize("name", RUNS)
def test_recordings_keep_what_is_assumed(name: str) -> None:
    """With their ghosts they are runs of the whole, so that they serve as witnesses."""
    assert run_with_truth(load_target("localizer"), FOLDER / f"localizer-{name}.jsonl.gz") is not None


def test_simulation_differs_by_seed() -> None:
    """The same seed gives the same steps, another one others."""
    config = LocalizerConfig()
    assert simulated(config, 1) == simulated(config, 1)
    assert simulated(config, 1) != simulated(config, 2)
