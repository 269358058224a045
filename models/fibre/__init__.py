"""Where one end of a train is, from localization sections in a fibre beside the track (FWG-1 to FWG-15).

In a localization section the backscatter's amplitude is higher or lower than beside it. When the amplitude leaves
normal, a position signal So arises; when it is normal again, the section was passed, or left where it was entered. The
place follows from which section it was, not from any time (l. 22-32 of the source).

    WAITING   no signal yet: the count is undefined
    COUNTING  signals are counted from the first one on, down where the train runs back; which sections they are is not known
    LOCATED   the count tells the section: from a reference, or from a word of the position code
    FAULTED   error signal F: what was seen and what the map has do not agree; nothing is located until a reference

While located, every section is expected where the map has it, of its kind (raised or lowered) and of its length (short
or long). A section that does not come, one that should not be there, one of another kind or length, and an additional
localization (time of flight, reflecting points) that tells another place all raise F in the same cycle.

The two ends of a train are two such machines; the sections between them are all active at once.
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
    as_num,
    between,
    ceil_to,
    exact_to,
    ite,
)
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.models.fibre import variables as v
from safeloc.models.fibre.cycle import Cycle
from safeloc.models.fibre.variables import FibreConfig, Parts, parts
from safeloc.models.fibre.world import world
from safeloc.models.vocabulary.absent import margin_if, position_if

__all__ = ["Fibre", "FibreConfig", "build", "machine", "parts"]
SEEN = ("FWG-1", "FWG-2", "FWG-3", "FWG-8", "FWG-11", "FWG-12", "FWG-13", "FWG-14")
COUNTS = ("FWG-9",)
CODE = ("FWG-10", "FWG-15")
CHECKED = ("FWG-4", "FWG-5", "FWG-6", "FWG-7")


@dataclass(frozen=True, eq=False)
class Fibre:
    """The machine together with the terms it was built from, for properties to speak about."""

    machine: Machine
    own: Parts
    cycle: Cycle


def machine(config: FibreConfig | None = None) -> Machine:
    """The machine of one end of a train (FWG-1)."""
    return build(parts(config or FibreConfig())).machine


def build(own: Parts, name: str = "fibre") -> Fibre:
    """The machine over the given variables, for one end of a train."""
    table = modes("WAITING", "COUNTING", "LOCATED", "FAULTED")
    current = current_mode(table)
    cycle = Cycle(own)
    made = Machine(
        name=name,
        modes=table,
        inputs=own.declared.inputs,
        state=own.declared.states,
        outputs=_outputs(own, current, table),
        transitions=list(_table(own, cycle, table)),
        world=world(own),
        lemmas=_lemmas(own, current, table),
        definitions={
            "position signal So": cycle.enters, "normal again": cycle.leaves, "signal fits the map": cycle.fits,
            "error F": cycle.error, "section overdue": cycle.overdue, "run in the section": cycle.inside,
            "interval without an edge": cycle.place,
        },
        doc=(
            "Place of one end of a train from localization sections in a fibre. Assumed of the detector: the run of a "
            "cycle is true within rate and floor; where the amplitude changes an edge was passed, within the edge's "
            "tolerance, since an amplitude was last told. Of the sections: those near each other in number differ, each is as "
            "long as its kind says, and what looks like the one expected, and is not, lies farther away than a window "
            "bridges. References and the map's answers are true. Any section may be missed, and false ones may come."
        ),
    )  # fmt: skip
    return Fibre(made, own, cycle)


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, cycle: Cycle, table: tuple[Lit, ...]) -> Iterator[Transition]:
    waiting, counting, located, faulted = table
    normal = cycle.band.eq(v.NORMAL)
    lost = {**cycle.nowhere(), own.why: ite(cycle.silent, v.SILENT, v.TOO_WIDE)}
    at: dict[Var, Expr] = {own.base: own.reference_place, own.since: as_num(0, MM), own.drift: as_num(0, NM)}
    known: dict[Var, Expr] = {own.count: own.reference_count, own.counted: FALSE, own.why: v.LOCATED}
    referred = {**cycle.heard(), **cycle.no_word(), **at, **known}
    yield Transition("reference accepted", table, located, own.reference & normal, referred, COUNTS, 0)
    yield Transition("pattern lost", (counting, located), waiting, cycle.silent | cycle.too_wide, lost, SEEN, 1)
    yield from _located(own, cycle, located, faulted)
    yield from _counting(own, cycle, waiting, counting, located)
    started = {**cycle.nowhere(), **cycle.enter(cycle.one), own.why: v.ONLY_COUNTING}
    yield Transition("first signal", waiting, counting, cycle.enters & ~cycle.late, started, (*SEEN, *COUNTS), 3)
    yield Transition("no signal yet", waiting, waiting, set=cycle.heard(), requirements=SEEN, rank=6)
    yield Transition("error stays", faulted, faulted, set=cycle.heard(), requirements=CHECKED, rank=6)


def _located(own: Parts, cycle: Cycle, located: Lit, faulted: Lit) -> Iterator[Transition]:
    """The count tells the section."""
    _, near, far, _, long = own.next_to(cycle.forwards)
    error = {**cycle.nowhere(), own.why: cycle.flaw, own.signal: ite(cycle.enters, v.POSITION_SIGNAL, v.NO_SIGNAL)}
    entered = {**cycle.enter(own.count + cycle.one), own.base: near, own.far: far, own.long: long}
    passed = {**cycle.edge(v.PASSED), own.base: own.far}
    turned = {**cycle.edge(v.TURNED_BACK), own.count: _uncounted(own)}

    def row(
        name: str, target: Lit, when: Bool, updates: dict[Var, Expr], trace: tuple[str, ...], rank: int
    ) -> Transition:
        return Transition(name, located, target, when, updates, trace, rank)

    yield row("error", faulted, cycle.error, error, (*CHECKED, *CODE, *COUNTS), 2)
    yield row("section counted", located, cycle.enters, entered, (*SEEN, *COUNTS), 3)
    yield row("section passed", located, cycle.leaves & ~cycle.turned_back, passed, (*SEEN, *CODE), 3)
    yield row("section left again", located, cycle.leaves & cycle.turned_back, turned, (*SEEN, *COUNTS), 3)
    yield row("run on", located, TRUE, cycle.run_on(), CHECKED, 6)


def _counting(own: Parts, cycle: Cycle, waiting: Lit, counting: Lit, located: Lit) -> Iterator[Transition]:
    """Which section it is, is not known yet."""
    turns = own.counted & cycle.forwards.iff(~own.upwards)
    edge = cycle.edge(v.PASSED)
    anew = {**cycle.nowhere(), own.why: v.NO_END_OF_SECTION}
    spelt: dict[Var, Expr] = {own.word: ite(turns, 0, own.word), own.read: ite(turns, 0, own.read)}
    entered = {**cycle.enter(own.count + cycle.one), **spelt}
    back = {**cycle.edge(v.TURNED_BACK), **cycle.no_word(), own.count: _uncounted(own)}
    found: dict[Var, Expr] = {own.count: own.answer_count, own.base: own.answer_place, own.why: v.LOCATED}
    whole = own.answer & (own.read >= own.config.window) & own.band.eq(v.NORMAL) & cycle.band.eq(v.NORMAL)

    def row(
        name: str, target: Lit, when: Bool, updates: dict[Var, Expr], trace: tuple[str, ...], rank: int
    ) -> Transition:
        return Transition(name, counting, target, when, updates, trace, rank)

    yield row("no end of the section", waiting, cycle.endless | (cycle.enters & cycle.full), anew, SEEN, 2)
    yield row("signal counted", counting, cycle.enters, entered, (*SEEN, *COUNTS), 3)
    yield row("symbol read", counting, cycle.read, {**edge, **cycle.spell()}, CODE, 3)
    yield row("section left again, uncounted", counting, cycle.leaves & cycle.turned_back, back, COUNTS, 3)
    yield row("symbol not read", counting, cycle.leaves & ~cycle.turned_back, {**edge, **cycle.no_word()}, CODE, 4)
    yield row("word found", located, whole, {**cycle.run_on(), **cycle.no_word(), **found}, CODE, 5)
    yield row("count on", counting, TRUE, cycle.run_on(), COUNTS, 6)


def _uncounted(own: Parts) -> Num:
    """The count without the section that was left where it was entered."""
    return own.count + ite(own.upwards, as_num(-1, COUNT), as_num(1, COUNT))


def _outputs(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> dict[str, Expr]:
    located = current.eq(table[2])
    counts = current.one_of(table[1], table[2]) & own.counted
    margin = own.config.edge_tolerance_mm + ceil_to(own.drift, MM)
    return {
        "valid": located,
        "position_mm": position_if(located, own.base + own.since),
        "margin_above_mm": margin_if(located, margin),
        "margin_below_mm": margin_if(located, margin),
        "error": current.eq(table[3]),
        "position_signal": own.signal.eq(v.POSITION_SIGNAL),
        "section_event": own.signal,
        "in_section": own.band.ne(v.NORMAL),
        "count_known": counts,
        "count": ite(counts | located, own.count, as_num(0, COUNT)),
        "forwards": own.forwards,
        "word": own.word,
        "word_length": own.read,
        "reason": own.why,
    }


# ------------------------------------------------------------------ what helps to prove


def _lemmas(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> dict[str, Bool]:
    counting, located = current.eq(table[1]), current.eq(table[2])
    seen, inside = own.ghosts, own.band.ne(v.NORMAL)
    of_map = [seen.of_map, seen.real, seen.edge.eq(exact_to(own.base, NM)), seen.far.eq(own.far)]
    onwards = ite(own.upwards, own.base < own.far, own.far < own.base)
    told = [own.long.iff(seen.long), onwards]
    return {
        "a section can be uncounted": (inside & (counting | located)).implies(
            abs_(_uncounted(own)) <= own.config.section_limit
        ),
        "the world hears what the machine hears": all_of(
            [own.band.eq(seen.band), own.forwards.iff(seen.upwards), own.unheard.eq(seen.unheard)]
        ),
        "the run is charged what it may be wrong by": (counting | located).implies(own.drift.eq(seen.wrong)),
        "the run since the last edge is true": counting.implies(_within(own, seen.truth - seen.edge)),
        "the interval holds the truth": located.implies(_within(own, seen.truth - exact_to(own.base, NM))),
        "the section entered is the map's": (located & inside).implies(all_of([*of_map, *told])),
        "its number is kept": (located & inside).implies(seen.ahead_by.eq(seen.count - own.count)),
    }


def _within(own: Parts, ran: Num) -> Bool:
    """The run since the last edge is that, within the edge's tolerance and what the run may be wrong by."""
    most = own.drift + own.config.edge_tolerance_mm * NM_PER_MM
    return between(-most, ran - exact_to(own.since, NM), most)
