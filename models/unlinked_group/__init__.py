"""The last unlinked balise group as a reference of its own, beside the position that linked groups give (RFL-9, RFL-D4).

    NONE  no unlinked group was read, or its distance is no longer known: nothing is reported
    HELD  the distance of the front end beyond the group lies in the reported interval

Distances that a balise group tells count from its own balise 1 (SUBSET-026 3.6.2.1.1). For an unlinked group no map or linking
tells where that is, and the position of the front end is not set by it. So its distance is measured from the reading on: the
place of the antenna at the reading, the odometer's distance since then, and the over-reading and the under-reading of both.

    taken      an unlinked group of two or more balises, read whole and undamaged, recently, while running forwards
    withdrawn  when the odometer is silent too long, when the vehicle has turned, or beyond the tolerance or the reach of packets

The machine reads no position and no linking, so that neither depends on the other. Of groups marked as linked it takes none.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import TRUE, Bool, Expr, Lit, Num, as_num, between, ceil_to, exact_to, ite, minimum
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import MM, NM
from safeloc.models.balise.telegram import LINKED, UNKNOWN
from safeloc.models.unlinked_group import variables as v
from safeloc.models.unlinked_group.variables import Parts, UnlinkedGroupConfig, parts
from safeloc.models.unlinked_group.world import world
from safeloc.models.vocabulary.absent import margin_if, position_if
from safeloc.models.vocabulary.first_of import first_of
from safeloc.models.vocabulary.interval import Interval

__all__ = ["UnlinkedGroup", "UnlinkedGroupConfig", "build", "machine", "parts"]
REQUIREMENTS = ("RFL-9", "RFL-D4")


def machine(config: UnlinkedGroupConfig | None = None) -> Machine:
    """Return the machine of the unlinked group of a vehicle (RFL-9, RFL-D4)."""
    return build(parts(config or UnlinkedGroupConfig())).machine


UnlinkedGroup = Model[Parts]


def build(own: Parts) -> UnlinkedGroup:
    """Build the machine over the given variables."""
    table = modes("NONE", "HELD")
    held = current_mode(table).eq(table[1])
    cycle = Cycle(own)
    made = own.declared.machine(
        name="unlinked_group",
        modes=table,
        outputs=_outputs(own, held),
        transitions=list(_rows(own, cycle, table)),
        world=world(own),
        lemmas=_lemmas(own, held),
        definitions={
            "reading judged": cycle.verdict,
            "backwards": cycle.backwards,
            "usable after the run": cycle.usable(cycle.run_on),
            "odometer admitted": own.odometer.admitted,
        },
        doc=(
            "Distance of the front end beyond the last unlinked balise group, from its reading and an odometer. What is assumed "
            "of odometer and antenna stands in the laws of its world. Nothing is assumed of where the group lies, nor of a "
            "telegram that is corrupted or incomplete."
        ),
    )
    return UnlinkedGroup(made, own)


# ------------------------------------------------------------------ terms of a cycle


@dataclass(frozen=True, eq=False)
class Cycle:
    """One cycle: the verdict on the reading, and the interval after it."""

    own: Parts

    @cached_property
    def backwards(self) -> Bool:
        """The vehicle runs backwards after the cycle."""
        return self.own.heading.after(self.own.odometer.distance)[0]

    @cached_property
    def verdict(self) -> Num:
        """Verdict on the reading."""
        read = self.own.read
        return first_of(
            (read.silent, v.NONE),
            (~read.well_formed, v.MALFORMED),
            (read.corrupted, v.CORRUPTED),
            (read.stale, v.STALE),
            (self.backwards, v.REVERSING),
            (read.link.value.eq(LINKED), v.MARKED_LINKED),
            (read.total.value.eq(1), v.SINGLE),
            (~read.complete, v.INCOMPLETE),
            default=v.TAKEN,
        )

    @cached_property
    def taken(self) -> Bool:
        """The group that was read becomes the reference."""
        return self.verdict.eq(v.TAKEN)

    @cached_property
    def first(self) -> Interval:
        """The distance of the front end beyond the group that was read, at the end of the cycle."""
        zero = as_num(0, MM)
        fix = self.own.config.reader.fix(self.own.read, zero, zero, self.own.odometer)
        since = self.own.read.since.value_or(zero)
        return Interval(since + self.own.config.antenna_mm, fix.above, fix.below)

    @cached_property
    def run_on(self) -> Interval:
        """The distance beyond the reference after the cycle, by the odometer."""
        return self.own.odometer.run_on(self.own.held.interval)

    def usable(self, distance: Interval) -> Bool:
        """Return whether both margins are tolerable, and the distance is one that a packet can tell."""
        config = self.own.config
        return distance.within(config.limits.tolerance_nm, config.reach_mm)


# ------------------------------------------------------------------ the transition table


def _rows(own: Parts, cycle: Cycle, table: tuple[Lit, ...]) -> Iterator[Transition]:
    none, held = table
    every, memory = _every(own, cycle), own.memory
    carried: Updates = {memory.age: minimum(memory.age + own.config.period_ms, v.LONGEST_AGE_MS)}
    kept = together(every, own.held.become(cycle.run_on), carried)
    anew = together(every, own.held.become(cycle.first), _reference(own))

    def drop(name: str, when: Bool, why: Lit, rank: int) -> Transition:
        return Transition(name, held, none, when, together(every, {memory.reason: why}), REQUIREMENTS, rank)

    yield Transition("unlinked group read", table, held, cycle.taken, anew, REQUIREMENTS, 0)
    yield drop("sensors failed", own.odometer.failed, v.SENSOR_FAILURE, 1)
    yield drop("turned", cycle.backwards, v.REVERSED, 2)
    yield drop("tolerance or reach exceeded", ~cycle.usable(cycle.run_on), v.TOLERANCE, 3)
    yield Transition("run on", held, held, TRUE, kept, REQUIREMENTS, 4)
    yield Transition("wait for an unlinked group", none, none, TRUE, every, REQUIREMENTS, 4)


def _every(own: Parts, cycle: Cycle) -> Updates:
    """Set by every transition: distance, direction of running, national value, and the verdict on the reading."""
    _, direction = own.heading.after(own.odometer.distance)
    told = own.national
    accuracy: Updates = {
        told.known: told.known | told.national_accuracy.present,
        told.stored: ite(told.national_accuracy.present, told.national_accuracy.value, told.stored),
    }
    return together(own.odometer.listen(), direction, accuracy, {own.memory.verdict: cycle.verdict})


def _reference(own: Parts) -> Updates:
    """The group that was read is the reference."""
    memory = own.memory
    return {
        memory.group: own.read.group.value,
        memory.passed: own.read.passed,
        memory.accuracy: own.national.accuracy,
        memory.age: own.read.age.value,
        memory.reason: v.HELD,
    }


# ------------------------------------------------------------------ what is reported, and what helps to prove


def _outputs(own: Parts, held: Bool) -> dict[str, Expr]:
    """Margins are rounded up, so that the reported interval holds the one in nm."""
    interval, memory = own.held.interval, own.memory
    return {
        "valid": held,
        "group": ite(held, memory.group, 0),
        "passed": ite(held, memory.passed, UNKNOWN),
        "distance_mm": position_if(held, interval.position),
        "margin_above_mm": margin_if(held, ceil_to(interval.above, MM)),
        "margin_below_mm": margin_if(held, ceil_to(interval.below, MM)),
        "location_accuracy_mm": ite(held, memory.accuracy, 0),
        "age_ms": ite(held, memory.age, 0),
        "telegram": memory.verdict,
        "odometer": own.odometer.last_verdict,
        "reason": memory.reason,
    }


def _lemmas(own: Parts, held: Bool) -> dict[str, Bool]:
    seen, told, odometer = own.world, own.national, own.odometer
    interval, half = own.held.interval, own.config.odometer.wander_nm
    off = seen.distance - exact_to(interval.position, NM) - seen.wander
    in_force = ite(told.known, told.stored, own.config.default_accuracy_mm)
    return {
        "the national accuracy is the one received": seen.national_accuracy_sent.eq(in_force),
        "the heading is the measured one": own.heading.backwards.iff(seen.backwards)
        & own.heading.rolled.eq(seen.rolled),
        "machine and world agree on the last odometer distance": odometer.gap.eq(seen.silent)
        & odometer.last.eq(seen.last_delivered),
        "the interval holds the true distance": held.implies(
            between(half - interval.below, off, interval.above - half)
        ),
        "a reference has a group": held.implies(own.memory.group.ne(0)),
    }
