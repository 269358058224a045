"""Lemmas of the odometry machine: facts over machine and world that help its proofs, and are proved themselves."""

from __future__ import annotations

import math
from collections.abc import Sequence

from safeloc.language.expr import Bool, Num, as_num, between, exact_to, ite, with_unit
from safeloc.language.units import NM
from safeloc.models.odometry.cycle import Situation
from safeloc.models.odometry.distance_device import Device, Unit
from safeloc.models.odometry.hidden_faults import hidden_with_age
from safeloc.models.odometry.variables import Parts
from safeloc.models.odometry.world import lawful


def lemmas(own: Parts, situation: Situation, leads: Sequence[Bool]) -> dict[str, Bool]:
    """Return the lemmas: the interval of every living unit contains the true position, and the mode names a living device with the smaller margin.

    leads  for each device, that the mode names it
    """
    found: dict[str, Bool] = {}
    for index, unit in enumerate(own.units):
        device, checker = own.partner(unit)
        sound = _holds(own, unit) & _set_no_earlier(own, index, device)
        other = own.units.index(checker)
        if own.ghosts.units[other].unset is not None:  # by the checker's law a missing distance is bridged
            sound = sound & _set_no_earlier(own, other, device)
        found[f"machine and world agree on the last distance of {unit.name}"] = _gated_alike(own, index)
        stray = situation.candidate & (own.ghosts.since_stray <= device.age)
        found[f"{unit.name} holds the truth"] = unit.alive.implies(sound | stray)
        found[f"{unit.name} is dead while delocalized"] = situation.lost.implies(~unit.alive)
        if own.config.single_fault_safe and _drift_mm_s2(device):
            found[f"{unit.name} holds the drift of its age"] = unit.alive.implies(_grown_with_age(unit, device))
    for device, named in zip(own.devices, leads, strict=True):
        found[f"{device.name} device is alive when it leads"] = named.implies(device.values.alive)
    if len(own.devices) == 2:
        front, rear = (device.values for device in own.devices)
        found["front device leads with the smaller margin"] = leads[0].implies(~rear.better_than(front))
        found["rear device leads with the smaller margin"] = leads[1].implies(~front.better_than(rear))
    for device, unseen in zip(own.devices, own.ghosts.unseen, strict=False):
        found[f"{device.name} hides no more than its age allows"] = hidden_with_age(device, unseen)
    return found


def _gated_alike(own: Parts, index: int) -> Bool:
    """The machine and the world store the same last distance of a unit, and the same number of cycles since then."""
    unit, seen = own.units[index], own.ghosts.units[index]
    return unit.gap.eq(seen.silent) & unit.last.eq(seen.last_delivered)


def _set_no_earlier(own: Parts, index: int, device: Device) -> Bool:
    """A unit that drifts was really set no earlier than the device reckons."""
    unset = own.ghosts.units[index].unset
    return as_num(0, NM).eq(0) if unset is None else unset <= device.age


def _drift_mm_s2(device: Device) -> int:
    """The drift that a cycle adds to either unit of a device that is safe against a single fault: the greater one."""
    return max(unit.law.drift_mm_s2 for unit in device.units)


def _grown_with_age(unit: Unit, device: Device) -> Bool:
    """Both margins have grown, since a certain age, by at least what the drift of that age adds in each cycle.

    Later cycles add no less: the drift grows with the age, and a cycle without a usable distance adds the farthest run. So a unit
    that is alive is no older than its tolerance allows. The age is the one that makes this bound the least.
    """
    drift, limits = _drift_mm_s2(device), unit.limits
    since_ms = max(math.isqrt(limits.tolerance_mm * 1_000_000 // drift), limits.period_ms)
    nm_in_a_ms = min(drift * since_ms, limits.max_speed_mm_s * 1_000)
    grown = with_unit(device.age * nm_in_a_ms, NM) - as_num(nm_in_a_ms * since_ms, NM)
    return (grown <= unit.above) & (grown <= unit.below)


def _holds(own: Parts, unit: Unit) -> Bool:
    """The interval holds the truth: by the own wander, or, of a faulty unit, by that of the unit that checks it."""
    itself = _inside(own, unit, unit, as_num(0, NM))
    if own.ghosts.faulty_unit is None:
        return itself
    device, checker = own.partner(unit)
    unseen = own.ghosts.unseen[own.devices.index(device)] if own.ghosts.unseen else as_num(0, NM)
    by_other, sound = _inside(own, unit, checker, unseen), lawful(own, unit)
    return ite(sound, itself, by_other)


def _inside(own: Parts, unit: Unit, checker: Unit, more: Num) -> Bool:
    wander = own.ghosts.units[own.units.index(checker)].wander
    half = checker.law.wander_nm
    off = own.ghosts.truth - exact_to(unit.position, NM) - wander
    return between(half - unit.below - more, off, unit.above - half + more)
