"""Properties of a train between two neighbouring areas (FVA-D1, FVA-1, FVA-2)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, all_of, between, exact_to, maximum, minimum
from safeloc.language.spec import Property, always, earlier_bool, reachable
from safeloc.language.units import NM
from safeloc.models.fibre_handover import FibreHandover, interval
from safeloc.models.verification import Verification
from safeloc.models.verification.variables import NEIGHBOUR
from safeloc.properties.verification import LAW

BORDER = ("FVA-D1",)
CLAIM = ("FVA-1", "FVA-10", "FVA-D1")
STAY = ("FVA-2", "FVA-11", "FVA-D1")
for_all_inputs = partial(always, requirements=STAY, unconditional=True)
under_assumption = partial(always, requirements=CLAIM, assumption=LAW)


def properties(model: FibreHandover) -> list[Property]:
    """Return the properties: containment on both sides, both areas only where the place is shared, and a lost handover."""
    return [
        *_truth(model),
        *_given(model),
        *_both(model),
        *_lost(model),
        *_arrives(model),
        *_shared(model),
        *_other_trains(model),
        *_sent(model),
        *_direction(model),
        *_either_way(model),
        *_on_the_way(model),
        *_reports(model),
        *_reached(model),
    ]


def _truth(model: FibreHandover) -> Iterator[Property]:
    """Claim that each area's trusted position contains the front."""
    of = model.composition.of
    truth = of(model.giving.machine).num(model.giving.own.truth)
    for side, verified in (("giving", model.giving), ("taking", model.taking)):
        here, (low, high) = of(verified.machine), interval(verified)
        yield under_assumption(
            f"containment in the {side} area",
            here.bool(verified.machine.flag("trusted")).implies(
                between(here.num(exact_to(low, NM)), truth, here.num(exact_to(high, NM)))
            ),
            statement=f"a position that the {side} area trusts contains the train's front",
        )


def _given(model: FibreHandover) -> Iterator[Property]:
    """Claim that the reported position contains the front, and is reported only of a trusted train."""
    of = model.composition.of
    truth = of(model.giving.machine).num(model.giving.own.truth)
    voice = of(model.speaker.machine)
    low, high = voice.num(model.speaker.low), voice.num(model.speaker.high)
    given = voice.bool(model.speaker.machine.flag("given"))
    yield under_assumption(
        "containment",
        given.implies(between(exact_to(low, NM), truth, exact_to(high, NM))),
        statement="the reported position contains the train's front, whichever area it comes from",
    )
    yield for_all_inputs(
        "a train that no area trusts is not reported",
        (~_trusted(model, model.giving) & ~_trusted(model, model.taking)).implies(~given & low.eq(0) & high.eq(0)),
        statement="if neither area trusts the train, no position is reported",
        requirements=CLAIM,
    )


def _both(model: FibreHandover) -> Iterator[Property]:
    of, voice = model.composition.of, model.speaker
    _, giving, taking, both = voice.machine.modes
    mode = of(voice.machine).num(voice.machine.mode)
    truth = of(model.giving.machine).num(model.giving.own.truth)
    begins, ends = (
        of(model.border.machine).num(var) for var in (model.border.own.shared_from, model.border.own.shared_to)
    )
    yield under_assumption(
        "both only where the place is shared",
        mode.eq(both).implies(between(exact_to(begins, NM), truth, exact_to(ends, NM))),
        statement="both areas report the position of a train only while it is in the stretch that they share",
        requirements=BORDER,
    )
    lower, upper = truth <= exact_to(ends, NM), truth >= exact_to(begins, NM)
    from_giving, from_taking, down = mode.one_of(giving, both), mode.one_of(taking, both), _down(model)
    yield under_assumption(
        "each area reports on its own stretch only",
        ((from_giving & ~down) | (from_taking & down)).implies(lower)
        & ((from_taking & ~down) | (from_giving & down)).implies(upper),
        statement="the area below never reports a train above the shared stretch, nor the area above one below it: the giving area is the lower "
        "one of a train that runs up, and the upper one of a train that runs down",
        requirements=BORDER,
    )


def _lost(model: FibreHandover) -> Iterator[Property]:
    """Claim that a record that does not arrive in time makes the train untrusted."""
    of, taking, border = model.composition.of, model.taking, model.border.machine
    here = of(taking.machine)
    *_, untrusted = taking.machine.modes
    mode = here.num(taking.machine.mode)
    on_the_way = of(border).num(border.mode)
    *_, lost = border.modes
    yield for_all_inputs(
        "a lost handover is untrusted",
        of(border).bool(border.fired("record lost on the way", "trust lost on the way")).implies(mode.eq(untrusted)),
        statement="a record that did not arrive in time makes the train untrusted in the taking area in the same cycle",
    )
    yield for_all_inputs(
        "a train stays untrusted after a lost handover",
        on_the_way.eq(lost).implies(mode.eq(untrusted)),
        statement="after a lost handover the taking area does not trust the train before it is gone",
    )


def _arrives(model: FibreHandover) -> Iterator[Property]:
    """Claim that the record arrives only while the giving area trusts the train."""
    of, giving, taking = model.composition.of, model.giving, model.taking
    here, border = of(taking.machine), model.border.machine
    none, *_ = taking.machine.modes
    mode = here.num(taking.machine.mode)
    on_the_way = of(border).num(border.mode)
    before, offered, *_ = border.modes
    arrives = of(border).bool(border.fired("record arrives"))
    yield for_all_inputs(
        "nothing is trusted before the record arrived",
        on_the_way.one_of(before, offered).implies(mode.eq(none)),
        statement="the taking area verifies nothing, and trusts nothing, before the record arrived",
        requirements=CLAIM,
    )
    yield for_all_inputs(
        "only a trusted train goes over",
        arrives.implies(_trusted(model, giving)),
        statement="a record arrives only in a cycle in which the giving area trusts the train",
    )


def _shared(model: FibreHandover) -> Iterator[Property]:
    """Claim that both areas verify against the same record."""
    of, giving, taking = model.composition.of, model.giving, model.taking
    there, here, border = of(giving.machine), of(taking.machine), model.border.machine
    _, withheld, trusted, _ = taking.machine.modes
    mode = here.num(taking.machine.mode)
    arrives = of(border).bool(border.fired("record arrives"))
    kept = [(one.stored_axles, one.stored_length_low, one.stored_length_high) for one in (taking.own, giving.own)]
    same = all_of(here.num(mine).eq(there.num(theirs)) for mine, theirs in zip(*kept, strict=True))
    yield for_all_inputs(
        "the same record on both sides",
        (arrives & mode.one_of(withheld, trusted)).implies(same),
        statement="the taking area verifies against the very record against which the giving area verified",
    )
    low, high = (there.num(one) for one in (giving.own.possible_low, giving.own.possible_high))
    limit = giving.own.config.position_limit_mm
    wider = (here.num(taking.own.possible_low) <= maximum(low, -limit)) & (
        here.num(taking.own.possible_high) >= minimum(high, limit)
    )
    yield for_all_inputs(
        "the same bounds of the front on both sides",
        (arrives & mode.one_of(withheld, trusted)).implies(wider),
        statement="the bounds of the front by the last record and the top speed are no narrower in the taking area than in "
        "the giving one, except at the ends of the line",
    )


def _other_trains(model: FibreHandover) -> Iterator[Property]:
    """Claim that no other train is taken for this one."""
    of, taking, border = model.composition.of, model.taking, model.border.machine
    here = of(taking.machine)
    none, *_ = taking.machine.modes
    mode = here.num(taking.machine.mode)
    on_the_way = of(border).num(border.mode)
    before, *_ = border.modes
    gone = of(border).bool(model.border.own.gone)
    yield for_all_inputs(
        "no data of a train are kept after it is gone",
        gone.implies(mode.eq(none) & on_the_way.eq(before)),
        statement="when a train has gone, the machine discards all its data",
    )
    counted = taking.own.associated & taking.own.fibre_axles.present
    yield for_all_inputs(
        "another train is not taken over",
        here.bool(counted & taking.own.fibre_axles.value.ne(taking.own.stored_axles)).implies(~_trusted(model, taking)),
        statement="a train with another number of axles than the record is not trusted in the taking area",
        requirements=CLAIM,
    )


def _sent(model: FibreHandover) -> Iterator[Property]:
    """Claim the moment from which a record is sent."""
    of, giving, border = model.composition.of, model.giving, model.border.machine
    on_the_way, (before, *_) = of(border).num(border.mode), border.modes
    gone = of(border).bool(model.border.own.gone)
    low, high = (of(giving.machine).num(bound) for bound in interval(giving))
    begins, ends = (of(border).num(one) for one in (model.border.own.shared_from, model.border.own.shared_to))
    may_be_here = _trusted(model, giving) & ((_down(model) & (low <= ends)) | (~_down(model) & (high >= begins)))
    sent = of(border).bool(border.fired("record is sent", "record arrives"))
    yield for_all_inputs(
        "a record goes over from the shared stretch on",
        sent.implies(may_be_here) & (may_be_here & ~gone).implies(on_the_way.ne(before)),
        statement="a record is first sent, or arrives, only while the giving area trusts the train and its front may have "
        "come to the shared stretch, from below or from above; and from then on it is sent",
    )


def _direction(model: FibreHandover) -> Iterator[Property]:
    """Claim the direction of a handover: as told until the record is sent, then kept."""
    of, border = model.composition.of, model.border.machine
    way, (before, *_) = of(border).num(border.mode), border.modes
    down, was_before = _down(model), earlier_bool(way.eq(before))
    told = of(border).bool(model.border.own.train_runs_down)
    yield for_all_inputs(
        "a handover keeps its direction",
        was_before.implies(down.iff(told)) & (~was_before).implies(down.iff(earlier_bool(down))),
        statement="the direction is the one that is told in each cycle before the record is sent and in the cycle in which it is first sent; "
        "from then on it stays until the train is gone",
        requirements=BORDER,
    )


def _either_way(model: FibreHandover) -> Iterator[Property]:
    """Claim that trains of both directions can be taken over."""
    voice, down = model.speaker.machine, _down(model)
    _, _, taking, both = voice.modes
    mode = model.composition.of(voice).num(voice.mode)
    for name, which in (("upwards", ~down), ("downwards", down)):
        yield reachable(
            f"a train is taken over {name}",
            mode.one_of(taking, both) & which,
            statement=f"a train that runs {name} can be taken over",
            requirements=BORDER,
        )


def _down(model: FibreHandover) -> Bool:
    """Return the condition that the handover is one of a train that runs downwards."""
    return model.composition.of(model.border.machine).bool(model.border.own.runs_down)


def _on_the_way(model: FibreHandover) -> Iterator[Property]:
    """Claim what the border hears of the giving area, and the taking one of the border."""
    of, giving, own = model.composition.of, model.giving, model.taking.own
    there, here, border = of(giving.machine), of(model.taking.machine), model.border.machine
    way, (_, offered, _, lost) = of(border).num(border.mode), border.modes
    distrusted = there.bool(giving.machine.flag("untrusted")) & ~of(border).bool(model.border.own.gone)
    yield for_all_inputs(
        "distrust on the way loses the handover",
        (earlier_bool(way.eq(offered)) & distrusted).implies(way.eq(lost)),
        statement="a mismatch that the giving area finds while the record is on its way loses the handover in the same cycle",
    )
    arrives = of(border).bool(border.fired("record arrives"))
    kept = (giving.own.stored_axles, giving.own.stored_length_low, giving.own.stored_length_high)
    record = zip((own.record_axles, own.record_length_low, own.record_length_high), kept, strict=True)
    same = all_of(here.num(mine).eq(there.num(theirs)) for mine, theirs in record)
    yield for_all_inputs(
        "the record that arrives is the giving area's",
        here.bool(own.due & own.sound).iff(arrives)
        & arrives.implies(same & here.num(own.reference_from).eq(NEIGHBOUR)),
        statement="the taking area gets a sound record in exactly the cycle in which it arrives, with the axles and the length against which the "
        "giving area verified, as one of its neighbour",
    )


def _reports(model: FibreHandover) -> Iterator[Property]:
    """Claim that each area that may report is heard, with the interval that it has."""
    of, voice, border = model.composition.of, model.speaker, model.border.own
    begins, ends = (of(model.border.machine).num(one) for one in (border.shared_from, border.shared_to))
    (low, high), (taking_low, taking_high) = (
        [of(one.machine).num(bound) for bound in interval(one)] for one in (model.giving, model.taking)
    )
    down = _down(model)
    giving = _trusted(model, model.giving) & ((~down & (high <= ends)) | (down & (low >= begins)))
    taking = _trusted(model, model.taking) & ((~down & (taking_low >= begins)) | (down & (taking_high <= ends)))
    apart = all_of([giving, taking, maximum(low, taking_low) > minimum(high, taking_high)])
    reported = of(voice.machine).bool(voice.machine.flag("given"))
    yield for_all_inputs(
        "each area that may report is heard",
        reported.iff((giving | taking) & ~apart),
        statement="a position is reported whenever an area trusts the train within its own stretch of line, which lies above the other one or below it by the direction, unless both do and exclude each other",
        requirements=CLAIM,
    )
    mine, mine_high = of(voice.machine).num(voice.low), of(voice.machine).num(voice.high)
    inside = all_of(
        [
            (reported & giving).implies((mine >= low) & (mine_high <= high)),
            (reported & taking).implies((mine >= taking_low) & (mine_high <= taking_high)),
            reported.implies((mine.eq(low) & giving) | (mine.eq(taking_low) & taking)),
            reported.implies((mine_high.eq(high) & giving) | (mine_high.eq(taking_high) & taking)),
        ]
    )
    yield for_all_inputs(
        "what is reported is what the areas have in common",
        inside,
        statement="the reported interval lies within that of each area that may report, and each of its ends is one of theirs",
        requirements=CLAIM,
    )


def _trusted(model: FibreHandover, verified: Verification) -> Bool:
    return model.composition.of(verified.machine).bool(verified.machine.flag("trusted"))


def _reached(model: FibreHandover) -> Iterator[Property]:
    voice, border = model.speaker.machine, model.border.machine
    mode = model.composition.of(voice).num(voice.mode)
    way = model.composition.of(border).num(border.mode)
    _, _, taking, both = voice.modes
    yield reachable(
        "a train is taken over", mode.eq(taking), statement="a train can be taken over", requirements=BORDER
    )
    yield reachable(
        "both areas report a train",
        mode.eq(both),
        statement="both areas can report the same train's position",
        requirements=BORDER,
    )
    yield reachable(
        "a handover is lost", way.eq(border.modes[3]), statement="a handover can be lost", requirements=BORDER
    )
