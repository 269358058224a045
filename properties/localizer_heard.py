"""Claims about the wires between the machines of a localizer (RFL-13, RFL-14): a wire from another output would keep every other claim.

Containment is kept as well by an arbitration that does not hear a source at all: it then notices no contradiction by it. So here it
is said of every source that arbitration hears whatever it states, and nothing else; and the same of the vehicle's distance, of the
reference that satellites hear, and of both links.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from safeloc.language.expr import Bool, BoolVar, Lit, Num, NumVar, Optional, all_of
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always
from safeloc.language.terms import Substitution
from safeloc.models import balise, odometry, reflector
from safeloc.models.arbitration import Source
from safeloc.models.localizer import Localizer
from safeloc.models.satellite import variables as satellites
from safeloc.models.transmission import Transmission
from safeloc.models.vocabulary.reasons import CONTRADICTION, NO_REFERENCE, SENSOR_FAILURE, TOLERANCE
from safeloc.properties.hearing import INTERVAL, hears_interval, hears_value
from safeloc.properties.reason_words import in_words
from safeloc.properties.reflector_words import says_why

_WHY_NO_SATELLITES: Mapping[Lit, Lit] = {
    satellites.NO_REFERENCE: NO_REFERENCE,
    satellites.TOLERANCE: TOLERANCE,
    satellites.COASTED_OUT: SENSOR_FAILURE,
    satellites.CONTRADICTION: CONTRADICTION,
    satellites.DRIFT: CONTRADICTION,
}
"""Reasons of the satellite machine, in the words of the vehicle."""
_for_all_inputs = partial(always, requirements=("RFL-13", "RFL-14"), unconditional=True)


def heard(model: Localizer) -> Iterator[Property]:
    """Yield the claims."""
    yield from _of_sources(model)
    yield _of_distance(model)
    if "satellite" in model.pieces:
        yield from _of_satellites(model)
    if model.downlink is not None:
        [machine] = model.pieces["fibre"].machines
        yield _sent_on_board(model, model.downlink, machine)
    yield _sent_to_the_trackside(model)


# ------------------------------------------------------------------ the sources


def _of_sources(model: Localizer) -> Iterator[Property]:
    into = model.composition.of(model.arbitration.machine)
    intervals, references, reasons = list[Bool](), list[Bool](), list[Bool]()
    for source in model.arbitration.own.sources:
        machine = _stating(model, source.name)
        said = model.composition.of(machine)
        valid, mine = said.bool(machine.flag("valid")), (source.position, source.below, source.above)
        intervals += [into.bool(source.valid).iff(valid), valid.implies(hears_interval(into, mine, said, machine))]
        references.append(into.bool(source.reference).iff(said.bool(_refers(source.name, machine))))
        reasons.append(valid | _told(source, into, said, machine))
    yield _for_all_inputs(
        "arbitration hears what each source states",
        all_of(intervals),
        statement="arbitration has an interval of each source in exactly the cycles in which that source states one, and that very interval",
    )
    yield _for_all_inputs(
        "arbitration hears each reference and each reason",
        all_of([*references, *reasons]),
        statement="a reference counts in exactly the cycles in which its source has accepted one and states an interval; while a source states "
        "none, arbitration has its reason, in the words of the vehicle",
    )


def _stating(model: Localizer, name: str) -> Machine:
    """Return the machine that states the interval on board; of the fibre it is the link."""
    if name == "fibre" and model.downlink is not None:
        return model.downlink.machine
    return model.pieces[name].machines[-1]


def _refers(name: str, machine: Machine) -> Bool:
    """Return whether the source has accepted an absolute reference in this cycle."""
    valid = machine.flag("valid")
    if name == "fibre":
        return valid
    if name == "satellite":
        return valid & machine.output("fix").eq(satellites.ACCEPTED)
    if name == "reflector":
        return all_of([valid, machine.flag("precise"), machine.flag("recognised")])
    return machine.flag("reference_accepted")


def _told(source: Source, into: Substitution, said: Substitution, machine: Machine) -> Bool:
    reason = into.num(source.reason)
    if source.name == "fibre":
        return reason.eq(NO_REFERENCE)
    if source.name == "satellite":
        return in_words(reason, said.num(machine.output("reason")), _WHY_NO_SATELLITES)
    if source.name == "reflector":
        return says_why(reason, said.num(machine.output("error")))
    return reason.eq(said.num(machine.output("reason")))


# ------------------------------------------------------------------ the vehicle's distance


def _of_distance(model: Localizer) -> Property:
    counts = model.arbitration
    read = [term for piece in model.pieces.values() for one in piece.models for term in _distances(model, one)]
    read.append(hears_value(model.composition.of(counts.machine), counts.own.distance, *_of_motion(model)))
    return _for_all_inputs(
        "every machine runs on by the vehicle's distance",
        all_of(read),
        statement="odometry has what each unit of the vehicle measures, and balises, reflectors and arbitration the vehicle's distance, in exactly "
        "the cycles in which there is one",
    )


def _distances(model: Localizer, source: object) -> Iterator[Bool]:
    """Yield what has to hold of the distances that a source hears: odometry reads the units, others what they are worth together."""
    moves, of = model.motion, model.composition.of
    if isinstance(source, odometry.Odometry):
        for unit, measured in zip(source.own.units, moves.own.inputs, strict=False):
            yield hears_value(of(source.machine), unit.measured, *_of_unit(model, measured))
    elif isinstance(source, balise.Balise | reflector.ReflectorMachine):
        into, own = of(source.machine), source.own.odometer
        checked = moves.own.check is not None and own.more is not None
        yield hears_value(
            into, own.measured, *(_of_motion(model) if checked else _of_unit(model, moves.own.odometer.measured))
        )
        if checked and own.more is not None:
            yield into.num(own.more).eq(of(moves.machine).num(moves.machine.output("more_nm")))


def _of_unit(model: Localizer, measured: Optional) -> tuple[Bool, Num]:
    """Return whether a unit of the vehicle measures a distance in the cycle, and the distance."""
    told = model.composition.of(model.motion.machine)
    return told.bool(measured.present), told.num(measured.value)


def _of_motion(model: Localizer) -> tuple[Bool, Num]:
    """Return whether the vehicle's distance is reported in the cycle, and the distance."""
    told, moves = model.composition.of(model.motion.machine), model.motion
    return told.bool(moves.reported), told.num(moves.machine.output("distance_mm"))


# ------------------------------------------------------------------ what satellites hear


def _of_satellites(model: Localizer) -> Iterator[Property]:
    selection, position = model.pieces["satellite"].machines
    chosen, into = model.composition.of(selection), model.composition.of(position)
    flags = {var.name: var for var in position.inputs if isinstance(var, BoolVar)}
    numbers = (name.removeprefix("usable_") for name in flags if name.startswith("usable_"))
    yield _for_all_inputs(
        "the position hears which satellites are usable",
        all_of(
            into.bool(flags[f"usable_{number}"]).iff(chosen.bool(selection.flag(f"channel_{number}_usable")))
            for number in numbers
        ),
        statement="a satellite is taken for usable in exactly the cycles in which the selection keeps it",
    )
    trusted = next((name for name in ("balise", "odometry", "reflector") if name in model.pieces), None)
    if trusted is not None:
        yield _reference(model, position, trusted)


def _reference(model: Localizer, position: Machine, trusted: str) -> Property:
    machine = model.pieces[trusted].machines[-1]
    into, said = model.composition.of(position), model.composition.of(machine)
    [given] = [one for one in position.inputs if isinstance(one, Optional) and one.value.name == "reference_mm"]
    [accuracy] = [one for one in position.inputs if isinstance(one, NumVar) and one.name == "reference_accuracy_mm"]
    place, below, above = (said.num(machine.output(name)) for name in INTERVAL)
    most, bound = model.config.satellite.tolerance_mm, into.num(accuracy)
    fits = all_of([said.bool(_refers(trusted, machine)), below <= most, above <= most])
    wide = (bound >= below) & (bound >= above) & (bound.eq(below) | bound.eq(above))
    return _for_all_inputs(
        "satellites hear every reference",
        hears_value(into, given, fits, place) & fits.implies(wide),
        statement=f"each reference of {trusted} that is no wider than satellites may be reaches their position in the same cycle, as accurate as "
        "its wider side",
    )


# ------------------------------------------------------------------ the links


def _sent_on_board(model: Localizer, link: Transmission, machine: Machine) -> Property:
    into, said = model.composition.of(link.machine), model.composition.of(machine)
    trusted, untrusted = said.bool(machine.flag("trusted")), said.bool(machine.flag("untrusted"))
    return _for_all_inputs(
        "each verdict of the trackside is sent on board",
        into.bool(link.own.sent).iff(trusted | untrusted) & _sent(into, link, trusted, said, machine),
        statement="the fibre's position is sent on board in each cycle in which the train is trusted, and its revocation in each in which it is "
        "not: a position that was revoked is never sent as valid",
    )


def _sent_to_the_trackside(model: Localizer) -> Property:
    into, said = model.composition.of(model.uplink.machine), model.composition.of(model.guard)
    passed = ~said.bool(model.guard.flag("restrictive"))
    return _for_all_inputs(
        "the trackside is sent what the host gets",
        _sent(into, model.uplink, passed, said, model.guard),
        statement="a report to the trackside has the interval that the host gets in this cycle, and none while the vehicle is restrictive",
    )


def _sent(into: Substitution, link: Transmission, valid: Bool, said: Substitution, machine: Machine) -> Bool:
    sent = (link.own.position, link.own.below, link.own.above)
    return into.bool(link.own.valid).iff(valid) & valid.implies(hears_interval(into, sent, said, machine))
