"""A wrong edit of a term of the fibre machine is noticed by a claim: claims speak of truth and inputs, not of its terms."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safeloc.language.expr import FALSE, TRUE, Bool, Num, abs_, as_num, ceil_to, exact_to, ite
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.units import MM, NM
from safeloc.models import fibre
from safeloc.models.fibre import FibreConfig, build, parts
from safeloc.models.fibre import variables as v
from safeloc.models.fibre.cycle import Cycle
from safeloc.models.fibre.variables import Parts
from safeloc.properties.fibre import properties
from tests.models.edited_terms import edited, keeps
from tests.models.inductive import changed

CONFIG = FibreConfig()
READ_MM = CONFIG.read_tolerance_mm


def made() -> tuple[Machine, list[Property]]:
    """The machine as it is built now, and its claims."""
    model = build(parts(CONFIG))
    return model.machine, properties(model)


def no_fall(_cycle: Cycle, right: Num) -> Num:
    """A fall of the amplitude is never noticed."""
    return ite(right.eq(v.LOWERED), v.NORMAL, right)


def missed_above_only(cycle: Cycle, _right: Bool) -> Bool:
    """A missed section is not noticed while running down."""
    beyond = cycle.own.ahead.known & (cycle.place - (READ_MM + cycle.slack) > cycle.own.ahead.near)
    return cycle.own.band.eq(v.NORMAL) & ~cycle.enters & beyond


def expected(cycle: Cycle, window_mm: Num | int) -> Bool:
    """The signal is that of the map's section within a window."""
    known, near, _, rises, _ = cycle.own.next_to(cycle.forwards)
    off = abs_(cycle.place - near)
    return known & rises.iff(cycle.band.eq(v.RAISED)) & (off <= window_mm) & ~cycle.full


def leaving_cycle_free(cycle: Cycle, _right: Num) -> Num:
    """The run of the cycle in which a section is left is not added in its length."""
    return ceil_to(cycle.drift, MM)


def of_this_cycle(cycle: Cycle, _right: Num) -> Num:
    """What was run before without an amplitude is not added to an edge."""
    return ite(cycle.own.run.present, exact_to(abs_(cycle.own.run.value), NM), as_num(0, NM)) + cycle.added_error


def half_way(cycle: Cycle, _right: Bool) -> Bool:
    """Whatever was left before half a short section was left where it was entered."""
    return abs_(cycle.inside) <= CONFIG.short_mm // 2


def reads(cycle: Cycle, _right: Bool, length: int) -> Bool:
    """The length of a section without what the run may be wrong by."""
    return abs_(cycle.inside - length) <= READ_MM


Wrong = Callable[..., object]
EDITS: dict[str, tuple[str, Wrong, str]] = {
    "a fall is never noticed": ("band", no_fall, "the band follows the amplitude"),
    "a fall is no edge": ("band", no_fall, "containment"),
    "a section missed while running down": ("overdue", missed_above_only, "missed section raises F at once"),
    "no section is ever missed": ("overdue", lambda _c, _r: FALSE, "missed section raises F at once"),
    "the window without what the run may be wrong by": (
        "fits", lambda c, _: expected(c, READ_MM + CONFIG.max_cycle_distance_mm), "a located end stays located"),
    "a window far too wide": ("fits", lambda c, _: expected(c, 3_000_000), "containment"),
    "any place for a section": (
        "fits", lambda c, _: c.own.ahead.known & ~c.full, "false section raises F at once"),
    "a section of any kind": (
        "fits", lambda c, _: c.own.next_to(c.forwards)[0] & (abs_(c.place - c.own.next_to(c.forwards)[1]) <= READ_MM), "containment"),
    "the run of an edge's cycle is not added": ("fresh", lambda c, _: c.added_error, "containment"),
    "the run without an amplitude is not added": ("fresh", of_this_cycle, "containment"),
    "the run without an amplitude is not added, claimed": (
        "fresh", of_this_cycle, "an edge adds the run of its cycle to the error"),
    "an edge after any silence": ("late", lambda _c, _r: FALSE, "a change of long ago is no signal"),
    "the leaving cycle is not added in the length": (
        "edge_slack", leaving_cycle_free, "a length that is read is the true one"),
    "the leaving cycle is not added in the map's length": (
        "edge_slack", leaving_cycle_free, "wrong length raises F"),
    "lengths without what the run may be wrong by": ("_reads", reads, "a length that is read is the true one"),
    "turned back by half a section": ("turned_back", half_way, "containment"),
    "turned back by half a section, claimed": ("turned_back", half_way, "a section left again was not passed"),
    "never turned back": ("turned_back", lambda _c, _r: FALSE, "a located end stays located"),
    "always turned back": ("turned_back", lambda _c, _r: TRUE, "containment"),
    "a long section is whatever is left late": (
        "reads_long", lambda c, _: abs_(c.inside) > CONFIG.short_mm, "a length that is read is the true one"),
    "a wrong length is no error": ("wrong_length", lambda _c, _r: FALSE, "disagreement raises F"),
    "a section without end": ("endless", lambda _c, _r: FALSE, "endless section raises F at once"),
    "rate and floor are not added": ("added_error", lambda _c, _r: as_num(0, NM), "containment"),
    "the run is not followed": ("since", lambda c, _: c.own.run_since_edge, "containment"),
    "the direction is that of before": ("forwards", lambda c, _: c.own.forwards, "direction and silence are followed"),
    "an unheard pattern is followed": ("silent", lambda _c, _r: FALSE, "a pattern that is lost has no place"),
}  # fmt: skip


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The claim that is named is kept by the machine as it is, and not by the one that was edited wrongly."""
    name, wrong, claim = EDITS[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, Cycle, name, wrong)
    assert not keeps(made(), claim)


OUTPUTS: dict[str, tuple[str, Callable[[Parts], Bool], tuple[str, ...]]] = {
    "every event is a signal": (
        "position_signal", lambda own: own.event.ne(v.NO_SIGNAL),
        ("a position signal is reported as one", "a signal is reported at an edge alone")),
    "a section passed is the signal": (
        "position_signal", lambda own: own.event.eq(v.PASSED),
        ("an edge that begins a section is reported as a signal", "a signal is reported at an edge alone")),
    "no signal is reported": (
        "position_signal", lambda _: FALSE, ("an edge that begins a section is reported as a signal",)),
    "a damped section is not reported": (
        "in_section", lambda own: own.band.eq(v.RAISED),
        ("an end in a section is reported", "a section is reported from its first edge to its last")),
    "a section is reported beside it": (
        "in_section", lambda own: own.band.ne(v.LOWERED),
        ("an end in a section is reported", "a section is reported from its first edge to its last")),
    "a section is reported while it is followed alone": (
        "in_section", lambda own: own.band.ne(v.NORMAL) & own.counted,
        ("a section is reported from its first edge to its last",)),
}  # fmt: skip


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("edit", OUTPUTS)
def test_a_wrong_output_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """What is reported of signal and section is claimed by inputs and world, not by the machine's own event and band."""
    name, wrong, claims = OUTPUTS[edit]
    right = fibre._outputs
    assert [] == [claim for claim in claims if not keeps(made(), claim)]
    monkeypatch.setattr(fibre, "_outputs", lambda own, *rest: {**right(own, *rest), name: wrong(own)})
    assert [] == [claim for claim in claims if keeps(made(), claim)]


@pytest.mark.parametrize("edit", ["upwards", "a count that is not negative"])
def test_a_word_that_is_not_taken_is_noticed(edit: str) -> None:
    """A machine that is located by no word read downwards, or below the place where it began to count, gives no wrong place."""
    model = build(parts(CONFIG))
    own, claims = model.own, properties(model)
    only = {"upwards": own.upwards, "a count that is not negative": own.sections_counted >= 0}[edit]
    [row] = [one for one in model.machine.transitions if one.name == "code word found"]
    wrong = changed(model.machine, row.name, when=row.when & only)
    assert keeps((model.machine, claims), "a complete word gives the place")
    assert not keeps((wrong, claims), "a complete word gives the place")
    assert keeps((wrong, claims), "a code word is complete")


def test_an_end_that_stops_reading_is_noticed() -> None:
    """A machine that no longer follows the sections as one is passed downwards completes no such word, and keeps the claims on words."""
    model = build(parts(CONFIG))
    cycle, claims = Cycle(model.own), properties(model)
    [row] = [one for one in model.machine.transitions if one.name == "no end of the section"]
    wrong = changed(model.machine, row.name, when=row.when | (cycle.read & ~cycle.forwards))
    assert keeps((model.machine, claims), "an end that counts goes on")
    assert not keeps((wrong, claims), "an end that counts goes on")
    assert keeps((wrong, claims), "a complete word gives the place")
    assert keeps((wrong, claims), "the code word consists of the sections read")
