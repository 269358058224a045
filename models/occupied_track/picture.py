"""The picture of a run of the occupied track: the edges that are possible, the one that is told, and the true one, over time."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import partial

from safeloc.models.occupied_track.reported import interval_on_the_edge
from safeloc.models.occupied_track.variables import OccupiedTrackConfig
from safeloc.railway.pictures import PossibleEdges


def picture(config: OccupiedTrackConfig, shipped: Callable[[], Collection[str]], owner: str = "") -> PossibleEdges:
    """Return the picture.

    shipped  returns the names of the recordings that ship: their line is known, and so the names of the edges
    owner    of a composition: the machine's name in it, with a full stop behind
    """
    tracks = interval_on_the_edge(config.tracks, owner).tracks
    assert tracks is not None
    names = partial(_names, shipped)
    return PossibleEdges("Possible edges", tracks, f"{owner}true_edge", config.period_ms, f"{owner}mode", names)


def _names(shipped: Callable[[], Collection[str]], recording: str) -> Mapping[int, str]:
    """Return the names of the edges of fig. 3, over which all recordings that ship are; none for another recording."""
    if recording not in shipped():
        return {}
    from safeloc.models.occupied_track.look_up import LookUp  # the map is loaded only where a picture is drawn
    from safeloc.railway.map.toml_files import find_line
    from safeloc.railway.map.topology import Topology

    topology = Topology(find_line("fig3"))
    look_up = LookUp(topology, OccupiedTrackConfig())
    return {look_up.number(run): run.edge for run in topology.graph}
