"""Runs as plain data: steps that runs share are stored once, and every run comes back as it was."""

from __future__ import annotations

import json
import pickle

import pytest

from safeloc.catalogue import load_target
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved
from safeloc.proof.drawn_runs.quick import quick_run
from safeloc.proof.results import Finding
from safeloc.proof.verification import courses
from safeloc.proof.verification.plain import Plain, pack_findings, unpack_findings
from safeloc.runtime.streams.steps import read_steps

TARGET = load_target("stop_point")


def shown_by(run: Trace) -> Finding:
    """A finding with this run as its witness."""
    return Finding("it", TARGET.name, "obligation", "", Proved(None, "recorded", witness=run), "", 0.0)


def sent(runs: list[Trace]) -> tuple[Plain, list[Trace]]:
    """The data of findings with these runs, and the runs that come back."""
    packed = json.loads(json.dumps(pack_findings([shown_by(run) for run in runs], TARGET.system)))
    results = [one.result for one in unpack_findings(packed, TARGET.system)]
    return packed, [one.witness for one in results if isinstance(one, Proved) and one.witness is not None]


@pytest.fixture(scope="module")
def whole() -> Trace:
    """A shipped recording, run."""
    stream = read_steps(TARGET.streams[0])
    names = {var.name for var in TARGET.system.inputs}
    rows = [{name: cell for name, cell in step.items() if name in names} for step in stream.steps]
    return quick_run(TARGET.system, rows, first=stream.first)


def part(run: Trace, begin: int, end: int) -> Trace:
    """Some steps of a run, as objects that it has too."""
    return Trace(run.system, run.initial, run.steps[begin:end])


@pytest.mark.parametrize("lengths", [(3, 9, 5), (9, 3, 9), (0, 4, 0)])
def test_runs_that_begin_alike_are_stored_once(whole: Trace, lengths: tuple[int, ...]) -> None:
    """In whatever order they come, also one without a step."""
    runs = [part(whole, 0, length) for length in lengths]
    packed, back = sent(runs)
    assert [text.count("\n") for text in packed["courses"] if "\n" in text] == [max(lengths)]
    assert [run.steps for run in back] == [run.steps for run in runs]


def test_runs_that_part_are_stored_apart(whole: Trace) -> None:
    """The same first step does not make two runs one."""
    other = Trace(whole.system, whole.initial, (*whole.steps[:2], *whole.steps[7:9]))
    packed, back = sent([part(whole, 0, 5), other, part(whole, 0, 6)])
    assert [run.steps for run in back] == [whole.steps[:5], other.steps, whole.steps[:6]]
    assert sum(text.count("\n") for text in packed["courses"]) <= 6 + 4 + 6


def test_steps_are_read_when_somebody_asks(whole: Trace, monkeypatch: pytest.MonkeyPatch) -> None:
    """As far as they are asked for, once for all runs; and a run is what it was without them."""
    read = list[object]()
    step = courses._step
    monkeypatch.setattr(courses, "_step", lambda names, row: read.append(row) or step(names, row))
    _, back = sent([part(whole, 0, length) for length in (3, 9, 5)])
    assert ([run.length for run in back], read) == ([3, 9, 5], [])
    assert back[0].steps == whole.steps[:3]
    assert len(read) == 3
    assert back[2] == part(whole, 0, 5) == back[2]
    assert back[2] != part(whole, 0, 6)
    assert back[2] != whole.steps
    assert len(read) == 5
    assert back[1].steps[0] is back[0].steps[0]
    assert back[1].steps is back[1].steps
    assert pickle.loads(pickle.dumps(back[1])).steps == whole.steps[:9]
    assert back[1].stream() == part(whole, 0, 9).stream()


def test_no_run_is_longer_than_its_course(whole: Trace) -> None:
    """Data that were not packed are refused before anybody asks."""
    packed, _ = sent([part(whole, 0, 3)])
    packed["traces"][0]["steps"] = 4
    with pytest.raises(ValueError, match="a run of 4 steps of a course of 3"):
        unpack_findings(packed, TARGET.system)


def test_certificates_are_stored_once() -> None:
    """Two proofs that rest on one text store it once, and each comes back with its own files in their order."""
    texts = [{"base.smt2": "base" * 100, "one.smt2": "one"}, {"two.smt2": "two", "base.smt2": "base" * 100}]
    findings = [
        Finding("it", TARGET.name, "property", "", Proved(None, "1-induction", certificates=each), "", 0.0)
        for each in texts
    ]
    data = json.dumps(pack_findings(findings, TARGET.system))
    assert data.count("base" * 100) == 1
    back = [one.result for one in unpack_findings(json.loads(data), TARGET.system)]
    assert [list(one.certificates.items()) for one in back if isinstance(one, Proved)] == [
        list(each.items()) for each in texts
    ]
