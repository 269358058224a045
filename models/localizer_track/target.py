"""The catalogue entry of a localizer on a map with switches."""

from __future__ import annotations

from safeloc.models import localizer_track
from safeloc.models.delocalized.reported import interval_of_the_host
from safeloc.models.localizer.target import SECTIONS, properties_of_machines
from safeloc.models.localizer_track import NAME, LocalizerTrackConfig
from safeloc.properties import localizer_track as claims
from safeloc.properties import occupied_track as track_claims
from safeloc.properties import turn_off as course_claims
from safeloc.target import Entry, Family, Hazard, Target, recorded

DOC = (
    "A localizer on a map with switches, in one step: the position that the host gets, and the edge of the map that it is on, if no other "
    "one is possible."
)


def target(config: LocalizerTrackConfig) -> Target:
    """Make the composition, with the properties of each of its machines."""
    model = localizer_track.compose_machines(config)
    properties, system = tuple(claims.properties(model)), model.composition.system
    members = {
        **properties_of_machines(model.localizer),
        model.course.machine.name: tuple(course_claims.properties(model.course)),
        model.track.machine.name: tuple(track_claims.properties(model.track)),
    }
    return Target(
        NAME, system.machines, system, properties, config, DOC, recorded(NAME), interval_of_the_host(),
        members=members, sections={**SECTIONS, "occupied_track": "track"},
    )  # fmt: skip


ENTRIES = (
    Entry(
        NAME,
        "the located vehicle on a map with switches: its position, and the track that it is on",
        LocalizerTrackConfig,
        target,
        Family.LOCALIZER,
        place=35,
        members=("motion", "balise", "arbitration", "delocalized", "uplink", "turn_off", "occupied_track"),
        hazard=Hazard(
            "a track is told on which the vehicle is not",
            ("occupied_track: the true track is carried", "occupied_track: a track that is told is the true one"),
        ),
    ),
)
