"""Adds up the samples of a counting head through one cycle of the axle counter.

    WITHIN   samples of a cycle are being added up; there is no record
    DONE     the last sample of the cycle: the record has its axles and their direction, or a fault; and whether the head is damped

A cycle is at fault if the head may have missed a wheel in one of its samples (it was disturbed, or a channel was not alive), if a wheel left the head without being counted or went back on it, if
one was counted that took too long over the head (models.counting_head.wheel_time), if axles passed both ways, or more than the counter takes. A channel that is silent makes every wheel leave uncounted; one that stays
damped makes every wheel go back. Only a channel that begins to stay damped under a wheel leaves this one uncounted without a fault: then
the head is damped at the end of that cycle and of each one until the next wheel, and the counter is told.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from safeloc.language.expr import TRUE, Bool, Lit, Num, as_num, ite, minimum
from safeloc.language.machine import Model, Transition, current_mode, modes
from safeloc.language.rows import Updates
from safeloc.language.units import COUNT
from safeloc.models.axle_head import DOWN, NO_AXLE, UP
from safeloc.models.counting_head.configuration import CountingHeadConfig
from safeloc.models.counting_head.lemmas import lemmas
from safeloc.models.counting_head.variables import Parts
from safeloc.models.counting_head.wheel_time import counted_late, first_alone, since_both, went_back
from safeloc.models.counting_head.world import world

REQUIREMENTS = ("FVA-4", "FVA-5", "FVA-13", "FVA-14")


HeadCycle = Model[Parts]


def head_cycle(config: CountingHeadConfig, head_modes: Sequence[Lit]) -> HeadCycle:
    """Return the machine of a head with these modes."""
    own, table = Parts(config, head_modes), modes("WITHIN", "DONE")
    current = current_mode(table)
    sound = current.eq(table[1]) & ~own.flawed
    way = ite(own.axles_upwards > 0, UP, ite(own.axles_downwards > 0, DOWN, NO_AXLE))
    made = own.declared.machine(
        name="head_cycle",
        modes=table,
        outputs={
            "cycle_done": current.eq(table[1]),
            "cycle_fault": current.eq(table[1]) & own.flawed,
            "cycle_axle": ite(sound, way, NO_AXLE),
            "cycle_axles": ite(sound, own.axles_upwards + own.axles_downwards, 0),
            "cycle_damped": current.eq(table[1]) & _head_is_damped(own),
        },
        transitions=list(_table(own, table)),
        world=world(own),
        lemmas={
            "a cycle ends with its last sample": current.eq(table[1]).iff(own.samples.eq(config.samples)),
            **lemmas(own),
        },
        doc=(
            "The samples of a counting head, added up through one cycle of the axle counter. Assumed: the head counts each wheel "
            "that passes, in the sample in which it leaves, or tells that it may have missed one; and wheels on the head keep to traction and brakes."
        ),
    )
    return Model(made, own)


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    within, done = table
    samples, ups, downs = (
        _sample_after(own),
        axles_after(own, own.axles_upwards, UP),
        axles_after(own, own.axles_downwards, DOWN),
    )
    both, many = (ups > 0) & (downs > 0), ups + downs > own.most
    every: Updates = {
        own.samples: samples,
        own.axles_upwards: ups,
        own.axles_downwards: downs,
        own.flawed: (~_begins(own) & own.flawed) | sample_flawed(own) | both | many,
        own.mode_before: own.head_mode,
        own.first_alone: first_alone(own),
        own.since_both: since_both(own),
    }
    last = samples >= own.cycle_samples
    yield Transition("last sample of a cycle", table, done, last, every, REQUIREMENTS, 0)
    yield Transition("sample of a cycle", table, within, TRUE, every, REQUIREMENTS, 1)


def _begins(own: Parts) -> Bool:
    """Return whether the sample is the first of a cycle."""
    return own.samples >= own.cycle_samples


def _sample_after(own: Parts) -> Num:
    return ite(_begins(own), as_num(1, COUNT), own.samples + 1)


def axles_after(own: Parts, before: Num, way: Lit) -> Num:
    """Return the axles of one direction with this sample."""
    kept = ite(_begins(own), as_num(0, COUNT), before)
    return minimum(kept + ite(own.counted.eq(way), as_num(1, COUNT), 0), own.most + 1)


def sample_flawed(own: Parts) -> Bool:
    """Return whether the head may have missed a wheel, or one left it uncounted, went back on it, or was counted late."""
    free = own.head_modes[0]
    uncounted = own.mode_before.ne(free) & own.head_mode.eq(free) & own.counted.eq(NO_AXLE)
    return own.may_miss | uncounted | went_back(own) | counted_late(own)


def _head_is_damped(own: Parts) -> Bool:
    """Return whether the head was damped, or disturbed, in this sample."""
    return own.mode_before.ne(own.head_modes[0])
