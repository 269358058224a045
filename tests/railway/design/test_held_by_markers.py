"""How long the odometry machine holds its position after a marker: the bound has a proof, and a run beyond it."""

from __future__ import annotations

import pytest

from safeloc.language.verdict import Proved
from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.layout_rules.marker_readers import MarkerReaders
from safeloc.models.line_runs.configs import LineVehicle
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.proof.provers.limits import Limits
from safeloc.railway.audit import audit
from safeloc.railway.design.held_by_markers import followed, held_run, layout_of, proof_of
from safeloc.railway.design.held_stretch import HeldStretch, broken_beyond
from tests.railway.map.made import marker, straight

LAYOUTS = {
    "default": LayoutConfig(markers=MarkerReaders()),
    "fine": LayoutConfig(
        tolerance_mm=10_000, odometry_constant_mm=1_001, odometry_rate_ppm=20_003,
        markers=MarkerReaders(vehicle_length_mm=120_000, reader_latency_ms=7, max_acceleration_mm_s2=1_300),
    ),
    "coarse": LayoutConfig(
        tolerance_mm=90_000, odometry_rate_ppm=300_000, markers=MarkerReaders(vehicle_length_mm=90_000)
    ),
}  # fmt: skip


def config(name: str) -> OdometryConfig:
    """The machine's configuration for a vehicle."""
    return LineVehicle(layout=LAYOUTS[name], trust_first=True).odometry()


def bound(name: str, accuracy_mm: int = 300) -> HeldStretch:
    """The machine's bound, where there is one."""
    found = held_run(config(name), accuracy_mm)
    assert found is not None
    return found


@pytest.mark.parametrize("name", LAYOUTS)
def test_the_machine_has_the_figures_of_the_audit(name: str) -> None:
    """What the audit is told of a vehicle comes back from its machine."""
    assert LAYOUTS[name].markers == layout_of(config(name)).markers


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", LAYOUTS)
def test_one_millimetre_more_loses_the_position(name: str) -> None:
    """A lawful run over a marker that both readers read withdraws the position within 1 mm beyond the bound, and no earlier."""
    held = bound(name)
    one = followed(config(name), 1, 300)
    assert broken_beyond(one, held) == len(held.steps) - 1
    shorter = HeldStretch(300, held.run_mm, held.measured_mm, held.steps[:-1], held.first)
    assert broken_beyond(one, shorter) is None


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("end", [0, 1])
def test_the_machine_holds_its_position_up_to_the_bound(end: int) -> None:
    """Proved on the machine that ships with two devices, for all runs of its world, after a reading by either reader."""
    assert isinstance(
        proof_of(followed(config("default"), end, 300), bound("default").run_mm, Limits(seconds=30)), Proved
    )


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["fine", "coarse"])
def test_so_do_other_vehicles(name: str) -> None:
    """Of other figures, whose rates do not come out even, too; for 1 mm more there is no proof."""
    one, held = followed(config(name), 1, 300), bound(name)
    assert isinstance(proof_of(one, held.run_mm, Limits(seconds=30)), Proved)
    assert not isinstance(proof_of(one, held.run_mm + 1, Limits(seconds=3)), Proved)


@pytest.mark.parametrize("name", LAYOUTS)
def test_the_audit_allows_what_the_machine_holds(name: str) -> None:
    """Off the map the way may be as long as the machine holds its position after the trailing reading, less what it may be longer."""
    readers = LAYOUTS[name].readers
    held_mm = bound(name).run_mm + readers.vehicle_length_mm - readers.vehicle_length_tolerance_mm - 300

    def lost(more_mm: int) -> list[str]:
        line = straight(1_000 + held_mm + more_mm, markers=(marker(1, "e0", 1_000),))
        return [one.subject for one in audit(line, LAYOUTS[name]).violated]

    assert [] == lost(0)
    assert ["from the trailing reading of marker m1 to the end of the map, increasing"] == lost(1)


def test_no_bound_and_no_run() -> None:
    """Without a rate no run is too long; without any room for error none is short enough."""
    assert (
        held_run(LineVehicle(layout=LayoutConfig(odometry_rate_ppm=0, markers=MarkerReaders())).odometry(), 300) is None
    )
    assert held_run(config("default"), 25_000) is None
