"""Adds up the samples of a counting head through one cycle of the axle counter.

    WITHIN   samples of a cycle are being added up; there is no record
    DONE     the last sample of the cycle: the record has its axles and their direction, or a fault; and whether the head is damped

A cycle is at fault if the head was disturbed in one of its samples, if a wheel left the head without being counted or went back on it, if
axles passed both ways, or more than the counter takes. A channel that is silent makes every wheel leave uncounted; one that stays
damped makes every wheel go back. Only a channel that begins to stay damped under a wheel leaves this one uncounted without a fault: then
the head is damped at the end of that cycle and of each one until the next wheel, and the counter is told.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    TRUE,
    Bool,
    Lit,
    Num,
    any_of,
    as_num,
    boolean,
    choice,
    enumeration,
    ite,
    minimum,
    number,
)
from safeloc.language.machine import Model, Transition, current_mode, modes
from safeloc.language.rows import Updates
from safeloc.language.units import COUNT
from safeloc.language.world import Law, World
from safeloc.models.axle_head import AXLE, DOWN, NO_AXLE, UP

HEARD = "the head counts each wheel that passes"
REQUIREMENTS = ("FVA-4", "FVA-5", "FVA-13", "FVA-14")


class Parts:
    """The variables of the machine.

    head_mode, counted        inputs: the head's mode and the axle that it counts in this sample, wired
    samples              state: samples of this cycle so far
    axles_upwards, axles_downwards           state: axles of this cycle so far; one more than the counter takes stands for any more
    flawed               state: this cycle is at fault
    mode_before                  state: the head's mode in the sample before
    passes               choice: the wheel that truly passed in this sample, wired
    true_samples, true_axles_upwards, true_axles_downwards   ghosts: samples of this cycle, and wheels that passed in them
    """

    def __init__(self, samples: int, most: int, head_modes: Sequence[Lit]) -> None:
        self.declared = declared = Declared()
        self.cycle_samples, self.most, self.head_modes = samples, most, tuple(head_modes)
        self.head_mode = declared.sensor(choice("head_mode", enumeration(self.head_modes)))
        self.counted = declared.sensor(choice("counted", enumeration(AXLE)))
        self.samples = declared.state(number("samples", COUNT, 0, samples), first=0)
        self.axles_upwards = declared.state(number("axles_upwards", COUNT, 0, most + 1), first=0)
        self.axles_downwards = declared.state(number("axles_downwards", COUNT, 0, most + 1), first=0)
        self.flawed = declared.state(boolean("cycle_flawed"), first=False)
        self.mode_before = declared.state(
            choice("head_mode_before", enumeration(self.head_modes)), first=self.head_modes[0]
        )
        self.true_samples = declared.ghost(number("true_samples", COUNT, 0, samples), first=0)
        self.true_axles_upwards = declared.ghost(number("true_axles_upwards", COUNT, 0, samples), first=0)
        self.true_axles_downwards = declared.ghost(number("true_axles_downwards", COUNT, 0, samples), first=0)
        self.passes = declared.choice(choice("wheel_passes", enumeration(AXLE)))


HeadCycle = Model[Parts]


def head_cycle(samples: int, most: int, head_modes: Sequence[Lit]) -> HeadCycle:
    """Return the machine: a cycle has so many samples, and the counter takes so many axles of it."""
    own, table = Parts(samples, most, head_modes), modes("WITHIN", "DONE")
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
        world=_world(own),
        lemmas={
            "a cycle ends with its last sample": current.eq(table[1]).iff(own.samples.eq(samples)),
            "a cycle without a fault is counted": _counted(own),
        },
        doc=(
            "The samples of a counting head, added up through one cycle of the axle counter. Assumed: the head counts each wheel "
            "that passes, in the sample in which it leaves."
        ),
    )
    return Model(made, own)


def _counted(own: Parts) -> Bool:
    """Return the lemma: samples and axles are those of the true cycle, and the axles of one direction."""
    same = (
        own.axles_upwards.eq(own.true_axles_upwards)
        & own.axles_downwards.eq(own.true_axles_downwards)
        & (own.axles_upwards.eq(0) | own.axles_downwards.eq(0))
    )
    seen = (own.true_axles_upwards <= own.true_samples) & (own.true_axles_downwards <= own.true_samples)
    return own.samples.eq(own.true_samples) & seen & (~own.flawed).implies(same)


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
    """Return whether the head was disturbed, or a wheel left it uncounted or went back on it."""
    free, a_first, both_up, b_last, b_first, both_down, a_last, disturbed = own.head_modes
    uncounted = own.mode_before.ne(free) & own.head_mode.eq(free) & own.counted.eq(NO_AXLE)
    back = ((both_up, a_first), (b_last, both_up), (both_down, b_first), (a_last, both_down))
    went_back = any_of(own.mode_before.eq(far) & own.head_mode.eq(near) for far, near in back)
    return own.head_mode.eq(disturbed) | own.mode_before.eq(disturbed) | uncounted | went_back


def _head_is_damped(own: Parts) -> Bool:
    """Return whether the head was damped, or disturbed, in this sample."""
    return own.mode_before.ne(own.head_modes[0])


# ------------------------------------------------------------------ the world


def _world(own: Parts) -> World:
    """Return the world: the wheels that truly passed in this cycle."""
    over = own.true_samples >= own.cycle_samples

    def after(passed: Num, way: Lit) -> Num:
        more = ite(over, as_num(0, COUNT), passed) + ite(own.passes.eq(way), as_num(1, COUNT), 0)
        return minimum(more, own.cycle_samples)

    return own.declared.world(
        moves={
            own.true_samples: ite(over, as_num(1, COUNT), own.true_samples + 1),
            own.true_axles_upwards: after(own.true_axles_upwards, UP),
            own.true_axles_downwards: after(own.true_axles_downwards, DOWN),
        },
        clauses={
            HEARD: Law(
                own.counted.eq(own.passes),
                "In each sample the head counts the wheel that leaves it on the far side, with its direction, and no other.",
                source="proved of the counting head",
                owner="supplier",
                check="proved in the composition",
            )
        },
    )
