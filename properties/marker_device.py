"""Properties of the marker device as one: what its host gets, whichever of markers and satellites gave it (MRK-1, MRK-5, MRK-D6).

The position of satellites is no input of the whole: that it holds end A is proved of the guard and the antenna's place.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, any_of, between, exact_to, maximum
from safeloc.language.spec import Property, always, earlier_bool, earlier_num
from safeloc.language.units import NM
from safeloc.models.marker_device import MarkerDevice
from safeloc.models.odometry.marker_reading import ACCEPTED, NONE, OUT_OF_WINDOW
from safeloc.models.odometry.satellite_reading import SatelliteReader
from safeloc.models.vocabulary.reasons import LOCATED
from safeloc.properties.guard import LAW as RECEIVER
from safeloc.properties.odometry import LAW as MARKERS

LAW = f"{MARKERS}; {RECEIVER}; the antenna is where the vehicle's data say"
REQUIREMENTS = ("MRK-1", "MRK-5", "MRK-D6")
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(whole: MarkerDevice) -> list[Property]:
    """Return the properties of the whole device."""
    makers = (_host, _restrictive_state, _satellites)
    return [prop for maker in makers for prop in maker(whole)]


def _host(whole: MarkerDevice) -> Iterator[Property]:
    (position, below, above), restrictive = _passed_on(whole), _restrictive(whole)
    truth, tolerance = whole.antenna.moved.truth, whole.config.odometry.tolerance_mm
    yield under_assumption(
        "containment",
        restrictive | between(exact_to(position - below, NM), truth, exact_to(position + above, NM)),
        statement="the position that the host gets contains the true position of end A, whether markers or satellites gave it",
        requirements=(*REQUIREMENTS, "MRK-D1"),
    )
    yield for_all_inputs(
        "tolerance",
        restrictive | ((above <= tolerance) & (below <= tolerance)),
        statement="the position that the host gets is never wider than the tolerable error",
        requirements=("MRK-D1",),
    )


def _restrictive_state(whole: MarkerDevice) -> Iterator[Property]:
    restrictive, source = _restrictive(whole), whole.composition.of(whole.source.machine)
    machine, own = whole.source.machine, whole.source.own
    yield for_all_inputs(
        "same-step entry",
        restrictive.iff(~source.bool(machine.flag("valid"))),
        statement="the vehicle is restrictive in exactly the cycles in which odometry reports nothing",
        requirements=("MRK-D1", "MRK-D2"),
    )
    yield for_all_inputs(
        "no resurrection",
        (earlier_bool(restrictive) & ~restrictive).implies(source.bool(machine.flag("reference_accepted"))),
        statement="the restrictive state is left only in a cycle with a checked absolute reference",
        requirements=("MRK-D1", "MRK-D2"),
    )
    says = whole.composition.of(whole.restrictive)
    yield for_all_inputs(
        "reason stated",
        says.num(whole.restrictive.output("reason")).eq(LOCATED).iff(~restrictive),
        statement="a reason is stated exactly while the vehicle is restrictive",
        requirements=("MRK-D2",),
    )
    if own.config.trust_first_marker:
        return
    by_marker = any_of(source.num(reader.verdict).eq(ACCEPTED) for reader in own.readers)
    candidate = source.num(machine.mode).eq(machine.modes[1]) & ~source.bool(_given(whole).gave_candidate)
    yield for_all_inputs(
        "the receiver alone ends no restrictive state",
        (earlier_bool(restrictive) & ~restrictive).implies(by_marker | earlier_bool(candidate)),
        statement="the restrictive state is left only with a fixed marker: one that is accepted in that cycle, or one that waited as "
        "the candidate and that satellites confirm",
        requirements=("MRK-D6", "MRK-D2"),
    )


def _satellites(whole: MarkerDevice) -> Iterator[Property]:
    """What the receiver may do to the position: nothing but what its guard passes on."""
    source, receiver = whole.composition.of(whole.source.machine), whole.composition.of(whole.receiver.machine)
    own, given = whole.source.own, _given(whole)
    passed, verdict = receiver.bool(whole.receiver.machine.flag("passed")), source.num(given.verdict)
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
    _, below, above = _passed_on(whole)
    restrictive, margin = _restrictive(whole), maximum(below, above)
    no_marker = all_of(source.num(reader.verdict).ne(ACCEPTED) for reader in own.readers)
    located = ~restrictive & ~earlier_bool(restrictive)
    yield for_all_inputs(
        "a false receiver narrows nothing while it is withheld",
        (located & ~passed & no_marker).implies(margin >= earlier_num(margin)),
        statement="while the guard withholds and no marker is accepted, the margin that the host gets never shrinks",
        requirements=("MRK-D6", "MRK-D1"),
    )
    yield under_assumption(
        "markers and satellites never exclude each other",
        verdict.ne(OUT_OF_WINDOW),
        statement="no position that the guard passes on is refused for what markers and odometers say",
    )
    yield _antenna(whole, passed)


def _antenna(whole: MarkerDevice, passed: Bool) -> Property:
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
        passed.implies(ahead & wide),
        statement="odometry gets the guard's position as far ahead as the antenna is behind end A, with both margins wider by the "
        "tolerance of that distance",
    )


def _given(whole: MarkerDevice) -> SatelliteReader:
    given = whole.source.own.satellites
    assert given is not None  # the configuration asks for it
    return given


def _restrictive(whole: MarkerDevice) -> Bool:
    return whole.composition.of(whole.restrictive).bool(whole.restrictive.flag("restrictive"))


def _passed_on(whole: MarkerDevice) -> tuple[Num, Num, Num]:
    """Position, margin below and margin above that the host gets."""
    says = whole.composition.of(whole.restrictive)
    position, below, above = (
        says.num(whole.restrictive.output(f"{name}_mm")) for name in ("position", "margin_below", "margin_above")
    )
    return position, below, above
