"""Position along the track from selected satellites (SAT-5, SAT-6), predicted from the state before and the map alone.

The state is the place of the vehicle along the track and its speed, each with bounds. In every cycle it is predicted with
constant acceleration (source [0042]). A solution is used only if every satellite in it is usable in this very cycle, if there
are enough of them, if it meets the prediction, and if it does not contradict odometry since the last reference, where that is
present. Without a solution the state coasts with growing margins, for a limited time.

    UNLOCATED   nothing is reported; left only through a trusted reference
    LOCATED     a solution or a reference was used in this cycle
    COASTING    predicted; margins grow

Distances are mm and nm along the mapped track, speeds um/s.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import (
    FALSE,
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
    floor_to,
    ite,
    minimum,
)
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM, UM_S
from safeloc.models.satellite.anchor import Anchor, carried
from safeloc.models.satellite.lemmas import lemmas
from safeloc.models.satellite.motion import (
    confirmed,
    fixed,
    predicted,
    protection_level,
    referred,
    reportable,
    solved,
)
from safeloc.models.satellite.variables import (
    ACCEPTED,
    COASTED_OUT,
    CONTRADICTION,
    DISJOINT,
    DRIFT,
    DRIFTED,
    LOCATED,
    MISSING,
    NO_FIX,
    NOT_LOCATED,
    NOT_USABLE,
    SPARE,
    TOLERANCE,
    TOO_COARSE,
    TOO_FEW,
    Parts,
    SatelliteConfig,
    State,
    held,
    parts,
)
from safeloc.models.satellite.world import SELECTED, Trusted, can_stop, hidden_errors, signal_errors, world
from safeloc.models.satellite_selection import USABLE, Channel, Selection
from safeloc.models.satellite_selection import build as build_selection
from safeloc.models.satellite_selection import parts as selection_parts
from safeloc.models.vocabulary.absent import margin_if, position_if

NAMES: dict[Trusted, str] = {"satellites": "satellite", "odometry": "satellite_drift"}
_ASSUMED: dict[Trusted, str] = {
    "satellites": (
        "the error of a solution is no more than its dilution times the bound of the signals, and the further error reported "
        "with it, if every satellite in it keeps the bound; and the prediction and the clock that signals are compared with are as "
        "good as configured. It is proved that usable satellites then keep the bound. A common drift of all satellites within "
        "their bounds, cycle by cycle, is noticed only by a reference, or by odometry where that is present."
    ),
    "odometry": "the error of the run that odometry gives is within its bound. Nothing is assumed of any solution.",
}


@dataclass(frozen=True, eq=False)
class Satellite:
    """Selection and position in one step, with the terms they were built from."""

    selection: Selection
    machine: Machine
    own: Parts
    composition: Composition


def compose_machines(config: SatelliteConfig | None = None, trusted: Trusted = "satellites") -> Satellite:
    """Compose selection and position: the position reads the list of usable satellites of the same cycle (SAT-5).

    trusted   selects the assumptions of the proofs; the machines on board are the same
    """
    config = config or SatelliteConfig()
    selection = build_selection(selection_parts(config.selection))
    own = parts(config, signals=trusted == "satellites")
    machine = build(own, trusted)
    wires = selection_wires(own, selection, trusted)
    discharged = [Clause(machine, SELECTED)] if trusted == "satellites" else []
    composition = compose(NAMES[trusted], [selection.machine, machine], wires, discharge=discharged)
    return Satellite(selection, machine, own, composition)


def selection_wires(own: Parts, selection: Selection, trusted: Trusted = "satellites") -> dict[Var, Expr]:
    """Wire each channel to the position machine: its standing, and, of the world, whether its signal keeps its bounds."""
    channels = selection.own.channels
    wires: dict[Var, Expr] = {input_: one.standing.eq(USABLE) for input_, one in zip(own.usable, channels, strict=True)}
    if trusted == "satellites":
        for number, one in enumerate(channels):
            compared, bounded = _true_of_signal(selection, one)
            wires |= {own.compared[number]: compared, own.bounded[number]: bounded}
    return wires


def _true_of_signal(selection: Selection, one: Channel) -> tuple[Bool, Bool]:
    """Return whether prediction and clock are as good as configured, and whether the signal's errors keep their bounds."""
    config, own = selection.own.config, selection.own
    hidden, hidden_speed = hidden_errors(config)
    most, most_speed = signal_errors(config)
    compared, bounded = list[Bool](), list[Bool]()
    if config.compared != "doppler":
        compared.append(between(-hidden, one.prediction - own.clock, hidden))
        bounded.append(between(-most, one.error, most))
    if config.compared != "pseudorange":
        compared.append(between(-hidden_speed, one.prediction_mm_s - own.clock_mm_s, hidden_speed))
        bounded.append(between(-most_speed, one.speed_error, most_speed))
    return all_of(compared), all_of(bounded)


def build(own: Parts, trusted: Trusted = "satellites") -> Machine:
    """Build the position machine over the given variables."""
    table = modes("UNLOCATED", "LOCATED", "COASTING")
    current = current_mode(table)
    valid = current.one_of(*table[1:])
    return own.declared.machine(
        name="position",
        modes=table,
        outputs={
            "valid": valid,
            "position_mm": position_if(valid, floor_to(own.position, MM)),
            "margin_below_mm": margin_if(valid, ceil_to(held(own).below, MM)),
            "margin_above_mm": margin_if(valid, ceil_to(held(own).above, MM) + 1),
            "coasting": current.eq(table[2]),
            "fix": own.last_verdict,
            "missing": own.why_missing,
            "drift_checked": own.anchored,
            "drift_bound_mm": margin_if(own.anchored, ceil_to(abs_(own.anchor_offset) + own.anchor_margin, MM) + 1),
            "reason": own.reason,
        },
        transitions=list(_table(own, table, valid)),
        world=world(own, trusted),
        initially=can_stop(own, own.truth, own.true_speed),
        lemmas=lemmas(own, current, table, trusted),
        doc=(
            "Position along the mapped track from usable satellites. Assumed: speed changes by no more than the greatest "
            "acceleration allows, and the vehicle stops before the coordinates end; "
            f"a reference is within its accuracy; {_ASSUMED[trusted]}"
        ),
    )  # fmt: skip


# ------------------------------------------------------------------ the verdict on the solution


def enough(own: Parts) -> Bool:
    """Return whether the solution uses enough satellites: as many as it has unknowns, and those to detect or exclude a fault."""
    total = as_num(0, COUNT)
    for used in own.used:
        total = total + ite(used, as_num(1, COUNT), 0)
    return total >= own.unknowns + SPARE[own.config.redundancy]


def verdict(own: Parts, located: Bool) -> Num:
    """Return the verdict on the solution: accepted, or why it is not used."""
    foreign = any_of(used & ~usable for used, usable in zip(own.used, own.usable, strict=True))
    coarse = protection_level(own) > own.config.protection_limit_mm * NM_PER_MM
    meets = solved(own).meets(predicted(own))
    drifted = ~carried(own, fixed(own)).holds
    outcome = ite(coarse, TOO_COARSE, ite(meets, ite(drifted, DRIFTED, ACCEPTED), DISJOINT))
    outcome = ite(foreign, NOT_USABLE, ite(enough(own), outcome, TOO_FEW))
    return ite(own.fix.present, ite(located, outcome, NOT_LOCATED), NO_FIX)


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, table: tuple[Lit, ...], valid: Bool) -> Iterator[Transition]:
    lost, located, coasting = table
    on, requirements, outcome = (located, coasting), ("SAT-5",), verdict(own, valid)
    ahead, known, both, found = predicted(own), referred(own), confirmed(own), fixed(own)
    every: Updates = {own.last_verdict: outcome, own.why_missing: ite(own.fix.present, MISSING[0], own.missing)}

    def become(state: State, anchor: Anchor, coasted: Num, change: Num) -> Updates:
        """Return updates that store state, anchor, change of speed, and the cycles since a solution or a reference was used."""
        rest: Updates = {own.coasted: coasted, own.change: change, own.reason: LOCATED}
        return together(every, _state(own, state), _anchor(own, anchor), rest)

    def drop(reason: Lit) -> Updates:
        return together(every, _nothing(own), {own.reason: reason})

    none = as_num(0, COUNT)
    begin = own.reference.present & reportable(own, known)
    start = become(known, _at_reference(own, known), none, as_num(0, UM_S))
    yield Transition("trusted reference", lost, located, begin, start, requirements, 0)
    yield Transition("wait for a reference", lost, lost, TRUE, every, requirements, 1)
    clash = own.reference.present & ~known.meets(ahead)
    yield Transition("reference contradicts", on, lost, clash, drop(CONTRADICTION), ("SAT-5", "SAT-1"), 2)
    better = own.reference.present & reportable(own, both)
    again = become(both, _at_reference(own, both), none, _change(own, both))
    yield Transition("reference while located", on, located, better, again, requirements, 3)
    good = outcome.eq(ACCEPTED) & reportable(own, found)
    solution = become(found, carried(own, found), none, _change(own, found))
    yield Transition("solution counts", on, located, good, solution, requirements, 4)
    over = own.coasted >= own.config.coast_limit_cycles
    yield Transition("coasted too long", on, lost, over, drop(COASTED_OUT), ("SAT-1", "SAT-5"), 5)
    yield Transition("tolerance exceeded", on, lost, ~reportable(own, ahead), drop(TOLERANCE), requirements, 6)
    beside = carried(own, ahead)
    yield Transition("common drift", on, lost, ~beside.holds, drop(DRIFT), ("SAT-1", "SAT-5"), 7)
    longer = minimum(own.coasted + 1, own.config.coast_limit_cycles)
    coast = become(ahead, beside, longer, _change(own, ahead))
    yield Transition("coast", on, coasting, TRUE, coast, ("SAT-1",), 8)


def _state(own: Parts, state: State) -> Updates:
    """Place and speed with their bounds."""
    return {
        own.position: state.position, own.low: state.low, own.high: state.high,
        own.speed: state.speed, own.slowest: state.slowest, own.fastest: state.fastest,
    }  # fmt: skip


def _change(own: Parts, state: State) -> Num:
    """Return the change of the estimated speed, with which the next prediction goes on; 0 where no vehicle can have it."""
    change, most = state.speed - own.speed, own.config.speed_change_um_s
    return ite(between(-most, change, most), change, as_num(0, UM_S))


def _at_reference(own: Parts, state: State) -> Anchor:
    known = referred(own)
    return Anchor(TRUE, state.position - known.position, known.above, TRUE)


def _anchor(own: Parts, anchor: Anchor) -> Updates:
    """The distance of the position from the place that odometry gives, and the error bound of that place."""
    nothing = as_num(0, NM)
    return {
        own.anchored: anchor.kept,
        own.anchor_offset: ite(anchor.kept, anchor.offset, nothing),
        own.anchor_margin: ite(anchor.kept, anchor.margin, nothing),
    }


def _nothing(own: Parts) -> Updates:
    """There is no position."""
    zero = (
        own.position, own.low, own.high, own.speed, own.slowest, own.fastest, own.change, own.coasted, own.anchor_offset,
        own.anchor_margin,
    )  # fmt: skip
    return together({one: as_num(0, one.unit) for one in zero}, {own.anchored: FALSE})
