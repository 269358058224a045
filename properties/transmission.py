"""Properties of a position on its way between computers (FVA-9, FVA-18, RFL-14): its age is added, and limited."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, before, between, exact_to, ite, was, with_unit
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import MM, MS, NM
from safeloc.models.transmission import Slot, Transmission, TransmissionConfig

LAW = "a position that is sent holds the truth when it is sent; the vehicle moves no faster than its highest speed"
REQUIREMENTS = ("FVA-9", "FVA-18", "RFL-14")
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def properties(model: Transmission) -> list[Property]:
    """Return the properties: containment, age, revocation and widening."""
    makers = (_interval, _age, _withdrawal, _on_its_way, _arrived, _kept)
    return [prop for maker in makers for prop in maker(model)]


def _interval(model: Transmission) -> Iterator[Property]:
    machine, own, valid = model.machine, model.own, model.machine.flag("valid")
    position, below, above = (machine.output(f"{name}_mm") for name in ("position", "margin_below", "margin_above"))
    yield always(
        "containment",
        valid.implies(between(exact_to(position - below, NM), own.truth, exact_to(position + above, NM))),
        statement="the interval that has arrived contains the present true position, however long it was on its way",
        requirements=REQUIREMENTS,
        assumption=LAW,
    )
    yield for_all_inputs(
        "tolerance",
        valid.implies((below <= own.config.margin_limit_mm) & (above <= own.config.margin_limit_mm)),
        statement="the given interval is never wider than the limit",
    )


def _age(model: Transmission) -> Iterator[Property]:
    machine, own, valid = model.machine, model.own, model.machine.flag("valid")
    kept = valid & earlier_bool(valid) & ~machine.fired("report arrives")
    wider = machine.output("margin_below_mm") - before(own.held.below)
    yield for_all_inputs(
        "age",
        machine.output("age_ms") <= own.config.age_limit_ms,
        statement="no position older than the limit is reported: a link without reports withdraws the position in time",
    )
    yield for_all_inputs(
        "age widens a stored report",
        kept.implies(
            (wider >= with_unit(before(own.held.age) * own.config.run_mm, MM))
            & own.held.age.eq(before(own.held.age) + 1)
        ),
        statement="while no report arrives the stored one grows older and wider in every cycle",
    )


def _withdrawal(model: Transmission) -> Iterator[Property]:
    machine, valid = model.machine, model.machine.flag("valid")
    yield for_all_inputs(
        "no resurrection",
        (valid & ~earlier_bool(valid)).implies(machine.fired("report arrives")),
        statement="a position is reported again only when a report arrives",
    )
    yield for_all_inputs(
        "revocation",
        machine.fired("report revokes").implies(~valid),
        statement="a report that revokes removes the position in the step in which it arrives",
    )


@dataclass(frozen=True, eq=False)
class _Before:
    """A report that was kept before the step: whether it was there and is young enough still, and its age now."""

    slot: Slot
    config: TransmissionConfig

    @property
    def age(self) -> Num:
        """One cycle more than before."""
        return before(self.slot.age) + 1

    @property
    def young(self) -> Bool:
        """There, and not too old by now."""
        return was(self.slot.there) & (self.age * self.config.period_ms <= self.config.age_limit_ms)

    @property
    def narrow(self) -> Bool:
        """Within the limit on either side, when widened by its age."""
        added_error = with_unit(self.age * self.config.run_mm, MM)
        widths = (before(self.slot.below), before(self.slot.above))
        return all_of(width <= self.config.margin_limit_mm - added_error for width in widths)

    def is_in(self, slot: Slot) -> Bool:
        """Return whether the slot still holds this report, one cycle older."""
        numbers = ((slot.position, self.slot.position), (slot.below, self.slot.below), (slot.above, self.slot.above))
        same = all_of(now.eq(before(then)) for now, then in numbers)
        return slot.there & slot.valid.iff(was(self.slot.valid)) & same & slot.age.eq(self.age)


def _on_its_way(model: Transmission) -> Iterator[Property]:
    own, flying = model.own, model.own.flying
    known = _Before(flying, own.config)
    numbers = ((flying.position, own.position), (flying.below, own.below), (flying.above, own.above))
    as_sent = all_of(now.eq(then) for now, then in numbers) & flying.valid.iff(own.valid) & flying.age.eq(0)
    yield for_all_inputs(
        "a report that is sent is on its way",
        own.sent.implies(flying.there & as_sent),
        statement="a report that is sent is on its way as it was sent, in place of the one sent before",
    )
    yield for_all_inputs(
        "a report on its way is not changed",
        (~own.sent & ~own.arrived & known.young).implies(known.is_in(flying)),
        statement="until it arrives a report stays as it was sent, and grows older in every cycle",
    )
    yield for_all_inputs(
        "a report arrives once",
        (~own.sent & (own.arrived | ~known.young)).implies(~flying.there),
        statement="a report that arrived, or is too old, is not on its way any longer",
    )


def _arrived(model: Transmission) -> Iterator[Property]:
    own, valid = model.own, model.machine.flag("valid")
    known = _Before(own.flying, own.config)
    arrives, usable = own.arrived & known.young, was(own.flying.valid) & known.narrow
    yield for_all_inputs(
        "a report that arrives is passed on",
        (arrives & usable).implies(valid & known.is_in(own.held)),
        statement="a position that arrives, no wider than the limit when widened by its age, is reported as it was sent",
    )
    yield for_all_inputs(
        "a report without a usable position removes the last one",
        (arrives & ~usable).implies(~valid),
        statement="a report without a position, or with one that is too wide by now, removes the report that "
        "arrived before it",
    )


def _kept(model: Transmission) -> Iterator[Property]:
    own, valid, age = model.own, model.machine.flag("valid"), model.machine.output("age_ms")
    known, coming = _Before(own.held, own.config), _Before(own.flying, own.config)
    waits = earlier_bool(valid) & ~(own.arrived & coming.young)
    yield for_all_inputs(
        "a position is passed on until the next arrives",
        (waits & known.young & known.narrow).implies(valid & known.is_in(own.held)),
        statement="while no report arrives, the machine reports the stored one as long as it is young and narrow "
        "enough",
    )
    yield for_all_inputs(
        "the age is reported",
        ite(valid, age.eq(with_unit(own.held.age * own.config.period_ms, MS)), age.eq(0)),
        statement="the machine reports the age of the given position, and 0 without one",
    )
