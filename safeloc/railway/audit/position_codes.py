"""Position codes: the sections of a fibre that the map calls a code give the place to the fibre machine as it is configured (FWG-10).

The fibre machine reads `code_window` symbols and asks the map for their place. That a word lies at one place only,
also with an error among its sections, is what the law of its world rests on; here it is checked on the map, for the window
that is configured. A fibre with fewer sections than that has no word.
"""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.models.fibre.code import PositionCode, Symbol, Word, least_window, nearest_alike
from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.audit.findings import Ledger
from safeloc.railway.audit.rules import UNBOUNDED, Rules
from safeloc.railway.map.elements import Fibre, LocalizationSection
from safeloc.railway.map.places import Place
from safeloc.railway.map.walk import Walk


def check_position_codes(walk: Walk, rules: Rules, ledger: Ledger) -> None:
    """Check every fibre whose sections are a code."""
    for fibre in walk.line.fibres:
        if fibre.position_code:
            sections = sorted(
                (one for one in walk.line.localization_sections if one.fibre == fibre.id),
                key=lambda one: one.from_fibre_mm,
            )
            _check(rules, ledger, fibre, sections)


def _check(rules: Rules, ledger: Ledger, fibre: Fibre, sections: Sequence[LocalizationSection]) -> None:
    lengths = [
        ledger.check(
            rules.section_length, _place(fibre, one.from_fibre_mm), f"section {one.id} of fibre {fibre.id}",
            length_of_cable_mm=one.to_fibre_mm - one.from_fibre_mm,
        )
        for one in sections
    ]  # fmt: skip
    if not all(lengths):
        return  # the symbol of a section of another length is not known
    symbols, layout = tuple(_symbol(one, rules.layout) for one in sections), rules.layout
    near = _near(rules, ledger, fibre, sections, symbols)
    least, start = least_window(symbols), _place(fibre, 0)
    subject = f"fibre {fibre.id}, {len(symbols)} sections"
    figure = UNBOUNDED if least is None or len(symbols) < layout.code_window else least
    unique = ledger.check(rules.code_window, start, subject, sections_that_give_a_place=figure)
    if near and unique:
        misleading = len(PositionCode(symbols, layout.code_window, layout.code_reach).undetected())
        ledger.check(rules.code_error, start, subject, misleading_readings=misleading)


def _near(rules: Rules, ledger: Ledger, fibre: Fibre, sections: Sequence[LocalizationSection], symbols: Word) -> bool:
    """Check of each section that none near it is alike; return whether all are told apart."""
    kept = True
    for number, section in enumerate(sections):
        apart = nearest_alike(symbols, number)
        if apart is not None:
            subject = f"section {section.id} of fibre {fibre.id}, alike {sections[number + apart].id}"
            place = _place(fibre, section.from_fibre_mm)
            kept &= ledger.check(rules.code_reach, place, subject, sections_apart=apart)
    return kept


def _symbol(section: LocalizationSection, layout: LayoutConfig) -> Symbol:
    long = section.to_fibre_mm - section.from_fibre_mm >= layout.long_section_mm
    return Symbol(section.effect == "raises", long)


def _place(fibre: Fibre, fibre_mm: int) -> Place:
    """Return the last surveyed point before a place on the cable, or the first one."""
    before = [point for point in fibre.map_points if point.fibre_mm <= fibre_mm]
    point = before[-1] if before else fibre.map_points[0]
    return Place(point.edge, point.position_mm)
