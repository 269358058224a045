"""Properties of the time of flight and of the distance Ls along the fibre (FWG-4, FWG-6, FWG-11).

The figures are the source's own: half the way of light in the measured time, at c0 / n. The machine computes with a speed in whole m/s;
the claims with the index itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, before, between, exact_to, ite, with_unit
from safeloc.language.spec import Property, always, earlier_bool, reachable
from safeloc.language.units import NM, ONE, PPM_PER_ONE, UM
from safeloc.models.time_of_flight import REQUIREMENTS, TimeOfFlight
from safeloc.models.time_of_flight.variables import LIGHT_M_S, Parts
from safeloc.models.vocabulary.absent import NO_MARGIN_MM, NO_POSITION_MM
from safeloc.properties.no_interval import no_interval

LAW = "the pattern comes from the vehicle's end, within an error; delay, index and slack of the cable are known within theirs"
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(model: TimeOfFlight) -> list[Property]:
    """Return the properties: time and distance are reported exactly when measured, and the distance holds the vehicle."""
    return [
        *_truth(model),
        *_reported(model),
        *_shown(model),
        *_time(model),
        *_half_the_way(model),
        *_along_the_track(model),
        *_reached(model),
    ]


def _reported_now(model: TimeOfFlight) -> Bool:
    return model.machine.flag("distance_reported")


def _distance(model: TimeOfFlight) -> tuple[Num, Num]:
    """Return the bounds of the distance as reported, mm."""
    output = model.machine.output
    return (
        output("distance_mm") - output("distance_margin_below_mm"),
        output("distance_mm") + output("distance_margin_above_mm"),
    )


def _place(model: TimeOfFlight) -> tuple[Num, Num]:
    """Return the bounds of the place along the track as reported, mm."""
    output = model.machine.output
    return output("position_mm") - output("margin_below_mm"), output("position_mm") + output("margin_above_mm")


def _truth(model: TimeOfFlight) -> Iterator[Property]:
    """Claim that what is reported holds the vehicle, and that a vehicle whose pattern is timed is reported."""
    own, machine = model.own, model.machine
    (low, high), (near, far) = _distance(model), _place(model)
    yield under_assumption(
        "the distance holds the vehicle",
        _reported_now(model).implies(between(exact_to(low, UM), own.true_distance, exact_to(high, UM))),
        statement="the bounds of Ls contain the distance along the fibre from the sensing end to the vehicle's end, after the cycle",
    )
    yield under_assumption(
        "containment",
        machine.flag("valid").implies(between(exact_to(near, NM), own.truth, exact_to(far, NM))),
        statement="a reported place along the track contains the vehicle's end",
    )
    yield under_assumption(
        "a vehicle that is timed is reported",
        own.delay.present.implies(_reported_now(model)),
        statement="whenever the delay of a vehicle's pattern is measured, time of flight and distance are reported in that cycle",
    )


def _reported(model: TimeOfFlight) -> Iterator[Property]:
    """Claim that time and distance are reported if they are known, and are absent otherwise: both directions."""
    own, machine = model.own, model.machine
    yield for_all_inputs(
        "time and distance are reported exactly when they are known",
        _reported_now(model).iff(own.delay.present & ~_beyond(own)),
        statement="time of flight and distance are reported in a cycle with a delay, unless it is longer than light needs to the fibre's end and "
        "back; in any other cycle they are absent, whatever was reported before",
    )
    yield for_all_inputs(
        "a delay beyond the fibre is reported",
        machine.flag("beyond_fibre").iff(own.delay.present & _beyond(own)),
        statement="a delay that only a place beyond the fibre's end explains is reported as such, and no other",
    )
    yield for_all_inputs(
        "a place is reported exactly with a surveyed point",
        machine.flag("valid").iff(_reported_now(model) & own.map_known),
        statement="the place along the track is reported in a cycle with a distance and a surveyed point of the cable map, and in no other",
    )


def _shown(model: TimeOfFlight) -> Iterator[Property]:
    """Claim the outputs themselves: absent while not known, and each value the middle of its bounds."""
    output, reported, placed = model.machine.output, _reported_now(model), model.machine.flag("valid")
    margins = [output(f"distance_margin_{side}_mm") for side in ("below", "above")]
    absent = [output("flight_time_ps").eq(NO_MARGIN_MM), output("distance_mm").eq(NO_POSITION_MM)]
    absent += [margin.eq(NO_MARGIN_MM) for margin in margins]
    yield for_all_inputs(
        "what is not known is absent",
        (~reported).implies(all_of(absent)) & (~placed).implies(no_interval(model.machine)),
        statement="while no distance is reported, time of flight, distance and its margins are absent; while no place is reported, position and its "
        "margins are",
    )
    along = [output(f"margin_{side}_mm") for side in ("below", "above")]
    yield for_all_inputs(
        "what is reported is the middle of its bounds",
        reported.implies(_even(*margins)) & placed.implies(_even(*along)),
        statement="the distance lies in the middle of its bounds, and so does the place: margins are not negative, and the upper one is "
        "greater by one millimetre at most",
    )


def _even(below: Num, above: Num) -> Bool:
    return (below >= 0) & between(0, above - below, 1)


def _beyond(own: Parts) -> Bool:
    """Return the condition that the shortest possible way of the light ends beyond the fibre, by one millimetre and the pattern's error."""
    config = own.config
    farthest = config.fibre_mm + config.pattern_error_mm + 1
    _, index = _indices(own)
    way = with_unit((own.delay.value - _time_error_ps(own)) * (LIGHT_M_S * PPM_PER_ONE // index), ONE)
    return way >= 2 * farthest * 10**9


def _time_error_ps(own: Parts) -> int:
    return own.config.trigger_error_ps + own.config.resolution_ps


def _indices(own: Parts) -> tuple[int, int]:
    """Return the least and the greatest index of refraction, ppm, rounded outward."""
    index, error = own.config.index_ppm, own.config.index_error_ppm
    off = -(-index * error // PPM_PER_ONE)
    return index - off, index + off


def _time(model: TimeOfFlight) -> Iterator[Property]:
    """Claim the time of flight that is reported, and that the distance grows with it (l. 173)."""
    own, time = model.own, model.own.time_reported
    yield for_all_inputs(
        "the time reported is the one measured",
        _reported_now(model).implies(time.eq(own.delay.value) & model.machine.output("flight_time_ps").eq(time)),
        statement="the time of flight is the delay of this cycle, to the picosecond",
    )
    (low, high) = own.low, own.high
    both = _reported_now(model) & earlier_bool(_reported_now(model))
    yield for_all_inputs(
        "a longer time is a greater distance",
        (both & (time >= before(time))).implies((low >= before(low)) & (high >= before(high))),
        statement="the delay grows as the vehicle moves away from the sensing end, so with no shorter a time no bound of the distance shrinks",
    )


def _half_the_way(model: TimeOfFlight) -> Iterator[Property]:
    """Claim Ls = T V / 2 with V = c0 / n: each bound is that of the light's way, and no wider than rounding makes it."""
    own, error = model.own, model.own.config.pattern_error_mm
    low, high = _distance(model)
    near, far = low + error, high - error
    most, least = _indices(own)
    shortest, longest = (_light(own, off) for off in (-_time_error_ps(own), _time_error_ps(own)))
    at_least = (low > 0).implies(_way(near, least) <= shortest) & (shortest < _way(near + 2, least))
    at_most = (_way(far, most) >= longest) & (longest > _way(far - 2, most))
    yield for_all_inputs(
        "the distance is half the way of light",
        _reported_now(model).implies(at_least & at_most),
        statement="Ls is T V / 2 with V = c0 / n: the lower bound with the shortest time and the greatest index, the upper one with the "
        "longest time and the least index, each widened by the pattern's error, and rounded outward by less than two millimetres",
    )


def _light(own: Parts, off_ps: int) -> Num:
    """Return the way of light in vacuum in the delay and `off_ps`."""
    return with_unit((own.delay.value + off_ps) * LIGHT_M_S, ONE)


def _way(distance: Num, index_ppm: int) -> Num:
    """Return the way there and back through that length of fibre, in vacuum, in the unit of `_light`."""
    return with_unit(distance * (2_000 * index_ppm), ONE)


def _along_the_track(model: TimeOfFlight) -> Iterator[Property]:
    """Claim the place along the track: as far from the surveyed point as the fibre, less the slack at most."""
    own, config = model.own, model.own.config
    (low, high), (near, far) = _distance(model), _place(model)
    slack = PPM_PER_ONE - config.slack_ppm
    ahead = ite(own.map_upwards, near - own.map_position, own.map_position - far) + config.map_error_mm
    beyond = ite(own.map_upwards, far - own.map_position, own.map_position - near) - config.map_error_mm
    from_low, from_high = low - own.map_distance, high - own.map_distance
    least = ite(from_low < 0, ahead.eq(from_low), _shortened(ahead, from_low, slack, up=False))
    most = ite(from_high < 0, _shortened(beyond, from_high, slack, up=True), beyond.eq(from_high))
    yield for_all_inputs(
        "the place is as far from the surveyed point as the fibre",
        model.machine.flag("valid").implies(least & most),
        statement="each bound of the place lies from the surveyed point as far as the distance along the fibre, on the side to which the fibre "
        "runs; shortened by the greatest slack where that is the cautious choice, and widened by the error of the survey",
    )


def _shortened(ran: Num, fibre: Num, slack: int, *, up: bool) -> Bool:
    """Return the condition that a run is that length of fibre without its slack, in whole mm, rounded up or down."""
    exact, reported = with_unit(fibre * slack, ONE), with_unit(ran * PPM_PER_ONE, ONE)
    off = reported - exact if up else exact - reported
    return (off >= 0) & (off < PPM_PER_ONE)


def _reached(model: TimeOfFlight) -> Iterator[Property]:
    machine = model.machine
    reported = _reported_now(model)
    reached = partial(reachable, requirements=REQUIREMENTS)
    yield reached(
        "a distance is reported",
        reported & ~machine.flag("valid"),
        statement="a distance can be reported without a place",
    )
    yield reached("a place is reported", machine.flag("valid"), statement="a place along the track can be reported")
    yield reached(
        "nothing is reported after a distance",
        ~reported & earlier_bool(reported),
        statement="what was reported is given up without a delay",
    )
