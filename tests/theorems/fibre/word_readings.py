"""Every way in which the end of a train can read a code word from the sections of a line, with up to so many of them read wrongly.

Nothing here knows what a code is, or how one is decoded. The end passes the line's sections one after the other. Of each it reads
the symbol, reads another one, or nothing; it may read one where no section is; and between two symbols it may turn, run back over
a section unseen, and turn again. Each but the first is a section read wrongly. A word begins anew when a section is read in the
other direction, as in the machine, so all of its symbols are read in one direction.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from safeloc.models.fibre.code import ALPHABET, PositionCode, Symbol, Word

NO_SECTION = 0


@dataclass(frozen=True)
class Reading:
    """A word as it is read, and where the end is after it.

    word     symbols, the one read last at the end
    number   the section that was read last, counted from 1; NO_SECTION if it was a false one
    step     direction of the end: 1 or -1
    """

    word: Word
    number: int
    step: int


def readings(symbols: Word, window: int, wrong: int) -> set[Reading]:
    """Return every word with exactly so many sections missed, misread or false, of which the last one read is no false one."""
    return {
        Reading((*word, symbol), number, step)
        for at_the_end in range(min(wrong, 1) + 1)
        for word, number, step in _before_the_last(symbols, window, wrong - at_the_end)
        if _on_the_line(symbols, number)
        for symbol in ALPHABET
        if (symbol != symbols[number - 1]) == bool(at_the_end)
    }


def false_at_the_end(symbols: Word, window: int) -> set[Reading]:
    """Return every word that is read right but for its last symbol, which is that of no section."""
    begun = _before_the_last(symbols, window, 0)
    return {Reading((*word, symbol), NO_SECTION, step) for word, _, step in begun for symbol in ALPHABET}


def wrong_places(code: PositionCode, read: Iterable[Reading]) -> list[Reading]:
    """Return the readings to which the decoder gives a place where the end is not, or a direction in which it does not run."""
    return [one for one in read if code.decode(one.word) not in (None, (one.number, one.step))]


def found(code: PositionCode, read: Iterable[Reading]) -> int:
    """Return to how many readings the decoder gives a place."""
    return sum(code.decode(one.word) is not None for one in read)


def _before_the_last(symbols: Word, window: int, wrong: int) -> Iterator[tuple[Word, int, int]]:
    """Yield the symbols of each word but its last one, with the number of the section that is ahead then, and the direction."""
    for step in (1, -1):
        for below in range(len(symbols) + 1):
            for word, at in _ways(symbols, step, below, window - 1, wrong, begun=False):
                yield word, _ahead(at, step), step


def _ways(symbols: Word, step: int, below: int, more: int, wrong: int, *, begun: bool) -> Iterator[tuple[Word, int]]:
    """Yield the next symbols read, `more` of them with `wrong` errors, and how many sections lie below the end then.

    begun  a symbol was read before: a section that is missed earlier is none of the word's
    """
    if not more and not wrong:
        yield (), below
    ahead, behind = _ahead(below, step), _ahead(below, -step)
    if more:
        for symbol in ALPHABET:
            if _on_the_line(symbols, ahead) and (cost := symbol != symbols[ahead - 1]) <= wrong:
                yield from _read(symbol, _ways(symbols, step, below + step, more - 1, wrong - cost, begun=True))
            if wrong:  # a false one
                yield from _read(symbol, _ways(symbols, step, below, more - 1, wrong - 1, begun=True))
    if begun and wrong:
        if _on_the_line(symbols, ahead):  # missed
            yield from _ways(symbols, step, below + step, more, wrong - 1, begun=True)
        if _on_the_line(symbols, behind):  # turned, ran back over it unseen, and turned again
            yield from _ways(symbols, step, below - step, more, wrong - 1, begun=True)


def _read(symbol: Symbol, ways: Iterator[tuple[Word, int]]) -> Iterator[tuple[Word, int]]:
    for word, below in ways:
        yield (symbol, *word), below


def _ahead(below: int, step: int) -> int:
    """Return the number of the section that an end with so many sections below it meets next in a direction."""
    return below + 1 if step > 0 else below


def _on_the_line(symbols: Word, number: int) -> bool:
    return 1 <= number <= len(symbols)
