"""Every state that a run of a shipped machine comes to has a lawful next step; a vehicle that could not stop in time would have none."""

from __future__ import annotations

import sys

import pytest

from safeloc.catalogue import load_target
from safeloc.language.expr import TRUE
from safeloc.language.verdict import Proved, Violated
from safeloc.models import satellite
from safeloc.models.satellite.variables import SatelliteConfig
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.proof.provers.dead_ends import lasts
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.runtime.streams.steps import read_steps
from safeloc.shipped_machines import ENTRIES

SLOW = {
    "localizer",
    "localizer_sections",
    "fibre_area",
    "guard",
    "odometry",
    "supervised_odometry",
    "marker_device",
    "reflector_device",
    "reflector",
    "balise",
}
SYSTEMS = [pytest.param(name, marks=pytest.mark.slow if name in SLOW else ()) for name in ENTRIES]


@pytest.mark.thorough
@pytest.mark.parametrize("name", SYSTEMS)
def test_no_run_comes_to_a_dead_end(name: str) -> None:
    """Proved, not only searched."""
    target = load_target(name)
    recordings = [Recording(stream.first, stream.steps) for stream in map(read_steps, target.streams)]
    verdict = lasts(target.system, Limits(seconds=60), recordings)
    assert isinstance(verdict, Proved), verdict


def test_a_vehicle_that_cannot_stop_comes_to_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """First state, assumption and invariant share one term; where it asks for nothing, a run into a dead end is found."""
    for module in ("", ".lemmas", ".world"):
        monkeypatch.setattr(sys.modules[f"{satellite.__name__}{module}"], "can_stop", lambda *_: TRUE)
    wrong = satellite.compose_machines(SatelliteConfig(selection=SelectionConfig(channels=3)))
    assert isinstance(lasts(wrong.composition.system, Limits(seconds=30)), Violated)
