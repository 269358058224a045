"""The localizer in a host: one object that takes what all devices say (RFL-13, RFL-14, MRK-2)."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from safeloc.errors import InputError, SnapshotError
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.runtime.embedding import Localizer, Program, localizer_program
from safeloc.runtime.streams.records import ValueRecord
from tests.runtime.embedding.driving import PERIOD_MS, drive

CONFIG = LocalizerConfig(sources=("odometry", "reflector"), odometry=OdometryConfig(trust_first_marker=True))


@pytest.fixture(scope="module")
def program() -> Program:
    """Odometry and reflectors, made ready once."""
    return localizer_program(CONFIG)


def test_records_of_all_devices_locate_it(program: Program) -> None:
    """Odometers and a marker: the leading source and the proven interval; every record is used; radar may be silent."""
    vehicle = Localizer(program)
    for records in drive(40):
        report = vehicle.step(records)
        assert report.rejections == ()
    assert report.modes["odometry"] == "FRONT"
    assert report.modes["delocalized"] == "LOCALIZED"
    assert report.outputs["arbitration.lead"] == "ODOMETRY"
    assert report.interval is not None
    assert report.interval.holds(250_310 + 38 * 1_200)


def test_what_is_no_vehicle() -> None:
    """Plain data is no configuration: read it with safeloc.catalogue.read_config, or make one of it."""
    with pytest.raises(InputError, match="expected a LocalizerConfig or a Program, got dict"):
        Localizer({"sources": ["balise"]})  # type: ignore[arg-type] # that is the point


class Cab:
    """A host's own object: it shows where the train is, or restricts it."""

    def __init__(self) -> None:
        self.told: list[str] = []

    def on_enter_localized(self, event: Any) -> None:
        """A position is passed on."""
        self.told.append(f"localized, {event.kwargs['report'].outputs['arbitration.lead']} leads")

    def on_enter_delocalized(self, event: Any) -> None:
        """Nothing is passed on any more."""
        self.told.append(f"restrictive, {event.kwargs['report'].outputs['delocalized.reason']}")


def test_host_objects_follow_the_whole(program: Program) -> None:
    """One follows what is passed on, another one which source leads; their callbacks run in the cycle of the change."""
    vehicle, cab, lead = Localizer(program), Cab(), SimpleNamespace(entered=[])
    lead.on_enter_odometry = lambda event: lead.entered.append(event.kwargs["report"].cycle)
    vehicle.follow(cab, "delocalized")
    vehicle.follow(lead, "arbitration")
    for records in drive(6):
        vehicle.step(records)
    assert (cab.told, lead.entered) == (["localized, ODOMETRY leads"], [2])
    lost = next(report for report in (vehicle.step([]) for _ in range(30)) if report.interval is None)
    assert cab.told[1:] == [f"restrictive, {lost.outputs['delocalized.reason']}"]
    assert lost.outputs["delocalized.reason"] == "SENSOR_FAILURE"
    assert (lead.state, cab.state) == ("WITHHELD", "DELOCALIZED")  # type: ignore[attr-defined] # `transitions` gave it


def test_half_a_radar_picture_is_no_picture(program: Program) -> None:
    """What came of it is not used, and said to be so; the other sources go on."""
    vehicle, other = Localizer(program), Localizer(program)
    for records in drive(3):
        half = ValueRecord(time_ms=records[0].time_ms, name="frame_present", value=True)
        report, whole = vehicle.step([*records, half]), other.step(records)
        assert report.values == whole.values
        assert [fault.channel for fault in report.rejections] == ["reflector"]
    assert report.interval is not None


def test_a_source_that_is_left_out_is_not_heard(program: Program) -> None:
    """Its records are told to be of no channel of this vehicle."""
    vehicle = Localizer(program)
    (fault,) = vehicle.step([ValueRecord(time_ms=PERIOD_MS, name="telegram_group", value=1)]).rejections
    assert fault.detail == "no input telegram_group"


def test_it_goes_on_from_its_snapshot(program: Program) -> None:
    """As every controller; a vehicle with other sources does not take it."""
    vehicle, rest = Localizer(program), Localizer(program)
    for records in drive(10):
        vehicle.step(records)
    rest.restore(vehicle.snapshot())
    for records in drive(5, 11):
        assert rest.step(records) == vehicle.step(records)
    with pytest.raises(SnapshotError, match=r"of another configuration \(sources \['odometry', 'reflector'\], here"):
        Localizer(CONFIG.model_copy(update={"sources": ("odometry",)})).restore(vehicle.snapshot())


def test_the_cycle_is_that_of_its_machines(program: Program) -> None:
    """Said once in the configuration, and known to the controller."""
    assert Localizer(program).next_end_ms == CONFIG.odometry.period_ms
