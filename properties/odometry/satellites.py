"""Properties of positions of satellites in place of markers (MRK-D6), for a machine that is given such positions."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, NumVar, all_of, any_of, as_num, before, exact_to, maximum, with_unit
from safeloc.language.spec import Property, always, earlier_bool, earlier_num
from safeloc.language.units import NM, NM_PER_MM
from safeloc.models.odometry import M1, Odometry
from safeloc.models.odometry.distance_device import Unit
from safeloc.models.odometry.marker_reading import ACCEPTED, CANDIDATE, NONE, NOT_BETTER, OUT_OF_WINDOW, TOO_COARSE
from safeloc.models.odometry.satellite_reading import SatelliteReader
from safeloc.models.odometry.variables import OdometryConfig, Parts

LAW = (
    "distances and marker readings keep the laws of odometry; the interval of a position of satellites holds end A, which what "
    "checks the receiver has to prove"
)
CONFIRMS, TRUSTED, SETS = "satellites confirm the candidate", "trusted position of satellites", "position of satellites"
for_all_inputs = partial(always, requirements=("MRK-D6",), unconditional=True)


def returns(own: Parts) -> list[str]:
    """Return the transitions by which positions of satellites end a loss, where such positions are given."""
    if own.satellites is None:
        return []
    return [TRUSTED if own.config.trust_first_marker else CONFIRMS]


def properties(model: Odometry) -> Iterator[Property]:
    """Return the properties of positions of satellites; none for a machine that is given no such positions."""
    given = model.own.satellites
    if given is not None:
        yield from _loss(model, given)
        yield from _candidate(model, given)
        yield from _use(model, given)
        yield from _coarse(model, given)
        yield from _apart(model)
        yield from _after_markers(model, given)


def _loss(model: Odometry, given: SatelliteReader) -> Iterator[Property]:
    """After a loss two references are needed, and the receiver is one only."""
    machine, own, of_satellites = model.machine, model.own, given.candidate_of_satellites
    if of_satellites is None:
        return
    valid = machine.flag("valid")
    by_marker = any_of(reader.verdict.eq(ACCEPTED) for reader in own.readers)
    waits = before(machine.mode).eq(machine.modes[1]) & ~earlier_bool(of_satellites)
    yield for_all_inputs(
        "satellites alone end no loss",
        (valid & ~earlier_bool(valid)).implies(by_marker | waits),
        statement="after a loss a position is reported only with a marker: one that is accepted, or one that waits as the "
        "candidate which satellites confirm",
        requirements=("MRK-D6", "MRK-D1"),
    )


def _candidate(model: Odometry, given: SatelliteReader) -> Iterator[Property]:
    """Claim that a candidate of satellites is known as one."""
    machine, own, of_satellites = model.machine, model.own, given.candidate_of_satellites
    if of_satellites is None:
        return
    candidate = machine.mode.eq(machine.modes[1])
    taken, marker = given.verdict.eq(CANDIDATE), any_of(reader.verdict.eq(CANDIDATE) for reader in own.readers)
    kept = candidate & before(machine.mode).eq(machine.modes[1]) & ~taken & ~marker
    yield for_all_inputs(
        "a candidate of satellites is known as one",
        taken.implies(candidate & of_satellites)
        & (marker & candidate).implies(~of_satellites)
        & kept.implies(of_satellites.iff(earlier_bool(of_satellites))),
        statement="the machine stores whether the candidate is a position of satellites or a marker, as long as it waits",
        requirements=("MRK-D6", "MRK-D1"),
    )


def _use(model: Odometry, given: SatelliteReader) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid = machine.flag("valid")
    yield always(
        "a position of satellites is inside the window",
        given.verdict.ne(OUT_OF_WINDOW),
        statement="no position of satellites that holds end A is refused as out of its window",
        requirements=("MRK-D6",),
        assumption=LAW,
    )
    located = valid & earlier_bool(valid) & given.place.present
    no_marker = all_of(~reader.marker.present for reader in own.readers)
    refused = given.verdict.one_of(OUT_OF_WINDOW, TOO_COARSE)
    widest = maximum(given.below, given.above) + _constant_mm(own.config)
    margin = maximum(machine.output("margin_below_mm"), machine.output("margin_above_mm"))
    yield for_all_inputs(
        "a position of satellites bounds the margin",
        (located & no_marker & ~refused).implies(margin <= widest),
        statement="while a position is reported and no marker is read, a position of satellites that is not refused leaves no margin "
        "greater than its own with the one-off constant of the better unit",
    )


def _coarse(model: Odometry, given: SatelliteReader) -> Iterator[Property]:
    """Claim which position of satellites is too coarse, and the mode after one."""
    machine, own = model.machine, model.own
    widest = maximum(given.below, given.above) + _constant_mm(own.config)
    most, limit = own.config.tolerance_mm, own.config.position_limit_mm
    yield for_all_inputs(
        "only a coarse position of satellites is too coarse",
        (given.verdict.eq(TOO_COARSE)).implies(
            (widest > most) | (given.place.value > limit) | (given.place.value < -limit)
        ),
        statement="a position of satellites is refused as too coarse only if its margin with the one-off constant of the better "
        "unit exceeds the tolerance, or if it lies beyond the line",
    )
    yield for_all_inputs(
        "M1 after a position of satellites",
        machine.fired(SETS).implies(machine.output("values").eq(M1)),
        statement="after a position of satellites that sets the device at end A the values M1 are used",
    )


def _constant_mm(config: OdometryConfig) -> int:
    """The one-off constant that a reading adds to the better unit, mm; with `single_fault_safe` the greater of both units' ones."""
    constants = (config.first_unit.constant_mm, config.second_unit.constant_mm)
    return max(constants) if config.single_fault_safe else min(constants)


def _apart(model: Odometry) -> Iterator[Property]:
    """Positions of satellites and readings of markers touch each other in one point only: what sets the device."""
    machine, own = model.machine, model.own
    valid = machine.flag("valid")
    silent = [~one.present for reader in own.readers for one in reader.inputs]
    no_turn = own.backwards.iff(earlier_bool(own.backwards))
    stays = [_same(var) for var in (*own.pending.places, own.last_marker, own.last_marker_position)]
    yield for_all_inputs(
        "satellites touch no identity",
        (all_of([valid, earlier_bool(valid), no_turn, *silent])).implies(all_of(stays)),
        statement="a position of satellites neither adds nor removes an identity that waits for the trailing reader, and the order of "
        "the markers is kept, so that dual reading goes on as without satellites",
        requirements=("MRK-D6", "MRK-1"),
    )


def _after_markers(model: Odometry, given: SatelliteReader) -> Iterator[Property]:
    """Claim that a marker counts before satellites, and what a position outside sets."""
    machine, own = model.machine, model.own
    valid = machine.flag("valid")
    taken = any_of(reader.verdict.one_of(ACCEPTED, CANDIDATE) for reader in own.readers)
    yield for_all_inputs(
        "a marker counts before satellites",
        taken.implies(given.verdict.one_of(NONE, NOT_BETTER)),
        statement="in a cycle in which a marker is accepted or becomes the candidate, a position of satellites sets nothing",
    )
    yield for_all_inputs(
        "a position of satellites that is outside sets nothing",
        (valid & earlier_bool(valid) & given.verdict.eq(ACCEPTED)).implies(_meets(model, given)),
        statement="while a position is reported, a position of satellites sets the device only if its interval overlaps that of an "
        "odometer unit in the same cycle, so that a false position that markers and distances exclude changes nothing",
    )


def _same(var: NumVar) -> Bool:
    return var.eq(earlier_num(var))


def _meets(model: Odometry, given: SatelliteReader) -> Bool:
    """The position's interval meets what some unit said before the cycle, widened by more than a cycle can run and add.

    A cycle runs at most at top speed, and adds no more than the difference of two such runs, a run's worth of error and both
    one-off constants. Where a unit drifts, its law explains ever more with the age of its device: that adds the drift of a cycle,
    to the other unit too while that measures nothing, or lets the difference of the units count for one run more. Margins of a
    device that is safe against a single fault hold that drift already.
    """
    config = model.own.config
    run_mm = config.measuring_step_mm + math.ceil(config.max_speed_mm_s * config.period_ms / 1_000)
    wider_mm = 4 * run_mm + config.first_unit.constant_mm + config.second_unit.constant_mm
    drift = max(config.first_unit.drift_mm_s2, config.second_unit.drift_mm_s2)
    low, high = (exact_to(place, NM) for place in (given.place.value - given.below, given.place.value + given.above))
    met = list[Bool]()
    for device in model.own.devices:
        wider: Num = as_num(wider_mm * NM_PER_MM, NM)
        if drift and not config.single_fault_safe:
            drifted = with_unit(earlier_num(device.age) * (drift * config.period_ms), NM)
            wider = wider + run_mm * NM_PER_MM + drifted + drift * config.period_ms**2
        met += [_overlaps(unit, low - wider, high + wider) for unit in device.units]
    return any_of(met)


def _overlaps(unit: Unit, low: Num, high: Num) -> Bool:
    place, above, below = exact_to(earlier_num(unit.position), NM), earlier_num(unit.above), earlier_num(unit.below)
    return earlier_bool(unit.alive) & (low <= place + above) & (place - below <= high)
