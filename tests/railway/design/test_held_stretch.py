"""How long the balise machine holds its position: the bound has a proof, and a run beyond it."""

from __future__ import annotations

import pytest

from safeloc.language.verdict import Proved
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.line_runs.configs import LineVehicle
from safeloc.proof.provers.limits import Limits
from safeloc.railway.audit import audit
from safeloc.railway.design.held_stretch import HeldStretch, _steps, broken_beyond, held_stretch, proof_of, watched
from tests.railway.map.made import group, straight

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
def test_the_audit_allows_what_the_machine_holds(name: str) -> None:
    """Two groups pass the audit as far apart as the machine holds its position, less the errors of both readings; not 1 mm farther."""
    figures, apart = LAYOUTS[name], bound(name, 300).run_mm - 2 * LAYOUTS[name].balise_fix_mm(300)

    def stretches(more_mm: int) -> list[str]:
        groups = (group(1, "e0", 1_000), group(2, "e0", 1_000 + apart + more_mm))
        found = audit(straight(2_000 + apart + more_mm, balise_groups=groups), figures).violated
        return [one.subject for one in found if one.rule == "odometry stretch"]

    assert [] == stretches(0)
    assert ["from balise group g1 to balise group g2, increasing"] == stretches(1)


def test_the_rule_that_did_not_round_is_refuted() -> None:
    """What the audit once allowed, (t - f - c)(1 - r)/r - c without rounding, is 19 mm more than the machine holds."""
    machine, found = watched(config("default")), bound("default", 300)
    old_mm = (30_000 - 1_300 - 5_000) * 950_000 // 50_000 - 5_000
    assert 19 == old_mm - found.run_mm
    assert broken_beyond(machine, found) is not None, (
        "the position is withdrawn within 1 mm more, which the old rule allows"
    )


def test_no_bound_and_no_run() -> None:
    """Without a rate no run is too long; without any room for error none is short enough."""
    flat = LayoutConfig(odometry_rate_ppm=0)
    assert held_stretch(LineVehicle(layout=flat, trust_first=True).balise(), 300) is None
    assert bound("default", 25_000).run_mm == -1
