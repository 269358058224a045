"""Findings of unchanged targets come back as they were; those of a changed one never do."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.errors import EngineError
from safeloc.language.verdict import Unknown
from safeloc.proof.cache import targets
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import asked, found_before, keep
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from safeloc.proof.verification import many
from safeloc.proof.verification.many import Event, Kept, Over, verify_targets
from safeloc.proof.verification.one import Plan
from safeloc.report.data import result_data
from safeloc.target import Target

PLAN = Plan(Limits(depth=6, seconds=20), examples=4, steps=10, seed=1)


def verified(names: list[str], store: Store, **options: bool) -> tuple[dict[str, list[Finding]], list[Event]]:
    """Findings and events of one run."""
    events: list[Event] = []
    look_in = None if options.get("fresh") else store
    loaded = [load_target(name) for name in names]
    return verify_targets(loaded, PLAN, jobs=2, on_event=events.append, look_in=look_in, keep_in=store), events


def told(findings: list[Finding]) -> list[dict[str, object]]:
    """What a report says of them."""
    return [result_data(one) for one in findings]


@pytest.mark.thorough
def test_an_unchanged_target_is_not_verified_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its findings are the same, run by run, and say since when they are kept; another one beside it is verified."""
    store = Store(tmp_path)
    first, _ = verified(["emitter"], store)
    again, events = verified(["emitter", "travel_direction"], store)
    assert told(first["emitter"]) == told(again["emitter"])
    [kept] = [event for event in events if isinstance(event, Kept)]
    assert ("emitter", len(first["emitter"])) == (kept.target, kept.findings)
    assert {kept.since} == {one.kept_since for one in again["emitter"]}
    assert {""} == {one.kept_since for one in (*first["emitter"], *again["travel_direction"])}
    assert ["travel_direction"] == [event.target for event in events if isinstance(event, Over)]

    def refuse(*_: object) -> None:
        raise EngineError("verified again")

    monkeypatch.setattr(many.Work, "verified", refuse)
    assert told(first["emitter"]) == told(verified(["emitter"], store)[0]["emitter"])
    with pytest.raises(EngineError, match="verified again"):
        verified(["emitter"], store, fresh=True)


def test_another_plan_is_another_question() -> None:
    """More examples, another seed, other limits."""
    emitter = load_target("emitter")
    plans = [PLAN, replace(PLAN, seed=2), replace(PLAN, examples=5), replace(PLAN, limits=Limits(depth=7, seconds=20))]
    assert len(plans) == len({asked(emitter, "verified", plan).key for plan in plans})
    assert asked(emitter, "verified", PLAN).key == asked(load_target("emitter"), "verified", PLAN).key


def finding(target: Target, result: Unknown) -> Finding:
    """One finding of a target."""
    return Finding("emitter/property/p", target.name, "property", "p", result, "", 1.0)


def test_what_is_undecided_is_not_kept(tmp_path: Path) -> None:
    """None of a target with one undecided finding: on a machine that is less busy it may be decided."""
    store, question = Store(tmp_path), asked(load_target("emitter"), "verified")
    keep(store, question, [finding(question.target, Unknown("time is up"))])
    assert found_before(store, question) is None
    keep(store, question, [])
    assert found_before(store, question) == []


def test_a_changed_engine_asks_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever of the engine was changed."""
    store, emitter = Store(tmp_path), load_target("emitter")
    keep(store, asked(emitter, "verified"), [])
    monkeypatch.setattr(targets, "engine_digest", lambda: "another")
    assert found_before(store, asked(emitter, "verified")) is None


def test_without_a_store_nothing_is_kept() -> None:
    """And nothing is found."""
    question = asked(load_target("emitter"), "verified")
    keep(None, question, [])
    assert found_before(None, question) is None


def test_what_an_engine_found_that_was_edited_meanwhile_is_not_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The findings are not those of the engine whose files are there now."""
    store, question = Store(tmp_path), asked(load_target("emitter"), "verified")
    monkeypatch.setattr(targets, "undisturbed", lambda: False)
    keep(store, question, [])
    assert found_before(store, question) is None


def test_a_store_may_be_looked_in_only(tmp_path: Path) -> None:
    """What it has is found; nothing is put there."""
    store = Store(tmp_path)
    first, _ = verified(["delocalized"], store)
    before = list(store.entries())
    loaded = load_target("delocalized")
    again = verify_targets([loaded], PLAN, jobs=1, on_event=lambda _: None, look_in=store)
    assert told(first["delocalized"]) == told(again["delocalized"])
    assert [path for path, _ in before] == [path for path, _ in store.entries()]
