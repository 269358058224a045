"""How long the balise machine holds its position: the bound has a proof, and a run beyond it."""

from __future__ import annotations

import pytest

from safeloc.language.verdict import Proved
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.line_runs.configs import LineVehicle
from safeloc.proof.provers.limits import Limits
from safeloc.railway.audit.stretches import longest
from safeloc.railway.design.held_stretch import HeldStretch, _steps, broken_beyond, held_stretch, proof_of, watched

LAYOUTS = {
    "default": LayoutConfig(),
    "fine": LayoutConfig(
        tolerance_mm=10_000, odometry_constant_mm=1_001, odometry_rate_ppm=20_003, antenna_offset_mm=7_000
    ),
    "coarse": LayoutConfig(tolerance_mm=90_000, odometry_rate_ppm=300_000),
}


def config(name: str) -> BaliseConfig:
    """The machine's configuration for a vehicle."""
    return LineVehicle(layout=LAYOUTS[name], trust_first=True).balise()


def bound(name: str, accuracy_mm: int) -> HeldStretch:
    """The machine's bound, where there is one."""
    found = held_stretch(config(name), accuracy_mm)
    assert found is not None
    return found


@pytest.mark.parametrize("name", LAYOUTS)
def test_one_millimetre_more_loses_the_position(name: str) -> None:
    """A lawful run of the machine withdraws it within 1 mm beyond the bound; the run that measures 1 mm less does not."""
    found = bound(name, 1_000)
    machine = watched(config(name))
    assert broken_beyond(machine, found) == len(found.steps) - 1
    shorter = HeldStretch(
        1_000, found.run_mm, found.measured_mm - 1, _steps(config(name), 1_000, found.measured_mm - 1), found.first
    )
    assert broken_beyond(machine, shorter) is None


@pytest.mark.thorough
@pytest.mark.parametrize("name", LAYOUTS)
def test_the_machine_holds_its_position_up_to_the_bound(name: str) -> None:
    """Proved on the machine that ships, for all runs of its world; for 1 mm more there is no proof."""
    found, machine = bound(name, 300), watched(config(name))
    assert isinstance(proof_of(machine, found, Limits(seconds=30)), Proved)
    farther = HeldStretch(300, found.run_mm + 1, found.measured_mm, found.steps, found.first)
    assert not isinstance(proof_of(machine, farther, Limits(seconds=3)), Proved)


@pytest.mark.parametrize("name", LAYOUTS)
def test_the_audit_allows_hardly_more(name: str) -> None:
    """The machine rounds its margin up to 1 mm, so it withdraws that millimetre of error earlier than the audit reckons."""
    layout = LAYOUTS[name]
    audited = longest(layout.balise_fix_mm(300), layout)
    of_a_millimetre = 1_000_000 // layout.odometry_rate_ppm + 1
    assert audited - of_a_millimetre <= bound(name, 300).run_mm < audited


def test_no_bound_and_no_run() -> None:
    """Without a rate no run is too long; without any room for error none is short enough."""
    flat = LayoutConfig(odometry_rate_ppm=0)
    assert held_stretch(LineVehicle(layout=flat, trust_first=True).balise(), 300) is None
    assert bound("default", 25_000).run_mm == -1
