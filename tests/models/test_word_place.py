"""A code word that is found lies at its place: no law, but what follows if no more than one of its sections is read wrongly (FWG-10, FWG-15).

Every reading of every line is tried that one error allows, through the decoder with which hosts look words up.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.models.fibre import code as fibre_code
from safeloc.models.fibre.code import ALPHABET, PositionCode, Symbol, Word, make_code
from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.audit import audit
from tests.railway.audit.test_position_codes import line, told
from tests.theorems.fibre.word_law import RUN_MM, CodedLine
from tests.theorems.fibre.word_readings import Reading, false_at_the_end, found, readings, wrong_places

PAGE = (Path(__file__).parents[2] / "docs" / "fibre.md").read_text(encoding="utf-8")
DRAWN, SIMULATED, LONG = make_code(6, 5), make_code(12, 5), make_code(13, 5)
"""The codes of figure 5, of the simulated line and of that of 20 km."""
LONGER = (PositionCode(SIMULATED.symbols, 7, SIMULATED.reach), make_code(20, 6))
CODES = {f"{len(one.symbols)} sections, {one.window} a word": one for one in (DRAWN, SIMULATED, LONG, *LONGER)}
Decoder = Callable[[PositionCode, Sequence[Symbol]], tuple[int, int] | None]
RIGHT = PositionCode.decode


def within_the_law(code: PositionCode) -> set[Reading]:
    """Every reading with one section missed, misread or false, or with none; the one read last is not false."""
    return readings(code.symbols, code.window, 0) | readings(code.symbols, code.window, 1)


# ------------------------------------------------------------------ what follows


@pytest.mark.parametrize("name", CODES)
def test_a_word_that_is_found_lies_at_its_place(name: str) -> None:
    """Of every line, place and direction, and every error: the very term of the law holds; and a word without an error is found."""
    code = CODES[name]
    coded, tried = CodedLine(code), within_the_law(code)
    assert wrong_places(code, tried) == []
    assert [one for one in tried if not coded.keeps(one)] == []
    right = readings(code.symbols, code.window, 0)
    assert found(code, right) == len(right) == 2 * (len(code.symbols) - code.window + 1)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", CODES)
def test_the_machine_is_there_or_nowhere(name: str) -> None:
    """Each such word read by the machine, section by section, and looked up by its host: it has no place, or the true one."""
    code = CODES[name]
    coded = CodedLine(code)
    located = 0
    for one in within_the_law(code):
        seen = coded.after(one)
        edge_mm, below = coded.truth(one)
        assert seen["valid"] == (code.decode(one.word) is not None)
        if seen["valid"]:
            located += 1
            assert (seen["position_mm"], seen["count"]) == (edge_mm + one.step * RUN_MM, below)
    assert located == 2 * (len(code.symbols) - code.window + 1)


# ------------------------------------------------------------------ for every code that the audit passes


def every_code(window: int, reach: int, least: int, most: int, row: Word = ()) -> Iterator[PositionCode]:
    """Every code of so many sections, misled by an error or not, up to a renaming of the symbols, on which no law depends."""
    if row:
        try:
            code = PositionCode(row, window, reach)
        except InputError:
            return
        if len(row) >= least:
            yield code
    if len(row) < most:
        for symbol in ALPHABET[: len(set(row)) + 1]:
            yield from every_code(window, reach, least, most, (*row, symbol))


@pytest.mark.parametrize(("window", "reach", "most"), [(4, 1, 7), (5, 1, 7), (5, 2, 8)])
def test_the_figure_of_the_audit_decides(window: int, reach: int, most: int) -> None:
    """Of every code of up to so many sections: the audit counts no misleading reading exactly if no error within the law misleads."""
    counted = {True: 0, False: 0}
    for code in every_code(window, reach, window, most):
        withstands = not wrong_places(code, within_the_law(code))
        assert withstands == (code.undetected() == [])
        counted[withstands] += 1
    assert min(counted.values()) > 5


def left_out(window: int) -> list[Word]:
    """The words with one error that the audit's rule does not try, in every row of `window` + 1 sections, where each such reading lies.

    Not those with two like neighbours, which no code has; nor those whose last section is misread, which others are read backwards.
    """
    found_out: list[Word] = []
    for one in every_code(window, 1, window - 1, window + 1):
        every, tried = readings(one.symbols, window, 1), {Reading(*reading) for reading in one.faulty()}
        words = {reading.word for reading in tried}
        assert tried <= every
        rest = [reading.word for reading in every - tried if not any(a == b for a, b in pairwise(reading.word))]
        found_out += [word for word in rest if word[::-1] not in words]
    return found_out


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("window", [3, 4, 5, 6])
def test_the_audit_tries_every_reading(window: int) -> None:
    """Of lines of any length: a reading with one error lies within one section more than a word."""
    assert left_out(window) == []


def test_a_rule_that_leaves_a_reading_out_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A false section before the line's first ones, which once could complete a word of a code."""
    right = fibre_code._one_error
    monkeypatch.setattr(fibre_code, "_one_error", lambda row, window: right(row, window) if len(row) >= window else ())
    assert left_out(4)


@pytest.mark.parametrize("name", CODES)
def test_a_reading_lies_within_a_word_and_one_section(name: str) -> None:
    """The readings of a line are those of its rows of `window` + 1 sections."""
    symbols, window = CODES[name].symbols, CODES[name].window
    parts = {
        Reading(one.word, one.number + first, one.step)
        for first in range(len(symbols) - window)
        for one in readings(symbols[first : first + window + 1], window, 1)
    }
    assert parts == readings(symbols, window, 1)


@st.composite
def rows(draw: st.DrawFn) -> tuple[Word, int, int]:
    """A row of symbols of which as many as possible are chosen so that no error misleads, a window and a reach."""
    window = draw(st.integers(3, 5))
    reach = draw(st.integers(1, 2))
    row: Word = ()
    for order in draw(st.lists(st.permutations(ALPHABET), min_size=window, max_size=9)):
        row = next((more for one in order if withstands(more := (*row, one), window, reach)), row)
    return (*row, *draw(st.lists(st.sampled_from(ALPHABET), max_size=1))), window, reach


def withstands(row: Word, window: int, reach: int) -> bool:
    """Whether the row is a code, and one that no error misleads by the audit's figure."""
    try:
        return PositionCode(row, window, reach).undetected() == []
    except InputError:
        return False


@given(rows())
def test_no_error_misleads_where_the_audit_finds_nothing(drawn: tuple[Word, int, int]) -> None:
    """Of lines that are drawn, by the audit itself; and of a code that it finds fault with, an error misleads."""
    row, window, reach = drawn
    findings = told(audit(line(row), LayoutConfig(code_window=window, code_reach=reach)))
    if not findings:
        code = PositionCode(row, window, reach)
        assert wrong_places(code, within_the_law(code)) == []
    elif {rule for rule, _ in findings} == {"code withstands an error"}:
        code = PositionCode(row, window, reach)
        assert wrong_places(code, within_the_law(code)) != []


# ------------------------------------------------------------------ what is refused


def directionless(code: PositionCode, read: Sequence[Symbol]) -> tuple[int, int] | None:
    """Every word as if it was read upwards."""
    place = RIGHT(code, read)
    return None if place is None else (place[0], 1)


def backwards(code: PositionCode, read: Sequence[Symbol]) -> tuple[int, int] | None:
    """The newest symbol taken for the oldest."""
    return RIGHT(code, tuple(reversed(read)))


def nearest(errors: int) -> Decoder:
    """The window that differs in the fewest symbols, if not in more than so many."""

    def decode(code: PositionCode, read: Sequence[Symbol]) -> tuple[int, int] | None:
        differ = {word: sum(one != two for one, two in zip(word, read, strict=True)) for word in code.places}
        best = min(differ, key=lambda word: differ[word])
        return code.places[best] if differ[best] <= errors else None

    return decode


def likeness(part: Callable[[Sequence[Symbol]], object]) -> Decoder:
    """A window of which a part alone is compared."""

    def decode(code: PositionCode, read: Sequence[Symbol]) -> tuple[int, int] | None:
        return next((place for word, place in code.places.items() if part(word) == part(read)), None)

    return decode


WRONG: dict[str, Decoder] = {
    "the direction is ignored": directionless,
    "the newest symbol comes first": backwards,
    "one error is corrected": nearest(1),
    "two errors are corrected": nearest(2),
    "the oldest symbol is not compared": likeness(lambda word: word[1:]),
    "lengths are not compared": likeness(lambda word: [one.rises for one in word]),
    "rise and fall are not compared": likeness(lambda word: [one.long for one in word]),
}


@pytest.mark.parametrize("edit", WRONG)
def test_a_wrong_decoder_is_refused(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """It gives a wrong place within the law, and the law's term is broken by what the host then tells."""
    tried, coded = within_the_law(SIMULATED), CodedLine(SIMULATED)
    monkeypatch.setattr(PositionCode, "decode", WRONG[edit])
    misled = wrong_places(SIMULATED, tried)
    assert misled
    assert any(not coded.keeps(one) for one in misled)


def test_a_code_of_unique_words_alone_is_refused() -> None:
    """One section read wrongly gives a wrong place: the rule on errors is needed beside the one on windows."""
    code = make_code(20, strict=False)
    misled = wrong_places(code, within_the_law(code))
    assert misled
    coded = CodedLine(code)
    assert not any(coded.keeps(one) for one in misled)


def test_an_error_that_the_law_excludes_is_none_of_the_readings() -> None:
    """A false section read last, which copies the next one, would mislead with any code."""
    row, window = SIMULATED.symbols, SIMULATED.window
    copied = Reading(row[:window], 0, 1)
    assert copied in false_at_the_end(row, window)
    assert wrong_places(SIMULATED, [copied]) == [copied]
    assert copied not in within_the_law(SIMULATED)


# ------------------------------------------------------------------ what breaks beyond the law


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", CODES)
def test_the_page_has_the_figures(name: str) -> None:
    """How many readings beyond the law there are, and to how many of them the decoder gives a wrong place."""
    code = CODES[name]
    one, two = (readings(code.symbols, code.window, wrong) for wrong in (1, 2))
    last = false_at_the_end(code.symbols, code.window)
    figures = [f"{len(wrong_places(code, wrong))} of {len(wrong)}" for wrong in (one, two, last)]
    assert f"| {len(code.symbols)} | {code.window} | {' | '.join(figures)} |" in PAGE
