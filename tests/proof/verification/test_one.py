"""One target: its proofs, obligations and property tests side by side, and then its replays."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace

import pytest

from safeloc.errors import EngineError, StreamError
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from safeloc.proof.verification.one import Plan, Work
from safeloc.report.data import result_data
from safeloc.target import Target
from tests.shipped import shipped

PLAN = Plan(Limits(depth=6, seconds=20), examples=4, steps=10, seed=1)
HERE = os.getpid()


@pytest.fixture
def emitter() -> Target:
    """A small machine with its shortest recording only, and two claims."""
    found = shipped("emitter")
    shortest = min(found.streams, key=lambda path: path.stat().st_size)
    return replace(found, streams=(shortest,), properties=found.properties[:2])


def told(findings: list[Finding]) -> list[dict[str, object]]:
    """What a report says of findings, without times."""
    rows = [{**result_data(one), "seconds": 0} for one in findings]
    return [
        {**row, "notes": {key: text for key, text in row["notes"].items() if "per second" not in key}} for row in rows
    ]


def test_tests_are_those_that_come_after_the_obligations(emitter: Target) -> None:
    """They begin before these are proved, along the same runs, and stand behind them; each finding is announced once."""
    seen = list[str]()
    work = Work(emitter, 1, lambda text, _: seen.append(text), lambda one: seen.append(one.id))
    findings = work.verified(PLAN)
    kinds = [one.kind for one in findings]
    assert ["lemma", "property", "obligation", "test", "replay"] == list(dict.fromkeys(kinds))
    assert sorted(one.id for one in findings) == sorted(name for name in seen if "/" in name)
    assert seen.index("testing emitter") < seen.index("emitter/obligation/assumption")
    assert seen.index("testing emitter") < seen.index(f"emitter/property/{emitter.properties[0].name}")
    after = Work(emitter, 1, lambda *_: None, lambda _: None)
    assert told(after.tested(PLAN, after.obliged(PLAN.limits))) == told([one for one in findings if one.kind == "test"])


def in_the_process_of_tests(act: Callable[[], object]) -> Callable[..., list[Finding]]:
    """Take the place of the tests, in a process of their own."""

    def tests(*_: object) -> list[Finding]:
        assert os.getpid() != HERE
        act()
        return []

    return tests


def refuse() -> None:
    """Refuse a recording."""
    raise StreamError("no such cycle")


@pytest.mark.parametrize(
    ("act", "error", "says"),
    [
        (refuse, StreamError, r"^no such cycle$"),
        (lambda: os._exit(7), EngineError, r"^emitter: property tests: its process ended with code 7\.$"),
        (lambda: 1 // 0, EngineError, r"^emitter: property tests: ZeroDivisionError: "),
    ],
)
def test_what_befalls_the_tests_is_raised(
    act: Callable[[], object], error: type[Exception], says: str, emitter: Target, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An error of a recording as it is; a process that ended, and what nobody foresaw, with the target's name."""
    monkeypatch.setattr(Work, "_tests", in_the_process_of_tests(act))
    with pytest.raises(error, match=says):
        Work(emitter, 2, lambda *_: None, lambda _: None).verified(PLAN)
