"""The view zone: its beginning, the origin of its echo, and its margins (RFL-1, -2, -3, -10, -D2)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, exact_to, with_unit
from safeloc.language.spec import Property, always
from safeloc.language.units import MM, NM
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.reflector.echo import FITS, NO_FRAME, NONE, OTHER_MODEL, OUT_OF_WINDOW, WEAK, Slot
from safeloc.models.reflector.variables import BY_REFLECTOR, MISMATCH, NO_SOURCE, Parts
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.properties.reflector.figures import (
    IN_ZONE,
    LAW,
    begun,
    looked_for,
    looked_for_model,
    stands_at,
    strong,
    was,
)

for_all_inputs = partial(always, requirements=("RFL-1", "RFL-10"), unconditional=True)
under_assumption = partial(always, requirements=("RFL-1", "RFL-3"), assumption=LAW)


def view(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties of measurements and of the position by them."""
    for maker in (_never_mistaken, _told_apart, _strong_enough, _own_bound, _sent_by_it, _used, _reasons, _source):
        yield from maker(model)


def _never_mistaken(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties that no reflector is taken for another, and nothing else for a reflector."""
    own, valid = model.own, model.machine.flag("valid")
    target = (looked_for(own), looked_for_model(own))
    verdicts = {
        "target": [(valid & slot.last_verdict.eq(FITS)).implies(_is_from(own, slot, *target)) for slot in own.slots],
        "next reflector": [
            slot.last_verdict_for_next.eq(FITS).implies(_is_from(own, slot, own.ahead.position.value, own.ahead.model))
            for slot in own.slots
        ],
    }
    for name, right in verdicts.items():
        yield under_assumption(
            f"the {name} is never mistaken",
            all_of(right),
            statement=f"that very reflector, of that model, reflected the echo that fits the {name}, however many others the line has",
            requirements=("RFL-3", "RFL-10"),
        )


def _is_from(own: Parts, slot: Slot, position: Num, model: Num) -> Bool:
    """Return whether the reflector that the map has at this place, with this model, truly sent the echo."""
    truly = own.ghosts.kind[slot.number - 1].eq(model) & own.ghosts.on_map[slot.number - 1].eq(position)
    return all_of([own.ghosts.reflector[slot.number - 1], truly, stands_at(own, slot, position)])


def _told_apart(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties that echoes are told apart by the model of what they truly come from, in both directions."""
    own, ahead = model.own, model.own.ahead.model
    sought = model.machine.flag("valid") & (was(model, "REFERENCE", "SEARCH", *IN_ZONE) | begun(own))
    of_map = ahead.ne(NO_MODEL) & own.ahead.position.present
    for name, known, of, verdicts in (
        ("target", sought, looked_for_model(own), [slot.last_verdict for slot in own.slots]),
        ("next reflector", of_map, ahead, [slot.last_verdict_for_next for slot in own.slots]),
    ):
        sent = list(zip(own.slots, own.ghosts.kind, verdicts, strict=True))
        yield under_assumption(
            f"an echo of anything else is refused for the {name}",
            all_of(
                (known & strong(own, slot) & kind.ne(of)).implies(judged.eq(OTHER_MODEL)) for slot, kind, judged in sent
            ),
            statement=f"whatever is no reflector of the model of the {name}, however strong its echo and wherever it stands, is refused "
            "for its model",
            requirements=("RFL-10",),
        )
        recognised = (known & strong(own, slot) & kind.eq(of) & slot.model.ne(NO_MODEL) for slot, kind, _ in sent)
        yield under_assumption(
            f"no echo of its model is refused as another's for the {name}",
            all_of(seen.implies(judged.ne(OTHER_MODEL)) for seen, judged in zip(recognised, verdicts, strict=True)),
            statement=f"an echo of a reflector of the model of the {name} is never refused for its model, if it shows one at all",
            requirements=("RFL-10",),
        )


def _is_reported(model: ReflectorMachine, slot: Slot) -> Bool:
    """Return whether the reported range, error and lateral place are those of this slot."""
    machine = model.machine
    return (
        slot.range.present
        & machine.output("range_mm").eq(slot.range.value)
        & machine.output("range_error_mm").eq(slot.error)
        & machine.output("lateral_mm").eq(slot.lateral)
    )


def _strong_enough(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    shown = machine.output("reflector_model")
    yield for_all_inputs(
        "minimum intensity",
        (machine.flag("precise") | machine.output("source").eq(BY_REFLECTOR)).implies(
            any_of(strong(own, slot) & _is_reported(model, slot) & slot.model.eq(shown) for slot in own.slots)
        ),
        statement="a reflector is the source of the position only by an echo with the minimum intensity and the reflector's model",
    )


def _own_bound(model: ReflectorMachine) -> Iterator[Property]:
    machine, own, config = model.machine, model.own, model.own.config
    least = exact_to(machine.output("range_error_mm") + config.map_accuracy_mm, NM)
    least = least + with_unit(machine.output("range_mm") * config.radar_scale_ppm, NM)
    sides = ((own.track.above, least + own.open_long), (own.track.below, least + own.open_short))
    share = -(-config.frame_latency_ms * 1_000_000 // config.period_ms)
    more = as_num(0, NM) if own.odometer.more is None else own.odometer.more
    late = with_unit(as_num(config.max_cycle_distance_mm, MM) * share, NM) + more
    place = machine.output("reflector_position_mm") + config.radar_offset_mm
    yield for_all_inputs(
        "errors of radar and survey make up the margins",
        machine.flag("precise").implies(
            (own.track.position + machine.output("range_mm")).eq(place)
            & all_of((least <= side) & (side - least <= late) for side, least in sides)
        ),
        statement="in the view zone the position is the reflector's place less the range. Each margin is the sum of the errors of "
        "echo, survey and scale, the systematic error that the last self-test left open, its drift, and the travel "
        "since the frame. An earlier position never narrows it",
        requirements=("RFL-2", "RFL-3", "RFL-D2"),
    )


def _sent_by_it(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    shown = machine.output("reflector_position_mm"), machine.output("reflector_model")
    yield under_assumption(
        "the reported reflector sent the echo",
        machine.flag("precise").implies(
            any_of(_is_reported(model, slot) & _is_from(own, slot, *shown) for slot in own.slots)
        ),
        statement="the reported reflector, of the reported model, truly sent the echo whose range is reported",
        requirements=("RFL-2", "RFL-3", "RFL-10"),
    )


def _used(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    fits = [verdict.eq(FITS) for slot in own.slots for verdict in (slot.last_verdict, slot.last_verdict_for_next)]
    yield under_assumption(
        "an echo that fits is used",
        all_of((machine.flag("valid") & one).implies(machine.flag("precise") | own.error.eq(MISMATCH)) for one in fits),
        statement="an echo that fits gives the position, or fails the self-test",
    )
    yield under_assumption(
        "the target's echo is in the window",
        all_of(
            (machine.flag("valid") & _from_target(own, slot)).implies(slot.last_verdict.ne(OUT_OF_WINDOW))
            for slot in own.slots
        ),
        statement="the machine never refuses a true echo of the searched reflector as out of the window",
    )


def _from_target(own: Parts, slot: Slot) -> Bool:
    return own.ghosts.reflector[slot.number - 1] & stands_at(own, slot, looked_for(own))


def _reasons(model: ReflectorMachine) -> Iterator[Property]:
    own, floor = model.own, model.own.config.minimum_intensity_cdb

    def right(slot: Slot, verdict: Num) -> Bool:
        there, frame = slot.range.present, model.own.frame_present
        empty, paused = verdict.eq(NONE).iff(~there), verdict.eq(NO_FRAME).iff(there & ~frame)
        return empty & paused & verdict.eq(WEAK).iff((slot.intensity <= floor - 1) & frame & there)

    yield for_all_inputs(
        "an echo that is not evaluated has its true reason",
        all_of(
            right(slot, verdict) for slot in own.slots for verdict in (slot.last_verdict, slot.last_verdict_for_next)
        ),
        statement="the verdicts empty slot, radar pause and too weak appear exactly when they are true",
    )


def _source(model: ReflectorMachine) -> Iterator[Property]:
    machine = model.machine
    source = machine.output("source")
    yield for_all_inputs(
        "the source is stated",
        source.eq(BY_REFLECTOR).iff(machine.flag("precise")) & source.eq(NO_SOURCE).iff(~machine.flag("valid")),
        statement="the source is the reflector exactly while the position is precise, and NONE exactly while there is no position",
        requirements=("RFL-1",),
    )
