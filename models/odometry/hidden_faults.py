"""Faults too small to be seen, of a machine that may have one faulty unit and does not charge for it.

What such a fault may add since the device was set is the ghost `unseen`. It follows the machine's own resets: it is what a
claim reckons with ("the interval, widened by so much"), no law of a sensor.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from safeloc.language.expr import Bool, Lit, Num, NumVar, any_of, as_num, ite, maximum, number, with_unit
from safeloc.language.units import MM, MS, NM
from safeloc.language.world import World
from safeloc.models.odometry.distance_device import Cycle, Device

if TYPE_CHECKING:
    from safeloc.models.odometry.cycle import Judged


def unseen(device: Device) -> NumVar:
    """What a fault too small to be seen may have added since the device was set, as long ago as the age limit allows."""
    cycles = device.limits.age_limit_ms // device.limits.period_ms + 2
    most = unseen_at_reading_nm(device) + cycles * unseen_in_a_cycle_nm(device)
    return number(f"{device.name}_unseen_nm", NM, 0, most)


def unseen_at_reading_nm(device: Device) -> int:
    """What a unit is charged too little for the other one's one-off constant, nm."""
    first, second = (unit.law.wander_nm for unit in device.units)
    return 2 * abs(first - second)


def unseen_in_a_cycle_nm(device: Device) -> int:
    """The most that one cycle may hide: twice the greater law at top speed and full age, nm."""
    limits = device.limits
    farthest, oldest = Lit(limits.max_step_mm, MM), Lit(limits.age_limit_ms, MS)
    growths = [unit.law.growth_nm(farthest, oldest, limits.period_ms) for unit in device.units]
    return 2 * max(growth.value for growth in growths if isinstance(growth, Lit))


def with_hidden(world: World, cycle: Judged) -> World:
    """The world with what its faults may hide, where they may."""
    hidden = dict(zip(cycle.own.devices, cycle.own.ghosts.unseen, strict=False))
    if not hidden:
        return world
    return replace(
        world,
        ghosts={**world.ghosts, **{ghost: unseen_at_reading_nm(device) for device, ghost in hidden.items()}},
        moves={**world.moves, **{ghost: _after(cycle, cycle.moved(one), ghost) for one, ghost in hidden.items()}},
        reads_machine="what a fault may hide is reckoned since the machine last set the device; no clause reads it",
    )


def _after(cycle: Judged, moved: Cycle, hidden: NumVar) -> Num:
    """Each cycle in which both units measure may hide twice the greater law; a reading starts afresh."""
    device, both = moved.device, moved.admitted[0] & moved.admitted[1]
    period, start = device.limits.period_ms, as_num(unseen_at_reading_nm(device), NM)
    most = maximum(*(unit.law.growth_nm(moved.reach, moved.age, period) for unit in device.units))
    taken = any_of(reading.accepted | reading.is_candidate for reading in cycle.setting(device))
    fresh = taken | ~device.values.alive
    return ite(fresh, start, ite(both, hidden + most * 2, hidden))


def hidden_with_age(device: Device, hidden: NumVar) -> Bool:
    """A lemma: no more is hidden than the device's age allows."""
    start, most, period = unseen_at_reading_nm(device), unseen_in_a_cycle_nm(device), device.limits.period_ms
    within_age = (hidden - start) * period <= with_unit(device.age * most, NM)
    return (hidden >= start) & device.values.alive.implies(within_age)
