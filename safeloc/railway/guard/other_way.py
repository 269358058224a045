"""Indicator of whether a given way is the one that the vehicle is on, from the fixes that the guard passes on; no check.

A given way is believed, since a fix rarely tells tracks that lie side by side: a receiver that is wrong by a few metres to the
side is nearer to the neighbouring track. But it is nearer now and then, and on a wrong way nearly always. So fixes that lie far
enough apart are counted: how many of the last ones are nearer to a track off the way than to the way. Nothing is withheld for it.
Needs the extra `geo`.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from safeloc.railway.guard.tracks import Tracks
from safeloc.railway.map.projection import Projector

APART_MM = 20_000
"""[D] `course_base_mm`: errors of fixes that are nearer to each other are nearly equal, above all while the vehicle stands."""
KEPT = 20
"""[D] 400 m of way. On the ways that recorded trains took, at most 6 of 20 are nearer to another track; on others 20 (docs/guard.md)."""
MOST = 10
"""[D] With more of them nearer to another track the way is doubtful."""


@dataclass(frozen=True)
class Beside:
    """Of the fixes that were passed on last beside another track: how many there are, and how many of them lie nearer to one off the way."""

    fixes: int
    nearer: int

    @property
    def doubtful(self) -> bool:
        """The vehicle may be on another way than the given one."""
        return self.nearer > MOST


def doubt(beside: Beside) -> str:
    """Return in words why the way is doubtful, and what to do."""
    return (
        f"{beside.nearer} of the last {beside.fixes} fixes that were passed on beside another track lie nearer to it than to the given way: "
        "check the way, or the receiver. No position is withheld for it."
    )


class OtherWay:
    """The last fixes beside other tracks than those of the way; without a way, or without other tracks, there are none."""

    def __init__(self, tracks: Tracks) -> None:
        self._tracks, self._others = tracks, _off_the_way(tracks)
        self._nearer: deque[bool] = deque(maxlen=KEPT)
        self._last_mm: int | None = None

    def forget(self) -> None:
        """Forget all fixes."""
        self._nearer.clear()
        self._last_mm = None

    def passed(self, x: float, y: float, position_mm: int, offset_mm: int) -> Beside | None:
        """Count a fix that was passed on, so far along the way and off it; None where there is no way, or no other track on the map.

        A fix counts `APART_MM` or more from the one that counted before, with another track within the clearance.
        """
        if self._others is None:
            return None
        if self._last_mm is None or abs(position_mm - self._last_mm) >= APART_MM:
            near = self._others.near(x, y, self._tracks.clear_mm, crs=self._tracks.crs)
            if near:
                self._last_mm = position_mm
                self._nearer.append(abs(near[0].offset_mm) < abs(offset_mm))
        return Beside(len(self._nearer), sum(self._nearer))


def _off_the_way(tracks: Tracks) -> Projector | None:
    if tracks.route is None:
        return None
    way = {laid.run.edge for laid in tracks.route}
    others = [edge.id for edge in tracks.topology.line.edges if edge.geometry is not None and edge.id not in way]
    if not others:
        return None
    projector = Projector(tracks.topology.line, edges=others)
    projector.prepare(tracks.crs)
    return projector
