"""The catalogue entry of a train and its area, from backscatter to virtual sections."""

from __future__ import annotations

from safeloc.models import fibre_area
from safeloc.models.fibre.picture import area_picture
from safeloc.models.fibre_area import FibreAreaConfig
from safeloc.models.fibre_area.configurations import CONFIGURATIONS
from safeloc.properties import fibre_area as claims
from safeloc.reported import Reported
from safeloc.target import Entry, Family, Hazard, Target, recorded

DOC = (
    "A train in a line area, from backscatter to virtual sections in one step: axle counters at both ends, the train's entry "
    "and exit, the order of trains, both ends' fibre machines, the test emitter, the verification, what is believed of the "
    "ends, the area and its sections."
)
REPORTED = Reported(
    position="verification.position_mm",
    below="verification.margin_below_mm",
    above="verification.margin_above_mm",
    valid="verification.trusted",
    truth="front.truth_nm",
)


def target(config: FibreAreaConfig) -> Target:
    """Make the composition."""
    model = fibre_area.compose_machines(config)
    properties, system = tuple(claims.properties(model)), model.composition.system
    pictures = (area_picture(config.sections.sections),)
    return Target(
        "fibre_area", system.machines, system, properties, config, DOC, recorded("fibre_area"), REPORTED, pictures=pictures,
        sections={"front": "fibre", "rear": "fibre", "report": "area"},
    )  # fmt: skip


ENTRIES = (
    Entry(
        "fibre_area",
        "a train and its area in one step",
        FibreAreaConfig,
        target,
        Family.FIBRE,
        place=90,
        members=(
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
        pairs_of=("axle_section", "train_order", "fibre", "verification", "emitter", "sections"),
        configurations=CONFIGURATIONS,
        hazard=Hazard(
            "a section is reported clear with a vehicle in it",
            (
                "section_* is never clear with a train in it",
                "section_* is never clear with a vehicle that was not counted",
            ),
        ),
    ),
)
