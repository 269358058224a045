"""A position that is not valid is absent: of every machine that ships, in every state, in C and in FMI."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from safeloc.catalogue import ENTRIES
from safeloc.codegen.c99 import library_texts
from safeloc.codegen.c99_layout import layout_of
from safeloc.codegen.fmi3_description import description
from safeloc.codegen.fmi3_variables import variables_of
from safeloc.language.absence import stand_ins
from safeloc.language.expr import Num, boolean, number
from safeloc.language.nodes import Choose
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.units import MM
from safeloc.models.delocalized import machine
from safeloc.models.vocabulary.absent import NO_MARGIN_MM, NO_POSITION_MM, margin_if, position_if
from safeloc.target import Target
from tests.shipped import shipped

OF = {"position_mm": NO_POSITION_MM, "margin_above_mm": NO_MARGIN_MM, "margin_below_mm": NO_MARGIN_MM}


def intervals(target: Target) -> dict[str, Num]:
    """Outputs of the machine that are a position or its margins, but for places of things on a map."""
    outputs = target.system.outputs
    return {full: term for full, term in outputs.items() if full.rpartition(".")[2] in OF and isinstance(term, Num)}


@pytest.mark.parametrize("name", ENTRIES)
def test_every_position_may_be_absent_with_its_margins(name: str) -> None:
    """All three under the same condition, so that none is there without the others; the interval that the machine reports is among them."""
    target = shipped(name)
    found, terms = stand_ins(target.system), intervals(target)
    assert {full: OF[full.rpartition(".")[2]] for full in terms} == {full: found.get(full) for full in terms}
    conditions = {full.rpartition(".")[0]: set[str]() for full in terms}
    for full, term in terms.items():
        assert isinstance(term, Choose)
        conditions[full.rpartition(".")[0]].add(repr(term.condition))
    assert [1] * len(conditions) == [len(one) for one in conditions.values()]
    if (reported := target.reported) is not None:
        assert {reported.position, reported.below, reported.above} <= set(found)


def test_the_two_numbers() -> None:
    """A margin has the one for margins, a position the other."""
    valid, length = boolean("valid"), number("length_mm", MM, 0, 9)
    for made, stand_in in ((position_if, -2_000_000_000_000), (margin_if, 4_000_000_000_000)):
        shown = made(valid, length)
        assert isinstance(shown, Choose)
        assert f"{stand_in}" in repr(shown.other)


def on_board() -> TransitionSystem:
    """The restrictive state behind any source, without ghosts."""
    return without_ghosts(lower(machine()))


def test_c_has_a_constant_for_each() -> None:
    """And the field of the output names it; its range is that of a position that is there."""
    header = next(text for name, text in library_texts(layout_of(on_board())).items() if name.endswith(".h"))
    assert "#define DELOCALIZED_ABSENT_POSITION_MM INT64_C(-2000000000000)" in header
    assert "#define DELOCALIZED_ABSENT_MARGIN_ABOVE_MM INT64_C(4000000000000)" in header
    assert "int64_t position_mm; /* mm, -1000000000 .. 1000000000, or DELOCALIZED_ABSENT_POSITION_MM */" in header


def test_fmi_describes_each() -> None:
    """The description says what stands in, and the greatest and least value include it."""
    layout = layout_of(on_board())
    tree = ElementTree.fromstring(description(layout, variables_of(layout, {}), 100, "").split("?>", 1)[-1])
    told = {one.attrib["name"]: one.attrib for one in tree.iter("Int64")}
    assert told["position_mm"]["description"] == "in mm; -2000000000000 while it is absent"
    assert (told["position_mm"]["min"], told["position_mm"]["max"]) == ("-2000000000000", "1000000000")
    assert (told["margin_above_mm"]["min"], told["margin_above_mm"]["max"]) == ("0", "4000000000000")
