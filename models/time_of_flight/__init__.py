"""Distance of one end of a train along the fibre by the time of flight of light, and its place along the track (FWG-4, FWG-6).

A pulse runs into the fibre; the vehicle's end scatters part of it back. The pattern comes back after the time T, in which the
light went there and back:

    Ls = T V / 2        V = c0 / n

    UNMEASURED  no delay was measured in this cycle: there is neither time of flight nor distance
    DISTANCE    time of flight T and distance Ls along the fibre are reported
    PLACED      the place along the track as well: the cable map has a surveyed point there
    BEYOND      the delay is longer than light needs to the end of the fibre and back: it is no vehicle, and nothing is reported

Nothing is kept from cycle to cycle: what is reported belongs to the delay of this cycle. `fibre` compares the place with that of its
sections, and raises the error signal F if they differ by more than a threshold.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.absence import NO_BOUND, shown_if
from safeloc.language.expr import TRUE, Expr, Lit, NumVar, floor_div
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates
from safeloc.models.time_of_flight.flight import Flight
from safeloc.models.time_of_flight.variables import Parts, TimeOfFlightConfig, parts
from safeloc.models.time_of_flight.world import world
from safeloc.models.vocabulary.absent import margin_if, position_if

__all__ = ["Parts", "TimeOfFlight", "TimeOfFlightConfig", "build", "machine", "parts"]
REQUIREMENTS = ("FWG-4", "FWG-6", "FWG-11")

TimeOfFlight = Model[Parts]


def machine(config: TimeOfFlightConfig | None = None) -> Machine:
    """Return the machine of one end of a train (FWG-6)."""
    return build(parts(config or TimeOfFlightConfig())).machine


def build(own: Parts, name: str = "time_of_flight") -> TimeOfFlight:
    """Return the machine over the given variables."""
    table, flight = modes("UNMEASURED", "DISTANCE", "PLACED", "BEYOND"), Flight(own)
    made = own.declared.machine(
        name=name,
        modes=table,
        outputs=_outputs(own, current_mode(table), table),
        transitions=list(_table(own, flight, table)),
        world=world(own),
        definitions={"a delay beyond the fibre": flight.beyond},
        doc=(
            "Distance along the fibre, and place along the track, of one end of a train by the time of flight. Assumed: the "
            "pattern that is timed comes from the vehicle's end, within an error; the delay is measured within the errors of "
            "trigger and reading; the index of refraction is known within an error; between surveyed points the cable is no "
            "shorter than its track, and longer by no more than its slack."
        ),
    )
    return Model(made, own)


def _table(own: Parts, flight: Flight, table: tuple[Lit, ...]) -> Iterator[Transition]:
    unmeasured, distance, placed, beyond = table
    nothing: Updates = dict.fromkeys((own.time_reported, own.low, own.high, own.track_low, own.track_high), 0)
    reported: Updates = {**nothing, own.time_reported: own.delay.value, own.low: flight.low, own.high: flight.high}
    on_track: Updates = {**reported, own.track_low: flight.track_low, own.track_high: flight.track_high}
    timed = own.delay.present & ~flight.beyond
    yield Transition("beyond the fibre", table, beyond, flight.beyond, nothing, REQUIREMENTS, 0)
    yield Transition("place reported", table, placed, timed & own.map_known, on_track, REQUIREMENTS, 1)
    yield Transition("distance reported", table, distance, timed, reported, REQUIREMENTS, 2)
    yield Transition("no delay", table, unmeasured, TRUE, nothing, REQUIREMENTS, 3)


def _outputs(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> dict[str, Expr]:
    _, distance, placed, beyond = table
    reported, on_track = current.one_of(distance, placed), current.eq(placed)
    middle, place = floor_div(own.low + own.high, 2), floor_div(own.track_low + own.track_high, 2)
    return {
        "distance_reported": reported,
        "flight_time_ps": shown_if(reported, own.time_reported, NO_BOUND),
        "distance_mm": position_if(reported, middle),
        "distance_margin_below_mm": margin_if(reported, middle - own.low),
        "distance_margin_above_mm": margin_if(reported, own.high - middle),
        "valid": on_track,
        "position_mm": position_if(on_track, place),
        "margin_below_mm": margin_if(on_track, place - own.track_low),
        "margin_above_mm": margin_if(on_track, own.track_high - place),
        "beyond_fibre": current.eq(beyond),
    }
