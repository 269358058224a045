"""The catalogue entry of a train between two neighbouring areas."""

from __future__ import annotations

from safeloc.models import fibre_handover
from safeloc.models.fibre_handover import FibreHandoverConfig
from safeloc.properties import fibre_handover as claims
from safeloc.reported import Reported
from safeloc.target import Entry, Family, Target, recorded

DOC = "A train between two neighbouring areas: two verifications, the record that goes over, and whose position counts."
REPORTED = Reported(
    position="speaker.position_mm",
    below="speaker.margin_below_mm",
    above="speaker.margin_above_mm",
    valid="speaker.given",
    truth="giving.truth_nm",
)


def target(config: FibreHandoverConfig) -> Target:
    """Make the composition."""
    model = fibre_handover.compose_machines(config)
    properties, system = tuple(claims.properties(model)), model.composition.system
    streams = recorded("fibre_handover")
    return Target("fibre_handover", system.machines, system, properties, config, DOC, streams, REPORTED)


ENTRIES = (
    Entry(
        "fibre_handover",
        "a train between two neighbouring areas",
        FibreHandoverConfig,
        target,
        Family.FIBRE,
        place=100,
        members=("giving", "border", "taking", "speaker"),
        pairs_of=("verification",),
        silent=("giving", "border", "taking"),
    ),
)
