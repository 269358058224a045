"""The catalogue entry of the occupied track."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from safeloc.models import occupied_track
from safeloc.models.occupied_track.picture import picture
from safeloc.models.occupied_track.reported import interval_on_the_edge
from safeloc.models.occupied_track.variables import OccupiedTrackConfig, parts
from safeloc.properties import occupied_track as claims
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Hazard, Pair, Target, single


def target(config: OccupiedTrackConfig) -> Target:
    """Make the machine."""
    model = occupied_track.build(parts(config))
    return single(
        model.machine,
        claims.properties(model),
        config,
        reported=interval_on_the_edge(config.tracks),
        simulate=lambda seed: _simulated(config, seed),
        pictures=(picture(config, _shipped),),
    )


def _shipped() -> Collection[str]:
    from safeloc.models.occupied_track.simulate import RUNS  # as below

    return RUNS


def _simulated(config: OccupiedTrackConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.occupied_track.simulate import (
        drawn,
    )  # numpy and the map are loaded only where something is simulated

    return drawn(config, seed)


ENTRIES = (
    Entry(
        "occupied_track",
        "which track of the map the vehicle is on, or that several are possible",
        OccupiedTrackConfig,
        target,
        Family.LOCALIZER,
        place=15,
        simulates=True,
        pairs=(
            Pair("line speed beside cycle time", "period_ms:down", "max_speed_mm_s:up", "design"),
            Pair("cycle time beside line speed", "max_speed_mm_s:down", "period_ms:up", "design"),
            Pair("line speed beside shortest edge", "shortest_edge_mm:up", "max_speed_mm_s:up", "design"),
            Pair("cycle time beside shortest edge", "shortest_edge_mm:up", "period_ms:up", "design"),
            Pair("longest edge beside length of the line", "position_limit_mm:up", "longest_edge_mm:up", "design"),
        ),
        silent=("occupied_track",),
        hazard=Hazard(
            "a track is told on which the vehicle is not",
            ("the true track is carried", "a track that is told is the true one"),
        ),
    ),
)
