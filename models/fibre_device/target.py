"""The catalogue entry of a fibre device: a train in its area with all sensors of the area."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from safeloc.models import fibre_device
from safeloc.models.fibre_device import NAME, FibreDeviceConfig
from safeloc.models.fibre_device.configurations import CONFIGURATIONS
from safeloc.properties import fibre_device as claims
from safeloc.reported import Reported
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Hazard, Target, recorded

DOC = (
    "A train in a line area with all sensors of the area, in one step: counters at both ends that make the train's record, the time of flight to "
    "both of its ends, the order of trains, the fibre's sections, emitter, verification, area and virtual sections."
)
REPORTED = Reported(
    position="verification.position_mm",
    below="verification.margin_below_mm",
    above="verification.margin_above_mm",
    valid="verification.trusted",
    truth="front.truth_nm",
)
_SECTIONS = {
    "counter_low": "counter", "counter_high": "counter", "front_course": "area.fibre", "rear_course": "area.fibre",
    "front_flight": "time_of_flight", "rear_flight": "time_of_flight", "front_additional": "area.fibre", "rear_additional": "area.fibre",
    "front": "area.fibre", "rear": "area.fibre", "report": "area.sections.area", "area": "area.sections.area",
}  # fmt: skip


def target(config: FibreDeviceConfig) -> Target:
    """Make the composition."""
    whole = fibre_device.compose_machines(config)
    properties, system = tuple(claims.properties(whole)), whole.composition.system
    return Target(
        NAME, system.machines, system, properties, config, DOC, recorded(NAME), REPORTED, partial(_simulated, config), sections=_SECTIONS
    )  # fmt: skip


def _simulated(config: FibreDeviceConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.fibre_device.simulate import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


ENTRIES = (
    Entry(
        NAME,
        "a train and its area with counters and time of flight, as one device",
        FibreDeviceConfig,
        target,
        Family.FIBRE,
        place=95,
        simulates=True,
        members=(
            "counter_low",
            "counter_high",
            "counted_axles",
            "reference",
            "front_course",
            "front_flight",
            "front_additional",
            "rear_course",
            "rear_flight",
            "rear_additional",
            "axle_section",
            "entry",
            "train_order",
            "front",
            "rear",
            "emitter",
            "verification",
            "report",
            "area",
            "section_1",
        ),
        pairs_of=(
            "axle_counter",
            "time_of_flight",
            "axle_section",
            "train_order",
            "fibre",
            "verification",
            "emitter",
            "sections",
        ),
        configurations=CONFIGURATIONS,
        hazard=Hazard(
            "a section is reported clear with a train in it, or a train is verified by a record that is not its own",
            (
                "section_* is never clear with a train in it",
                "the axles that passed at the * end are compared",
            ),
        ),
    ),
)
