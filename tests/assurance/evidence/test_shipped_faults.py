"""Broken laws of shipped machines whose effect only a run from a known run, or a weaker lemma, decides."""

from __future__ import annotations

import pytest

from safeloc.assurance.evidence import effects
from safeloc.assurance.evidence.effects import End, effect
from safeloc.assurance.evidence.interval import HOLDS
from safeloc.assurance.law_ids import ids_of
from safeloc.catalogue import load_target
from safeloc.language.spec import observe
from safeloc.language.verdict import Unknown, word
from safeloc.proof.cores.clauses import ClauseId, assumed_clauses, without
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove_one
from safeloc.target import Target

LIMITS = Limits(seconds=40)


def law(target: Target, wanted: str) -> ClauseId:
    """The law with this id."""
    return next(one for one in assumed_clauses(target.system) if ids_of(target)[one] == wanted)


def test_the_age_of_a_record_is_counted_whatever_the_record_says() -> None:
    """A false record leads to the hazard, but a place is withheld after as many cycles as always: proved without a bound."""
    target = load_target("verification_doubted")
    claim = next(one for one in target.properties if one.name == "a place whose record is old")
    for broken in ("verification_doubted/A4", "verification_doubted/A5"):
        system = without(target.system, [law(target, broken)])
        assert "proved" == word(prove_one(observe(system, claim), LIMITS)), broken


def test_a_train_passes_whatever_ended_the_passage_before() -> None:
    """A passage that is reported as over while its train runs on costs the count, not the distance after the last axle."""
    target = load_target("axle_counter")
    system = without(target.system, [law(target, "axle_counter/A3")])
    claim = next(one for one in target.properties if one.name == "the whole train has passed")
    assert "proved" == word(prove_one(observe(system, claim), LIMITS))


@pytest.mark.thorough
def test_the_train_of_a_record_stays_the_same_by_the_wires() -> None:
    """Of the verification by itself that is a law; a counted entry keeps it, since its train is that of the counter."""
    target = load_target("counted_entry")
    claims = {prop.name for prop in target.properties if prop.kind != "reachable"}
    one = effect(target, (law(target, "verification_doubted/A1"),), claims, LIMITS)
    assert ("no hazard", claims, {}, ()) == (one.end, {*one.kept}, one.lost, one.open_)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "broken", "claims", "end"),
    [
        ("unlinked_group", "unlinked_group/A1", {"containment"}, "wrong"),
        ("arbitration", "arbitration/A5", {"containment"}, "wrong"),
        ("satellite_drift", "satellite/position/A1", {"common drift is bounded"}, "wrong"),
        ("satellite_drift", "satellite_drift/position/A6", {"common drift is bounded"}, "wrong"),
        ("axle_counter", "axle_counter/A6", {"length is true", "place is true", "count is true"}, "hazard"),
    ],
)
def test_its_effect_is_decided(name: str, broken: str, claims: set[str], end: End) -> None:
    """A wrong interval that lasts, or a hazard that a whole passage leads to."""
    target = load_target(name)
    one = effect(target, (law(target, broken),), claims | {HOLDS}, LIMITS)
    assert (end, (), claims) == (one.end, one.open_, {*one.lost})


@pytest.mark.thorough
def test_a_wrong_interval_is_searched_for_from_known_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """A false code word shows after five sections: farther than a bounded search from the first states comes; here it finds nothing at all."""
    target = load_target("fibre_timed")
    monkeypatch.setattr(effects, "prove_one", lambda *_: Unknown("limit reached"))
    one = effect(target, (law(target, "fibre/A11"),), {HOLDS}, LIMITS)
    assert "wrong" == one.end
    assert one.run is not None
    assert one.run.cycles > 10
