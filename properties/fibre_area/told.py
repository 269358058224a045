"""Claims about the messages between the machines of a fibre area (FVA-4, FVA-8, FVA-9): a wire from another output would keep every other claim.

That a disagreement withholds is claimed in `properties.fibre_area`. Here is the other direction: a train is distrusted, withheld or not
reported only for what a machine before says in that cycle.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property, partial

from safeloc.language.expr import Bool, Num, all_of, any_of, between
from safeloc.language.spec import Property, always, earlier_bool, earlier_num
from safeloc.models.area.slot import (
    ACCEPTED,
    CONTRADICTED,
    NOBODY,
    STALE,
)
from safeloc.models.fibre import Fibre
from safeloc.models.fibre_area import FibreArea
from safeloc.models.verification.variables import (
    AXLE_COUNTER,
    CHAIN_FAILED,
    CHAIN_UNTESTED,
    ENDS_APART,
    FIBRE_ERROR,
    NEIGHBOUR,
    NOT_ASSOCIATED,
    NOT_LOCATED,
    REFERENCE_LOST,
    REFERENCE_REFUSED,
)
from safeloc.models.verification.variables import NOBODY as NO_SENDER
from safeloc.properties.hearing import INTERVAL, hears_interval

_TRUST = ("FVA-1", "FVA-10")
_EMITTER = ("FVA-8", "FVA-17")
_ENTRY = ("FVA-4", "FVA-13", "FVA-14")
_CLEAR = ("FVA-9", "FVA-18")
for_all_inputs = partial(always, unconditional=True)


def told(model: FibreArea) -> Iterator[Property]:
    """Yield the claims."""
    seen = _Seen(model)
    yield from _distrusted(seen)
    yield from _withheld(seen)
    yield _located(seen)
    yield from _compared(seen)
    yield from _reported(seen)


class _Seen:
    """The machines of the area after a step."""

    def __init__(self, model: FibreArea) -> None:
        self.model = model
        of = model.composition.of
        self.verification, self.entry = of(model.verification.machine), of(model.entry.machine)
        self.report, self.area = of(model.report.machine), of(model.area.machine)

    def mode(self, number: int) -> Bool:
        """Return whether the verification is in this mode: 1 withheld, 2 trusted, 3 untrusted."""
        machine = self.model.verification.machine
        return self.verification.num(machine.mode).eq(machine.modes[number])

    def says(self, fibre: Fibre, output: str) -> Bool:
        """Return an output of the machine of one end."""
        return self.model.composition.of(fibre.machine).bool(fibre.machine.flag(output))

    def chain(self, output: str) -> Bool:
        """Return an output of the emitter's machine."""
        machine = self.model.emitter.machine
        return self.model.composition.of(machine).bool(machine.flag(output))

    def end(self, fibre: Fibre, side: str) -> Num:
        """Position, or one of the margins, of one end."""
        return self.model.composition.of(fibre.machine).num(fibre.machine.output(f"{side}_mm"))

    @cached_property
    def both(self) -> Bool:
        """Both ends are located."""
        return self.says(self.model.front, "valid") & self.says(self.model.rear, "valid")

    @cached_property
    def nearest(self) -> Num:
        """The least distance between both ends, mm."""
        front, rear = self.model.front, self.model.rear
        least = self.end(front, "position") - self.end(front, "margin_below")
        return least - self.end(rear, "position") - self.end(rear, "margin_above")

    @cached_property
    def farthest(self) -> Num:
        """The greatest distance between both ends, mm."""
        front, rear = self.model.front, self.model.rear
        most = self.end(front, "position") + self.end(front, "margin_above")
        return most - self.end(rear, "position") + self.end(rear, "margin_below")


def _distrusted(seen: _Seen) -> Iterator[Property]:
    model, own, figures = seen.model, seen.model.verification.own, seen.model.config.verification
    reason = seen.verification.num(own.why)
    begins = seen.mode(3) & ~earlier_bool(seen.mode(3))
    error = seen.says(model.front, "error") | seen.says(model.rear, "error")
    causes = {
        FIBRE_ERROR: error,
        ENDS_APART: seen.both & _apart(seen),
        REFERENCE_LOST: seen.entry.bool(model.entry.machine.fired("reference overdue")),
        REFERENCE_REFUSED: seen.entry.num(model.entry.own.comes).ne(NO_SENDER),
    }
    if figures.needs_emitter:
        causes[CHAIN_FAILED] = seen.chain("failed")
        yield for_all_inputs(
            "a chain that failed is latched",
            all_of([_was_known(seen), seen.chain("failed"), ~_anew(seen)]).implies(seen.mode(3)),
            statement="a test of the fibre chain that failed, with a reference stored, makes the train untrusted until another accepted record",
            requirements=_EMITTER,
        )
    yield for_all_inputs(
        "a train is untrusted only for what is said of it",
        all_of((begins & reason.eq(why)).implies(cause) for why, cause in causes.items()),
        statement="a train becomes untrusted for an error F only in a cycle with F of either end, for the distance of its ends only if both are "
        "located and it fits no length of the record, for a lost record only if it is overdue, for a refused one only if one came, "
        "and for the emitter only if its test failed",
        requirements=(*_TRUST, *_EMITTER),
    )


def _withheld(seen: _Seen) -> Iterator[Property]:
    """Claim the only reasons for which a train is withheld."""
    model, own, figures = seen.model, seen.model.verification.own, seen.model.config.verification
    reason = seen.verification.num(own.why)
    front, limit = model.front, figures.position_limit_mm
    margins = [seen.end(front, f"margin_{side}") > figures.margin_limit_mm for side in ("above", "below")]
    outside = any_of([*margins, ~between(-limit, seen.end(front, "position"), limit)])
    order = model.order.own
    its = [model.composition.of(model.order.machine).num(one).eq(1) for one in order.belongs]
    lacks = {NOT_LOCATED: ~seen.both | outside | ~_spans(seen), NOT_ASSOCIATED: ~any_of(its)}
    if figures.needs_emitter:
        lacks[CHAIN_UNTESTED] = ~seen.chain("chain_tested")
    yield for_all_inputs(
        "a train is withheld only for what is missing",
        all_of((seen.mode(1) & reason.eq(why)).implies(cause) for why, cause in lacks.items()),
        statement="a train is withheld as not located only if an end is not, or its interval is beyond the figures; as not associated only if no "
        "pattern belongs to it by the order of trains; and as not tested only if no test of the chain has passed",
        requirements=(*_TRUST, *_EMITTER),
    )


def _anew(seen: _Seen) -> Bool:
    """The train has left, or one comes in with its number."""
    own = seen.model.entry.own
    return seen.entry.bool(own.left) | any_of(seen.entry.num(one).eq(1) for one in own.enters)


def _was_known(seen: _Seen) -> Bool:
    return earlier_bool(seen.mode(1) | seen.mode(2))


def _spans(seen: _Seen) -> Bool:
    """Both bounds of the distance are such as two places on the line can have."""
    figures = seen.model.config.verification
    most = 2 * (figures.position_limit_mm + figures.margin_limit_mm)
    return between(-most, seen.nearest, most) & between(-most, seen.farthest, most)


def _apart(seen: _Seen) -> Bool:
    """The distance between both ends fits no length of the record that is due, or that was stored before."""
    own, tolerance = seen.model.verification.own, seen.model.config.verification.length_tolerance_mm
    due = seen.entry.bool(seen.model.entry.own.due)
    new_low, new_high = seen.verification.num(own.record_length_low), seen.verification.num(own.record_length_high)
    low, high = (
        earlier_num(seen.verification.num(own.stored_length_low)),
        earlier_num(seen.verification.num(own.stored_length_high)),
    )
    by_new = (seen.nearest - tolerance > new_high) | (seen.farthest + tolerance < new_low)
    by_old = (seen.nearest - tolerance > high) | (seen.farthest + tolerance < low)
    return (due & by_new) | (~due & by_old) | (seen.nearest > seen.farthest)


def _located(seen: _Seen) -> Property:
    model, machine = seen.model, seen.model.verification.machine
    front = model.front.machine
    mine = [machine.output(name) for name in INTERVAL]
    return for_all_inputs(
        "the reported position is the front's",
        seen.mode(2).implies(hears_interval(seen.verification, mine, model.composition.of(front), front)),
        statement="the position that is reported, and both margins, are those of the front's machine in this cycle",
        requirements=_TRUST,
    )


def _compared(seen: _Seen) -> Iterator[Property]:
    """Properties of the comparison with a record, which depends on its sender."""
    model, own = seen.model, seen.model.verification.own
    machine, comes = model.verification.machine, seen.entry.num(model.entry.own.comes)
    speed, place = (seen.verification.bool(machine.flag(f"verified_{one}_at_entry")) for one in ("speed", "place"))
    present = seen.verification.bool(own.associated & own.fibre_speed.present)
    taken = seen.mode(2) & ~seen.entry.bool(model.entry.own.left)
    yield for_all_inputs(
        "at the counter speed and place are compared",
        (taken & comes.eq(AXLE_COUNTER)).implies(place & present.implies(speed)),
        statement="a train that is trusted in the cycle of a counter's record has had its place compared with it, and its speed if the fibre told one",
        requirements=_ENTRY,
    )
    yield for_all_inputs(
        "a neighbour's record is compared with no counter",
        (taken & comes.eq(NEIGHBOUR)).implies(~place & ~speed),
        statement="in the cycle of a record that the neighbour handed over, no place and no speed counts as compared with a counter's",
        requirements=_ENTRY,
    )


def _reported(seen: _Seen) -> Iterator[Property]:
    model, own, verified = seen.model, seen.model.report.own, seen.model.verification.own
    reports = seen.report.bool(model.report.machine.flag("reported"))
    whole = seen.report.bool(model.report.machine.flag("integer"))
    matches = all_of(
        [
            seen.verification.bool(verified.associated & verified.fibre_axles.present),
            seen.verification.num(verified.fibre_axles.value).eq(seen.verification.num(verified.stored_axles)),
        ]
    )
    yield for_all_inputs(
        "a train of which all axles are counted is reported whole",
        all_of([seen.mode(2), matches, _inside_the_line(seen)]).implies(reports & whole),
        statement="a trusted train of which as many axles are counted as at its entry is reported as whole in that cycle, if all of it is on the line",
        requirements=_CLEAR,
    )
    believed = seen.report.num(model.report.machine.mode).one_of(*model.report.machine.modes[2:])
    yield for_all_inputs(
        "a believed end is reported",
        all_of([seen.mode(2), believed, _on_the_line(seen)]).implies(reports),
        statement="a trusted train of which one end is believed is reported, with or without a count in that cycle, if all of it is on the line",
        requirements=_CLEAR,
    )
    yield _runs(seen)
    slot, age = model.area.own.slots[0], seen.report.num(own.age)
    judged = seen.area.num(slot.last_verdict)
    fresh = age <= model.config.sections.area.report_age_limit_ms
    yield for_all_inputs(
        "every report reaches the area",
        reports.implies(judged.one_of(ACCEPTED, CONTRADICTED, NOBODY) | (judged.eq(STALE) & ~fresh)),
        statement="a report of the train is judged by the area in the same cycle, and refused only if it is older than permitted, contradicts the "
        "train's interval, or comes of a train that is not there",
        requirements=_CLEAR,
    )
    confirmed = all_of([judged.eq(ACCEPTED), reports, whole])
    if model.area.own.slots[0].integrity_is_trusted:
        yield for_all_inputs(
            "a whole train is confirmed",
            confirmed.implies(seen.area.num(slot.unconfirmed).eq(0)),
            statement="an accepted report of a whole train confirms its integrity in the same cycle",
            requirements=_CLEAR,
        )


def _inside_the_line(seen: _Seen) -> Bool:
    """Both ends are on the line, even if the train was whole a count's run ago only."""
    model, figures = seen.model, seen.model.config.parting
    limit = model.config.sections.area.limit_mm
    long = seen.verification.num(model.verification.own.stored_length_high)
    most = long + figures.count_run_mm + figures.roll_back_mm
    (_, behind), (ahead, _) = _ends(seen, model.rear), _ends(seen, model.front)
    return all_of([_on_the_line(seen), ahead - most >= -limit, behind + most <= limit])


def _on_the_line(seen: _Seen) -> Bool:
    """Both ends of the pattern are on the line, the front ahead of the rear."""
    limit = seen.model.config.sections.area.limit_mm
    behind, ahead = _ends(seen, seen.model.rear), _ends(seen, seen.model.front)
    inside = [between(-limit, place, limit) for place in (*behind, *ahead)]
    return all_of([*inside, behind[0] <= ahead[0], behind[1] <= ahead[1], behind[0] <= ahead[1]])


def _ends(seen: _Seen, fibre: Fibre) -> tuple[Num, Num]:
    """Bounds of one end, mm."""
    place = seen.end(fibre, "position")
    return place - seen.end(fibre, "margin_below"), place + seen.end(fibre, "margin_above")


def _runs(seen: _Seen) -> Property:
    """A measured run beyond its error counts for the end that leads: by half of it at least, which the error law leaves."""
    model, own = seen.model, seen.model.report.own
    run = model.composition.of(model.front.machine)
    measured, ran = run.bool(model.front.own.run.present), run.num(model.front.own.run.value)
    mine = all_of([measured, seen.verification.bool(model.verification.own.associated), ~_anew(seen)])
    least = 2 * (model.config.fibre.floor_mm + 1)
    straight = seen.report.num(own.run_one_way)
    return for_all_inputs(
        "a measured run counts for the end that leads",
        (mine & (ran >= least)).implies(straight > 0) & (mine & (ran <= -least)).implies(straight < 0),
        statement="in a cycle in which the train measurably ran up, the high end leads, and the low end where it ran down",
        requirements=_CLEAR,
    )
