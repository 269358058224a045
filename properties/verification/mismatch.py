"""What must withhold a fibre position, parameter by parameter, in figures of its own (FVA-2 to FVA-7)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, Num, any_of, before, between, with_unit
from safeloc.language.spec import Property, always
from safeloc.language.units import MM, MM_S
from safeloc.models.verification import Verification
from safeloc.models.verification import variables as v
from safeloc.models.verification.variables import Parts

CLAIM = ("FVA-1", "FVA-10")
STAY = ("FVA-2", "FVA-11")
ENTRY = ("FVA-3", "FVA-12")
SAFE = ("FVA-4", "FVA-13", "FVA-5", "FVA-14")
CONTROL = ("FVA-7", "FVA-16")


def properties(model: Verification) -> Iterator[Property]:
    """Each comparison of claim 1 to 5 and 7, written from the inputs and not with the machine's own guards."""
    own = model.own
    trusted = model.machine.flag("trusted")
    for name, (differs, statement, trace) in (_parameters(own) | _entry(own) | _record(model)).items():
        yield always(name, differs.implies(~trusted), statement=statement, requirements=trace, unconditional=True)


Clause = tuple[Bool, str, tuple[str, ...]]


def _parameters(own: Parts) -> dict[str, Clause]:
    """Parameters that do not change, and the distance of both ends."""
    seen = own.associated & own.seen_length.present
    control = own.control_length.present & _other_length(own, own.control_length.value)
    return {
        "another length is withheld": (
            seen & _other_length(own, own.seen_length.value),
            "a length that differs from the counter's beyond both tolerances withholds in the same cycle",
            (*CLAIM, *STAY),
        ),
        "another length by train control is withheld": (
            control,
            "a length by train control that contradicts the reference withholds; it never replaces it",
            CONTROL,
        ),
        "ends too far apart are withheld": (
            any_of(_ends_apart(own)),
            "both ends located where no length of the reference lies between them withhold in the same cycle",
            (*CLAIM, *STAY),
        ),
    }


def _other_length(own: Parts, length: Num) -> Bool:
    tolerance = own.config.length_tolerance_mm
    return (length < own.kept_low - tolerance) | (length > own.kept_high + tolerance)


def _ends_apart(own: Parts) -> Iterator[Bool]:
    near, far, tolerance = own.ends_low, own.ends_high, own.config.length_tolerance_mm
    yield near.present & far.present & (near.value > far.value)
    yield near.present & (near.value > own.kept_high + tolerance)
    yield far.present & (far.value < own.kept_low - tolerance)


def _entry(own: Parts) -> dict[str, Clause]:
    """What is compared at the counter, when the record comes."""
    config = own.config
    at_counter = own.due & own.source.eq(v.AXLE_COUNTER) & own.associated
    most = -(-max(config.traction_mm_s2, config.brake_mm_s2) * config.period_ms // v.MS_PER_S)
    change = with_unit(own.record_age * most, MM_S) + config.speed_tolerance_mm_s
    run = with_unit(own.record_age * -(-config.max_speed_mm_s * config.period_ms // v.MS_PER_S), MM)
    slack, speed, place = run + config.place_tolerance_mm, own.seen_speed.value, own.place.value
    low, high = own.record_place_low - slack, own.record_place_high + slack
    away = (place + own.place_over < low) | (place - own.place_under > high)
    return {
        "another speed at the counter is withheld": (
            at_counter
            & own.seen_speed.present
            & ~between(own.record_speed_low - change, speed, own.record_speed_high + change),
            "at the counter the fibre's speed is the counter's, within tolerance and what the train can have changed since",
            ENTRY,
        ),
        "another place at the counter is withheld": (
            at_counter & own.place.present & away,
            "at the counter the fibre's interval meets the counter's, within tolerance and the farthest run since",
            ENTRY,
        ),
    }


def _record(model: Verification) -> dict[str, Clause]:
    """A record against the one that is stored."""
    own, machine = model.own, model.machine
    _, withheld, trusted, _ = machine.modes
    apart = (own.record_high < before(own.kept_low)) | (own.record_low > before(own.kept_high))
    other = own.record_count.ne(before(own.kept_count)) | apart
    known = before(machine.mode).one_of(withheld, trusted)
    return {
        "another record of the same stay is withheld": (
            known & own.due & other,
            "a record that contradicts the stored one withholds in the same cycle, also where the fibre agrees with it",
            (*SAFE, *STAY),
        ),
    }
