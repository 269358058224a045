"""The track that the vehicle is on, on a map of edges: every one that is possible is carried, and one is told if it is the only one (RFL-D6).

A localizer has one coordinate, the distance along the way that it was announced. Behind a facing switch that number is true on
either branch, and hides the wrong one. This machine carries the tracks on which the vehicle may be: edges of the map, each with
the coordinate at which it begins, so that the localizer's interval gives the interval on each.

    IDLE     no start yet
    ONE      the edge is known
    SEVERAL  more than one edge is possible
    LOST     no position, a contradiction, or more tracks than are carried: nothing is told until the next start

The map stays outside. In each cycle its look-up states what joins the carried edges (`entries`), and the tracks to be carried from now
on (`offers`). The machine does not believe the offers: it takes one only if it follows from a carried track, and if one that
follows is not offered, it tells nothing any more. A balise group, a turn that is seen, a stated position of the points and a
start end tracks. A group that was NOT read ends nothing.

An edge has a direction here: that in which the localizer's coordinate grows. Both directions of one track are two numbers.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import (
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    Var,
    any_of,
    as_num,
    floor_div,
    ite,
    maximum,
    minimum,
)
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT, MM
from safeloc.models.occupied_track.cycle import Cycle, on_one_edge
from safeloc.models.occupied_track.lemmas import lemmas
from safeloc.models.occupied_track.variables import (
    CONTRADICTION,
    NO_EDGE,
    NO_POSITION,
    NO_REASON,
    NOT_ALL_CARRIED,
    OccupiedTrackConfig,
    Parts,
    Slot,
    parts,
)
from safeloc.models.occupied_track.world import on_its_edge, world
from safeloc.models.vocabulary.absent import margin_if, position_if

REQUIREMENTS = ("RFL-D6",)


OccupiedTrack = Model[Parts]


def machine(config: OccupiedTrackConfig | None = None) -> Machine:
    """Return the machine (RFL-D6)."""
    return build(parts(config or OccupiedTrackConfig())).machine


def build(own: Parts) -> OccupiedTrack:
    """Return the machine over the given variables."""
    table = modes("IDLE", "ONE", "SEVERAL", "LOST")
    current, cycle = current_mode(table), Cycle(own)
    kept = cycle.kept
    made = own.declared.machine(
        name="occupied_track",
        modes=table,
        outputs=_outputs(own, current, table),
        transitions=list(_table(own, cycle, kept, table)),
        world=world(own),
        initially=on_its_edge(own),
        lemmas=lemmas(own, current, table),
        definitions={
            "every possible track is offered": cycle.all_offered,
            **{f"offer {number} is taken": one for number, one in enumerate(kept, 1)},
        },
        doc=(
            "The edges of the map on which the vehicle may be, each with the localizer's interval on it, and the one on which it is, "
            "if no other is possible. Assumed: the localizer's interval holds the front end; of the edge on which the vehicle is, the map "
            "has the length and every edge that joins it; no edge is shorter than a cycle's run; a start names the true track; "
            "groups, turns and points that are told are those of the vehicle. Nothing is assumed of the other edges."
        ),
    )
    return OccupiedTrack(made, own)


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, cycle: Cycle, kept: tuple[Bool, ...], table: tuple[Lit, ...]) -> Iterator[Transition]:
    idle, one_edge, several, lost = table
    carried, silent = (one_edge, several), (idle, lost)
    inside: Updates = {own.given_low: own.low, own.given_high: own.high, own.reason: NO_REASON}
    run_on, begun = together(_taken(own, kept), inside), together(_begun(own), inside)
    alike = on_one_edge(tuple(offer.edge for offer in own.offers), kept)
    yield Transition("start", silent, one_edge, cycle.begins, begun, REQUIREMENTS, 0)
    yield Transition("position lost", carried, lost, ~cycle.located, _nothing(own, NO_POSITION), REQUIREMENTS, 0)
    yield Transition(
        "more than carried", carried, lost, ~cycle.all_offered, _nothing(own, NOT_ALL_CARRIED), REQUIREMENTS, 1
    )
    yield Transition("no track fits", carried, lost, ~any_of(kept), _nothing(own, CONTRADICTION), REQUIREMENTS, 2)
    yield Transition("one edge is left", several, one_edge, alike, run_on, REQUIREMENTS, 3)
    yield Transition("run on along one edge", one_edge, one_edge, alike, run_on, REQUIREMENTS, 3)
    yield Transition("tracks part", one_edge, several, TRUE, run_on, REQUIREMENTS, 4)
    yield Transition("run on along several", several, several, TRUE, run_on, REQUIREMENTS, 4)
    yield Transition("wait for a start", idle, idle, TRUE, {}, REQUIREMENTS, 5)
    yield Transition("stay lost", lost, lost, TRUE, {}, REQUIREMENTS, 5)


def _taken(own: Parts, kept: tuple[Bool, ...]) -> Updates:
    """Return the updates of the slots: the offers that are kept."""
    updates: dict[Var, Expr] = {}
    for slot, offer, one in zip(own.slots, own.offers, kept, strict=True):
        updates[slot.edge] = ite(one, offer.edge, NO_EDGE)
        updates[slot.origin] = ite(one, offer.origin, 0)
        updates[slot.length] = ite(one, offer.length, slot.length.low)
    return updates


def _begun(own: Parts) -> Updates:
    """Return the updates of the slots at a start: its track is the only one."""
    first, *others = own.slots
    start: Updates = {first.edge: own.start_edge, first.origin: own.start_origin, first.length: own.start_length}
    return together(start, *(_empty(slot) for slot in others))


def _nothing(own: Parts, reason: Lit) -> Updates:
    """Return the updates after which nothing is carried, for this reason."""
    rest: Updates = {own.given_low: 0, own.given_high: 0, own.reason: reason}
    return together(rest, *(_empty(slot) for slot in own.slots))


def _empty(slot: Slot) -> Updates:
    return {slot.edge: as_num(NO_EDGE, COUNT), slot.origin: as_num(0, MM), slot.length: as_num(slot.length.low, MM)}


# ------------------------------------------------------------------ outputs


def _outputs(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Expr]:
    known = current.eq(table[1])
    of_track: dict[str, Expr] = {}
    edge, tracks = as_num(NO_EDGE, COUNT), as_num(0, COUNT)
    low, high = as_num(own.config.longest_edge_mm, MM), as_num(0, MM)
    for slot in own.slots:
        there, (least, most) = slot.edge.ne(NO_EDGE), _on_edge(own, slot)
        name = f"track_{slot.number}"
        of_track[f"{name}_edge"] = ite(there, slot.edge, NO_EDGE)  # no bare variable: a claim on it would state itself
        of_track[f"{name}_origin_mm"] = position_if(there, slot.origin)
        of_track[f"{name}_low_mm"] = position_if(there, least)
        of_track[f"{name}_high_mm"] = position_if(there, most)
        tracks = tracks + ite(there, as_num(1, COUNT), 0)
        edge = ite(there & known, slot.edge, edge)
        low, high = ite(there, minimum(low, least), low), ite(there, maximum(high, most), high)
    middle = floor_div(low + high, 2)
    return {
        "valid": known,
        "edge": edge,
        "position_mm": position_if(known, middle),
        "margin_below_mm": margin_if(known, middle - low),
        "margin_above_mm": margin_if(known, high - middle),
        "tracks": tracks,
        "reason": own.reason,
        **of_track,
    }


def _on_edge(own: Parts, slot: Slot) -> tuple[Num, Num]:
    """Return the interval on the edge of a slot, from its beginning; an interval beyond its ends is cut there."""
    return maximum(own.given_low - slot.origin, as_num(0, MM)), minimum(own.given_high - slot.origin, slot.length)


__all__ = ["NO_EDGE", "OccupiedTrack", "OccupiedTrackConfig", "Parts", "build", "machine", "parts"]
