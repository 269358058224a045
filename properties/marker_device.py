"""Properties of the marker device as one: what its host gets, whichever of markers and satellites gave it (MRK-1, MRK-5, MRK-D6).

The position of satellites is no input of the whole: that it holds end A is proved of the guard and the antenna's place. What odometry
and the restrictive state keep by themselves for all that they may be given, they keep in the whole.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

from safeloc.language.expr import NumVar, all_of, between, exact_to
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always, earlier_bool, earlier_num
from safeloc.language.units import NM
from safeloc.models.marker_device import MarkerDevice, restrictive_config
from safeloc.models.odometry.marker_reading import ACCEPTED, NONE
from safeloc.models.odometry.satellite_reading import SatelliteReader
from safeloc.properties import delocalized, odometry
from safeloc.properties.behind_a_source import behind_a_source
from safeloc.properties.guard import LAW as RECEIVER
from safeloc.properties.odometry import LAW as MARKERS

LAW = f"{MARKERS}; {RECEIVER}; the antenna is where the vehicle's data say"
REQUIREMENTS = ("MRK-1", "MRK-5", "MRK-D6")
_OF_THE_RESTRICTIVE_STATE = ("tolerance", "no resurrection")
_OF_ODOMETRY = ("margin never shrinks", "satellites alone end no loss", "a position of satellites is inside the window")
"""What these machines keep by themselves, said of the whole; the second of odometry is none where the first reference is believed."""
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def properties(whole: MarkerDevice) -> list[Property]:
    """Return the properties of the whole device."""
    makers = (_host, _satellites, _kept)
    return [prop for maker in makers for prop in maker(whole)]


def _host(whole: MarkerDevice) -> Iterator[Property]:
    restrictive, source = whole.composition.of(whole.restrictive), whole.composition.of(whole.source.machine)
    yield _containment(whole)
    yield for_all_inputs(
        "same-step entry",
        restrictive.bool(whole.restrictive.flag("restrictive")).iff(~source.bool(whole.source.machine.flag("valid"))),
        statement="the vehicle is restrictive in exactly the cycles in which odometry reports nothing",
        requirements=("MRK-D1", "MRK-D2"),
    )
    yield from behind_a_source(whole.composition, whole.restrictive, whole.source.machine, "odometry")
    yield _found_again(whole)


def _found_again(whole: MarkerDevice) -> Property:
    """From the verdicts on the readings of the cycle, not from odometry's own word for them."""
    own, source = whole.source.own, whole.composition.of(whole.source.machine)
    restrictive = whole.composition.of(whole.restrictive).bool(whole.restrictive.flag("restrictive"))
    read = [one.verdict for one in own.readers] + [_given(whole).verdict]
    all_refused = all_of(source.num(one).ne(ACCEPTED) for one in read)
    return for_all_inputs(
        "only an accepted reading ends a loss",
        (all_refused & earlier_bool(restrictive)).implies(restrictive),
        statement="the restrictive state is left only in a cycle in which odometry accepted a marker or a position of satellites",
        requirements=("MRK-D1", "MRK-D6"),
    )


def _containment(whole: MarkerDevice) -> Property:
    """Proved of the restrictive state, given that odometry's interval holds the truth, which odometry has to keep."""
    machine, truth = whole.restrictive, next(iter(whole.restrictive.world.choices))  # the vehicle's, after the step
    assert isinstance(truth, NumVar)
    position, below, above = (machine.output(f"{name}_mm") for name in ("position", "margin_below", "margin_above"))
    own = always(
        "containment",
        machine.flag("restrictive") | between(exact_to(position - below, NM), truth, exact_to(position + above, NM)),
        statement="the position that the host gets contains the true position of end A, whether markers or satellites gave it",
        requirements=(*REQUIREMENTS, "MRK-D1"),
        assumption=LAW,
    )
    return replace(whole.composition.inherited(machine, own), name=own.name)


def _satellites(whole: MarkerDevice) -> Iterator[Property]:
    """Yield the properties of the receiver: it changes the position only by fixes that its guard passes on."""
    source, receiver = whole.composition.of(whole.source.machine), whole.composition.of(whole.receiver.machine)
    passed = receiver.bool(whole.receiver.machine.flag("passed"))
    verdict = source.num(_given(whole).verdict)
    yield for_all_inputs(
        "what the guard withholds is no reading",
        (~passed).implies(verdict.eq(NONE)),
        statement="in a cycle in which the guard withholds the receiver's position, odometry gets none",
    )
    yield for_all_inputs(
        "what the guard passes on is judged",
        passed.implies(verdict.ne(NONE)),
        statement="every position that the guard passes on is judged by odometry in the same cycle",
    )
    yield _antenna(whole)
    yield _time_passes(whole)


def _time_passes(whole: MarkerDevice) -> Property:
    """A guard whose clock stands would be proved of a vehicle that stands: its law says that nothing moves where no time passes."""
    own, into, figures = whole.receiver.own, whole.composition.of(whole.receiver.machine), whole.config.guard
    low, high, line = into.num(own.known_low), into.num(own.known_high), own.known_high.high
    ran_nm = figures.max_speed_mm_s * figures.period_ms * 1_000
    full = into.num(own.fair_fixes).eq(figures.confirmations)
    ahead = (high >= earlier_num(high) + ran_nm) | high.eq(line)
    return for_all_inputs(
        "time passes for the guard in every cycle",
        into.bool(own.start_anew) | full | (ahead & (low <= earlier_num(low))),
        statement="unless a row of fixes is full or the host starts anew, the place that the guard knows widens in each cycle by the run at "
        "the highest speed",
    )


def _antenna(whole: MarkerDevice) -> Property:
    """The interval that odometry gets is the guard's, at end A, and no narrower than the antenna's place allows."""
    source, receiver = whole.composition.of(whole.source.machine), whole.composition.of(whole.receiver.machine)
    given, machine, config = _given(whole), whole.receiver.machine, whole.config
    place, below, above = (source.num(one) for one in (given.place.value, given.below, given.above))
    position, guard_below, guard_above = (
        receiver.num(machine.output(f"{name}_mm")) for name in ("position", "margin_below", "margin_above")
    )
    ahead = place.eq(position + config.antenna_mm)
    wide = (below - guard_below).eq(config.antenna_tolerance_mm) & (above - guard_above).eq(config.antenna_tolerance_mm)
    return for_all_inputs(
        "positions of the antenna count for end A",
        receiver.bool(machine.flag("passed")).implies(ahead & wide),
        statement="odometry gets the guard's position as far ahead as the antenna is behind end A, with both margins wider by the "
        "tolerance of that distance",
    )


def _kept(whole: MarkerDevice) -> Iterator[Property]:
    """Yield the properties of odometry and the restrictive state that are proved of each alone, for all inputs."""
    of_restrictive = delocalized.properties(whole.restrictive, restrictive_config(whole.config))
    yield from _named(whole, whole.restrictive, of_restrictive, _OF_THE_RESTRICTIVE_STATE)
    yield from _named(whole, whole.source.machine, odometry.properties(whole.source), _OF_ODOMETRY)


def _named(
    whole: MarkerDevice, machine: Machine, claims: Sequence[Property], names: Sequence[str]
) -> Iterator[Property]:
    for claim in claims:
        if claim.name in names:
            yield whole.composition.inherited(machine, claim)


def _given(whole: MarkerDevice) -> SatelliteReader:
    given = whole.source.own.satellites
    assert given is not None  # the configuration asks for it
    return given
