"""The picture of a run of the occupied track: the edges that are possible, the one that is told, and the true one, over time."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.models.occupied_track.reported import interval_on_the_edge
from safeloc.models.occupied_track.variables import OccupiedTrackConfig
from safeloc.railway.pictures import PossibleEdges


def picture(config: OccupiedTrackConfig, owner: str = "") -> PossibleEdges:
    """Return the picture; `owner` is the machine's name in a composition, with a full stop behind."""
    tracks = interval_on_the_edge(config.tracks, owner).tracks
    assert tracks is not None
    return PossibleEdges("Possible edges", tracks, f"{owner}true_edge", config.period_ms, f"{owner}mode", _names)


def _names(recording: str) -> Mapping[int, str]:
    """Return the names of the edges for recordings that ship: all are over fig. 3."""
    from safeloc.models.occupied_track.look_up import LookUp  # the map is loaded only where a picture is drawn
    from safeloc.railway.map.toml_files import find_line
    from safeloc.railway.map.topology import Topology
    from safeloc.target import recorded, recording_name

    shipped = {recording_name(path) for name in ("occupied_track", "localizer_track") for path in recorded(name)}
    if recording not in shipped:
        return {}
    topology = Topology(find_line("fig3"))
    look_up = LookUp(topology, OccupiedTrackConfig())
    return {look_up.number(run): run.edge for run in topology.graph}
