"""The position code: its laws, and what they guarantee, tried on whole lines."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.models.fibre.code import ALPHABET, PositionCode, make_code

CODE = make_code(20)


def test_places_are_told_in_both_directions() -> None:
    """Every window tells its last section and the direction of reading, whichever way it is read."""
    symbols, window = CODE.symbols, CODE.window
    for last in range(window, len(symbols) + 1):
        word = symbols[last - window : last]
        assert CODE.decode(word) == (last, 1)
        assert CODE.decode(word[::-1]) == (last - window + 1, -1)


def test_one_error_within_a_word_never_misleads() -> None:
    """A missed, false or misread section within a word tells nothing, or the true place."""
    readings = list(CODE.faulty())
    assert len(readings) > 1_000
    assert CODE.undetected() == []


def test_a_false_signal_before_the_first_section_never_misleads() -> None:
    """Read before the line's first sections, from either end: nothing precedes them that it could be a misreading of."""
    for row in (CODE.symbols, CODE.symbols[::-1]):
        for symbol in ALPHABET:
            assert CODE.decode((symbol, *row[: CODE.window - 1])) is None


def test_a_code_that_is_not_strict_may_mislead() -> None:
    """The guarantee is not one of unique windows alone."""
    assert make_code(20, strict=False).undetected()


def test_neighbours_differ() -> None:
    """Sections up to `reach` apart differ: the next one read after a missed one is not the one expected."""
    for number, symbol in enumerate(CODE.symbols):
        assert symbol not in CODE.symbols[number + 1 : number + 1 + CODE.reach]


def test_too_few_symbols_tell_nothing() -> None:
    """A word that is not whole has no place."""
    assert CODE.decode(CODE.symbols[: CODE.window - 1]) is None


def test_what_breaks_a_law_is_refused() -> None:
    """Alike neighbours, windows that occur twice, and lines that no code can be found for."""
    one, two, three, _ = ALPHABET
    with pytest.raises(InputError, match="sections 1 and 2 are alike"):
        PositionCode((one, one, two), 2, 1)
    with pytest.raises(InputError, match="are alike"):
        PositionCode((one, two, three) * 3, 3, 2)
    with pytest.raises(InputError, match="no code of 12 sections"):
        make_code(12, 2, 1)
    with pytest.raises(InputError, match="1 <= reach < window"):
        PositionCode((one, two), 2, 2)
