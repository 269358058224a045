"""Undetectably small faults of a machine that may have one faulty unit and whose margins do not cover such faults.

The ghost `unseen` bounds what such a fault may have added since a reading set the device. It follows the machine's own
resets: a property widens the interval by it; no law of a sensor reads it.

The bound holds where no reading is stray (`trust_first_marker`). A stray reading is a second fault, and the window, which a hidden
fault has moved, may let it in: it lies three tolerances away from the truth, not from where the hidden fault has put the interval.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from safeloc.language.expr import Bool, Lit, Num, NumVar, any_of, as_num, ite, maximum, number, with_unit
from safeloc.language.units import MM, MS, NM
from safeloc.language.world import World
from safeloc.models.odometry.distance_device import Cycle, Device

if TYPE_CHECKING:
    from safeloc.models.odometry.cycle import Judgement


def unseen(device: Device) -> NumVar:
    """Make the ghost of what an undetectable fault may have added since the device was set, at most the age limit ago."""
    cycles = device.limits.age_limit_ms // device.limits.period_ms + 2
    most = unseen_at_reading_nm(device) + cycles * _unseen_in_a_cycle_nm(device)
    return number(f"{device.name}_unseen_nm", NM, 0, most)


def unseen_at_reading_nm(device: Device) -> int:
    """Return by how much a unit's margin may fall short of the other unit's one-off constant, nm."""
    first, second = (unit.law.wander_nm for unit in device.units)
    return 2 * abs(first - second)


def _unseen_in_a_cycle_nm(device: Device) -> int:
    """Return the most that a fault may add in one cycle undetected: twice the greater law at top speed and full age, nm."""
    limits = device.limits
    farthest, oldest = Lit(limits.max_cycle_distance_mm, MM), Lit(limits.age_limit_ms, MS)
    growths = [unit.law.growth_nm(farthest, oldest, limits.period_ms) for unit in device.units]
    return 2 * max(growth.value for growth in growths if isinstance(growth, Lit))


def with_hidden(world: World, cycle: Judgement) -> World:
    """Add to the world how undetected faults grow, where the parts have such ghosts."""
    hidden = dict(zip(cycle.own.devices, cycle.own.ghosts.unseen, strict=False))
    if not hidden:
        return world
    return replace(
        world,
        moves={**world.moves, **{ghost: _after(cycle, cycle.moved(one), ghost) for one, ghost in hidden.items()}},
        reads_machine="what a fault may hide is reckoned since the machine last set the device; no clause reads it",
    )


def _after(cycle: Judgement, moved: Cycle, hidden: NumVar) -> Num:
    """A fault may add twice the greater law in each cycle in which both units measure; a reading starts afresh."""
    device, both = moved.device, moved.admitted[0] & moved.admitted[1]
    period, start = device.limits.period_ms, as_num(unseen_at_reading_nm(device), NM)
    most = maximum(*(unit.law.growth_nm(moved.reach, moved.age, period) for unit in device.units))
    taken = any_of(reading.accepted | reading.is_candidate for reading in cycle.setting(device))
    fresh = taken | ~device.values.alive
    return ite(fresh, start, ite(both, hidden + most * 2, hidden))


def hidden_with_age(device: Device, hidden: NumVar) -> Bool:
    """State the lemma that the undetected part is no more than the device's age allows."""
    start, most, period = unseen_at_reading_nm(device), _unseen_in_a_cycle_nm(device), device.limits.period_ms
    within_age = (hidden - start) * period <= with_unit(device.age * most, NM)
    return (hidden >= start) & device.values.alive.implies(within_age)
