"""The world of the odometry machine: where the vehicle really is, and what ties each sensor's raw data to that.

The world knows the inputs and the configuration, and nothing that the machine makes of them.

    a unit     delivers a distance that obeys its error law, or one that no vehicle can have run, or nothing
    a reader   stands over the marker whose identity it gives and says what was run since then, or, rarely, it gives the
               identity of a marker that lies far away
    the map    has a marker within its accuracy of where it really lies
    the train  is as long as its data say, within their tolerance

Where one unit may be faulty, a ghost names it: what it delivers breaks its law at will.
"""

from __future__ import annotations

from dataclasses import replace

from safeloc.language.expr import (
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    Var,
    all_of,
    any_of,
    as_num,
    between,
    exact_to,
    ite,
    maximum,
    minimum,
    with_unit,
)
from safeloc.language.machine import Machine
from safeloc.language.terms import variables
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.language.world import Law, World
from safeloc.models.odometry.distance_device import Unit
from safeloc.models.odometry.marker_reading import Reader
from safeloc.models.odometry.variables import OdometryConfig, Parts
from safeloc.models.vocabulary.measuring_world import THOUSAND, Measuring, Physics
from safeloc.models.vocabulary.vehicle_world import ON_THE_LINE, SPEED, line_law, speed_law

ENDS = ("front", "rear")
SATELLITES = "the position of satellites holds end A"
"""The clause that the machine which gives the positions has to keep."""


def world(own: Parts) -> World:
    """Make the world: the true movement, the units' errors, the markers and, where the parts have one, the fault."""
    seen = own.ghosts
    moves: dict[Var, Expr] = {seen.truth: _after(own), seen.since_stray: _since_stray(own)}
    for index, of_unit in enumerate(seen.units):
        unit = measuring(own, index)
        moves |= {of_unit.wander: unit.wander_after(of_unit.wander, of_unit.next_wander), **unit.moves()}
        if of_unit.unset is not None:
            moves[of_unit.unset] = _unset(own, index, of_unit.unset)
    if seen.faulty_unit is not None:
        moves[seen.faulty_unit] = seen.faulty_unit
    return own.declared.world(moves, _laws(own))


def on_board(machine: Machine) -> Machine:
    """Return the machine without its world, for compositions that give it another one."""
    ghosts = set(machine.world.variables)
    kept = {name: term for name, term in machine.lemmas.items() if ghosts.isdisjoint(variables([term]))}
    return replace(machine, world=World(), lemmas=kept)


def _laws(own: Parts) -> dict[str, Law]:
    units = {f"{unit.name} obeys its error law": _unit_law(own, index) for index, unit in enumerate(own.units)}
    readers: dict[str, Law] = {}
    for end, name in enumerate(ENDS):
        readers[f"{name} reader stood over its marker"] = _reader_law(own, end)
        readers[f"the map has the {name} reader's marker"] = _map_law(own, end)
    return {**units, **_never_alone(own), **readers, **_stray_laws(own), **_satellite_law(own), **_vehicle_laws(own)}


def _after(own: Parts) -> Num:
    """Return the place of end A at the end of the cycle, nm."""
    return own.ghosts.truth + own.ghosts.true_cycle_distance


# ------------------------------------------------------------------ units


def measuring(own: Parts, index: int) -> Measuring:
    """Return the unit as the world sees it: its law and its ghosts."""
    unit, seen, config = own.units[index], own.ghosts.units[index], own.config
    physics = Physics.of(config, config.lone_limit_cycles + 1)
    return Measuring(unit.law, unit.measured, seen.last_delivered, seen.silent, physics)


def _unset(own: Parts, index: int, unset: Num) -> Num:
    """A unit that drifts is set anew where a reader that sets it stands over a marker, or satellites give a position."""
    device = own.partner(own.units[index])[0]
    set_now = any_of(reads(own, end) for end in (0, 1) if own.set_by(end) is device)
    if own.satellites is not None and device is own.devices[0]:
        set_now = set_now | own.satellites.place.present
    period = own.config.period_ms
    return ite(set_now, as_num(period, unset.unit), minimum(unset + period, own.config.age_limit_ms + period))


_FIELDS = ("first_unit", "second_unit")
"""Fields of the configuration with the figures of a device's units, in their order."""
_OF_A_UNIT = ("constant_mm", "rate_ppm", "floor_mm_s", "knee_mm_s", "drift_mm_s2")


def _unit_law(own: Parts, index: int) -> Law:
    unit, seen, delivers = own.units[index], own.ghosts.units[index], measuring(own, index)
    error = delivers.error(own.ghosts.true_cycle_distance, seen.wander, seen.next_wander)
    kept = delivers.allows(error, None if seen.unset is None else seen.unset + own.config.period_ms)
    return Law(
        (delivers.can_be_run & lawful(own, unit)).implies(kept),
        f"What {unit.name} measures in a cycle is wrong by no more than its rate, floor and drift allow, and by the change "
        "of a one-off part within half its constant; or it is a distance that no vehicle can have run (faster than the "
        "highest speed, or changed faster than the greatest acceleration allows). The rate is that of the MEASURED distance: "
        "a wheel that locks and measures nothing breaks this law once its constant is used up.",
        (
            *(f"{_FIELDS[index % len(_FIELDS)]}.{name}" for name in _OF_A_UNIT),
            "max_speed_mm_s",
            "max_acceleration_mm_s2",
        ),
        "[S] SUBSET-041: 5 m + 5 % of every measured distance, speed accuracy; figures of other kinds [M]",
        "supplier",
        "type test; in operation the other unit of the device, and the run between two markers against the map",
    )


def lawful(own: Parts, unit: Unit) -> Bool:
    """Return whether the unit obeys its error law; in a machine without faults every unit does."""
    if own.ghosts.faulty_unit is None:
        return TRUE
    return own.ghosts.faulty_unit.ne(Lit(1 + own.units.index(unit), own.ghosts.faulty_unit.unit))


def _never_alone(own: Parts) -> dict[str, Law]:
    """Assume, if a lone distance is used, that the distance of a faulty unit never comes alone."""
    if own.ghosts.faulty_unit is None or own.config.single_fault_safe:
        return {}
    pairs = [(2 * number, 2 * number + 1) for number in range(len(own.devices))]
    term = all_of(
        (measuring(own, one).can_be_run & ~measuring(own, other).can_be_run).implies(lawful(own, own.units[one]))
        for first, second in pairs
        for one, other in ((first, second), (second, first))
    )
    statement = "The distance of a faulty unit comes only in cycles in which the other unit of the device measures too."
    return {"the distance of a faulty unit never comes alone": Law(term, statement, (), "[M]", "supplier", "type test")}


# ------------------------------------------------------------------ readers and markers


def reads(own: Parts, end: int) -> Bool:
    """Return whether the reader reports a marker of this line over which it stood."""
    reader = own.readers[end]
    return reader.marker.present & reader.place.present & ~own.ghosts.readers[end].stray


def _ran_since(own: Parts, end: int) -> Num:
    """Return the true run of end A since this reader stood over the true place of the marker, nm."""
    ran = _after(own) - own.ghosts.readers[end].spot
    return ran - own.ghosts.length if end else ran


def _reader_law(own: Parts, end: int) -> Law:
    reader, config = own.readers[end], own.config
    measured, twice = _measured(reader), 2 * config.period_ms
    off = (_ran_since(own, end) - exact_to(measured, NM)) * twice
    rate = max(config.first_unit.rate_ppm, config.second_unit.rate_ppm)
    wrong = with_unit(maximum(measured, -measured) * (rate * twice), NM)
    timed, untimed = _ran_in(own, config.reader_latency_ms), _ran_in(own, config.period_ms)
    least, most = (ite(reader.since.present, one, other) for one, other in zip(timed, untimed, strict=True))
    return Law(
        reads(own, end).implies(between(least - wrong, off, most + wrong)),
        f"The {ENDS[end]} reader stood over the true place of its marker. The distance run since then, which it reports "
        "with the reading, is wrong by no more than the worse rate of the units and the run within the reader's latency. A "
        "reading without that distance was taken at some time in this cycle. Within a cycle the speed changes by no more than "
        "the greatest acceleration allows.",
        ("reader_latency_ms", "max_acceleration_mm_s2", "rate_ppm"),
        "[S] balise reader 10 +- 2 ms; the distance reported since then [D]: by counting units, over less than a cycle",
        "supplier",
        "type test of reader and time stamp at the highest speed",
        "how far the vehicle ran since the reading, either way, is one input or 0; both speak of its size",
    )


def _measured(reader: Reader) -> Num:
    return reader.since.value_or(as_num(0, MM))


def _ran_in(own: Parts, window_ms: int) -> tuple[Num, Num]:
    """Return the least and the greatest run of the vehicle in up to so many ms of the cycle, nm x twice the period."""
    config, ran = own.config, own.ghosts.true_cycle_distance * (2 * window_ms)
    unsteady = config.max_acceleration_mm_s2 * config.period_ms**2 * window_ms
    return minimum(ran, 0) - unsteady, maximum(ran, 0) + unsteady


def _map_law(own: Parts, end: int) -> Law:
    reader, spot = own.readers[end], own.ghosts.readers[end].spot
    accuracy = exact_to(reader.accuracy.value_or(as_num(own.config.marker_accuracy_mm, MM)), NM)
    place = exact_to(reader.place.value, NM)
    return Law(
        reads(own, end).implies((place - spot <= accuracy) & (spot - place <= accuracy)),
        "A marker lies within its accuracy of where the map has it; a virtual marker of satellites too.",
        ("marker_accuracy_mm",),
        "[M] Q_NVLOCACC 12 m; overridden per marker",
        "infrastructure",
        "survey; after works on the track; two markers against the distance measured between them",
        "the accuracy that comes with a marker, or the default, is an input read in its unit and nothing more",
    )


def far_away_mm(config: OdometryConfig) -> int:
    """Return the least error of the place by a stray reading: beyond what any interval and any fix can bridge."""
    return 3 * config.tolerance_mm


def _stray_laws(own: Parts) -> dict[str, Law]:
    front, rear = (one.stray for one in own.ghosts.readers)
    both, either = front & rear, front | rear
    period, limit = own.config.period_ms, own.config.age_limit_ms
    rare = either.implies(~both & (own.ghosts.since_stray + period > limit))
    far = {f"a stray {name} reading is far off": _far_law(own, end) for end, name in enumerate(ENDS)}
    if own.config.trust_first_marker:
        never = (
            "No reader reads a marker that is not under it: a first marker is believed at once (trust_first_marker)."
        )
        far = {}
        rare, statement = ~either, never
    else:
        statement = (
            "No two readings within the age limit are stray: of a marker of this line that is not under the reader."
        )
    source = "[M] cross-talk and wrongly mounted markers are rare; the candidate rule withstands one at a time"
    check = "every refused reading is counted and reported"
    return {**far, "stray readings are rare": Law(rare, statement, ("age_limit_ms",), source, "infrastructure", check)}


def _far_law(own: Parts, end: int) -> Law:
    reader, stray = own.readers[end], own.ghosts.readers[end].stray
    behind = own.ghosts.length if end else as_num(0, NM)
    off = exact_to(reader.place.value + _measured(reader), NM) + behind - _after(own)
    far = far_away_mm(own.config) * NM_PER_MM + own.config.vehicle_length_tolerance_mm * NM_PER_MM
    return Law(
        (stray & reader.marker.present & reader.place.present).implies((off > far) | (off < -far)),
        "A marker that is read although it is not under the reader has a place in the map more than three tolerances, and the tolerance of the vehicle's length, away.",
        ("tolerance_mm", "vehicle_length_tolerance_mm"),
        "[D] layout: nearer than that, no window could tell it from the marker that is due",
        "infrastructure",
        "layout check of neighbouring tracks; survey of mounted markers",
        "where a reading puts the reader is the sum of two inputs; a stray reading has no true place to speak of instead",
    )


def _since_stray(own: Parts) -> Num:
    since, period = own.ghosts.since_stray, own.config.period_ms
    stray = any_of(one.stray for one in own.ghosts.readers)
    return ite(stray, as_num(0, since.unit), minimum(since + period, own.config.age_limit_ms + period))


# ------------------------------------------------------------------ satellites


def _satellite_law(own: Parts) -> dict[str, Law]:
    """Assume that positions of satellites that serve as markers are right; the machine that checks the receiver has to
    prove it.
    """
    given = own.satellites
    if given is None:
        return {}
    place, after = exact_to(given.place.value, NM), _after(own)
    inside = between(place - exact_to(given.below, NM), after, place + exact_to(given.above, NM))
    return {
        SATELLITES: Law(
            given.place.present.implies(inside),
            "The interval of a position that satellites give in place of a marker holds end A at the end of the cycle.",
            (),
            "[D] containment of what checks the receiver, whose own proof it is",
            "supplier",
            "fixed markers on the way: each is compared with the position",
            "where an interval that comes as inputs begins and ends is those inputs and nothing more",
        )
    }


# ------------------------------------------------------------------ the vehicle


def _vehicle_laws(own: Parts) -> dict[str, Law]:
    seen, config = own.ghosts, own.config
    farthest = config.max_speed_mm_s * config.period_ms * THOUSAND
    length = exact_to(as_num(config.vehicle_length_mm, MM) if own.length is None else own.length, NM)
    slack = config.vehicle_length_tolerance_mm * NM_PER_MM
    return {
        SPEED: speed_law(seen.true_cycle_distance, farthest),
        "the readers are as far apart as configured": Law(
            between(length - slack, seen.length, length + slack),
            "The readers are as far apart as the vehicle's data say, within their tolerance.",
            ("vehicle_length_mm", "vehicle_length_tolerance_mm"),
            "[S] OCORA: up to + 0.30 m",
            "operator",
            "train data entry; the run between both readings of one marker",
        ),
        ON_THE_LINE: line_law(seen.truth, _after(own)),
    }
