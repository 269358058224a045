"""The catalogue entry of a fibre that is timed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from safeloc.models import fibre_timed
from safeloc.models.fibre_timed import NAME, FibreTimedConfig
from safeloc.models.fibre_timed.configurations import CONFIGURATIONS
from safeloc.properties import fibre as section_claims
from safeloc.properties import fibre_timed as claims
from safeloc.properties import time_of_flight as flight_claims
from safeloc.reported import Reported
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Hazard, Target, recorded

DOC = (
    "One end of a train on a fibre: its place by localization sections, compared with its place by the time of flight of light, in one step. "
    "Time of flight T and distance Ls are outputs; F comes of them only where a law is broken."
)
REPORTED = Reported(
    position="fibre.position_mm",
    below="fibre.margin_below_mm",
    above="fibre.margin_above_mm",
    valid="fibre.valid",
    truth="truth_nm",
)


def target(config: FibreTimedConfig) -> Target:
    """Make the composition, with the properties of each of its machines."""
    whole = fibre_timed.compose_machines(config)
    properties, system = tuple(claims.properties(whole)), whole.composition.system
    members = {
        whole.flight.machine.name: tuple(flight_claims.properties(whole.flight)),
        whole.sections.machine.name: tuple(section_claims.properties(whole.sections)),
    }
    return Target(
        NAME, system.machines, system, properties, config, DOC, recorded(NAME), REPORTED, partial(_simulated, config),
        members=members, sections={"course": "fibre", "additional": "fibre"},
    )  # fmt: skip


def _simulated(config: FibreTimedConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.fibre_timed.simulate import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


ENTRIES = (
    Entry(
        NAME,
        "place from localization sections, compared with the place by time of flight",
        FibreTimedConfig,
        target,
        Family.FIBRE,
        place=17,
        simulates=True,
        silent=("time_of_flight",),
        members=("course", "time_of_flight", "additional", "fibre"),
        pairs_of=("fibre", "time_of_flight"),
        configurations=CONFIGURATIONS,
        hazard=Hazard(
            "a distance along the fibre or a place by its time is reported that is not the train's, or a place that the time contradicts",
            (
                "time_of_flight: the distance holds the vehicle",
                "time_of_flight: containment",
                "a time off the section raises F",
                "a located end agrees with its time",
            ),
        ),
    ),
)
