"""Position along the track from selected satellites (SAT-5, SAT-6), predicted from the state before and the map alone.

The state is where the vehicle is along the track and how fast it is, each with its margin. In every cycle it is
predicted with constant acceleration (source [0042]). A solution counts only if every satellite in it is usable in this
very cycle, if there are enough of them, and if it meets the prediction. Without one the state coasts, its margins
growing, for a limited time.

    UNLOCATED   nothing is reported; left only through a trusted reference
    LOCATED     a solution counted in this cycle, or a reference
    COASTING    predicted; margins grow

Distances are mm and nm along the mapped track, speeds um/s.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.composition import Composition, compose
from safeloc.expr import (
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    Var,
    abs_,
    all_of,
    any_of,
    as_num,
    between,
    ceil_to,
    exact_to,
    floor_to,
    ite,
    minimum,
)
from safeloc.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.models.satellite_parts.variables import (
    ACCEPTED,
    COASTED_OUT,
    CONTRADICTION,
    DISJOINT,
    LOCATED,
    NM_PER_MM,
    NO_FIX,
    NO_REFERENCE,
    NOT_LOCATED,
    NOT_USABLE,
    TOLERANCE,
    TOO_COARSE,
    TOO_FEW,
    Parts,
    SatelliteConfig,
    State,
    meet,
    parts,
)
from safeloc.models.satellite_selection import USABLE, Selection
from safeloc.models.satellite_selection import build as build_selection
from safeloc.models.satellite_selection import parts as selection_parts
from safeloc.units import COUNT, MM, MS, NM, UM_S


@dataclass(frozen=True, eq=False)
class Satellite:
    """Selection and position in one step, with the terms they were built from."""

    selection: Selection
    machine: Machine
    own: Parts
    composition: Composition


def compose_machines(config: SatelliteConfig | None = None) -> Satellite:
    """Both machines: the position sees the list of usable satellites of the same cycle (SAT-5)."""
    config = config or SatelliteConfig()
    selection = build_selection(selection_parts(config.selection))
    own = parts(config)
    machine = build(own)
    wires: dict[Var, Expr] = {
        told: one.standing.eq(USABLE) for told, one in zip(own.usable, selection.own.channels, strict=True)
    }
    return Satellite(selection, machine, own, compose("satellite", [selection.machine, machine], wires))


def build(own: Parts) -> Machine:
    """The position machine over the given variables."""
    table = modes("UNLOCATED", "LOCATED", "COASTING")
    current = current_mode(table)
    valid = current.one_of(*table[1:])
    return Machine(
        name="position",
        modes=table,
        inputs=[
            *own.usable, *own.used, own.fix, own.protection, own.fix_speed, own.speed_protection, own.reference, own.accuracy,
        ],
        state={
            own.position: 0, own.margin: 0, own.speed: 0, own.speed_margin: 0, own.change: 0, own.coasted: 0,
            own.judged: NO_FIX, own.reason: NO_REFERENCE,
        },
        outputs={
            "valid": valid,
            "position_mm": ite(valid, floor_to(own.position, MM), 0),
            "under_mm": ite(valid, ceil_to(own.margin, MM), 0),
            "over_mm": ite(valid, ceil_to(own.margin, MM) + 1, 0),
            "coasting": current.eq(table[2]),
            "fix": own.judged,
            "reason": own.reason,
        },
        transitions=list(_table(own, table, valid)),
        ghosts={own.truth: ANY, own.true_speed: ANY},
        ghost_inputs=[own.next_truth, own.next_speed],
        ghost_moves={own.truth: own.next_truth, own.true_speed: own.next_speed},
        assumption=_assumption(own),
        lemmas=_lemmas(own, current, table),
        mode_variable=current,
        doc=(
            "Position along the mapped track from usable satellites. Assumed: speed changes by no more than the greatest "
            "acceleration allows; where every satellite of a solution is usable, the solution is within its protection "
            "level (which follows from the bound of each used satellite); a reference is within its accuracy. A common "
            "drift of all satellites within their bounds, cycle by cycle, is not noticed without a reference."
        ),
    )  # fmt: skip


# ------------------------------------------------------------------ what a cycle knows


def predicted(own: Parts) -> State:
    """The state E* from the state before alone: constant acceleration along the track (SAT-1, [0042])."""
    config, period = own.config, Lit(own.config.period_ms, MS)
    half = exact_to(own.change * Lit(config.period_ms // 2, MS), NM)
    way = as_num(config.way_nm, NM)
    return State(
        own.position + exact_to(own.speed * period, NM) + half,
        own.margin + exact_to(own.speed_margin * period, NM) + abs_(half) + way,
        own.speed + own.change,
        own.speed_margin + abs_(own.change) + config.speed_change_um_s,
    )


def solved(own: Parts) -> State:
    """What the solution says."""
    return State(exact_to(own.fix.value, NM), exact_to(own.protection, NM), own.fix_speed, own.speed_protection)


def verdict(own: Parts, located: Bool) -> Num:
    """What becomes of the solution, with the reason where it does not count."""
    foreign = any_of(used & ~usable for used, usable in zip(own.used, own.usable, strict=True))
    few = _count(own) < own.config.minimum_satellites
    coarse = own.protection > own.config.protection_limit_mm
    meets = solved(own).meets(predicted(own))
    judged = ite(coarse, TOO_COARSE, ite(meets, ACCEPTED, DISJOINT))
    judged = ite(foreign, NOT_USABLE, ite(few, TOO_FEW, judged))
    return ite(own.fix.present, ite(located, judged, NOT_LOCATED), NO_FIX)


def _count(own: Parts) -> Num:
    total = as_num(0, COUNT)
    for used in own.used:
        total = total + ite(used, as_num(1, COUNT), 0)
    return total


def _narrowed(first: State, second: State) -> State:
    """The one with the smaller margin, place and speed apart: both hold the truth."""
    nearer, steadier = second.margin <= first.margin, second.speed_margin <= first.speed_margin
    return State(
        ite(nearer, second.position, first.position),
        ite(nearer, second.margin, first.margin),
        ite(steadier, second.speed, first.speed),
        ite(steadier, second.speed_margin, first.speed_margin),
    )


def _usable(own: Parts, state: State) -> Bool:
    """It may be reported: margin within the tolerance when rounded, place and speed in range."""
    config = own.config
    fast = config.max_speed_mm_s * 1_000
    limit = config.position_limit_mm * NM_PER_MM
    return all_of(
        [
            state.margin <= (config.tolerance_mm - 2) * NM_PER_MM,
            between(-limit, state.position, limit),
            between(-fast, state.speed, fast),
        ]
    )


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, table: tuple[Lit, ...], valid: Bool) -> Iterator[Transition]:
    lost, located, coasting = table
    config, carried = own.config, (located, coasting)
    trace, judged = ("SAT-5",), verdict(own, valid)
    ahead, fast = predicted(own), config.max_speed_mm_s * 1_000
    none = as_num(0, COUNT)
    known = State(exact_to(own.reference.value, NM), exact_to(own.accuracy, NM), as_num(0, UM_S), as_num(fast, UM_S))
    referred = _narrowed(ahead, known)
    fixed = _narrowed(ahead, solved(own))

    def become(state: State, coasted: Num) -> dict[Var, Expr]:
        return {**_become(own, state), own.coasted: coasted, own.judged: judged, own.reason: LOCATED}

    def drop(reason: Lit) -> dict[Var, Expr]:
        nothing = State(as_num(0, NM), as_num(0, NM), as_num(0, UM_S), as_num(0, UM_S))
        return {**become(nothing, none), own.change: as_num(0, UM_S), own.reason: reason}

    begin = own.reference.present & _usable(own, known)
    yield Transition(
        "trusted reference", lost, located, begin, {**become(known, none), own.change: as_num(0, UM_S)}, trace, 0
    )
    yield Transition("wait for a reference", lost, lost, TRUE, {own.judged: judged}, trace, 1)
    clash = own.reference.present & ~meet(known.bounds, ahead.bounds)
    yield Transition("reference contradicts", carried, lost, clash, drop(CONTRADICTION), ("SAT-5", "SAT-1"), 2)
    better = own.reference.present & _usable(own, referred)
    yield Transition("reference while located", carried, located, better, become(referred, none), trace, 3)
    good = judged.eq(ACCEPTED) & _usable(own, fixed)
    yield Transition("solution counts", carried, located, good, become(fixed, none), trace, 4)
    over = own.coasted >= config.coast_limit_cycles
    yield Transition("coasted too long", carried, lost, over, drop(COASTED_OUT), ("SAT-1", "SAT-5"), 5)
    yield Transition("tolerance exceeded", carried, lost, ~_usable(own, ahead), drop(TOLERANCE), trace, 6)
    longer = minimum(own.coasted + 1, config.coast_limit_cycles)
    yield Transition("coast", carried, coasting, TRUE, become(ahead, longer), ("SAT-1",), 7)


def _become(own: Parts, state: State) -> dict[Var, Expr]:
    """The state, and the change of speed that the next prediction goes on with, if a vehicle can have it."""
    change, most = state.speed - own.speed, own.config.speed_change_um_s
    return {
        own.position: state.position,
        own.margin: state.margin,
        own.speed: state.speed,
        own.speed_margin: minimum(state.speed_margin, own.speed_margin.high),
        own.change: ite(between(-most, change, most), change, as_num(0, UM_S)),
    }


# ------------------------------------------------------------------ the environment, and what helps to prove


def _assumption(own: Parts) -> Bool:
    """The movement of the vehicle; solutions of usable satellites and references are true within their bounds."""
    config, period = own.config, Lit(own.config.period_ms, MS)
    ran = own.next_truth - own.truth - exact_to(own.true_speed * period, NM)
    sped = own.next_speed - own.true_speed
    only_usable = all_of(usable | ~used for used, usable in zip(own.used, own.usable, strict=True))
    off, off_speed = own.next_truth - exact_to(own.fix.value, NM), own.next_speed - own.fix_speed
    solution = between(-exact_to(own.protection, NM), off, exact_to(own.protection, NM)) & between(
        -own.speed_protection, off_speed, own.speed_protection
    )
    beside, accuracy = own.next_truth - exact_to(own.reference.value, NM), exact_to(own.accuracy, NM)
    enough = _count(own) >= config.minimum_satellites
    return all_of(
        [
            between(-config.way_nm, ran, config.way_nm),
            between(-config.speed_change_um_s, sped, config.speed_change_um_s),
            (own.fix.present & only_usable & enough).implies(solution),
            own.reference.present.implies(between(-accuracy, beside, accuracy)),
        ]
    )


def _lemmas(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    lost, located, _ = table
    fast = own.config.max_speed_mm_s * 1_000
    inside = between(own.position - own.margin, own.truth, own.position + own.margin)
    speed = between(own.speed - own.speed_margin, own.true_speed, own.speed + own.speed_margin)
    return {
        "the truth is inside": current.ne(lost).implies(inside & speed),
        "margins are tolerable": own.margin <= (own.config.tolerance_mm - 2) * NM_PER_MM,
        "nothing while unlocated": current.eq(lost).implies(own.coasted.eq(0) & own.margin.eq(0)),
        "speed in range": between(-fast, own.speed, fast),
        "coasting counts": current.eq(located).implies(own.coasted.eq(0)),
    }
