"""A localizer on a map with switches: the position that the host gets, and the track that it is on, in one step (RFL-13, RFL-D6).

    motion ... delocalized, uplink   the localizer (safeloc.models.localizer)
    turn_off         sees by the reflector behind a switch whether the vehicle turns off
    occupied_track   carries the edges of the map on which the vehicle may be, and tells the one on which it is

The track is that of the interval which the host gets: no interval, no track. A group begins a track, or ends the others, only if the
balise machine accepted it. That the interval holds the front end, and that a turn which is seen is the one taken, is proved of the
machines before. What the map states of the true track, and groups of other branches, stay laws of the infrastructure.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from safeloc.language.composition import Clause, Composition
from safeloc.language.expr import Expr, Var, as_num, ite, maximum, minimum
from safeloc.language.machine import Machine
from safeloc.language.units import MM
from safeloc.models import occupied_track, turn_off
from safeloc.models.localizer import Localizer, More, Piece
from safeloc.models.localizer import compose_machines as compose_localizer
from safeloc.models.localizer_track.configuration import LocalizerTrackConfig
from safeloc.models.motion import Motion
from safeloc.models.occupied_track import OccupiedTrack
from safeloc.models.occupied_track.world import POSITION
from safeloc.models.transmission import Transmission
from safeloc.models.turn_off import TurnOff
from safeloc.models.turn_off.seen_course import TAKEN
from safeloc.models.vocabulary.absent import wired_interval

__all__ = ["LocalizerTrack", "LocalizerTrackConfig", "compose_machines"]
NAME = "localizer_track"


@dataclass(frozen=True, eq=False)
class LocalizerTrack:
    """The composition and its machines; `localizer.composition` is that of the whole."""

    config: LocalizerTrackConfig
    localizer: Localizer
    course: TurnOff
    track: OccupiedTrack

    @property
    def composition(self) -> Composition:
        """All machines in one step."""
        return self.localizer.composition

    @property
    def groups(self) -> Machine:
        """The machine that judges balise groups."""
        [machine] = self.localizer.pieces["balise"].machines
        return machine


def compose_machines(config: LocalizerTrackConfig | None = None) -> LocalizerTrack:
    """Compose the localizer with the track behind it."""
    config = config or LocalizerTrackConfig()
    course = turn_off.build(turn_off.parts(config.turn_off))
    made: list[OccupiedTrack] = []

    def behind(moves: Motion, guard: Machine, _: Transmission, pieces: Mapping[str, Piece]) -> More:
        [groups] = pieces["balise"].machines
        track = occupied_track.build(occupied_track.Parts(config.track, moves.own.ghosts.truth))
        made.append(track)
        wires = {**_into_course(guard, course), **_into_track(moves, guard, groups, course, track)}
        return More(
            (course.machine, track.machine),
            wires,
            discharge=(Clause(track.machine, POSITION), Clause(track.machine, TAKEN)),
        )

    localizer = compose_localizer(config.localizer, name=NAME, behind=behind)
    [track] = made
    return LocalizerTrack(config, localizer, course, track)


def _into_course(guard: Machine, course: TurnOff) -> dict[Var, Expr]:
    """Return the wires of the interval to the course at switches; the whole line while the host gets none."""
    own, passed = course.own, ~guard.flag("restrictive")
    position, below, above = wired_interval(guard)
    limit = own.high.high
    return {
        own.low: ite(passed, maximum(position - below, -limit), as_num(-limit, MM)),
        own.high: ite(passed, minimum(position + above, limit), as_num(limit, MM)),
    }


def _into_track(
    moves: Motion, guard: Machine, groups: Machine, course: TurnOff, track: OccupiedTrack
) -> dict[Var, Expr]:
    """Return the wires of the host's interval, of accepted groups and of the turn; the true place is that of the vehicle."""
    own = track.own
    position, below, above = wired_interval(guard)
    return {
        own.located: ~guard.flag("restrictive"),
        own.low: position - below,
        own.high: position + above,
        own.start_given: groups.flag("reference_accepted"),
        own.course_taken: course.machine.output("course"),
        own.ghosts.course: course.own.true_course,
        own.ghosts.next_truth: moves.own.ghosts.truth,
    }
