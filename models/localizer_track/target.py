"""The catalogue entry of a localizer on a map with switches."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from safeloc.language.system import TransitionSystem
from safeloc.models import localizer_track
from safeloc.models.localizer.target import SECTIONS, properties_of_machines
from safeloc.models.localizer_track import NAME, LocalizerTrackConfig
from safeloc.models.localizer_track.configurations import CONFIGURATIONS
from safeloc.models.occupied_track.picture import picture
from safeloc.models.occupied_track.reported import interval_on_the_edge
from safeloc.properties import localizer_track as claims
from safeloc.properties import occupied_track as track_claims
from safeloc.properties import turn_off as course_claims
from safeloc.reported import Reported
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Hazard, Target, recorded

DOC = (
    "A localizer on a map with switches, in one step. The host is told the edge of the map and the interval on it, or that the edge is not "
    "known, with at most as many possible ones as are carried; a position along the announced way is no place on the map."
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
        NAME, system.machines, system, properties, config, DOC, recorded(NAME), _reported(config, system),
        simulate=lambda seed: _simulated(config, seed), pictures=(picture(config.track, _shipped, "occupied_track."),),
        members=members, sections={**SECTIONS, "occupied_track": "track"},
    )  # fmt: skip


def _simulated(config: LocalizerTrackConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    """Return a journey of one of the scenes that ship; the seed selects it, and gives the sensors' errors."""
    from safeloc.models.localizer_track.simulate import (
        drawn,
    )  # numpy and the map are loaded only where something is simulated

    return drawn(config, seed)


def _shipped() -> Collection[str]:
    from safeloc.models.localizer_track.simulate import (
        RUNS,
    )  # numpy and the map are loaded only where a picture is drawn

    return RUNS


def _reported(config: LocalizerTrackConfig, system: TransitionSystem) -> Reported:
    """Return the interval along the edge; what other machines have as a position is marked as no place on the map."""
    along = [
        name for name in system.outputs if name.endswith(".position_mm") and not name.startswith("occupied_track.")
    ]
    return interval_on_the_edge(config.track.tracks, "occupied_track.", tuple(along))


ENTRIES = (
    Entry(
        NAME,
        "the located vehicle on a map with switches: its position, and the track that it is on",
        LocalizerTrackConfig,
        target,
        Family.LOCALIZER,
        place=35,
        simulates=True,
        members=("motion", "balise", "arbitration", "delocalized", "uplink", "turn_off", "occupied_track"),
        pairs_of=("balise", "turn_off", "occupied_track"),
        silent=("uplink",),
        configurations=CONFIGURATIONS,
        hazard=Hazard(
            "a track is told on which the vehicle is not",
            ("occupied_track: the true track is carried", "occupied_track: a track that is told is the true one"),
        ),
    ),
)
