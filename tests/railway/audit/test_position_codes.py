"""A line whose sections are said to be a code: the window that the fibre machine is configured with gives every place (FWG-10, FWG-15)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import pytest

from safeloc.models.fibre.code import ALPHABET, PositionCode, Symbol, least_window, make_code, nearest_alike
from safeloc.models.fibre.variables import FibreConfig
from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.audit import audit
from safeloc.railway.audit.findings import AuditReport
from safeloc.railway.map.elements import Fibre, FibrePoint, LocalizationSection, Stretch
from safeloc.railway.map.model import Line
from tests.railway.map.made import straight

FIBRE = FibreConfig()
CODE, REACH, LENGTH, ERROR = (
    "position code",
    "near sections differ",
    "section short or long",
    "code withstands an error",
)
RULES = (CODE, REACH, LENGTH, ERROR)
EVERY_MM = 1_000_000


def line(symbols: Sequence[Symbol], *, coded: bool = True, lengths: dict[int, int] | None = None) -> Line:
    """A straight line with a section a kilometre; `lengths`: of some sections by number from 0, mm of cable; else with a usual slack."""
    whole = EVERY_MM * (len(symbols) + 1)
    sections = []
    for number, symbol in enumerate(symbols):
        usual = FIBRE.long_mm * 103 // 100 if symbol.long else FIBRE.short_mm + 2_000
        length = (lengths or {}).get(number, usual)
        start = EVERY_MM * (number + 1) - 500_000
        effect = "raises" if symbol.rises else "lowers"
        sections.append(
            LocalizationSection(
                id=f"z{number + 1}", fibre="f", from_fibre_mm=start, to_fibre_mm=start + length, effect=effect  # type: ignore[arg-type]
            )
        )  # fmt: skip
    points = tuple(FibrePoint(fibre_mm=at, edge="e0", position_mm=at) for at in range(0, whole + 1, EVERY_MM))
    path = (Stretch(edge="e0", from_mm=0, to_mm=whole),)
    fibre = Fibre(id="f", length_mm=whole, path=path, map_points=points, position_code=coded)
    return straight(whole, fibres=(fibre,), localization_sections=tuple(reversed(sections)))


def told(report: AuditReport) -> list[tuple[str, str]]:
    """Rule and text of the findings about the code."""
    return [(one.rule, one.as_text()) for one in report.findings if one.rule in RULES]


def test_the_figures_are_those_of_the_fibre_machine() -> None:
    """Whoever changes the machine's window changes what the line is checked for."""
    layout = LayoutConfig()
    assert (layout.code_window, layout.code_reach) == (FIBRE.window, FIBRE.reach)
    assert (layout.short_section_mm, layout.long_section_mm) == (FIBRE.short_mm, FIBRE.long_mm)


@pytest.mark.parametrize("count", [5, 12])
def test_a_code_keeps_every_rule(count: int) -> None:
    """Each section, each pair of alike ones, the window and its errors are checked; the order in the file is no matter."""
    code = make_code(count, FIBRE.window, FIBRE.reach)
    report = audit(line(code.symbols))
    alike = sum(nearest_alike(code.symbols, number) is not None for number in range(count))
    assert [] == told(report)
    assert {CODE: 1, ERROR: 1, LENGTH: count, REACH: alike} == {rule: report.cases[rule] for rule in RULES}


def test_sections_that_are_counted_are_no_code() -> None:
    """Alike sections are allowed where the map does not say that they are a code, and nothing is checked."""
    report = audit(line([ALPHABET[0]] * 6, coded=False))
    assert [] == told(report)
    assert not set(RULES) & set(report.cases)


def test_a_window_that_is_too_short_for_the_line_is_found() -> None:
    """Two places with the same four sections: five tell them apart, four do not. The finding says how many would."""
    one, two, three, four = ALPHABET
    row = (one, two, three, four, one, two, three, two, four, three)
    least = least_window(row)
    assert least == 4
    assert [] == [
        text for rule, text in told(audit(line(row), LayoutConfig(code_window=4, code_reach=1))) if rule != ERROR
    ]
    ((rule, text),) = told(audit(line(row), LayoutConfig(code_window=3, code_reach=1)))
    assert CODE == rule
    assert text == (
        "violated  position code [FWG-10 FWG-15] fibre f, 10 sections, on e0 at 0 mm: sections that give a place 4, must be <= 3"
    )


def test_a_row_that_repeats_itself_gives_no_place() -> None:
    """Read backwards it is itself: no number of sections tells the direction."""
    one, two, three, _ = ALPHABET
    row = (one, two, three, two, one)
    found = told(audit(line(row), LayoutConfig(code_reach=1)))
    assert ("violated  position code [FWG-10 FWG-15] fibre f, 5 sections, on e0 at 0 mm: "
            "sections that give a place without bound, must be <= 5") in [text for _, text in found]  # fmt: skip


def test_fewer_sections_than_a_word_give_no_place() -> None:
    """Four are told apart by two in a row, but a word of five never comes about."""
    assert 2 == least_window(ALPHABET)
    assert CODE in {rule for rule, _ in told(audit(line(ALPHABET)))}
    assert CODE not in {rule for rule, _ in told(audit(line(ALPHABET), LayoutConfig(code_window=4)))}


def test_alike_sections_within_the_reach_are_found() -> None:
    """With the section that is too near, and its distance."""
    symbols = list(make_code(12).symbols)
    symbols[5] = symbols[3]
    found = [text for rule, text in told(audit(line(symbols))) if rule == REACH]
    assert found[0] == (
        "violated  near sections differ [FWG-9 FWG-10] section z4 of fibre f, alike z6, on e0 at 3000000 mm: "
        "sections apart 2, must be > 2"
    )


@pytest.mark.parametrize(
    ("length", "kept"),
    [(149_999, False), (150_000, True), (154_500, True), (154_501, False), (411_999, False), (412_000, True), (900_000, True)],
)  # fmt: skip
def test_a_length_between_short_and_long_is_found(length: int, kept: bool) -> None:
    """Of cable, which is up to 3 % longer than its track; a section of another length has no symbol, so no code is checked."""
    symbols = make_code(12).symbols
    number = next(at for at, one in enumerate(symbols) if one.long == (length > 200_000))
    report = audit(line(symbols, lengths={number: length}))
    assert kept == (LENGTH not in {rule for rule, _ in told(report)})
    assert kept == (CODE in report.cases)


def test_a_code_that_an_error_may_mislead_is_found() -> None:
    """Unique windows alone do not withstand a missed section."""
    code = make_code(20, 6, strict=False)
    report = audit(line(code.symbols), LayoutConfig(code_window=6))
    ((rule, text),) = told(report)
    assert ERROR == rule
    assert text.startswith(
        "violated  code withstands an error [FWG-10] fibre f, 20 sections, on e0 at 0 mm: misleading readings "
    )
    assert text.endswith(f" {len(code.undetected())}, must be <= 0")


@pytest.mark.parametrize("count", [5, 8, 12])
def test_the_least_window_is_the_least_that_is_a_code(count: int) -> None:
    """One less is refused as a code, and no window that is longer is."""
    symbols = make_code(count).symbols
    least = least_window(symbols)
    assert least is not None
    for window in range(max(least, 3), count + 1):
        PositionCode(symbols, window, 2)
    if least > 3:
        with pytest.raises(Exception, match="are alike"):
            PositionCode(symbols, least - 1, 2)


def test_no_code_no_least_window() -> None:
    """Alike sections have none, nor has a single one; neighbours that differ are alike nobody."""
    assert least_window(ALPHABET[:1] * 4) is None
    assert least_window(ALPHABET[:1]) is None
    assert [None] * 4 == [nearest_alike(ALPHABET, number) for number in range(4)]
    assert all(first != second for first, second in pairwise(make_code(8).symbols))
