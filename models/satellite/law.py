"""What is assumed of the world around the satellite position machine, and the invariants that help to prove."""

from __future__ import annotations

from typing import Literal

from safeloc.language.expr import Bool, Lit, Num, all_of, as_num, between, exact_to, ite
from safeloc.language.units import COUNT, MS, NM
from safeloc.models.satellite.variables import NM_PER_MM, SPARE, Parts, held

Trusted = Literal["satellites", "odometry"]
"""satellites: solutions of usable satellites hold within their bounds; odometry: any solution may be false, the run is true."""


def used_count(own: Parts) -> Num:
    """How many satellites the solution uses."""
    total = as_num(0, COUNT)
    for used in own.used:
        total = total + ite(used, as_num(1, COUNT), 0)
    return total


def enough(own: Parts) -> Bool:
    """As many as the unknowns, and those that detect or exclude beyond."""
    return used_count(own) >= own.unknowns + SPARE[own.config.redundancy]


REFERENCE = "a reference holds the true place"
"""The clause that an earlier machine can be made to keep, if the reference is its position."""


def clauses(own: Parts, trusted: Trusted) -> dict[str, Bool]:
    """What is assumed of references, and of the satellites or the odometry, by name."""
    beside, accuracy = own.next_truth - exact_to(own.reference.value, NM), exact_to(own.accuracy, NM)
    faster = own.next_speed - own.reference_speed.value
    return {
        REFERENCE: own.reference.present.implies(between(-accuracy, beside, accuracy)),
        "a reference's speed holds the true one": own.reference_speed.present.implies(
            between(-own.speed_accuracy, faster, own.speed_accuracy)
        ),
        f"what is believed of {trusted} is true": _solution_is_true(own)
        if trusted == "satellites"
        else _run_is_true(own),
    }


def can_stop(own: Parts, place: Num, speed: Num) -> Bool:
    """The vehicle can come to a stop before the coordinates end; without it the movement would have to end with them."""
    at_rest = place + exact_to(speed * Lit(own.config.stopping_ms, MS), NM)
    return between(own.truth.low, at_rest, own.truth.high)


def assumption(own: Parts) -> Bool:
    """The movement of the vehicle; the rest is in `clauses`."""
    config, period = own.config, Lit(own.config.period_ms, MS)
    ran = own.next_truth - own.truth - exact_to(own.true_speed * period, NM)
    sped = own.next_speed - own.true_speed
    return all_of(
        [
            between(-config.way_nm, ran, config.way_nm),
            between(-config.speed_change_um_s, sped, config.speed_change_um_s),
            can_stop(own, own.next_truth, own.next_speed),
        ]
    )


def _solution_is_true(own: Parts) -> Bool:
    """Of usable satellites, enough of them, whose errors keep their bounds."""
    only_usable = all_of(usable | ~used for used, usable in zip(own.used, own.usable, strict=True))
    off, off_speed = own.next_truth - exact_to(own.fix.value, NM), own.next_speed - own.fix_speed
    protection = exact_to(own.protection, NM)
    holds = between(-protection, off, protection) & between(-own.speed_protection, off_speed, own.speed_protection)
    return (own.fix.present & only_usable & enough(own)).implies(holds)


def _run_is_true(own: Parts) -> Bool:
    off, error = own.next_truth - own.truth - exact_to(own.odometry.value, NM), exact_to(own.odometry_error, NM)
    return own.odometry.present.implies(between(-error, off, error))


def lemmas(own: Parts, current: Num, table: tuple[Lit, ...], trusted: Trusted) -> dict[str, Bool]:
    """Invariants of the machine; of its ghosts, those that follow from what is trusted."""
    lost, located, _ = table
    state, most = held(own), (own.config.tolerance_mm - 2) * NM_PER_MM
    margin = own.anchor_margin
    return {
        **(_inside(own, current, lost) if trusted == "satellites" else _near_anchor(own)),
        "margins are tolerable": between(0, state.under, most) & between(0, state.over, most),
        "nothing while unlocated": current.eq(lost).implies(own.coasted.eq(0) & ~own.anchored),
        "speed between its bounds": (state.slowest <= state.speed) & (state.speed <= state.fastest),
        "coasting counts": current.eq(located).implies(own.coasted.eq(0)),
        "position and anchor meet": between(-(state.over + margin), own.anchor_offset, state.under + margin),
        "the vehicle can stop before the coordinates end": can_stop(own, own.truth, own.true_speed),
    }


def _inside(own: Parts, current: Num, lost: Lit) -> dict[str, Bool]:
    state = held(own)
    place = (state.low <= own.truth) & (own.truth <= state.high)
    speed = (state.slowest <= own.true_speed) & (own.true_speed <= state.fastest)
    return {"the truth is inside": current.ne(lost).implies(place & speed)}


def _near_anchor(own: Parts) -> dict[str, Bool]:
    off = own.truth - (own.position - own.anchor_offset)
    return {"the truth is near the anchor": own.anchored.implies(between(-own.anchor_margin, off, own.anchor_margin))}
