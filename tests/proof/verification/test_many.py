"""Several targets at once: the findings are the same as one by one, and reported as they come; an error ends the rest."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.errors import EngineError, StreamError
from safeloc.language.verdict import word
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from safeloc.proof.verification.many import Began, Event, Found, Over, in_order, verify_targets
from safeloc.proof.verification.one import Plan, Work
from safeloc.proof.verification.plain import pack_findings, unpack_findings
from safeloc.report.data import result_data
from safeloc.target import Target

PLAN = Plan(Limits(depth=6, seconds=20), examples=4, steps=10, seed=1)


def target(name: str) -> Target:
    """A shipped machine with its shortest recording only."""
    found = load_target(name)
    return replace(found, streams=tuple(sorted(found.streams, key=lambda path: path.stat().st_size)[:1]))


def told(findings: list[Finding]) -> list[dict[str, object]]:
    """The contents of findings in a report, without times."""
    return [{**result_data(one), "seconds": 0} for one in findings]


def alone(one: Target) -> tuple[Target, list[Finding]]:
    """A target, verified in this process."""
    return one, Work(one, 1, lambda *_: None, lambda _: None).verified(PLAN)


@pytest.fixture(scope="module")
def emitter() -> tuple[Target, list[Finding]]:
    """A machine with several kinds of findings."""
    return alone(target("emitter"))


@pytest.fixture(scope="module")
def smallest() -> tuple[Target, list[Finding]]:
    """The machine that takes least time."""
    return alone(target("delocalized"))


@pytest.mark.thorough
def test_findings_are_the_same_after_a_journey_as_data(emitter: tuple[Target, list[Finding]]) -> None:
    """Findings sent through JSON make the same report, runs and replays included; shared objects stay shared."""
    machine, findings = emitter
    again = unpack_findings(json.loads(json.dumps(pack_findings(findings, machine.system))), machine.system)
    assert told(findings) == told(again)
    runs = {id(one.replayed) for one in again if one.replayed is not None}
    assert len(runs) == len({id(one.replayed) for one in findings if one.replayed is not None}) == 1
    for one, other in zip(findings, again, strict=True):
        assert (one.replayed is None) == (other.replayed is None)
        if one.replayed is not None and other.replayed is not None:
            assert one.replayed.trace.steps == other.replayed.trace.steps


def test_side_by_side_is_as_one_by_one(smallest: tuple[Target, list[Finding]]) -> None:
    """Two targets in two slots: every finding comes in order, is announced once, and before its target is over."""
    delocalized, findings = smallest
    events: list[Event] = []
    found = verify_targets(
        [replace(target("emitter"), properties=()), delocalized], PLAN, jobs=2, on_event=events.append
    )
    assert ["emitter", "delocalized"] == list(found)
    assert [row["id"] for row in told(findings)] == [one.id for one in found["delocalized"]]
    assert [row["verdict"] for row in told(findings)] == [word(one.result) for one in found["delocalized"]]
    ids = [event.id for event in events if isinstance(event, Found)]
    assert sorted(one.id for one in in_order(found)) == sorted(ids)
    for name in found:
        own = [type(event) for event in events if event.target == name]
        assert (Began, Over) == (own[0], own[-1])


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("jobs", "order"), [(1, [1, 2, 0]), (2, [0, 1, 2])])
def test_a_short_target_begins_beside_the_longest(jobs: int, order: list[int]) -> None:
    """With several processes the first results come soon; with one the longest target begins, as it takes as long in any order."""
    names = ("delocalized", "travel_direction", "emitter")  # from few variables and results to many
    targets = [replace(load_target(name), streams=(), properties=()) for name in names]
    sizes = [len(one.system.state) for one in targets]
    assert sizes[0] == min(sizes)
    began: list[str] = []
    verify_targets(
        targets,
        PLAN,
        jobs=jobs,
        on_event=lambda event: began.append(event.target) if isinstance(event, Began) else None,
    )
    assert [names[place] for place in order] == began


@pytest.mark.thorough
def test_what_a_target_raises_is_raised(tmp_path: Path) -> None:
    """For a recording that the machine cannot take, the error has file and line; it is not a lost process."""
    path = tmp_path / "other.jsonl"
    path.write_text('{"schema": "safeloc-stream/1", "machine": "odometry", "first": {}}\n{"x": 1}\n', encoding="utf-8")
    wrong = replace(target("emitter"), streams=(path,))
    with pytest.raises(StreamError, match=r"other\.jsonl:1: the stream is for machine 'odometry'"):
        verify_targets([wrong, target("delocalized")], PLAN, jobs=2, on_event=lambda _: None)


def test_a_process_that_dies_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """The error names the target and the exit code."""
    import os

    monkeypatch.setattr(Work, "verified", lambda *_: os._exit(7))
    with pytest.raises(EngineError, match="emitter: its process ended with code 7 before it was done"):
        verify_targets([target("emitter")], PLAN, jobs=1, on_event=lambda _: None)


def test_what_nobody_foresaw_is_told_with_its_place(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """The parent raises an unforeseen error with the target's name; the other process prints its traceback."""

    def failing(*_: object) -> list[Finding]:
        raise ZeroDivisionError("by nothing")

    monkeypatch.setattr(Work, "verified", failing)
    with pytest.raises(EngineError, match="emitter: ZeroDivisionError: by nothing"):
        verify_targets([target("emitter")], PLAN, jobs=1, on_event=lambda _: None)
    assert "in failing" in capfd.readouterr().err


def test_that_nothing_was_asked_is_an_event() -> None:
    """A target without properties has a finding that says so, and it is announced like any other."""
    events: list[Event] = []
    verify_targets([replace(target("emitter"), properties=())], PLAN, jobs=1, on_event=events.append)
    assert ["not asked"] == [one.verdict for one in events if isinstance(one, Found) and "/property/" in one.id]


def test_a_run_of_another_system_is_not_packed(smallest: tuple[Target, list[Finding]]) -> None:
    """Packing refuses it: the receiver could not interpret its inputs."""
    with pytest.raises(ValueError, match="with other inputs cannot be packed"):
        pack_findings(smallest[1], load_target("stop_point").system)
