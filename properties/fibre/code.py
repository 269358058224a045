"""Properties of the position code: reading it, and locating by it (FWG-10, FWG-15)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, abs_, all_of, any_of, before, floor_div, ite, minimum, was
from safeloc.language.spec import Property, always
from safeloc.language.units import NM_PER_MM
from safeloc.models.fibre import CODE, COUNTS, Fibre
from safeloc.models.fibre import variables as v
from safeloc.properties.fibre.place import LAW
from safeloc.properties.fibre.seen import Seen

SYMBOLS = 4
for_all_inputs = partial(always, requirements=CODE, unconditional=True)
under_assumption = partial(always, requirements=(*CODE, *COUNTS), assumption=LAW)


def properties(model: Fibre) -> Iterator[Property]:
    """Yield the properties of words and counts."""
    yield from _against_the_truth(model)
    yield from _lengths(model)
    yield from _lengths_of_the_map(model)
    yield from _turned_back(model)
    yield from _words(model)
    yield from _read(model)
    yield from _unread(model)


def _against_the_truth(model: Fibre) -> Iterator[Property]:
    machine, own, seen = model.machine, model.own, Seen(model.own)
    located = machine.modes[2]
    mode, was_located = machine.mode, before(machine.mode).eq(located)
    off = before(own.ghosts.count) - before(own.sections_counted)
    near = was(own.ghosts.real) & (abs_(off) <= own.config.reach)
    passed = was_located & mode.eq(located) & own.event.eq(v.PASSED) & ~own.reference_accepted
    yield under_assumption(
        "count agrees with the truth",
        (passed & near).implies(off.eq(0)),
        statement="when a real section was passed and F is not raised, the count is the true one, although up to `reach` "
        "sections were missed or false before",
    )
    read = seen.returns & (seen.long | seen.short)
    yield under_assumption(
        "disagreement raises F",
        (was_located & near & read & off.ne(0)).implies(mode.ne(located) | own.reference_accepted),
        statement="a real section that is passed while the count is wrong ends the location in that cycle",
    )


def _lengths(model: Fibre) -> Iterator[Property]:
    """Claim that the length that the machine reads is that of the section."""
    machine, own = model.machine, model.own
    counting = machine.modes[1]
    mode, ran = machine.mode, own.ghosts.edge - before(own.ghosts.edge)
    long = abs_(ran) >= own.config.long_mm * NM_PER_MM
    real = was(own.ghosts.real) & ~own.reference_accepted
    counts = before(mode).eq(counting) & mode.eq(counting) & (own.read > 0)
    read_long = own.word_read.eq(floor_div(own.word_read, 2) * 2 + 1)
    passed = own.event.eq(v.PASSED) & real
    yield under_assumption(
        "a length that is read is the true one",
        (counts & passed).implies(read_long.iff(long)),
        statement="a section read as long is long, and one read as short is short, at every speed at which the end can leave it",
        requirements=CODE,
    )


def _lengths_of_the_map(model: Fibre) -> Iterator[Property]:
    """Claim that a section that was passed is as long as the map has it."""
    machine, own = model.machine, model.own
    located = machine.modes[2]
    mode, ran = machine.mode, own.ghosts.edge - before(own.ghosts.edge)
    long = abs_(ran) >= own.config.long_mm * NM_PER_MM
    real = was(own.ghosts.real) & ~own.reference_accepted
    stays = before(mode).eq(located) & mode.eq(located)
    passed = own.event.eq(v.PASSED) & real
    yield under_assumption(
        "a section passed has the length of the map",
        (stays & passed).implies(was(own.long_by_map).iff(long)),
        statement="if the end stays located past a section, that section is as long as the map has it",
        requirements=CODE,
    )


def _turned_back(model: Fibre) -> Iterator[Property]:
    machine, own = model.machine, model.own
    _, _, located, _ = machine.modes
    mode, ran = machine.mode, own.ghosts.edge - before(own.ghosts.edge)
    stays = before(mode).eq(located) & mode.eq(located)
    yield under_assumption(
        "a section left again was not passed",
        (stays & own.event.eq(v.TURNED_BACK) & ~own.reference_accepted).implies(ran.eq(0)),
        statement="a section counted as left on the side of entry was left there",
        requirements=COUNTS,
    )


def _words(model: Fibre) -> Iterator[Property]:
    """Claim that a whole word gives the place, and nothing less."""
    machine, own, seen = model.machine, model.own, Seen(model.own)
    _, counting, located, _ = machine.modes
    mode, was_counting = machine.mode, before(machine.mode).eq(counting)
    window = own.config.window
    was_normal = before(own.band).eq(v.NORMAL)
    taken = own.edge.eq(own.word_position) & own.sections_counted.eq(own.word_count)
    yield for_all_inputs(
        "a code word is complete",
        (was_counting & mode.eq(located) & ~own.reference_accepted).implies(
            own.word_found & before(own.read).eq(window) & taken
        ),
        statement="the code gives a place only when as many symbols were read as make a window of the line unique, and the "
        "place is the map's answer",
    )
    whole = all_of([was_counting, own.word_found, before(own.read).eq(window), was_normal, seen.normal, ~seen.lost])
    yield for_all_inputs(
        "a complete word gives the place",
        whole.implies(mode.eq(located)),
        statement="beside a section, the end is located in the cycle in which the map has the complete word, whatever its direction, its count and the "
        "kinds of its sections; unless its pattern is lost in that cycle",
    )


def _read(model: Fibre) -> Iterator[Property]:
    """Claim that each section read joins the word."""
    machine, own, seen = model.machine, model.own, Seen(model.own)
    _, counting, *_ = machine.modes
    mode, was_counting = machine.mode, before(machine.mode).eq(counting)
    window = own.config.window
    counts = was_counting & mode.eq(counting)
    read = counts & seen.returns & (seen.long | seen.short)
    longer = own.read.eq(minimum(before(own.read) + 1, window))
    yield for_all_inputs(
        "the code word consists of the sections read",
        read.implies(_joined(model, _symbol(model)) & longer),
        statement="the kind and the length of the section passed are appended to the word; the oldest symbol of a "
        "complete word is dropped",
    )


def _unread(model: Fibre) -> Iterator[Property]:
    """Claim the events that break the word; no other one changes it."""
    machine, own, seen = model.machine, model.own, Seen(model.own)
    _, counting, *_ = machine.modes
    mode, was_counting = machine.mode, before(machine.mode).eq(counting)
    counts = was_counting & mode.eq(counting)
    unread = counts & seen.returns & ~(seen.long | seen.short)
    turned = counts & seen.changes & was(own.counted) & seen.forwards.iff(~was(own.upwards))
    yield for_all_inputs(
        "a section that is not read breaks the word",
        (unread | turned).implies(own.word_read.eq(0) & own.read.eq(0)),
        statement="a new word begins at a section whose length cannot be read or that was left again, and at a change of "
        "direction",
    )
    kept = counts & ~seen.returns & ~turned
    yield for_all_inputs(
        "nothing else is read",
        kept.implies(own.word_read.eq(before(own.word_read)) & own.read.eq(before(own.read))),
        statement="the word changes only when a section is left, or the direction changes",
    )


def _symbol(model: Fibre) -> Num:
    """Return the symbol as a number from 0 to 3: lowered or raised, short or long."""
    own, seen = model.own, Seen(model.own)
    raised: Num = ite(before(own.band).eq(v.RAISED), own.word_read * 0 + 2, 0)
    return raised + ite(seen.long, own.word_read * 0 + 1, 0)


def _joined(model: Fibre, symbol: Num) -> Bool:
    """Return the condition that the word is four times the last one and the symbol, less the oldest symbol of a whole word."""
    own = model.own
    joined, words = before(own.word_read) * SYMBOLS + symbol, SYMBOLS**own.config.window
    return any_of(own.word_read.eq(joined - words * oldest) for oldest in range(SYMBOLS))
