"""Properties of a fibre device as one: its sensors are one another's, and what an area claims holds behind them (FWG-1 to FVA-18).

No record, no axle count and no place by time of flight is an input of the whole. The claims on records compare with the counter's world: with
the axles that passed the head, and not with what a machine has stored. Each claim says what entry and verification read.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial

from safeloc.language.expr import Bool, Num, all_of, between, exact_to, ite, maximum
from safeloc.language.spec import Property, always, reachable
from safeloc.language.units import NM, NM_PER_MM, UM, UM_S
from safeloc.models.axle_counter import AxleCounter
from safeloc.models.axle_head import DOWN, UP
from safeloc.models.fibre_device import FibreDevice, TimedEnd
from safeloc.models.fibre_timed import FibreTimed
from safeloc.models.verification.variables import AXLE_COUNTER, NEIGHBOUR, NOBODY
from safeloc.properties import axle_counter, fibre_area, fibre_timed, time_of_flight
from safeloc.properties.fibre_area.counters import Counted

LAW = (
    f"{fibre_area.LAW}; {axle_counter.LAW}; the axles that pass a counter in one passage are those of the train that is the outermost there; "
    f"{time_of_flight.LAW}"
)
REQUIREMENTS = ("FVA-3", "FVA-12", "FVA-4", "FVA-13", "FVA-D1")
_OF_THE_AREA = (
    "containment",
    "the pattern lies between its ends",
    "the area reads a true report",
    "a train that is counted out has left with all its axles",
    "wires are in range",
    "lost parts lie in the train's interval",
)
"""Claimed of an area whose record and time of flight come as they come, and proved again behind the sensors; so is that no section is clear with a train in it.
The other claims of an area hold here as well: all that it assumes is assumed here or proved, and each value on a wire is in the range of its input."""
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(whole: FibreDevice) -> list[Property]:
    """Return the properties of the whole device."""
    sides = [_Side(whole, number) for number in range(2)]
    found = [*_heads(whole, sides), *_reference(whole, sides), *_who_comes_in(whole), *_handed_over(whole, sides)]
    for side in sides:
        found += [*_true(side), *_narrow(side)]
    return [*found, *_of_the_area(whole), *_of_the_ends(whole), *_reached(whole, sides)]


# ------------------------------------------------------------------ terms


@dataclass(frozen=True, eq=False)
class _Side:
    """The counter at the low end (0), or at the high one (1)."""

    whole: FibreDevice
    number: int

    @property
    def name(self) -> str:
        """The end of the area."""
        return ("low", "high")[self.number]

    @property
    def counter(self) -> AxleCounter:
        """Its machine."""
        return self.whole.counters[self.number]

    def flag(self, name: str) -> Bool:
        """Return an output of the counter."""
        return self.whole.composition.of(self.counter.machine).bool(self.counter.machine.flag(name))

    def record(self, name: str) -> Num:
        """Return a figure of the counter's record."""
        return self.whole.composition.of(self.counter.machine).num(self.counter.machine.output(f"record_{name}"))

    def ghost(self, var: Num) -> Num:
        """Return what the counter's world knows of the passage."""
        return self.whole.composition.of(self.counter.machine).num(var)

    @cached_property
    def comes_in(self) -> Bool:
        """A record comes of a passage into the area, or one with a flaw, and this train was the outermost at this end."""
        outermost, enters = self._heard.was_outermost[self.number], self.whole.area.entry.own.enters
        stays = all_of(self.whole.composition.of(self.whole.area.entry.machine).num(one).ne(1) for one in enters)
        inwards = self.record("direction").eq((UP, DOWN)[self.number])
        return self.flag("record_ready") & outermost.eq(1) & stays & (inwards | ~self.flag("record_sound"))

    @cached_property
    def is_the_reference(self) -> Bool:
        """The record is the train's reference: the low end comes first."""
        return self.comes_in if self.number == 0 else self.comes_in & ~_Side(self.whole, 0).comes_in

    @cached_property
    def is_sound(self) -> Bool:
        """The record is the train's reference, and has no flaw."""
        return self.is_the_reference & self.flag("record_sound")

    @cached_property
    def end_mm(self) -> Num:
        """Place of the counter: the end of the area."""
        area = self.whole.area.area
        return self.whole.composition.of(area.machine).num((area.own.low_end, area.own.high_end)[self.number])

    @cached_property
    def front_nm(self) -> Num:
        """Place of the axle that lies farthest up the line, from the counter: of a train that came in at the high end the last one."""
        own = self.counter.own
        return self.ghost(own.run) if self.number == 0 else self.ghost(own.run) - self.ghost(own.length)

    @cached_property
    def _heard(self) -> Counted:
        return Counted(self.whole.area)


def _read(whole: FibreDevice, var: Num) -> Num:
    """Return what the verification reads."""
    return whole.composition.of(whole.area.verification.machine).num(var)


def _sound(whole: FibreDevice) -> Bool:
    """The verification reads a record as sound."""
    return whole.composition.of(whole.area.verification.machine).bool(whole.area.verification.own.sound)


def _sender(whole: FibreDevice) -> Num:
    """Return the sender of the reference that the entry hears in this cycle."""
    return whole.composition.of(whole.area.entry.machine).num(whole.area.entry.own.comes)


# ------------------------------------------------------------------ heads


def _heads(whole: FibreDevice, sides: list[_Side]) -> Iterator[Property]:
    """Claim that the section between the counters counts the axles of the counters' own heads."""
    section = whole.area.axle_section
    of = whole.composition.of(section.machine)
    counts, passes = list[Bool](), list[Bool]()
    for side in sides:
        own, (inwards, outwards) = side.counter.own, ((UP, DOWN), (DOWN, UP))[side.number]
        for var, way in ((section.own.into, inwards), (section.own.out, outwards)):
            heard, counted = side.ghost(own.axle).eq(way), of.num(var[side.number])
            counts += [heard.implies(counted.eq(side.ghost(own.axles_in_cycle))), heard | counted.eq(0)]
        into, out = of.num(section.own.true_into[side.number]), of.num(section.own.true_out[side.number])
        passed, up = side.ghost(own.true_axles_in_cycle), side.ghost(own.axle_true_speed) > 0
        inward = up if side.number == 0 else ~up
        passes += [(into + out).eq(passed), (into - out).eq(ite(inward, passed, -passed))]
    yield for_all_inputs(
        "the section counts the axles of the counters' heads",
        all_of(counts),
        statement="at either end the axles that the section counts in and out are those that the counter's head reports, each in its direction",
    )
    yield for_all_inputs(
        "the axles that pass a head pass it for both",
        all_of(passes),
        statement="the axles that really pass an end are the same for its counter and for the section",
    )
    either = {
        name: [whole.composition.of(one.counter.machine).bool(getattr(one.counter.own, name)) for one in sides]
        for name in ("fault", "damped")
    }
    (low, high), (low_damped, high_damped) = either["fault"], either["damped"]
    yield for_all_inputs(
        "a head at fault or damped is one of the section",
        of.bool(section.own.fault).iff(low | high) & of.bool(section.own.damped).iff(low_damped | high_damped),
        statement="the section hears a fault and a wheel on a head exactly when one of both heads reports it",
    )


# ------------------------------------------------------------------ whose record


def _reference(whole: FibreDevice, sides: list[_Side]) -> Iterator[Property]:
    """Claim when a counter's record is the train's reference, in both directions, and when it is sound."""
    yield for_all_inputs(
        "the counter's record of the train is its reference",
        _sender(whole).eq(AXLE_COUNTER).iff(sides[0].is_the_reference | sides[1].is_the_reference),
        statement="the entry hears a counter's record in exactly the cycles in which the counter at an end at which this train was the outermost has one "
        "of a passage into the area, or one with a flaw",
    )
    came = _sender(whole).eq(AXLE_COUNTER)
    yield for_all_inputs(
        "a counter's record is sound without a flaw only",
        came.implies(_sound(whole).iff(sides[0].is_sound | sides[1].is_sound)),
        statement="the verification reads the counter's record as sound exactly when the counter tells no flaw",
    )
    yield for_all_inputs(
        "a counter's record is not old",
        (came & _sound(whole)).implies(_read(whole, whole.area.verification.own.record_age).eq(0)),
        statement="a counter's record is read in the cycle in which it is made",
    )


def _who_comes_in(whole: FibreDevice) -> Iterator[Property]:
    """Claim that reference and entry speak of the same train."""
    of, reference = whole.composition.of(whole.area.entry.machine), whole.composition.of(whole.reference.machine)
    pairs = zip(whole.area.entry.own.enters, whole.reference.own.enters, strict=True)
    yield for_all_inputs(
        "the entry hears who comes in at each end",
        all_of(of.num(heard).eq(reference.num(told)) for heard, told in pairs),
        statement="the train that comes in at an end is the same for the entry as for the reference",
    )


def _handed_over(whole: FibreDevice, sides: list[_Side]) -> Iterator[Property]:
    """Claim what is heard of the neighbour."""
    reference, verified = whole.reference, whole.area.verification.own
    of, given = whole.composition.of(reference.machine), reference.own.neighbours
    sends = of.bool(reference.own.neighbour_sends) & ~(sides[0].is_the_reference | sides[1].is_the_reference)
    yield for_all_inputs(
        "the neighbour's record is the reference where no counter has one",
        _sender(whole).eq(NEIGHBOUR).iff(sends)
        & _sender(whole).eq(NOBODY).iff(~sends & _sender(whole).ne(AXLE_COUNTER)),
        statement="the entry hears the neighbour's record in exactly the cycles in which it is sent and no counter has one of this train, and nobody's in all others "
        "without a counter's",
    )
    pairs: list[tuple[Num, Num]] = [
        (verified.record_axles, given.axles),
        (verified.record_length_low, given.length[0]), (verified.record_length_high, given.length[1]),
        (verified.record_speed_low, given.speed[0]), (verified.record_speed_high, given.speed[1]),
        (verified.record_place_low, given.place[0]), (verified.record_place_high, given.place[1]),
        (verified.record_age, given.age),
    ]  # fmt: skip
    same = all_of(_read(whole, read).eq(of.num(sent)) for read, sent in pairs)
    yield for_all_inputs(
        "the neighbour's record is read as it was sent",
        sends.implies(_sound(whole).iff(of.bool(given.sound)) & of.bool(given.sound).implies(same)),
        statement="axles, length, speed, place and age of a neighbour's sound record are those that it sent; one that is not sound is not read as sound",
    )


# ------------------------------------------------------------------ what a record tells


def _true(side: _Side) -> Iterator[Property]:
    """Claim that the record that is read is true of the axles that passed the head."""
    whole, own, verified = side.whole, side.counter.own, side.whole.area.verification.own
    claim = partial(under_assumption, requirements=REQUIREMENTS)
    yield claim(
        f"the axles that passed at the {side.name} end are compared",
        side.is_sound.implies(_sound(whole) & _read(whole, verified.record_axles).eq(side.ghost(own.axles))),
        statement=f"a sound record of the {side.name} end has as many axles as passed the head there",
    )
    low, high = (exact_to(_read(whole, one), NM) for one in (verified.record_length_low, verified.record_length_high))
    along = side.ghost(own.length) if side.number == 0 else -side.ghost(own.length)
    yield claim(
        f"the length that passed at the {side.name} end is compared",
        (side.is_sound & (along >= 0)).implies(between(low, along, high)),
        statement="the bounds of length that the verification reads contain the length from first to last axle",
    )
    low, high = (exact_to(_read(whole, one), NM) for one in (verified.record_place_low, verified.record_place_high))
    overhang = whole.config.overhang_mm * NM_PER_MM
    front = exact_to(side.end_mm, NM) + side.front_nm
    yield claim(
        f"the place of who passed at the {side.name} end is compared",
        side.is_sound.implies((low <= front) & (front + overhang <= high)),
        statement="the bounds of place that the verification reads contain the axle that lies farthest up the line, and a train's end as far before it as a vehicle overhangs",
    )
    low, high = (exact_to(_read(whole, one), UM_S) for one in (verified.record_speed_low, verified.record_speed_high))
    yield claim(
        f"the speed of who passed at the {side.name} end is compared",
        side.is_sound.implies(between(low, side.ghost(own.speed), high)),
        statement="the bounds of speed that the verification reads contain that of the train, counted upwards",
    )


def _narrow(side: _Side) -> Iterator[Property]:
    """Claim that the record is read as narrow as it is: a wider one would be true as well, and verify less."""
    yield for_all_inputs(
        f"the record of the {side.name} end is no wider than the counter's",
        side.is_sound.implies(all_of(_narrow_bounds(side))),
        statement="the bounds of length, place and speed that the verification reads are those of the counter, rounded to whole millimetres, and at the place of the "
        "front with the overhang",
    )


def _narrow_bounds(side: _Side) -> Iterator[Bool]:
    """No wider, and the length no narrower: the counter's bounds leave room for axles that are counted late, in which a bound rounded inward would hide."""
    whole, own = side.whole, side.whole.area.verification.own
    low, high = (exact_to(_read(whole, bound), UM) for bound in (own.record_length_low, own.record_length_high))
    shortest, longest = side.record("length_low_um"), maximum(side.record("length_high_um"), 0)
    yield (low > shortest - 1_000) & ((low <= shortest) | low.eq(0))
    yield (high >= longest) & (high < longest + 1_000)
    width = {name: side.record(f"{name}_high_um") - side.record(f"{name}_low_um") for name in ("run", "length")}
    along = exact_to(_read(whole, own.record_place_high) - _read(whole, own.record_place_low), UM)
    most = width["run"] if side.number == 0 else width["run"] + width["length"]
    yield along <= most + (whole.config.overhang_mm + 2) * 1_000
    speed = _read(whole, own.record_speed_high) - _read(whole, own.record_speed_low)
    yield speed.eq(side.record("speed_high_mm_s") - side.record("speed_low_mm_s"))


# ------------------------------------------------------------------ kept of the area and of the ends


def _of_the_area(whole: FibreDevice) -> Iterator[Property]:
    """Return what an area claims, where its reference and its time of flight are those of this step."""
    found = {claim.name: claim for claim in fibre_area.properties(whole.area)}
    clear = (f"{one.machine.name} is never clear with a train in it" for one in whole.area.sections)
    for name in (*_OF_THE_AREA, *clear):
        claim = found[name]
        kept = claim if claim.unconditional else replace(claim, assumption=LAW)
        yield replace(kept, requirements=tuple(dict.fromkeys((*REQUIREMENTS, *claim.requirements))))


def _of_the_ends(whole: FibreDevice) -> Iterator[Property]:
    """Return what is claimed of one end that is timed, for each end."""
    for name, end in zip(("front", "rear"), whole.ends, strict=True):
        yield from _one_end(whole, name, end)
        timed = FibreTimed(whole.config.timed, whole.composition, end.flight, end.additional, end.sections)
        for claim in fibre_timed.of_one_end(timed):
            yield replace(claim, name=f"{name}: {claim.name}")


def _one_end(whole: FibreDevice, name: str, end: TimedEnd) -> Iterator[Property]:
    """Claim that light and sections are about one and the same end, and hear one and the same amplitude."""
    of, limit = whole.composition.of, 2 * whole.config.area.fibre.position_limit_mm * NM_PER_MM
    truth = of(end.sections.machine).num(end.sections.own.ghosts.truth)
    timed, compared = (of(one.machine).num(one.own.next_truth) for one in (end.flight, end.additional))
    yield under_assumption(
        f"{name}: the light runs to the end that the sections follow",
        between(-limit, truth, limit).implies(timed.eq(truth) & compared.eq(truth)),
        statement="within twice the coordinates of the line the place of the end is one for light and sections",
        requirements=("FWG-4", "FWG-6"),
    )
    one, other = end.additional.own.amplitude, end.sections.own.amplitude
    heard, told = of(end.sections.machine), of(end.additional.machine)
    came = told.bool(one.present)
    yield for_all_inputs(
        f"{name}: sections and comparison hear one amplitude",
        heard.bool(other.present).iff(came) & came.implies(heard.num(other.value).eq(told.num(one.value))),
        statement="the machine of sections hears the amplitude of this cycle, or none if none came",
        requirements=("FWG-4", "FWG-6"),
    )


def _reached(whole: FibreDevice, sides: list[_Side]) -> Iterator[Property]:
    machine = whole.area.verification.machine
    trusted = whole.composition.of(machine).bool(machine.flag("trusted"))
    for side in sides:
        yield reachable(
            f"a train that came in at the {side.name} end is verified by its record",
            side.is_sound & trusted,
            statement="a train is trusted in the cycle of its counter's record",
            requirements=REQUIREMENTS,
        )
