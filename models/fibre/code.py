"""A position code made of localization sections: raised or lowered, short or long (FWG-10, FWG-15).

The symbol of a section is its effect on the amplitude (rise or fall) and its length (short or long). Two laws make a row of
symbols a code:

reach    any two sections at most `reach` apart differ in their symbol
window   any `window` sections in a row occur once on the line, read in either direction

They guarantee, without counting and without measured distances (each is a function here, tested over whole lines):

1. While the count is known, the next section read after up to `reach - 1` missed ones has another symbol than the one
   expected: a missed section is noticed at the next section that is read. A false section is noticed at once if its symbol
   differs, otherwise at the next true one.
2. `window` symbols that were read correctly give place and direction without counting.
3. `window` symbols with one section missed among them, or one false one before or between the others, or one misread, are
   no window of the line at any other place (`strict` codes): such a reading gives no place rather than a wrong one.

No code of symbols can notice a false section after the last true one whose symbol is just that of the next section. The
count is then one ahead until the next true section; the expectation window of the fibre machine, or an additional
localization, notices it at once. Nor do these laws exclude that a word is another one, two of whose sections were
missed, misread or false: how often that gives a wrong place is in docs/fibre.md.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

from safeloc.errors import InputError


@dataclass(frozen=True)
class Symbol:
    """The appearance of one section."""

    rises: bool
    long: bool

    @property
    def number(self) -> int:
        """The symbol as a number from 0 to 3, as in the words of the fibre machine."""
        return 2 * self.rises + self.long


ALPHABET = tuple(Symbol(rises, long) for rises, long in product((False, True), repeat=2))
Word = tuple[Symbol, ...]


@dataclass(frozen=True)
class PositionCode:
    """The symbols of a line's sections, in order of growing position, and the laws that they obey."""

    symbols: Word
    window: int
    reach: int

    def __post_init__(self) -> None:
        """Refuse a row of symbols that breaks one of its laws (InputError)."""
        if self.window < 2 or not 1 <= self.reach < self.window:
            raise InputError(f"window {self.window}, reach {self.reach}: 1 <= reach < window is needed.")
        broken = _too_near(self.symbols, self.reach) or _ambiguous(self.symbols, self.window)
        if broken:
            raise InputError(f"no position code: {broken}.")

    def decode(self, read: Sequence[Symbol]) -> tuple[int, int] | None:
        """Return the number of the section that was read last (from 1), and the direction (1 or -1).

        None if the symbols are no window of this line: fewer symbols than a window, or an error among them.
        """
        return self.places.get(tuple(read[-self.window :])) if len(read) >= self.window else None

    @cached_property
    def places(self) -> dict[Word, tuple[int, int]]:
        """Every window, read either way, with the section that is read last."""
        return dict(_windows(self.symbols, self.window))

    def faulty(self) -> Iterator[tuple[Word, int, int]]:
        """Yield every window with one inner error, with the section really read last and the direction of reading."""
        for line, step in ((self.symbols, 1), (self.symbols[::-1], -1)):
            for last in range(1, len(line) + 1):
                number = last if step == 1 else len(line) - last + 1
                for read in _one_error(line[:last], self.window):
                    yield read, number, step

    def undetected(self) -> list[tuple[Word, int]]:
        """Return the readings with one inner error that give another place than the section really read last."""
        return [(read, number) for read, number, step in self.faulty() if self._misleads(read, (number, step))]

    def _misleads(self, read: Word, truth: tuple[int, int]) -> bool:
        windows_of_word = self.decode(read)
        return windows_of_word is not None and windows_of_word != truth


def make_code(sections: int, window: int = 6, reach: int = 2, *, strict: bool = True) -> PositionCode:
    """Return a code for a number of sections: the first in order of search that obeys its laws; InputError if there is none.

    strict  no reading with one inner error is a window elsewhere (guarantee 3)
    """
    search = _Search(window, reach, strict)
    tries: list[Iterator[Symbol]] = [iter(ALPHABET)]
    while len(search.row) < sections:
        symbol = next(tries[-1], None)
        if symbol is not None:
            if search.push(symbol):
                tries.append(iter(ALPHABET))
        elif search.row:
            tries.pop()
            search.pop()
        else:
            raise InputError(f"no code of {sections} sections with window {window} and reach {reach}.")
    return PositionCode(tuple(search.row), window, reach)


def least_window(symbols: Word) -> int | None:
    """Return the least number of sections in a row, 2 or more, that occur once on the line, read either way; None if there is none."""
    return next((window for window in range(2, len(symbols) + 1) if not _ambiguous(symbols, window)), None)


def nearest_alike(symbols: Word, number: int) -> int | None:
    """Return how many sections farther on the next one like section `number` (from 0) is; None if there is none."""
    return next((apart for apart, symbol in enumerate(symbols[number + 1 :], 1) if symbol == symbols[number]), None)


class _Search:
    """A row of symbols that obeys its laws, with its last windows and the readings that they must not be confused with."""

    def __init__(self, window: int, reach: int, strict: bool) -> None:
        self.row: list[Symbol] = []
        self._window, self._reach, self._strict = window, reach, strict
        self._windows: list[dict[Word, tuple[int, int]]] = []
        self._wrong: list[list[tuple[Word, tuple[int, int]]]] = []

    def push(self, symbol: Symbol) -> bool:
        """Append a symbol if the laws allow it; return whether they do."""
        if symbol in self.row[max(0, len(self.row) - self._reach) :]:
            return False
        self.row.append(symbol)
        if not self._distinguishable():
            self.row.pop()
            return False
        return True

    def pop(self) -> None:
        """Remove the last symbol."""
        self.row.pop()
        self._windows.pop()
        self._wrong.pop()

    def _distinguishable(self) -> bool:
        """Add the windows and readings of the new symbol if no two are confused; return whether they were added."""
        windows_of_word, wrong = self._new_windows(), self._new_readings() if self._strict else []
        if windows_of_word is None or any(word in known for known in self._windows for word in windows_of_word):
            return False
        known = [*self._windows, windows_of_word]
        if any(self._misleads(one, known) for one in wrong) or any(
            self._misleads(one, [windows_of_word]) for old in self._wrong for one in old
        ):
            return False
        self._windows.append(windows_of_word)
        self._wrong.append(wrong)
        return True

    def _misleads(self, reading: tuple[Word, tuple[int, int]], known: Sequence[dict[Word, tuple[int, int]]]) -> bool:
        word, truth = reading
        return any(word in places and places[word] != truth for places in known)

    def _new_windows(self) -> dict[Word, tuple[int, int]] | None:
        """Return the windows that end with the new symbol, read either way; None if both are the same word."""
        first = len(self.row) - self._window
        windows = list(_windows(tuple(self.row[max(first, 0) :]), self._window))
        windows_of_word = {word: (last + max(first, 0), step) for word, (last, step) in windows}
        return windows_of_word if len(windows_of_word) == len(windows) else None

    def _new_readings(self) -> list[tuple[Word, tuple[int, int]]]:
        """Return the readings with an error that contain the new symbol, read either way."""
        number, window, row = len(self.row), self._window, tuple(self.row)
        upwards = [(word, (number, 1)) for word in _one_error(row, window)]
        downwards = [
            (word, (number - count + 1, -1))
            for count in range(window - 1, window + 2)
            if count <= number
            for word in _one_error(row[: number - count - 1 : -1] if count < number else row[::-1], window)
        ]
        return upwards + downwards


def _too_near(symbols: Word, reach: int) -> str:
    for number, symbol in enumerate(symbols):
        for other in range(number + 1, min(number + reach, len(symbols) - 1) + 1):
            if symbols[other] == symbol:
                return f"sections {number + 1} and {other + 1} are alike, and only {other - number} apart"
    return ""


def _ambiguous(symbols: Word, window: int) -> str:
    seen: dict[Word, tuple[int, int]] = {}
    for word, place in _windows(symbols, window):
        if word in seen:
            return f"the {window} sections read last at {seen[word]} and at {place} are alike"
        seen[word] = place
    return ""


def _windows(symbols: Word, window: int) -> Iterator[tuple[Word, tuple[int, int]]]:
    for last in range(window, len(symbols) + 1):
        word = symbols[last - window : last]
        yield word, (last, 1)
        yield word[::-1], (last - window + 1, -1)


def _one_error(passed: Word, window: int) -> Iterator[Word]:
    """Yield the last `window` symbols read, with one section missed, misread or false, but not the last one.

    A word whose last section is misread is, read backwards, one whose first is, and windows are read both ways.
    """
    symbols_read = passed[-window - 1 :]
    if len(symbols_read) == window + 1:
        for missed in range(1, window):
            yield symbols_read[:missed] + symbols_read[missed + 1 :]
    last = passed[-window:]
    if len(last) == window:
        for wrong, symbol in product(range(window - 1), ALPHABET):
            if last[wrong] != symbol:
                yield (*last[:wrong], symbol, *last[wrong + 1 :])
    fewer = passed[-(window - 1) :]
    if len(fewer) == window - 1:
        for false, symbol in product(range(window - 1), ALPHABET):
            yield (*fewer[:false], symbol, *fewer[false:])
