"""Position of one end of a train from localization sections in a fibre beside the track (FWG-1 to FWG-15).

In a localization section the backscatter's amplitude is higher or lower than beside it. When the amplitude leaves
normal, a position signal So arises; when it returns to normal, the end has passed the section, or has left it where it
entered. The place follows from the section's number, not from a time (l. 22-32 of the source).

    WAITING   no signal yet: the count is undefined
    COUNTING  signals are counted from the first one on, down where the train runs back; the sections are not identified yet
    LOCATED   the count identifies the section: from a reference, or from a word of the position code
    FAULTED   error signal F: detector and map disagree; the end is not located until a reference is accepted

While the end is located, the machine expects each section where the map has it, of its kind (raised or lowered) and of its
length (short or long). F is raised in the same cycle by a section that is missing, by one that the map does not have, by one
of another kind or length, and by an additional localization (time of flight, reflecting points) that gives another place.

The two ends of a train are two such machines; all sections between them are active at once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

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
    exact_to,
    ite,
)
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.language.world import World
from safeloc.models.fibre import variables as v
from safeloc.models.fibre.coupled import BESIDE, CoupledConfig, Coupling, coupled_world, coupling, lowers, raises
from safeloc.models.fibre.cycle import Cycle
from safeloc.models.fibre.variables import FibreConfig, Parts, parts
from safeloc.models.fibre.world import world
from safeloc.models.vocabulary.absent import margin_if, position_if

__all__ = ["CoupledConfig", "Fibre", "FibreConfig", "build", "build_coupled", "machine", "parts"]
SEEN = ("FWG-1", "FWG-2", "FWG-3", "FWG-8", "FWG-11", "FWG-12", "FWG-13", "FWG-14")
COUNTS = ("FWG-9",)
CODE = ("FWG-10", "FWG-15")
CHECKED = ("FWG-4", "FWG-5", "FWG-6", "FWG-7")
_DOC = (
    "Position of one end of a train from localization sections in a fibre. Assumed of the detector: the "
    "measured run of a cycle is within rate and floor of the true run; when the amplitude changes, the "
    "end has passed an edge since the last amplitude, within the edge's tolerance. Assumed of the "
    "sections: sections near each other in number differ; each is as long as its kind says; any other "
    "change that looks like the expected section lies farther away than the expectation window can "
    "bridge. References and the map's answers are true. Any section may be missed, and false ones may "
    "come, but no more than one among those of a code word that is found."
)
_COUPLED_DOC = (
    "The same machine of one end of a train. Assumed of coupling and material: by how much each kind of section changes the amplitude "
    "that is received, and how even it is beside them. Nothing is assumed of runs, the map, references or code words."
)


@dataclass(frozen=True, eq=False)
class Fibre(Model[Parts]):
    """The machine together with the terms from which it was built; properties refer to these terms."""

    cycle: Cycle
    coupling: Coupling | None = None


def machine(config: FibreConfig | None = None) -> Machine:
    """Return the machine of one end of a train (FWG-1)."""
    return build(parts(config or FibreConfig())).machine


def build(own: Parts, name: str = "fibre") -> Fibre:
    """Return the machine over the given variables, for one end of a train."""
    around = world(own)
    return _built(own, name, lambda cycle, current, table: (around, _lemmas(own, cycle, current, table)), _DOC)


def build_coupled(own: Parts, config: CoupledConfig) -> Fibre:
    """Return the same machine in the world of coupling and material, which says when a section cannot be missed."""
    fibre = coupling(own, config)

    def around(cycle: Cycle, current: NumVar, table: tuple[Lit, ...]) -> tuple[World, dict[str, Bool]]:
        return coupled_world(fibre), {**_counts(own, cycle, current, table), **_last_received(fibre)}

    return replace(_built(own, "fibre_coupled", around, _COUPLED_DOC), coupling=fibre)


def _built(
    own: Parts,
    name: str,
    around: Callable[[Cycle, NumVar, tuple[Lit, ...]], tuple[World, dict[str, Bool]]],
    doc: str,
) -> Fibre:
    """Return the machine in a world; `around` gives world and lemmas."""
    table = modes("WAITING", "COUNTING", "LOCATED", "FAULTED")
    current = current_mode(table)
    cycle = Cycle(own)
    surroundings, lemmas = around(cycle, current, table)
    made = own.declared.machine(
        name=name,
        modes=table,
        outputs=_outputs(own, current, table),
        transitions=list(_table(own, cycle, table)),
        world=surroundings,
        lemmas=lemmas,
        definitions={
            "position signal So": cycle.enters, "normal again": cycle.leaves, "signal fits the map": cycle.fits,
            "error F": cycle.error, "section overdue": cycle.overdue, "run in the section": cycle.inside,
            "interval without an edge": cycle.place,
        },
        doc=doc,
    )  # fmt: skip
    return Fibre(made, own, cycle)


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, cycle: Cycle, table: tuple[Lit, ...]) -> Iterator[Transition]:
    waiting, counting, located, faulted = table
    every_cycle, no_signal = _every_cycle(own, cycle), _signal(own, v.NO_SIGNAL)
    referred: Updates = {
        own.edge: own.reference_position,
        own.sections_counted: own.reference_count,
        own.counted: FALSE,
    }
    lost: Updates = {own.why: ite(cycle.silent, v.SILENT, v.TOO_WIDE)}
    normal = cycle.band.eq(v.NORMAL)
    yield Transition(
        "reference accepted", table, located, own.reference_accepted & normal,
        together(every_cycle, no_signal, _no_run(own), _no_word(own), referred, {own.why: v.LOCATED}), COUNTS, 0)  # fmt: skip
    yield Transition(
        "pattern lost", (counting, located), waiting, cycle.silent | cycle.too_wide,
        together(every_cycle, no_signal, _no_run(own), _no_word(own), _no_place(own), _no_count(own), lost), SEEN, 1)  # fmt: skip
    yield from _located(own, cycle, located, faulted)
    yield from _counting(own, cycle, waiting, counting, located)
    yield Transition(
        "first signal", waiting, counting, cycle.enters & ~cycle.late,
        together(every_cycle, _entered(own, cycle, cycle.one), _no_word(own), _no_place(own), {own.why: v.ONLY_COUNTING}),
        (*SEEN, *COUNTS), 3)  # fmt: skip
    yield Transition("no signal yet", waiting, waiting, TRUE, together(every_cycle, no_signal), SEEN, 6)
    yield Transition("error stays", faulted, faulted, TRUE, together(every_cycle, no_signal), CHECKED, 6)


def _located(own: Parts, cycle: Cycle, located: Lit, faulted: Lit) -> Iterator[Transition]:
    """Yield the rows of LOCATED: the count identifies the section."""
    every_cycle, edge = _every_cycle(own, cycle), _from_edge(own, cycle)
    _, near, far, _, long = own.next_to(cycle.forwards)
    error: Updates = {own.event: ite(cycle.enters, v.POSITION_SIGNAL, v.NO_SIGNAL), own.why: cycle.flaw}
    entered: Updates = {own.edge: near, own.far_edge: far, own.long_by_map: long}
    yield Transition(
        "error", located, faulted, cycle.error,
        together(every_cycle, _no_run(own), _no_word(own), _no_place(own), _no_count(own), error),
        (*CHECKED, *CODE, *COUNTS), 2)  # fmt: skip
    yield Transition(
        "section counted", located, located, cycle.enters,
        together(every_cycle, _entered(own, cycle, own.sections_counted + cycle.one), entered), (*SEEN, *COUNTS), 3)  # fmt: skip
    yield Transition(
        "section passed", located, located, cycle.leaves & ~cycle.turned_back,
        together(every_cycle, edge, {own.event: v.PASSED, own.edge: own.far_edge}), (*SEEN, *CODE), 3)  # fmt: skip
    yield Transition(
        "section left again", located, located, cycle.leaves & cycle.turned_back,
        together(every_cycle, edge, {own.event: v.TURNED_BACK, own.sections_counted: cycle.uncounted}), (*SEEN, *COUNTS), 3)  # fmt: skip
    yield Transition(
        "run on", located, located, TRUE,
        together(every_cycle, _run_on(own, cycle), {own.event: v.NO_SIGNAL}), CHECKED, 6)  # fmt: skip


def _counting(own: Parts, cycle: Cycle, waiting: Lit, counting: Lit, located: Lit) -> Iterator[Transition]:
    """Yield the rows of COUNTING: the section is not identified yet."""
    every_cycle, edge, on = _every_cycle(own, cycle), _from_edge(own, cycle), _run_on(own, cycle)
    no_signal, passed = _signal(own, v.NO_SIGNAL), _signal(own, v.PASSED)
    turns = own.counted & cycle.forwards.iff(~own.upwards)
    turned: Updates = {own.word_read: ite(turns, 0, own.word_read), own.read: ite(turns, 0, own.read)}
    found: Updates = {own.sections_counted: own.word_count, own.edge: own.word_position, own.why: v.LOCATED}
    complete = own.word_found & (own.read >= own.config.window) & own.band.eq(v.NORMAL) & cycle.band.eq(v.NORMAL)
    yield Transition(
        "no end of the section", counting, waiting, cycle.endless | (cycle.enters & cycle.full),
        together(every_cycle, no_signal, _no_run(own), _no_word(own), _no_place(own), _no_count(own),
                 {own.why: v.NO_END_OF_SECTION}), SEEN, 2)  # fmt: skip
    yield Transition(
        "signal counted", counting, counting, cycle.enters,
        together(every_cycle, _entered(own, cycle, own.sections_counted + cycle.one), turned), (*SEEN, *COUNTS), 3)  # fmt: skip
    yield Transition(
        "symbol read", counting, counting, cycle.read,
        together(every_cycle, edge, passed, {own.word_read: cycle.word, own.read: cycle.word_length}), CODE, 3)  # fmt: skip
    yield Transition(
        "section left again, uncounted", counting, counting, cycle.leaves & cycle.turned_back,
        together(every_cycle, edge, {own.event: v.TURNED_BACK, own.sections_counted: cycle.uncounted}, _no_word(own)),
        COUNTS, 3)  # fmt: skip
    yield Transition(
        "symbol not read", counting, counting, cycle.leaves & ~cycle.turned_back,
        together(every_cycle, edge, passed, _no_word(own)), CODE, 4)  # fmt: skip
    yield Transition(
        "code word found", counting, located, complete, together(every_cycle, on, no_signal, _no_word(own), found), CODE, 5)  # fmt: skip
    yield Transition("count on", counting, counting, TRUE, together(every_cycle, on, no_signal), COUNTS, 6)


# ------------------------------------------------------------------ groups of updates


def _every_cycle(own: Parts, cycle: Cycle) -> Updates:
    """Set amplitude band, direction, and how long run and amplitude have been absent: in every row."""
    return {
        own.band: cycle.band,
        own.forwards: cycle.forwards,
        own.silent_cycles: cycle.gap,
        own.run_since_amplitude: cycle.unheard,
    }


def _signal(own: Parts, signal: Lit) -> Updates:
    return {own.event: signal}


def _run_on(own: Parts, cycle: Cycle) -> Updates:
    """Continue the run and its error bound: no edge in this cycle."""
    return {own.run_since_edge: cycle.since, own.drift: cycle.drift}


def _from_edge(own: Parts, cycle: Cycle) -> Updates:
    """Begin the run anew: the end passed an edge."""
    return {own.run_since_edge: 0, own.drift: cycle.fresh}


def _entered(own: Parts, cycle: Cycle, count: Num) -> Updates:
    """Count a position signal, and begin the run anew at the edge of the section entered."""
    counted: Updates = {own.sections_counted: count, own.counted: TRUE, own.upwards: cycle.forwards}
    return together(_from_edge(own, cycle), _signal(own, v.POSITION_SIGNAL), counted)


def _no_run(own: Parts) -> Updates:
    return {own.run_since_edge: 0, own.drift: 0}


def _no_place(own: Parts) -> Updates:
    return {own.edge: 0, own.far_edge: 0}


def _no_word(own: Parts) -> Updates:
    return {own.word_read: 0, own.read: 0}


def _no_count(own: Parts) -> Updates:
    return {own.sections_counted: 0, own.counted: FALSE}


# ------------------------------------------------------------------ outputs


def _outputs(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> dict[str, Expr]:
    located = current.eq(table[2])
    counts = current.one_of(table[1], table[2]) & own.counted
    margin = own.config.edge_tolerance_mm + ceil_to(own.drift, MM)
    return {
        "valid": located,
        "position_mm": position_if(located, own.edge + own.run_since_edge),
        "margin_above_mm": margin_if(located, margin),
        "margin_below_mm": margin_if(located, margin),
        "error": current.eq(table[3]),
        "position_signal": own.event.eq(v.POSITION_SIGNAL),
        "section_event": own.event,
        "in_section": own.band.ne(v.NORMAL),
        "count_known": counts,
        "count": ite(counts | located, own.sections_counted, as_num(0, COUNT)),
        "forwards": own.forwards,
        "word": own.word_read,
        "word_length": own.read,
        "reason": own.why,
    }


# ------------------------------------------------------------------ lemmas


def _counts(own: Parts, cycle: Cycle, current: NumVar, table: tuple[Lit, ...]) -> dict[str, Bool]:
    followed, inside = current.one_of(table[1], table[2]), own.band.ne(v.NORMAL)
    return {
        "a section can be uncounted": (inside & followed).implies(abs_(cycle.uncounted) <= own.config.section_limit),
    }


def _last_received(fibre: Coupling) -> dict[str, Bool]:
    """Return the lemmas that tie the amplitude's band to the section in which it was last received."""
    band = fibre.own.band
    return {
        "beside the sections the band is normal": fibre.last_received.eq(BESIDE).implies(band.eq(v.NORMAL)),
        "a section never has the other one's band": all_of(
            [
                raises(fibre.last_received).implies(band.ne(v.LOWERED)),
                lowers(fibre.last_received).implies(band.ne(v.RAISED)),
            ]
        ),
    }


def _lemmas(own: Parts, cycle: Cycle, current: NumVar, table: tuple[Lit, ...]) -> dict[str, Bool]:
    counting, located = current.eq(table[1]), current.eq(table[2])
    seen, inside = own.ghosts, own.band.ne(v.NORMAL)
    of_map = [
        seen.section_is_the_maps,
        seen.real,
        seen.edge.eq(exact_to(own.edge, NM)),
        seen.far_edge_on_map.eq(own.far_edge),
    ]
    onwards = ite(own.upwards, own.edge < own.far_edge, own.far_edge < own.edge)
    as_read = [own.long_by_map.iff(seen.long_on_map), onwards]
    return {
        **_counts(own, cycle, current, table),
        "machine and world follow the same amplitude": all_of(
            [
                own.band.eq(seen.band),
                own.forwards.iff(seen.upwards),
                own.run_since_amplitude.eq(seen.possible_run_since_amplitude),
            ]
        ),
        "the run's error bound equals the world's": (counting | located).implies(own.drift.eq(seen.measured_run_error)),
        "the run since the last edge is true": counting.implies(_within(own, seen.truth - seen.edge)),
        "the interval holds the truth": located.implies(_within(own, seen.truth - exact_to(own.edge, NM))),
        "the section entered is the map's": (located & inside).implies(all_of([*of_map, *as_read])),
        "the world tracks the difference of the counts": (located & inside).implies(
            seen.ahead_by.eq(seen.count - own.sections_counted)
        ),
    }


def _within(own: Parts, ran: Num) -> Bool:
    """Return the condition that `ran` is the run since the last edge, within the edge's tolerance and the error bound of the run."""
    most = own.drift + own.config.edge_tolerance_mm * NM_PER_MM
    return between(-most, ran - exact_to(own.run_since_edge, NM), most)
