"""Claims on vehicles that nobody announced, beside a train that is known (FVA-9).

The counters cannot tell whose axles pass. A vehicle that comes in behind a train, or at the other end, is taken for that train until more axles came in than
can be the train's own. Until its reference comes nobody knows how many these are, and until then the train's interval reaches from its front to beyond the end at which it came in.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import FALSE, Bool, all_of, any_of, exact_to, ite
from safeloc.language.spec import Property, always, earlier_bool, reachable
from safeloc.language.units import UM
from safeloc.models.fibre_area import FibreArea
from safeloc.models.sections import Section
from safeloc.properties.fibre_area.counters import Counted

LAW = (
    "undisturbed counters count every axle; no vehicle passes another; a sound reference has no more axles than its train; a train that is announced is so no "
    "later than in the cycle of its first axle"
)
_CLEAR = ("FVA-9", "FVA-18")
_COUNTER = ("FVA-4", "FVA-13")
for_all_inputs = partial(always, requirements=_CLEAR, unconditional=True)
under_assumption = partial(always, requirements=_CLEAR, assumption=LAW)


def unannounced(model: FibreArea) -> Iterator[Property]:
    """Yield the claims."""
    seen = Counted(model)
    yield from _listed(seen)
    yield from _its_axles(seen)
    yield from _noticed(seen)
    yield from _says_whose(seen)
    yield _there(seen)
    yield _hears_the_heads(seen)
    yield from _reaches_back(seen)
    yield from _others(seen)
    for one in model.sections:
        yield from _not_clear(seen, one)


def _listed(seen: Counted) -> Iterator[Property]:
    """Claim for which trains the balance is exact."""
    yield under_assumption(
        "a train in the known order is counted without a gap",
        _without_a_gap(seen),
        statement="while the order of trains is known and has this train, each of its axles was counted since it came in",
    )


def _without_a_gap(seen: Counted) -> Bool:
    return seen.is_listed.implies(seen.entry.bool(seen.model.entry.own.sure))


def _exact(seen: Counted) -> Bool:
    """Each axle that is taken for the train's is known: it was counted if it is in the order, and there is none if it is not."""
    own = seen.model.entry.own
    nobody = all_of(seen.entry.num(one).eq(0) for one in (own.true_axles_inside, own.behind, own.ahead))
    return _without_a_gap(seen) & (seen.is_ordered & ~seen.is_listed).implies(nobody)


def _its_axles(seen: Counted) -> Iterator[Property]:
    """Claim which record tells how many axles a train has."""
    model, own, verified = seen.model, seen.model.entry.own, seen.model.verification
    of = model.composition.of(verified.machine)
    yield for_all_inputs(
        "a train is verified only when its axles are known",
        _verified_is_known(seen),
        statement="while a reference is stored, the entry knows how many axles a sound reference gave the train",
    )
    yield for_all_inputs(
        "the record that is verified is the one that tells the axles",
        of.num(verified.own.record_axles).eq(seen.entry.num(own.record_axles))
        & of.bool(verified.own.sound).iff(seen.entry.bool(own.record_sound)),
        statement="the axles that the entry takes for the train's are those of the record that the verification compares",
        requirements=_COUNTER,
    )
    listed = seen.is_listed & seen.entry.bool(own.known)
    yield under_assumption(
        "no more axles came in than the train's own",
        _without_a_gap(seen)
        & listed.implies(seen.entry.num(own.come_in) <= seen.entry.num(own.own_axles))
        & seen.is_listed.implies(seen.entry.num(own.inside) <= seen.entry.num(own.come_in)),
        statement="while the order of trains is known and has this train, no more axles came in where it did than its first sound reference has, and at the "
        "other end no more than had gone out there",
    )


def _says_whose(seen: Counted) -> Iterator[Property]:
    """Claim the only reasons for which axles disturb the counters."""
    own = seen.model.entry.own
    others = any_of(seen.entry.bool(one) for one in own.beside_trains) if own.beside_trains else FALSE
    yield for_all_inputs(
        "a disturbance by axles says whose they are not",
        (seen.counting & ~seen.believed).implies(any_of([seen.of_nobody, seen.more, others])),
        statement="axles disturb the counters only where no train is known to which they could belong, where they came in beside this train, or where another train's "
        "composition tells so",
        requirements=_COUNTER,
    )


def _there(seen: Counted) -> Property:
    """Claim that the claims on sections speak of every train that is counted."""
    return under_assumption(
        "a train that is counted is there for the area",
        _there_if_counted(seen),
        statement="while each axle of the train was counted since it was announced, the claims on trains in the area speak of this one, also before its first axle is counted",
    )


def _there_if_counted(seen: Counted) -> Bool:
    own, slot = seen.model.entry.own, seen.model.area.own.slots[0]
    return seen.entry.bool(own.sure).implies(seen.area.bool(slot.there))


def _hears_the_heads(seen: Counted) -> Property:
    """Claim the wires of all axles, counted and true: with both ends exchanged the laws would exclude the true runs."""
    own, heads = seen.model.entry.own, seen.model.axle_section.own
    pairs = [
        *zip(own.axles_in, heads.into, strict=True), *zip(own.axles_out, heads.out, strict=True),
        *zip(own.passed_in, heads.true_into, strict=True), *zip(own.passed_out, heads.true_out, strict=True),
    ]  # fmt: skip
    return for_all_inputs(
        "the entry hears the axles of each head",
        all_of(seen.entry.num(mine).eq(seen.heads.num(theirs)) for mine, theirs in pairs),
        statement="the axles that the entry takes for those of one end, counted and true, are those of the head at that end",
        requirements=_COUNTER,
    )


def _verified_is_known(seen: Counted) -> Bool:
    verified = seen.model.verification.machine
    stored = seen.model.composition.of(verified).num(verified.mode).one_of(*verified.modes[1:3])
    return stored.implies(seen.entry.bool(seen.model.entry.own.known))


def _noticed(seen: Counted) -> Iterator[Property]:
    """Claim when such a vehicle is noticed."""
    own = seen.model.entry.own
    behind, ahead = (seen.entry.num(one) > 0 for one in (own.behind, own.ahead))
    yield under_assumption(
        "an unannounced vehicle behind a train is noticed once the train's axles are known",
        _exact(seen) & (behind & seen.entry.bool(own.known)).implies(~seen.believed),
        statement="a vehicle that nobody announced and that came in behind a train is a disturbance of the counters in the cycle of its first axle, or in the "
        "later one in which the train's first sound reference comes",
    )
    yield under_assumption(
        "an unannounced vehicle at the other end is noticed at once",
        _exact(seen) & ahead.implies(~seen.believed),
        statement="a vehicle that nobody announced and that came in at the end at which the train did not is a disturbance of the counters in the cycle of its "
        "first axle",
    )
    more = seen.more & seen.counting
    yield reachable(
        "an unannounced vehicle is noticed",
        more & ~earlier_bool(seen.more) & earlier_bool(behind),
        statement="axles of a vehicle behind a train can be noticed as not the train's own in a later cycle than that of the first",
        requirements=_CLEAR,
    )


def _reaches_back(seen: Counted) -> Iterator[Property]:
    """Claim what covers a vehicle that is not noticed yet."""
    yield for_all_inputs(
        "a train whose axles are not known reaches back to where it came in",
        _verified_is_known(seen) & _reaches(seen),
        statement="until a sound reference comes, the train's interval goes from beyond the end at which it came in to its front: what follows it is in it",
    )


def _reaches(seen: Counted) -> Bool:
    own, slot = seen.model.entry.own, seen.model.area.own.slots[0]
    edge, from_high = seen.model.config.sections.area.limit_mm, seen.entry.bool(own.from_high)
    low, high = seen.area.num(slot.low), seen.area.num(slot.high)
    unknown = seen.entry.bool(own.sure) & ~seen.entry.bool(own.known)
    return unknown.implies(seen.area.bool(slot.present) & ite(from_high, high.eq(edge), low.eq(-edge)))


def _others(seen: Counted) -> Iterator[Property]:
    """Claim the same of a vehicle beside another train, which that train's composition notices."""
    own, area = seen.model.entry.own, seen.model.area.machine
    for number, more in enumerate(own.beside_trains, 2):
        yield for_all_inputs(
            f"more axles beside train {number} leave the area unswept",
            (seen.entry.bool(more) & ~seen.is_clear).implies(~seen.area.bool(area.flag("swept")) & ~seen.is_ordered),
            statement=f"axles that came in beside train {number} and are not its own are a disturbance of the counters here too",
        )


def _not_clear(seen: Counted, one: Section) -> Iterator[Property]:
    """Claim that the section is not free over such a vehicle: until it is noticed, and from then on."""
    of, name, own = seen.model.composition.of(one.machine), one.machine.name, seen.model.entry.own
    free = of.bool(one.machine.flag("clear"))
    yield _not_clear_yet(seen, one, free)
    yield for_all_inputs(
        f"{name} is not clear while axles disturb the counters",
        (seen.counting & ~seen.believed).implies(~free),
        statement="while axles that no known train has disturb the counters, the section is not FREE",
    )
    behind, ahead = (seen.entry.num(axles) > 0 for axles in (own.behind, own.ahead))
    yield under_assumption(
        f"{name} is not clear with an unannounced vehicle that must be noticed",
        _exact(seen) & ((behind & seen.entry.bool(own.known)) | ahead).implies(~free),
        statement="a vehicle that nobody announced leaves no section FREE if it came in at the other end than the train, or behind a train of which the axles are known",
    )


def _not_clear_yet(seen: Counted, one: Section, free: Bool) -> Property:
    model, own, slot = seen.model, seen.model.entry.own, seen.model.area.own.slots[0]
    of, area = model.composition.of(one.machine), model.area.own
    start, end = (of.num(exact_to(place, UM)) for place in (one.start, one.end))
    low_end, high_end = (seen.area.num(exact_to(place, UM)) for place in (area.low_end, area.high_end))
    rear, front = seen.area.num(slot.true_rear), seen.area.num(slot.true_front)
    below, above = (start <= rear) & (end >= low_end), (end >= front) & (start <= high_end)
    exact = all_of([_exact(seen), _verified_is_known(seen), _reaches(seen), _there_if_counted(seen)])
    follows = all_of([seen.believed, seen.entry.num(own.behind) > 0, free])
    return under_assumption(
        f"{one.machine.name} is never clear with an unannounced vehicle behind the train",
        exact & follows.implies(~ite(seen.entry.bool(own.true_from_high), above, below)),
        statement="until a vehicle that nobody announced is noticed, no section between the end at which the train came in and the train is FREE: there it is, since it does not pass the train",
    )
