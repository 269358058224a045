"""One cycle's look at the sky from the predicted state: residuals on every portion of track that is possible.

Every satellite of the epoch that is given has a part in the clock, and so in all residuals and in the time of the measurement.
The chain looks twice: at all that is visible, for the criterion, and at the usable satellites alone, for the solution (SAT-5).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from safeloc.errors import InputError
from safeloc.models.satellite.ahead import Ahead
from safeloc.sensing.satellite.epochs import Epoch
from safeloc.sensing.satellite.places import Place
from safeloc.sensing.satellite.residuals import Kept, Residuals, Sky, residuals
from safeloc.sensing.satellite.track_prediction import OnTrack, Portion, on_portion

Track = Callable[[float, float], Sequence[Portion]]
"""(from_m, to_m) -> the courses that a vehicle between these distances may be on (`LineTrack.portions`)."""


@dataclass(frozen=True, slots=True)
class Sighting:
    """Residuals on each portion, where the prediction lies on it, and how long after the cycle it was measured.

    missing   why there are none; empty otherwise
    """

    missing: str = ""
    residuals: tuple[Residuals, ...] = ()
    places: tuple[OnTrack, ...] = ()
    portions: tuple[Portion, ...] = ()
    distance_m: float = 0.0
    offset_s: float = 0.0


def sighted(epoch: Epoch, ahead: Ahead, portions: Sequence[Portion], due_s: float, sky: Sky, kept: Kept) -> Sighting:
    """Return the residuals of an epoch at the places that E*(t) predicts on the portions; a state off the map gives none."""
    state = ahead.at(epoch.time_s - due_s)
    try:
        places = on_portion(state, portions)
    except InputError:
        return Sighting("NO_PREDICTION")
    found = [residuals(epoch, _place(one), one.velocity_m_per_s, sky, kept) for one in places]
    offset_s = epoch.time_s - found[0].clock_s - due_s
    return Sighting("", tuple(found), tuple(places), tuple(portions), ahead.at(offset_s).distance_m, offset_s)


def true_time_s(epoch: Epoch, ahead: Ahead, portions: Sequence[Portion], sky: Sky) -> float:
    """Return the time at which an epoch was measured, without the receiver's clock error, for a vehicle near its
    predicted place.

    InputError where the prediction is off the map.
    """
    place = on_portion(ahead.at(0.0), portions)[0]
    return epoch.time_s - residuals(epoch, _place(place), (0.0, 0.0, 0.0), sky).clock_s


def _place(one: OnTrack) -> Place:
    return Place.of_earth_fixed(one.point_m)
