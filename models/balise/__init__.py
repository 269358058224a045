"""Position by balise groups and an odometer between them, supervised by linking (RFL-5, RFL-9, RFL-D4).

    DELOCALIZED  no reference, or lost: nothing is reported
    CANDIDATE    one group was read; nothing is reported until a different group agrees with it
    LOCATED      the front end lies in the reported interval

While located, the map announces the next groups (linking). A group may set the position only if it is announced, was
read whole and undamaged, in the announced orientation, and inside its expectation window, which opens when the max
safe front end reaches the first place where the group can be read and closes when the min safe front end has passed
the last one (SUBSET-026 3.4.4.4.3). The new interval is what the old one and the telegram have in common: a reset never
widens. Where they exclude each other nothing is believed any more. Whatever is not accepted leaves the interval as it
was, and says why.

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
    NumVar,
    Var,
    all_of,
    between,
    ceil_to,
    floor_to,
    ite,
)
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.units import MM
from safeloc.models.balise import variables as v
from safeloc.models.balise.judgement import Judged
from safeloc.models.balise.reckoning import as_reckoned
from safeloc.models.balise.variables import BaliseConfig, Parts, parts
from safeloc.models.balise.world import ODOMETER, is_doubted, world
from safeloc.models.vocabulary.absent import margin_if, position_if
from safeloc.models.vocabulary.interval import Interval
from safeloc.models.vocabulary.reasons import CONTRADICTION, LOCATED, SENSOR_FAILURE, TOLERANCE

__all__ = ["ODOMETER", "Balise", "build", "machine"]


def machine(config: BaliseConfig | None = None) -> Machine:
    """The balise machine of a vehicle (RFL-5, RFL-9, RFL-D4)."""
    return build(parts(config or BaliseConfig())).machine


@dataclass(frozen=True, eq=False)
class Balise:
    """The machine together with the terms it was built from, for properties to speak about."""

    machine: Machine
    own: Parts
    judged: Judged


def build(own: Parts) -> Balise:
    """The machine over the given variables."""
    waits = [] if own.config.trust_first_group else ["CANDIDATE"]
    mode = modes("DELOCALIZED", *waits, "LOCATED")
    current = current_mode(mode)
    located = current.eq(mode[-1])
    judged = Judged(own, located, current.eq(mode[1]) if waits else FALSE)
    made = Machine(
        name="balise",
        modes=mode,
        inputs=own.inputs,
        state=own.state(),
        outputs=_outputs(own, located),
        transitions=[*_located(own, judged, mode), *_unlocated(own, judged, mode)],
        world=world(own),
        lemmas=_lemmas(own, current, mode),
        definitions=_definitions(judged),
        doc=(
            "Position of the front end from balise groups and an odometer between them. What is assumed of odometer, antenna and "
            "map stands in the laws of its world. Nothing is assumed of a telegram that is corrupted or incomplete, or of a group "
            "passed the wrong way; a group that is not where the map has it is far off."
        ),
    )
    return Balise(made, own, judged)


# ------------------------------------------------------------------ the transition table


def _located(own: Parts, cycle: Judged, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Transitions out of the mode that reports a position."""
    lost, located = mode[0], mode[-1]
    told = {**cycle.listen(), **cycle.supervise()}
    reset = {**told, **cycle.remember(), **own.held.become(cycle.narrowed)}
    kept = {**told, **cycle.carry_on(), **own.held.become(cycle.run_on)}
    acted: dict[Var, Expr] = {var: told[var] for var in (own.memory.reaction, own.memory.ended, own.linking.judged)}
    accepted, rejected = cycle.accepted, cycle.announced & ~cycle.accepted
    expected = cycle.sightings[0].seen

    def drop(reason: Lit) -> dict[Var, Expr]:
        return {**told, **cycle.unsupervised(), **acted, **cycle.forget(), own.memory.reason: reason}

    def judged(*verdicts: Lit) -> Bool:
        return rejected & cycle.verdict.one_of(*verdicts)

    def stay(name: str, when: Bool, updates: dict[Var, Expr], trace: tuple[str, ...], rank: int) -> Transition:
        return Transition(name, located, located, when, updates, trace, rank)

    after = ~cycle.usable(cycle.narrowed) & accepted | ~cycle.usable(cycle.run_on) & ~accepted
    yield Transition("sensors failed", located, lost, own.odometer.failed, drop(SENSOR_FAILURE), ("RFL-D4",), 0)
    yield Transition("contradiction", located, lost, judged(v.CONTRADICTED), drop(CONTRADICTION), ("RFL-D4",), 1)
    yield Transition("tolerance exceeded", located, lost, after, drop(TOLERANCE), ("RFL-D4",), 2)
    yield stay("expected group resets the position", accepted & expected, reset, ("RFL-5", "RFL-9", "RFL-D4"), 3)
    later = accepted & cycle.announced & ~expected
    yield stay("later group resets the position", later, reset, ("RFL-5", "RFL-9", "RFL-D4"), 3)
    if own.config.free_references:
        free = accepted & ~cycle.announced
        yield stay("group without linking resets the position", free, reset, ("RFL-5", "RFL-9"), 3)
    outside, unfit = judged(v.TOO_EARLY, v.TOO_LATE), judged(v.INCOMPLETE, v.MISMATCH)
    yield stay("group passed in the wrong direction", judged(v.WRONG_DIRECTION), kept, ("RFL-D4",), 4)
    yield stay("group found outside its window", outside, kept, ("RFL-D4",), 4)
    yield stay("group incomplete or not as announced", unfit, kept, ("RFL-D4",), 4)
    yield stay("expected group missed", cycle.missed, kept, ("RFL-D4",), 5)
    yield stay("telegram rejected", ~own.read.silent, kept, ("RFL-D4",), 6)
    yield stay("run on", TRUE, kept, ("RFL-D4",), 7)


def _unlocated(own: Parts, cycle: Judged, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Transitions out of the modes that report nothing."""
    lost, located = mode[0], mode[-1]
    told = {**cycle.listen(), **cycle.unsupervised()}
    first = {**told, **cycle.remember(), **own.held.become(cycle.fix)}
    sure = {**first, own.memory.reason: LOCATED}
    if own.config.trust_first_group:
        yield Transition("first group is trusted", lost, located, cycle.accepted, sure, ("RFL-5",), 8)
    else:
        yield from _candidate(cycle, mode, told, first, sure)
    yield Transition("wait for a group", lost, lost, set=told, requirements=("RFL-D4",), rank=10)


def _candidate(
    cycle: Judged, mode: tuple[Lit, ...], told: dict[Var, Expr], first: dict[Var, Expr], sure: dict[Var, Expr]
) -> Iterator[Transition]:
    """A first group waits for a different one that agrees with it."""
    lost, candidate, located = mode
    carried = {**told, **cycle.carry_on(), **cycle.own.held.become(cycle.run_on)}
    is_candidate = cycle.verdict.eq(v.CANDIDATE)
    gone = cycle.own.odometer.failed | ~cycle.usable(cycle.run_on)
    yield Transition("group is a candidate", (lost, candidate), candidate, is_candidate, first, ("RFL-D4",), 8)
    yield Transition("group confirms the candidate", candidate, located, cycle.accepted, sure, ("RFL-5", "RFL-D4"), 8)
    yield Transition("candidate lost", candidate, lost, gone, {**told, **cycle.forget()}, ("RFL-D4",), 9)
    yield Transition("carry the candidate", candidate, candidate, set=carried, requirements=("RFL-D4",), rank=10)


def _definitions(cycle: Judged) -> dict[str, Expr]:
    """Names for what the table speaks of."""
    named: dict[str, Expr] = {
        "telegram judged": cycle.verdict,
        "telegram accepted": cycle.accepted,
        "expected group missed": cycle.missed,
        "announced groups given up": cycle.ended,
        "linking reaction": cycle.reaction,
        "announcement judged": cycle.announcement,
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
        "odometer": own.odometer.judged,
        "telegram": memory.verdict,
        "linking": own.linking.judged,
        "reaction": memory.reaction,
        "missed_in_row": memory.missed,
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
    """What the machine keeps of inputs is what the world knows of them."""
    seen, told, odometer = own.world, own.national, own.odometer
    found = {
        "the national accuracy is the one received": seen.national.eq(
            ite(told.known, told.kept, own.config.default_accuracy_mm)
        ),
        "the heading is the measured one": own.heading.backwards.iff(seen.backwards)
        & own.heading.rolled.eq(seen.rolled),
    }
    if not own.config.told_distance:
        gated = odometer.gap.eq(seen.silent) & odometer.last.eq(seen.heard)
        found["the odometer is gated as the world would"] = gated
    return found
