"""Runs on generated code: they equal the interpreter's, and a difference is an error."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.catalogue import load_target
from safeloc.errors import EngineError, InputError
from safeloc.language.expr import TRUE, NumVar
from safeloc.language.interpret import run
from safeloc.language.monitor import Checks, check_all
from safeloc.language.units import ONE
from safeloc.proof.drawn_runs import quick
from safeloc.proof.drawn_runs.quick import PAYS, SAMPLED, Again, Quick, quick_run, run_again
from safeloc.runtime.streams.steps import read_steps

TARGET = load_target("stop_point")
STREAM = read_steps(TARGET.streams[0])
INPUTS = {var.name for var in TARGET.system.inputs}
ROWS = [{name: cell for name, cell in step.items() if name in INPUTS} for step in STREAM.steps]


def test_the_same_run() -> None:
    """States, outputs, fired transitions and the types of values are the same."""
    right, found = run(TARGET.system, ROWS, first=STREAM.first), quick_run(TARGET.system, ROWS, first=STREAM.first)
    assert repr(right.steps) == repr(found.steps)
    assert right.initial == found.initial


def test_a_run_made_again_is_the_same() -> None:
    """Interpreted or compiled, a run that is made again is equal; many steps of one system are compiled."""
    right = run(TARGET.system, ROWS, first=STREAM.first)
    times = 2 + PAYS // len(ROWS)
    for _ in range(times):
        assert run_again(TARGET.system, ROWS, first=STREAM.first).steps == right.steps
    assert quick._steps_of(TARGET.system).interpreted > PAYS
    anyhow = replace(TARGET.system, assume=TRUE)
    assert quick._steps_of(anyhow) is quick._steps_of(TARGET.system)


def test_a_run_that_begins_another_one_is_a_part_of_it() -> None:
    """Its steps are the same objects. Other inputs, another first state or a longer run are made anew, and all are right."""
    again, first = Again(), dict(STREAM.first)
    whole = again(TARGET.system, ROWS, first=first)
    part = again(TARGET.system, ROWS[:5], first=first)
    assert len(part.steps) == 5 and all(one is other for one, other in zip(part.steps, whole.steps, strict=False))
    turned = [*ROWS[:3], *reversed(ROWS[3:6])]
    assert turned != ROWS[:6]
    for rows in (turned, ROWS[:2], ROWS, []):
        assert again(TARGET.system, rows, first=first).steps == run(TARGET.system, rows, first=first).steps


def test_the_same_verdicts() -> None:
    """Every property has the same verdict, with the cases that never occurred."""
    trace = run(TARGET.system, ROWS, first=STREAM.first)
    asked = [prop for prop in TARGET.properties if prop.kind != "reachable"]
    assert repr(check_all(trace, asked)) == repr(Checks(TARGET.system, asked, Quick)(trace))


def test_the_same_refusal() -> None:
    """A missing input is refused, as by the interpreter."""
    with pytest.raises(InputError, match="is missing"):
        quick_run(TARGET.system, [{}], first=STREAM.first)


def test_wrong_code_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A difference in the first step or in a sampled later step is an error."""
    x = NumVar("x", ONE, 0, 9)
    right = quick.compiled_terms
    monkeypatch.setattr(quick, "compiled_terms", lambda reads, terms: lambda row: [row[0] + (row[0] > 3)])
    wrong = Quick([x])
    for _ in range(SAMPLED):
        assert [2] == list(wrong({x: 2}))
    with pytest.raises(EngineError, match="generated code gives 6 for term 0, the interpreter 5"):
        wrong({x: 5})
    monkeypatch.setattr(quick, "compiled_terms", right)
    assert [5] == list(Quick([x])({x: 5}))
