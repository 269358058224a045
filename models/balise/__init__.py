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

from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    NumVar,
    Var,
    abs_,
    all_of,
    between,
    ceil_to,
    exact_to,
    floor_to,
    ite,
)
from safeloc.language.machine import ANY, Initial, Machine, Transition, current_mode, modes
from safeloc.language.units import MM, NM, PPM
from safeloc.language.world import Law, World
from safeloc.models.balise import variables as v
from safeloc.models.balise.judgement import Judged
from safeloc.models.balise.reckoning import as_reckoned
from safeloc.models.balise.telegram import LINKED
from safeloc.models.balise.variables import BaliseConfig, Parts, parts
from safeloc.models.vocabulary.absent import margin_if, position_if
from safeloc.models.vocabulary.interval import Interval
from safeloc.models.vocabulary.reasons import CONTRADICTION, LOCATED, SENSOR_FAILURE, TOLERANCE


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
    ghosts, moves, choices = _world(own)
    made = Machine(
        name="balise",
        modes=mode,
        inputs=own.inputs,
        state=own.state(),
        outputs=_outputs(own, located),
        transitions=[*_located(own, judged, mode), *_unlocated(own, judged, mode)],
        world=World(
            ghosts=ghosts,
            choices=choices,
            moves=moves,
            clauses=_clauses(own, judged),
            reads_machine="its clauses still assume what passes the machine's own checks",
        ),
        lemmas=_lemmas(own, current, mode),
        definitions=_definitions(judged),
        mode_variable=current,
        doc=(
            "Position of the front end from balise groups and an odometer between them. Assumed: admitted distances obey "
            "the odometer's error law; no cycle runs farther than the highest speed allows; a group that the map "
            "announces, read whole, undamaged, recent, in the announced orientation and inside its window, lies where "
            "the map has it within its location accuracy and the antenna's detection accuracy, and since it was read "
            "the vehicle has run no farther than its highest speed, or the latched counter, allows. The same is assumed "
            "of a group that confirms a candidate. Nothing is assumed of any other telegram: corrupted, incomplete, "
            "foreign, displaced or passed the wrong way."
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


# ------------------------------------------------------------------ the environment, and what helps to prove


def _world(own: Parts) -> tuple[dict[Var, Initial], dict[Var, Expr], list[Var]]:
    world = own.world
    moves: dict[Var, Expr] = {world.truth: world.truth + world.true_step, world.wander: _wander_after(own)}
    choices: list[Var] = [
        world.true_step, world.next_wander, world.place_error, world.true_since, world.reading_wander
    ]  # fmt: skip
    return {world.truth: ANY, world.wander: ANY}, moves, choices


def _wander_after(own: Parts) -> Num:
    """Of a distance that comes judged it may move in every cycle: whatever it does is charged."""
    told = TRUE if own.config.told_distance else own.odometer.admitted
    return ite(told, own.world.next_wander, own.world.wander)


ODOMETER = "the odometer keeps its law"
"""The clause that an earlier machine can be made to keep, if it judges the distance."""


def _odometer_law(own: Parts) -> Bool:
    """What a cycle is charged covers what its distance misses."""
    world, odometer = own.world, own.odometer
    error = world.true_step - exact_to(odometer.distance, NM) - (_wander_after(own) - world.wander)
    return between(-odometer.growth, error, odometer.growth)


def _clauses(own: Parts, cycle: Judged) -> dict[str, Law]:
    """The truth of telegrams that can be believed, the odometer, and the vehicle staying on the line."""
    world = own.world
    after = world.truth + world.true_step
    return {
        "a telegram that can be believed was read where the map says": Law(
            believable(cycle).implies(_read_truly(own, cycle, after)),
            "A group that agrees with map, linking and orientation was read where the map has it, within the accuracies of map and "
            "antenna; since then the vehicle ran no farther than it is charged.",
            source="[S] openETCS: location accuracy of linking and 1 m; [M] the 1 m is the detection accuracy of SUBSET-036",
            owner="infrastructure",
            check="every rejected group is counted and reported with its reason",
        ),
        "the vehicle stays on the line": Law(
            between(world.truth.low, after, world.truth.high),
            "The vehicle does not leave the coordinates of the line.",
            ("position_limit_mm",),
            "[D] 1 000 km of line",
            "operator",
            "route setting",
        ),
        ODOMETER: Law(
            _odometer_law(own),
            "What the odometer measures in an admitted cycle is wrong by no more than its rate and floor allow.",
            source="[S] SUBSET-041: 5 m + 5 % of every measured distance",
            owner="supplier",
            check="type test; in operation the run between two groups against the map",
        ),
    }


def believable(cycle: Judged) -> Bool:
    """The telegrams of which something is assumed, in terms of what was read; no matter what the machine makes of them."""
    read = cycle.own.read
    whole = cycle.credible & read.complete & ~read.against(cycle.orientation)
    placed = read.place.present & (read.link.value.eq(LINKED) | read.total.value.ne(1))
    linked = cycle.announced & cycle.inside & cycle.matches
    confirming = cycle.candidate & placed & read.group.value.ne(cycle.own.memory.group)
    agreeing = cycle.agrees & (linked | confirming | (cycle.free & placed))
    if not cycle.own.config.trust_first_group:
        return whole & agreeing
    first = ~cycle.located & ~cycle.candidate & placed
    return whole & (agreeing | first)


def _read_truly(own: Parts, cycle: Judged, after: Num) -> Bool:
    """The front end is where the group's place, the antenna, the errors and the run since the reading put it."""
    world, read, reader = own.world, own.read, own.config.reader
    front = exact_to(cycle.place + reader.antenna_mm, NM) + world.place_error + world.true_since
    spread = exact_to(cycle.accuracy + reader.detection_mm, NM)
    return all_of(
        [
            after.eq(front),
            between(-spread, world.place_error, spread),
            ite(read.since.present, _since_by_counter(own), _since_by_age(own)),
        ]
    )


def _since_by_counter(own: Parts) -> Bool:
    """What the latched counter says, with the odometer's law."""
    world, since = own.world, own.read.since.value
    error = world.true_since - exact_to(since, NM) - (_wander_after(own) - world.reading_wander)
    most = abs_(since) * Lit(own.config.odometer.rate_ppm, PPM)
    return between(-most, error, most)


def _since_by_age(own: Parts) -> Bool:
    """No farther than the age at the highest speed, in the direction that the cycle was measured in."""
    back, forth = own.config.reader.run_since(own.read, own.odometer.distance, own.odometer.admitted)
    return between(-back, own.world.true_since, forth)


def _lemmas(own: Parts, current: NumVar, mode: tuple[Lit, ...]) -> dict[str, Bool]:
    lost, located = mode[0], mode[-1]
    interval: Interval = own.held.interval
    half = own.config.odometer.wander_nm
    off = own.world.truth - interval.position - own.world.wander
    inside = between(half - interval.below, off, interval.above - half)
    usable = interval.usable(own.config.tolerance_mm, own.config.position_limit_mm)
    return {
        "the interval holds the truth": current.eq(located).implies(inside),
        "an interval is usable wherever there is one": current.ne(lost).implies(usable),
        "the margin is at most what the audit reckons": as_reckoned(own),
        "nothing is announced while nothing is reported": current.ne(located).implies(own.linking.slots[0].group.eq(0)),
    }
