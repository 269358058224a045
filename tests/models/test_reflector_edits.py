"""A wrong edit of a term of the reflector machine is noticed by a proof: claims speak of truth and inputs, not of its terms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from safeloc.language.expr import FALSE, TRUE, Bool, Num, abs_, as_num, exact_to, ite, with_unit
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.units import MM, NM
from safeloc.models.reflector import build
from safeloc.models.reflector.balise_reading import BaliseReading
from safeloc.models.reflector.cycle import Judged
from safeloc.models.reflector.dead_reckoning import Interval, Odometer
from safeloc.models.reflector.echo import Recognition, Situation
from safeloc.models.reflector.map_data import NextReflector, Reflector, Target
from safeloc.models.reflector.variables import ReflectorConfig, parts
from safeloc.properties.reflector import properties
from tests.models.edited_terms import edited, keeps

CONFIG = ReflectorConfig(echo_slots=1, radar_offset_mm=20_000)
"""The radar stands behind end A, so that a wrong offset shows."""
M = 1_000


def made(slots: int = 1) -> tuple[Machine, list[Property]]:
    """The machine as it is built now, and its claims."""
    model = build(parts(CONFIG.model_copy(update={"echo_slots": slots})))
    return model.machine, properties(model)


def reference(cycle: Judged, *, lax_mm: int = 0, offset_mm: int = CONFIG.radar_offset_mm) -> Bool:
    """The self-test with other figures."""
    missed = cycle.target.range + cycle.run - offset_mm - cycle.reference
    allowed = exact_to(cycle.target.error + (CONFIG.reference_tolerance_mm + lax_mm), NM)
    return exact_to(abs_(missed), NM) <= allowed + with_unit(abs_(cycle.run) * CONFIG.odometer.rate_ppm, NM)


def lax_run(cycle: Judged, lax_mm: int) -> Bool:
    """The check of a steady error, so much too lax."""
    fix = cycle.target.fix
    return Interval(fix.position, fix.above + lax_mm * 1_000_000, fix.below + lax_mm * 1_000_000).meets(cycle.anchored)


def run_error(balise: BaliseReading) -> Num:
    """What the odometer may err over the run since the balise, nm; mm x ppm = nm."""
    return with_unit(abs_(balise.run) * balise.law_ppm, NM)


Wrong = Callable[..., object]
EDITS: dict[str, tuple[type, str, Wrong, str]] = {
    "self-test 20 m too lax": (
        Judged, "reference_holds", lambda c, _: reference(c, lax_mm=20 * M), "the test is the prescribed distance"),
    "self-test without the radar's offset": (
        Judged, "reference_holds", lambda c, _: reference(c, offset_mm=0), "the test is the prescribed distance"),
    "self-test always passed": (Judged, "reference_holds", lambda _c, _r: TRUE, "the test is the prescribed distance"),
    "self-test never passed": (Judged, "reference_holds", lambda _c, _r: FALSE, "a test fails only on a wrong distance"),
    "steadiness 20 m too lax": (Judged, "steady", lambda c, _: lax_run(c, 20 * M), "error is constant"),
    "never steady": (Judged, "steady", lambda _c, _r: FALSE, "a sound radar raises no alarm"),
    "not found 100 m late": (
        Reflector, "over", lambda r, _, held, run: held.low > r.search_ends(run + 100 * M), "what is looked for is found in time"),
    "not found 100 m early": (
        Reflector, "over", lambda r, _, held, run: held.low > r.search_ends(run - 100 * M),
        "not found is said only beyond the search"),
    "passed unseen and not said": (Judged, "passed_unseen", lambda _c, _r: FALSE, "nothing is skipped"),
    "passed unseen whatever was found": (
        Judged, "passed_unseen", lambda c, _: c.own.ahead.known & c.own.ahead.reflector.over(c.held, CONFIG.search_run_mm),
        "passed unseen is said only beyond the search"),
    "the reference is waited for without end": (
        Judged, "reference_over", lambda _c, _r: FALSE, "the reference reflector is found in time"),
    "the search goes on behind": (Judged, "search_left", lambda _c, _r: FALSE, "it is looked for where it may be in view"),
    "the search is left in the view zone": (
        Judged, "search_left", lambda c, _: c.held.low < c.reflector.view_begins(), "the search is left only before the view zone"),
    "too close by the rear end": (
        Judged, "too_close", lambda c, _: c.held.low >= exact_to(c.reflector.place - c.reflector.view_to, NM),
        "no echo is waited for when too close"),
    "gone by with the front end": (
        Judged, "gone_by", lambda c, _: c.held.high >= exact_to(c.reflector.place, NM), "what was passed lies behind"),
    "never gone by": (Judged, "gone_by", lambda _c, _r: FALSE, "passing goes on until it lies behind"),
    "any neighbour": (Reflector, "roomy", lambda _r, _, _held: TRUE, "never too early"),
    "view without the radar's offset": (
        Reflector, "view_begins", lambda r, _: exact_to(r.place - CONFIG.radar_offset_mm - r.view_from, NM), "never too early"),
    "no latency of the frame": (
        Situation, "fix", lambda now, _, r, range_, error: Interval(
            r.place - range_, exact_to(error, NM) + now.law.accuracy_nm, exact_to(error, NM) + now.law.accuracy_nm),
        "containment"),
    "no accuracy of the map": (
        Situation, "fix", lambda _, right, *_a: Interval(right.position, right.above - 50_000_000, right.below - 50_000_000),
        "containment"),
    "the radar's offset twice": (
        NextReflector, "reflector", lambda n, right: replace(right, place=n.position.value + 2 * n.offset_mm), "containment"),
    "no offset of the target": (Target, "reflector", lambda t, right: replace(right, place=t.position + 0), "containment"),
    "a clearance twice as wide": (
        NextReflector, "reflector", lambda _n, right: replace(right, clear=right.clear * 2), "containment"),
    "the target keeps no clearance of its own": (
        Target, "become", lambda t, right, ahead: {**right, t.clear: ahead.view_from},
        "the target is the next reflector of the map"),
    "balise without the odometer's rate": (
        BaliseReading, "fix", lambda b, right, _o: Interval(
            right.position, right.above - run_error(b), right.below - run_error(b)), "containment"),
    "balise without its latency": (
        BaliseReading, "fix", lambda b, _, _o: Interval(
            b.position.value + b.run, *2 * (exact_to(b.accuracy.value_or(as_num(b.accuracy_mm, MM)), NM) + run_error(b),)),
        "containment"),
    "balise without the run since it": (
        BaliseReading, "fix", lambda b, right, _o: Interval(b.position.value, right.above, right.below), "containment"),
    "balise beyond the position believed": (
        Judged, "balise_contradicts", lambda _c, _r: FALSE, "a balise far away is noticed"),
    "a true balise contradicts": (
        Judged, "balise_contradicts", lambda c, _: c.zones.located & c.own.balise.read, "only a stray balise contradicts"),
    "odometer error not charged": (Odometer, "growth", lambda _o, right: right * 0, "containment"),
    "blind cycles not charged": (Odometer, "growth", lambda o, right: ite(o.admitted, right, right * 0), "containment"),
    "constant not charged": (Odometer, "constant_nm", lambda _o, _r: 0, "containment"),
    "any distance admitted": (Odometer, "admitted", lambda o, _: o.step.present, "containment"),
    "silent odometer not noticed": (Odometer, "failed", lambda _o, _r: FALSE, "without an odometer nothing is reported"),
    "the lag of the other direction": (
        Odometer, "lag", lambda _o, right, _share: (right[1], right[0]), "containment"),
    "an echo of the wrong sign": (
        Situation, "fix", lambda _, right, r, range_, _e: Interval(r.place + range_, right.above, right.below), "containment"),
}  # fmt: skip


@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The claim that is named is kept by the machine as it is, and not by the one that was edited wrongly."""
    owner, name, wrong, claim = EDITS[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, owner, name, wrong)
    assert not keeps(made(), claim)


OF_TWO: dict[str, tuple[type, str, Wrong, str]] = {
    "echoes that exclude each other are believed": (
        Recognition, "conflict", lambda _c, _r: FALSE, "echoes that exclude each other give no position"),
    "every second echo is a conflict": (Recognition, "conflict", lambda _c, _r: TRUE, "what fits is used"),
    "the last echo instead of the first": (
        Recognition, "of_chosen", lambda _c, _, terms: terms[-1], "the reported reflector sent the echo"),
    "views that overlap always contradict": (
        Judged, "overlap_contradicts", lambda c, _: c.target.accepted & c.ahead.accepted, "a sound radar raises no alarm"),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("edit", OF_TWO)
def test_a_wrong_edit_of_two_echoes_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The same with two echoes in a frame."""
    owner, name, wrong, claim = OF_TWO[edit]
    assert keeps(made(2), claim)
    edited(monkeypatch, owner, name, wrong)
    assert not keeps(made(2), claim)
