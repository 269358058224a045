"""The interval along an edge of the map, with the outputs that tell the edge: what the host is given of the track."""

from __future__ import annotations

from safeloc.reported import PossibleTrack, Reported, Tracks


def interval_on_the_edge(tracks: int, owner: str = "", coordinates: tuple[str, ...] = ()) -> Reported:
    """Return the names of the outputs that make up the interval and its track.

    tracks       how many tracks are carried at most
    owner        of a composition: the name of the machine in it, with a full stop behind
    coordinates  outputs of other machines that are no places on the map
    """
    possible = [
        PossibleTrack(*(f"{owner}track_{number}_{word}" for word in ("edge", "low_mm", "high_mm")))
        for number in range(1, tracks + 1)
    ]
    plain = Reported()
    return Reported(
        position=f"{owner}{plain.position}",
        below=f"{owner}{plain.below}",
        above=f"{owner}{plain.above}",
        valid=f"{owner}{plain.valid}",
        truth=f"{owner}true_place_nm",
        tracks=Tracks(f"{owner}edge", f"{owner}tracks", tuple(possible), coordinates),
    )
