"""Properties of the room that a train's entry record leaves for axles that a head counts late (FVA-4; as a device FVA-13)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Lit, Num, between, exact_to, ite
from safeloc.language.spec import Property
from safeloc.language.units import NM, UM
from safeloc.models.axle_counter import AxleCounter
from safeloc.models.axle_head import DOWN
from safeloc.properties.claims import Claims


def claims(model: AxleCounter, safe: Claims, held: Claims) -> Iterator[Property]:
    """Yield the properties, in both directions: room enough, and no more.

    safe, held  groups of the counter's claims: on its safety, and on its record
    """
    yield from _room_for_late_axles(model, safe)
    yield from _room_is_no_wider(model, held)


def ahead(model: AxleCounter, along: Num) -> Num:
    """Return an upward distance as a distance in the direction of the record."""
    return ite(model.machine.output("record_direction").eq(DOWN), -along, along)


def _room_for_late_axles(model: AxleCounter, safe: Claims) -> Iterator[Property]:
    """Claim that a record is true also if axles were counted late: the world's own length and run are those of the axles as counted."""
    machine, own = model.machine, model.own
    sound, late = machine.flag("record_sound"), Lit(own.config.late_mm * 1_000_000, NM)
    low, high, run_low, run_high = (
        exact_to(machine.output(f"record_{name}_um"), NM)
        for name in ("length_low", "length_high", "run_low", "run_high")
    )
    length, run = ahead(model, own.length), ahead(model, own.run)
    yield safe.lawful(
        "length is true of axles that are counted late",
        sound.implies(between(low, length - late, high) & between(low, length + late, high)),
        "a sound record's bounds contain the length from first to last axle, whichever of the two was counted up to the figure beyond the head",
    )
    yield safe.lawful(
        "place is true of an axle that is counted late",
        sound.implies(between(run_low, run, run_high) & between(run_low, run + late, run_high)),
        "a sound record's bounds contain the place of the first axle, also if it was counted up to the figure beyond the head",
    )


def _room_is_no_wider(model: AxleCounter, held: Claims) -> Iterator[Property]:
    """Claim that a record is wider than what is known of the axles as counted by that figure alone."""
    machine, own = model.machine, model.own
    late, sound = Lit(own.config.late_mm * 1_000, UM), machine.flag("record_sound")
    yield held.for_all_inputs(
        "a record leaves no more room than for late axles",
        sound.implies(
            (machine.output("record_length_low_um") >= own.length_low - late)
            & (machine.output("record_length_high_um") <= own.length_high + late)
            & (machine.output("record_run_low_um") >= own.run_low)
            & (machine.output("record_run_high_um") <= own.run_high + late)
        ),
        "a sound record's bounds of length and place are those of the axles as counted, and the figure beyond them",
    )
