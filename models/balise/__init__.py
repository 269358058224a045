"""Position by balise groups and an odometer between them, supervised by linking (RFL-5, RFL-9, RFL-D4).

    DELOCALIZED  no reference, or lost: nothing is reported
    CANDIDATE    one group was read; nothing is reported until a different group agrees with it
    LOCATED      the front end lies in the reported interval

While located, the map announces the next groups (linking). A group may set the position only if it is announced, was
read whole and undamaged, in the announced orientation, and inside its expectation window, which opens when the max
safe front end reaches the first place where the group can be read and closes when the min safe front end has passed
the last one (SUBSET-026 3.4.4.4.3). The new interval is what the old one and the telegram have in common: a reset never
widens. Where they exclude each other nothing is believed any more. Whatever is not accepted leaves the interval as it
was, and says why. A single group that is read completely, but not where or as announced, may be a false one; as many in a row
as configured speak against the position, and end it.

The position is that of the front end, in mm along the route, which grows in the direction of travel.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    NumVar,
    abs_,
    all_of,
    as_num,
    between,
    ceil_to,
    floor_to,
    ite,
    minimum,
)
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT, MM, NM
from safeloc.models.balise import variables as v
from safeloc.models.balise.judgement import Judgement
from safeloc.models.balise.linking import EMPTY, NO_REACTION, NOT_LOCATED, NOTHING, Record, Slot
from safeloc.models.balise.reckoning import as_reckoned
from safeloc.models.balise.variables import Ahead, BaliseConfig, Parts, parts
from safeloc.models.balise.world import ODOMETER, is_doubted, world
from safeloc.models.vocabulary.absent import margin_if, position_if
from safeloc.models.vocabulary.interval import Interval
from safeloc.models.vocabulary.reasons import CONTRADICTION, LOCATED, SENSOR_FAILURE, TOLERANCE

__all__ = ["ODOMETER", "Balise", "build", "machine"]


def machine(config: BaliseConfig | None = None) -> Machine:
    """Return the balise machine of a vehicle (RFL-5, RFL-9, RFL-D4)."""
    return build(parts(config or BaliseConfig())).machine


@dataclass(frozen=True, eq=False)
class Balise(Model[Parts]):
    """The machine together with the terms it was built from, for properties to speak about."""

    judgement: Judgement


def build(own: Parts) -> Balise:
    """Build the machine over the given variables."""
    waits = [] if own.config.trust_first_group else ["CANDIDATE"]
    mode = modes("DELOCALIZED", *waits, "LOCATED")
    current = current_mode(mode)
    located = current.eq(mode[-1])
    judgement = Judgement(own, located, current.eq(mode[1]) if waits else FALSE)
    made = own.declared.machine(
        name="balise",
        modes=mode,
        outputs=_outputs(own, located),
        transitions=[*_located(own, judgement, mode), *_unlocated(own, judgement, mode)],
        world=world(own),
        lemmas=_lemmas(own, current, mode),
        definitions=_definitions(judgement),
        doc=(
            "Position of the front end from balise groups and an odometer between them. What is assumed of odometer, antenna and "
            "map stands in the laws of its world. Nothing is assumed of a telegram that is corrupted or incomplete, or of a group "
            "passed the wrong way; a group that is not where the map has it is far off."
        ),
    )
    return Balise(made, own, judgement)


# ------------------------------------------------------------------ the transition table


def _located(own: Parts, cycle: Judgement, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Transitions out of the mode that reports a position."""
    lost, located = mode[0], mode[-1]
    every = together(_seen(own, cycle), _linking_outcome(own, cycle))
    supervised = together(every, _linking(own, cycle))
    reset = together(supervised, _group_counts(own, cycle), own.held.become(cycle.narrowed))
    kept = together(supervised, _run_since_group(own, cycle), own.held.become(cycle.run_on))
    accepted, rejected = cycle.accepted, cycle.announced & ~cycle.accepted
    expected = cycle.sightings[0].seen

    def drop(reason: Lit) -> Updates:
        return together(every, _no_linking(own), _no_position(own), {own.memory.reason: reason})

    def verdict_is(*verdicts: Lit) -> Bool:
        return rejected & cycle.verdict.one_of(*verdicts)

    def stay(name: str, when: Bool, updates: Updates, requirements: tuple[str, ...], rank: int) -> Transition:
        return Transition(name, located, located, when, updates, requirements, rank)

    after = ~cycle.usable(cycle.narrowed) & accepted | ~cycle.usable(cycle.run_on) & ~accepted
    yield Transition("sensors failed", located, lost, own.odometer.failed, drop(SENSOR_FAILURE), ("RFL-D4",), 0)
    yield Transition("contradiction", located, lost, verdict_is(v.CONTRADICTED), drop(CONTRADICTION), ("RFL-D4",), 1)
    yield Transition("tolerance exceeded", located, lost, after, drop(TOLERANCE), ("RFL-D4",), 2)
    yield Transition(
        "announced groups disagree in a row", located, lost, cycle.refuted, drop(CONTRADICTION), ("RFL-D4",), 3
    )
    yield stay("expected group resets the position", accepted & expected, reset, ("RFL-5", "RFL-9", "RFL-D4"), 3)
    later = accepted & cycle.announced & ~expected
    yield stay("later group resets the position", later, reset, ("RFL-5", "RFL-9", "RFL-D4"), 3)
    if own.config.free_references:
        free = accepted & ~cycle.announced
        yield stay("group without linking resets the position", free, reset, ("RFL-5", "RFL-9"), 3)
    outside, unfit = verdict_is(v.TOO_EARLY, v.TOO_LATE), verdict_is(v.INCOMPLETE, v.MISMATCH)
    yield stay("group passed in the wrong direction", verdict_is(v.WRONG_DIRECTION), kept, ("RFL-D4",), 4)
    yield stay("group found outside its window", outside, kept, ("RFL-D4",), 4)
    yield stay("group incomplete or not as announced", unfit, kept, ("RFL-D4",), 4)
    yield stay("expected group missed", cycle.missed, kept, ("RFL-D4",), 5)
    yield stay("telegram rejected", ~own.read.silent, kept, ("RFL-D4",), 6)
    yield stay("run on", TRUE, kept, ("RFL-D4",), 7)


def _unlocated(own: Parts, cycle: Judgement, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Transitions out of the modes that report nothing."""
    lost, located = mode[0], mode[-1]
    every = together(_seen(own, cycle), _no_linking(own), _no_linking_outcome(own))
    first = together(every, _group_counts(own, cycle), own.held.become(cycle.fix))
    sure = together(first, {own.memory.reason: LOCATED})
    if own.config.trust_first_group:
        yield Transition("first group is trusted", lost, located, cycle.accepted, sure, ("RFL-5",), 8)
        yield Transition("wait for a group", lost, lost, TRUE, every, ("RFL-D4",), 10)
        return
    candidate, is_candidate = mode[1], cycle.verdict.eq(v.CANDIDATE)
    gone = own.odometer.failed | ~cycle.usable(cycle.run_on)
    dropped = together(every, _no_position(own))
    carried = together(every, _run_since_group(own, cycle), own.held.become(cycle.run_on))
    yield Transition("group is a candidate", (lost, candidate), candidate, is_candidate, first, ("RFL-D4",), 8)
    yield Transition("group confirms the candidate", candidate, located, cycle.accepted, sure, ("RFL-5", "RFL-D4"), 8)
    yield Transition("candidate lost", candidate, lost, gone, dropped, ("RFL-D4",), 9)
    yield Transition("carry the candidate", candidate, candidate, TRUE, carried, ("RFL-D4",), 10)
    yield Transition("wait for a group", lost, lost, TRUE, every, ("RFL-D4",), 10)


# ------------------------------------------------------------------ groups of updates: what the transitions set


def _seen(own: Parts, cycle: Judgement) -> Updates:
    """Set by every transition: distance, direction of running, national value, and the verdict on the telegram."""
    _, direction = own.heading.after(own.odometer.distance)
    received, national = own.national.national_accuracy, own.national
    accuracy: Updates = {
        national.known: national.known | received.present,
        national.stored: ite(received.present, received.value, national.stored),
    }
    return together(own.odometer.listen(), direction, accuracy, {own.memory.verdict: cycle.verdict})


def _linking(own: Parts, cycle: Judgement) -> Updates:
    """The announced groups without those that are done with, and the groups that were given up."""
    memory, linking = own.memory, own.linking
    groups = linking.after(cycle.left, cycle.announcement)
    return together(
        *(_stores(slot, group) for slot, group in zip(linking.slots, groups, strict=True)),
        {
            memory.given_up_group: cycle.given_up_after,
            memory.missed_in_row: cycle.missed_after,
            memory.refused_in_row: cycle.refused_after,
        },
    )


def _no_linking(own: Parts) -> Updates:
    """No group is announced, so none can be missed or refused."""
    memory, none = own.memory, as_num(0, COUNT)
    nothing: Updates = {memory.given_up_group: none, memory.missed_in_row: none, memory.refused_in_row: none}
    return together(*(_stores(slot, EMPTY) for slot in own.linking.slots), nothing)


def _stores(slot: Slot, group: Record) -> Updates:
    return {
        slot.group: group.group, slot.place: group.place, slot.accurate: group.accurate, slot.accuracy: group.accuracy,
        slot.reaction: group.reaction, slot.orientation: group.orientation,
    }  # fmt: skip


def _linking_outcome(own: Parts, cycle: Judgement) -> Updates:
    """The verdict on the announcement, the number of groups given up, and the reaction."""
    memory = own.memory
    return {
        own.linking.last_verdict: cycle.announcement,
        memory.given_up_now: cycle.ended,
        memory.linking_reaction_now: cycle.reaction,
    }


def _no_linking_outcome(own: Parts) -> Updates:
    """An announcement is refused, and there is no reaction."""
    refused = ite(own.linking.offered.silent, NOTHING, NOT_LOCATED)
    return {
        own.linking.last_verdict: refused,
        own.memory.given_up_now: as_num(0, COUNT),
        own.memory.linking_reaction_now: NO_REACTION,
    }


def _group_counts(own: Parts, cycle: Judgement) -> Updates:
    """The group that was read sets the interval; its telegram gives the next reflector."""
    read, memory, here = own.read, own.memory, cycle.place
    group: Updates = {
        memory.group: read.group.value,
        memory.last_group_position: here,
        memory.accuracy: cycle.accuracy,
        memory.run: abs_(read.since.value_or(as_num(0, MM))),
        memory.measured: read.since.present,
        memory.direction: cycle.direction,
    }
    return together(
        group,
        _lies(own.reflector, read.reflector.present, here + read.reflector.value),
        _lies(own.search, read.search.present, here + read.search.value),
    )


def _run_since_group(own: Parts, cycle: Judgement) -> Updates:
    """The run since the last group grows by the distance; a reflector that was passed is forgotten."""
    memory, passed = own.memory, cycle.run_on.low
    run: Updates = {
        memory.run: minimum(memory.run + abs_(own.odometer.distance), v.FARTHEST_MM),
        memory.measured: memory.measured & own.odometer.admitted,
    }
    places = (own.reflector, own.search)
    return together(run, *(_lies(one, one.lies_ahead(passed), one.place) for one in places))


def _no_position(own: Parts) -> Updates:
    """There is no interval, and no group is remembered."""
    memory = own.memory
    group: Updates = {
        memory.group: as_num(0, COUNT),
        memory.run: as_num(0, MM),
        memory.measured: FALSE,
        memory.direction: v.DIRECTION_UNKNOWN,
    }
    nowhere = Interval(*(as_num(0, NM) for _ in range(3)))
    places = (own.reflector, own.search)
    return together(own.held.become(nowhere), group, *(_lies(one, FALSE, one.place) for one in places))


def _lies(one: Ahead, known: Bool, place: Num) -> Updates:
    """A place ahead; 0 where it is not known."""
    return {one.known: known, one.place: ite(known, place, as_num(0, MM))}


# ------------------------------------------------------------------ terms of the table


def _definitions(cycle: Judgement) -> dict[str, Expr]:
    """Name the terms of the table."""
    named: dict[str, Expr] = {
        "verdict on the telegram": cycle.verdict,
        "telegram accepted": cycle.accepted,
        "expected group missed": cycle.missed,
        "announced groups given up": cycle.ended,
        "announced group disagrees": cycle.disagrees,
        "linking reaction": cycle.reaction,
        "verdict on the announcement": cycle.announcement,
        "backwards": cycle.backwards,
        "odometer admitted": cycle.own.odometer.admitted,
        "place of the group": cycle.place,
        "location accuracy": cycle.accuracy,
        "telegram and interval agree": cycle.agrees,
    }
    for name, interval in (("run on", cycle.run_on), ("telegram", cycle.fix), ("narrowed", cycle.narrowed)):
        ends = {f"{name}: min safe front end": interval.low, f"{name}: max safe front end": interval.high}
        named |= {**ends, f"{name}: position": interval.position, f"{name}: usable": cycle.usable(interval)}
    for number, one in enumerate(cycle.sightings, 1):
        flags = {"read": one.seen, "window open": one.opened, "window closed": one.over}
        named |= {f"announced group {number} {what}": term for what, term in flags.items()}
    return named


# ------------------------------------------------------------------ what is reported


def _outputs(own: Parts, valid: Bool) -> dict[str, Expr]:
    """Interval ends are rounded outward, so that the reported interval holds the one in nm."""
    interval, memory = own.held.interval, own.memory
    position = floor_to(interval.position, MM)
    return {
        "valid": valid,
        "position_mm": position_if(valid, position),
        "margin_above_mm": margin_if(valid, ceil_to(interval.high, MM) - position),
        "margin_below_mm": margin_if(valid, position - floor_to(interval.low, MM)),
        "distance_run_mm": ite(valid, memory.run, 0),
        "run_measured": valid & memory.measured,
        "reference_accepted": valid & memory.verdict.eq(v.ACCEPTED),
        "reason": memory.reason,
        "odometer": own.odometer.last_verdict,
        "telegram": memory.verdict,
        "linking": own.linking.last_verdict,
        "reaction": memory.linking_reaction_now,
        "missed_in_row": memory.missed_in_row,
        "refused_in_row": memory.refused_in_row,
        "wants_linking": valid & own.linking.slots[-1].group.eq(0),
        "expected": own.linking.slots[0].group,
        "direction": memory.direction,
        "reflector_known": valid & own.reflector.known,
        "reflector_mm": ite(valid & own.reflector.known, own.reflector.place, 0),
        "search_known": valid & own.search.known,
        "search_mm": ite(valid & own.search.known, own.search.place, 0),
    }


# ------------------------------------------------------------------ what helps to prove


def _lemmas(own: Parts, current: NumVar, mode: tuple[Lit, ...]) -> dict[str, Bool]:
    lost, located = mode[0], mode[-1]
    interval: Interval = own.held.interval
    half = own.config.odometer.wander_nm
    off = own.world.truth - interval.position - own.world.wander
    inside = between(half - interval.below, off, interval.above - half)
    usable = interval.usable(own.config.tolerance_mm, own.config.position_limit_mm)
    return {
        **_alike(own),
        "the interval holds the truth": current.eq(located).implies(inside),
        "a candidate holds the truth, or it is the false one": current.eq(lost)
        | inside
        | is_doubted(own, own.memory.group),
        "an interval is usable wherever there is one": current.ne(lost).implies(usable),
        "the margin is at most what the audit reckons": as_reckoned(own),
        "nothing is announced while nothing is reported": current.ne(located).implies(own.linking.slots[0].group.eq(0)),
        "no group is held behind an empty place": all_of(
            farther.group.eq(0) | nearer.group.ne(0) for nearer, farther in pairwise(own.linking.slots)
        ),
    }


def _alike(own: Parts) -> dict[str, Bool]:
    """Return the lemmas that machine and world store the same of the inputs."""
    seen, national, odometer = own.world, own.national, own.odometer
    found = {
        "the national accuracy is the one received": seen.national_accuracy_sent.eq(
            ite(national.known, national.stored, own.config.default_accuracy_mm)
        ),
        "the heading is the measured one": own.heading.backwards.iff(seen.backwards)
        & own.heading.rolled.eq(seen.rolled),
    }
    if not own.config.checked_distance:
        gated = odometer.gap.eq(seen.silent) & odometer.last.eq(seen.last_delivered)
        found["machine and world agree on the last odometer distance"] = gated
    return found
