"""A wrong edit of a term of the reflector machine is noticed by a proof: claims speak of truth and inputs, not of its terms."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from types import ModuleType

import pytest

from safeloc.language.expr import FALSE, TRUE, Bool, Num, abs_, as_num, exact_to, ite, with_unit
from safeloc.language.machine import Machine, Transition
from safeloc.language.rows import Updates
from safeloc.language.spec import Property
from safeloc.language.units import MM, NM
from safeloc.models.reflector import build, echo, table
from safeloc.models.reflector import cycle as cycles
from safeloc.models.reflector.balise_reading import BaliseReading
from safeloc.models.reflector.cycle import Judgement
from safeloc.models.reflector.echo import Recognition, Situation
from safeloc.models.reflector.map_data import NextReflector, Reflector, Target
from safeloc.models.reflector.odometer import ReflectorOdometer as Odometer
from safeloc.models.reflector.variables import Parts, ReflectorConfig, parts
from safeloc.models.vocabulary.interval import Interval
from safeloc.models.vocabulary.reflectors import MODEL, NO_MODEL
from safeloc.properties.reflector import properties
from tests.models.edited_terms import edited, keeps

CONFIG = ReflectorConfig(echo_slots=1, radar_offset_mm=20_000)
"""The radar stands behind end A, so that a wrong offset shows."""
M = 1_000


def made(slots: int = 1) -> tuple[Machine, list[Property]]:
    """The machine as it is built now, and its claims."""
    model = build(parts(CONFIG.model_copy(update={"echo_slots": slots})))
    return model.machine, properties(model)


def reference(cycle: Judgement, *, lax_nm: int = 0, offset_mm: int = CONFIG.radar_offset_mm) -> Bool:
    """The self-test with other figures."""
    missed = exact_to(cycle.target.range + cycle.run - offset_mm - cycle.reference, NM)
    fix, known, more = cycle.target.bare, cycle.known, CONFIG.accuracy_nm + lax_nm
    return (missed <= known.below + fix.above + more) & (missed >= -(known.above + fix.below + more))


def nearer(interval: Interval, above: Num | int = 0, below: Num | int = 0) -> Interval:
    """The interval with so much less on its sides, nm."""
    return Interval(interval.position, interval.above - above, interval.below - below)


def lax_run(cycle: Judgement, lax_mm: int) -> Bool:
    """The check of a steady error, so much too lax."""
    return cycle.target.bare.widened(lax_mm * 1_000_000).meets(cycle.drifted)


def run_error(balise: BaliseReading) -> Num:
    """What the odometer may err over the run since the balise, nm; mm x ppm = nm."""
    return with_unit(abs_(balise.run) * balise.law_ppm, NM)


Wrong = Callable[..., object]
Edits = dict[str, tuple[type | ModuleType, str, Wrong, str]]
EDITS: Edits = {
    "self-test 20 m too lax": (
        Judgement, "reference_holds", lambda c, _: reference(c, lax_nm=20 * M * 1_000_000), "the test is the prescribed distance"),
    "self-test without the radar's offset": (
        Judgement, "reference_holds", lambda c, _: reference(c, offset_mm=0), "the test is the prescribed distance"),
    "self-test always passed": (Judgement, "reference_holds", lambda _c, _r: TRUE, "the test is the prescribed distance"),
    "self-test never passed": (Judgement, "reference_holds", lambda _c, _r: FALSE, "a test fails only on a wrong distance"),
    "steadiness 20 m too lax": (Judgement, "steady", lambda c, _: lax_run(c, 20 * M), "error is constant"),
    "never steady": (Judgement, "steady", lambda _c, _r: FALSE, "a sound radar raises no alarm"),
    "not found 100 m late": (
        Reflector, "over", lambda r, _, held, run: held.low > r.search_ends(run + 100 * M), "the search for a reflector ends in time"),
    "not found 100 m early": (
        Reflector, "over", lambda r, _, held, run: held.low > r.search_ends(run - 100 * M),
        "not found is reported only beyond the search run"),
    "the reflector found is not stored": (
        vars(table)["_Groups"], "seen", lambda _g, right, *_a: {var: term for var, term in right.items() if var.name != "last_found_mm"},
        "the reflector found last is stored"),
    "the reflector found is stored a metre on": (
        vars(table)["_Groups"], "seen",
        lambda _g, right, *_a: {var: term + M if var.name == "last_found_mm" else term for var, term in right.items()},
        "the reflector found last is stored"),
    "passed unseen and not said": (Judgement, "passed_unseen", lambda _c, _r: FALSE, "nothing is skipped"),
    "passed unseen whatever was found": (
        Judgement, "passed_unseen", lambda c, _: c.own.ahead.known & c.own.ahead.reflector.over(c.held, CONFIG.search_run_mm),
        "passed unseen is reported only beyond the search run"),
    "the reference is waited for without end": (
        Judgement, "reference_over", lambda _c, _r: FALSE, "the reference reflector is found in time"),
    "the search goes on behind": (Judgement, "search_left", lambda _c, _r: FALSE, "a reflector is searched only where it may be in view"),
    "the search is left in the view zone": (
        Judgement, "search_left", lambda c, _: c.held.low < c.reflector.view_begins(), "the search is left only before the view zone"),
    "too close by the rear end": (
        Judgement, "too_close", lambda c, _: c.held.low >= exact_to(c.reflector.place - c.reflector.view_to, NM),
        "no echo is waited for when too close"),
    "gone by with the front end": (
        Judgement, "gone_by", lambda c, _: c.held.high >= exact_to(c.reflector.place, NM), "a passed reflector lies behind the vehicle"),
    "never gone by": (Judgement, "gone_by", lambda _c, _r: FALSE, "passing goes on until it lies behind"),
    "any neighbour": (Reflector, "roomy", lambda _r, _, _held: TRUE, "never too early"),
    "view without the radar's offset": (
        Reflector, "view_begins", lambda r, _: exact_to(r.place - CONFIG.radar_offset_mm - r.view_from, NM), "never too early"),
    "no latency of the frame": (
        Situation, "bare", lambda now, right, *_a: nearer(right, *now.lag), "containment"),
    "no accuracy of the map": (
        Situation, "bare", lambda _, right, *_a: nearer(right, 50_000_000, 50_000_000), "containment"),
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
        BaliseReading, "fix", lambda b, right, _o: Interval(right.position - b.run, right.above, right.below), "containment"),
    "balise beyond the position believed": (
        Judgement, "balise_contradicts", lambda _c, _r: FALSE, "a balise far away is noticed"),
    "a true balise contradicts": (
        Judgement, "balise_contradicts", lambda c, _: c.zones.located & c.own.balise.read, "only a stray balise contradicts"),
    "odometer error not added": (Odometer, "growth", lambda _o, right: right * 0, "containment"),
    "blind cycles not added": (Odometer, "growth", lambda o, right: ite(o.admitted, right, right * 0), "containment"),
    "constant not added": (Odometer, "constant_nm", lambda _o, _r: 0, "containment"),
    "any distance admitted": (Odometer, "admitted", lambda o, _: o.measured.present, "containment"),
    "silent odometer not noticed": (Odometer, "failed", lambda _o, _r: FALSE, "without an odometer nothing is reported"),
    "the lag of the other direction": (
        Odometer, "lag", lambda _o, right, _share: (right[1], right[0]), "containment"),
    "an echo of the wrong sign": (
        Situation, "bare", lambda _, right, r, range_, _e: Interval(r.place + range_, right.above, right.below), "containment"),
}  # fmt: skip


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The claim that is named is kept by the machine as it is, and not by the one that was edited wrongly."""
    owner, name, wrong, claim = EDITS[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, owner, name, wrong)
    assert not keeps(made(), claim)


OF_RADAR: Edits = {
    "self-test 1 nm too lax": (
        Judgement, "reference_holds", lambda c, _: reference(c, lax_nm=1), "the test is the prescribed distance"),
    "self-test 1 nm too tight": (
        Judgement, "reference_holds", lambda c, _: reference(c, lax_nm=-1), "a right radar passes the self-test"),
    "self-test by the prescribed distance alone": (
        Judgement, "agrees", lambda c, _: c.reference_holds, "a radar that passes errs no more than the test can detect"),
    "self-test by the map alone": (
        Judgement, "agrees", lambda c, _: c.target.fix.meets(c.known), "the test is the prescribed distance"),
    "the radar's scale not added": (
        Situation, "bare", lambda now, right, _r, range_, _e: nearer(
            right, *2 * (with_unit(range_ * CONFIG.radar_scale_ppm, NM),)), "containment"),
    "what the self-test left open not added": (
        Situation, "fix", lambda now, _, *echo: now.bare(*echo), "containment"),
    "what the self-test left open added on the wrong sides": (
        Situation, "fix", lambda now, right, *_a: Interval(
            right.position, right.above - now.open[0] + now.open[1], right.below - now.open[1] + now.open[0]), "containment"),
    "1 nm less added ahead": (Situation, "fix", lambda _, right, *_a: nearer(right, 1, 0), "containment"),
    "1 nm less added behind": (Situation, "fix", lambda _, right, *_a: nearer(right, 0, 1), "containment"),
    "1 nm less left open, measured too long": (
        Judgement, "left_open", lambda _, right: (right[0] - 1, right[1]), "containment"),
    "1 nm less left open, measured too short": (
        Judgement, "left_open", lambda _, right: (right[0], right[1] - 1), "containment"),
    "nothing added in the cycle of the test": (Judgement, "tested_fix", lambda c, _: c.target.bare, "containment"),
    "nothing added in the cycle of the test, and claimed": (
        Judgement, "tested_fix", lambda c, _: c.target.bare, "a test that passed makes nothing better known"),
    "drift 1 nm slower than it is": (ReflectorConfig, "drift_nm", lambda _, right: right - 1, "containment"),
    "drift not added": (ReflectorConfig, "drift_nm", lambda _c, _r: 0, "the error that a test left open grows by the drift"),
    "never out of date": (
        Judgement, "outdated", lambda _c, _r: FALSE, "precise only with a radar that is nearly right"),
    "always out of date": (
        Judgement, "outdated", lambda c, _: c.tolerable & ~c.started, "a test is out of date only when it is"),
    "a test as coarse as can be": (
        Situation, "fine", lambda _n, _r, _f: TRUE, "precise only with a radar that is nearly right"),
    "another reflector heard in the self-test": (
        Situation, "alone", lambda _n, _, _r: TRUE, "the target is never mistaken"),
    "another reflector heard from the strong range": (
        Situation, "alone", lambda now, _, r: exact_to(r.clear, NM) - now.law.accuracy_nm
        > exact_to(r.place, NM) - now.window.low + now.lag[0], "the target is never mistaken"),
    "another reflector heard behind the target's balise": (
        Situation, "alone", lambda now, _, r: exact_to(r.clear, NM) - now.law.accuracy_nm
        > now.window.high - exact_to(r.place, NM) + now.lag[1] + now.law.strong_nm, "the target is never mistaken"),
    "no self-test alone enough": (
        Situation, "alone", lambda _n, _, _r: FALSE, "a self-test is ambiguous only if another reflector is in range"),
    "the balise's one-off constant not added in the wait": (
        Judgement, "begins_at", lambda c, _: c.balise, "containment"),
    "a wait however coarse": (Judgement, "too_coarse", lambda _c, _r: FALSE, "containment"),
    "drift taken for a fault": (Judgement, "drifted", lambda c, _: c.anchored, "a sound radar raises no alarm"),
    "where the radar has the vehicle, sides exchanged": (
        cycles, "_seen_by", lambda i, _, o: Interval(i.position, i.above + o[0], i.below + o[1]),
        "the target's echo is in the window"),
    "a jump that what was left open hides": (
        cycles, "_measured_on", lambda own, right: nearer(right, -own.open_long, -own.open_short), "no measurement jumps"),
    "the last measurement without drift": (
        cycles, "_measured_on", lambda _, right: nearer(right, *2 * (CONFIG.drift_nm,)),
        "the target's echo is in the window"),
}  # fmt: skip
"""What the radar may be wrong by, and what the self-test says of it."""


@pytest.mark.slow
@pytest.mark.parametrize("edit", OF_RADAR)
def test_a_wrong_charge_for_the_radar_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The same of each addition, of either side, and of the guards of the self-test."""
    owner, name, wrong, claim = OF_RADAR[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, owner, name, wrong)
    assert not keeps(made(), claim)


_JUDGE = echo.judge
ANYTHING_ELSE = "an echo of anything else is refused for the {}"
ITS_MODEL = "no echo of its model is refused as another's for the {}"


def showing(shown: Callable[[Num, Num], Num]) -> Wrong:
    """An echo judged as if it showed another model, by the one that it shows and the one that is searched."""
    return lambda slot, _, reflector, *now: _JUDGE(
        replace(slot, model=shown(slot.model, reflector.model)),
        reflector,
        *now,  # type: ignore[arg-type]
    )


def refused(when: Callable[[Num], Bool]) -> Wrong:
    """An echo refused for its model, by the one that it shows."""
    return lambda slot, right, *_a: replace(
        right, verdict=ite(right.verdict.eq(echo.FITS) & when(slot.model), echo.OTHER_MODEL, right.verdict)
    )


OF_MODELS: Edits = {
    "any model fits": (echo, "judge", showing(lambda _, searched: searched), ANYTHING_ELSE.format("target")),
    "any model fits the next reflector": (
        echo, "judge", showing(lambda _, searched: searched), ANYTHING_ELSE.format("next reflector")),
    "an echo without a model fits": (
        echo, "judge", showing(lambda shown, searched: ite(shown.eq(NO_MODEL), searched, shown)), ANYTHING_ELSE.format("target")),
    "two models alike": (
        echo, "judge", showing(lambda shown, _: ite(shown.eq(MODEL[2]), MODEL[1], shown)), ANYTHING_ELSE.format("target")),
    "the target's model forgotten": (Target, "reflector", lambda _t, right: replace(right, model=MODEL[1]), ANYTHING_ELSE.format("target")),
    "no model fits": (echo, "judge", refused(lambda _: TRUE), ITS_MODEL.format("target")),
    "one model is never known": (echo, "judge", refused(lambda shown: shown.eq(MODEL[8])), ITS_MODEL.format("next reflector")),
    "models one for another": (
        echo, "judge", showing(lambda shown, _: ite(shown.eq(MODEL[2]), MODEL[1], ite(shown.eq(MODEL[1]), MODEL[2], shown))),
        ITS_MODEL.format("target")),
}  # fmt: skip
"""What the machine may take a model for."""


@pytest.mark.thorough
@pytest.mark.parametrize("edit", OF_MODELS)
def test_a_model_taken_for_another_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The same of the model that an echo shows, against what truly sent it."""
    owner, name, wrong, claim = OF_MODELS[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, owner, name, wrong)
    assert not keeps(made(), claim)


def rows(name: str, more: Callable[[Parts], Updates]) -> Wrong:
    """The row of that name sets more."""

    def wrong(own: Parts, right: Iterable[Transition], *_args: object) -> list[Transition]:
        return [replace(row, set={**row.set, **more(own)}) if row.name == name else row for row in right]

    return wrong


FAR_MM = 100 * M
OF_FOUND: Edits = {
    "a reflector found does not count": (
        vars(table)["_Groups"], "seen",
        lambda _g, right, *_a: {
            var: FALSE if var.name == "recognised_now" else term for var, term in right.items() if var.name != "last_found_mm"},
        "a searched reflector is found exactly when an echo fits it"),
    "a reference reflector found does not count": (
        vars(table)["_Groups"], "seen",
        lambda _g, right, *_a: {
            var: FALSE if var.name == "recognised_now" else term for var, term in right.items() if var.name != "last_found_mm"},
        "a reference reflector is found exactly when an echo passes the self-test"),
    "each echo of the reflector in view counts as one found": (
        table, "_measured", rows("reflector tracked", lambda own: {own.recognised_now: TRUE, own.found: own.target.position}),
        "in a view zone another reflector is found exactly when an echo fits it alone"),
    "an echo from far away is refused as too close": (
        echo, "judge", lambda slot, right, *_a: replace(right, verdict=ite(
            right.verdict.eq(echo.FITS) & (slot.range.value > FAR_MM), echo.TOO_CLOSE, right.verdict)),
        "a searched reflector is found exactly when its own echo is measured"),
    "a balise alone counts as a reflector": (
        table, "_going_on", rows("balise without self-test", lambda own: {own.recognised_now: TRUE}),
        "where no reflector is looked for, none is found"),
}  # fmt: skip
"""When a reflector counts as found. But for the last, all other claims that one step of induction decides keep these machines."""


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("edit", OF_FOUND)
def test_a_reflector_that_is_wrongly_found_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The same of what counts as found: too seldom, too often, or where none is looked for."""
    owner, name, wrong, claim = OF_FOUND[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, owner, name, wrong)
    assert not keeps(made(), claim)


LAWS = {
    "a reflector stands where the map has it": "the target is never mistaken",
    "reflectors of one model are far apart on the map": "the target is never mistaken",
    "a recognised reflector shows its own model": ANYTHING_ELSE.format("target"),
    "other things show no reflector's signature": ANYTHING_ELSE.format("target"),
}


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("law", LAWS)
def test_each_law_on_what_sends_an_echo_is_needed(law: str) -> None:
    """In a world without it the claim is not kept: it follows from no other law."""
    machine, claims = made()
    laws = {name: clause for name, clause in machine.world.laws.items() if name != law}
    assert len(laws) == len(machine.world.laws) - 1
    free = replace(machine, world=replace(machine.world, clauses=laws))
    assert keeps((machine, claims), LAWS[law])
    assert not keeps((free, claims), LAWS[law])


OF_TWO: Edits = {
    "echoes that exclude each other are believed": (
        Recognition, "conflict", lambda _c, _r: FALSE, "echoes that exclude each other give no position"),
    "every second echo is a conflict": (Recognition, "conflict", lambda _c, _r: TRUE, "an echo that fits is used"),
    "the last echo instead of the first": (
        Recognition, "of_chosen", lambda _c, _, terms: terms[-1], "the reported reflector sent the echo"),
    "views that overlap always contradict": (
        Judgement, "overlap_contradicts", lambda c, _: c.target.accepted & c.ahead.accepted, "a sound radar raises no alarm"),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("edit", OF_TWO)
def test_a_wrong_edit_of_two_echoes_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The same with two echoes in a frame."""
    owner, name, wrong, claim = OF_TWO[edit]
    assert keeps(made(2), claim)
    edited(monkeypatch, owner, name, wrong)
    assert not keeps(made(2), claim)
