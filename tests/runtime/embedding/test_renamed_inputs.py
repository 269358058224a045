"""A host that says an input by its name of before is told the name of now, on every way in."""

from __future__ import annotations

import json
from functools import cache

import pytest

from safeloc.catalogue import load_target
from safeloc.errors import InputError
from safeloc.runtime.embedding import Controller, Program
from safeloc.runtime.service.lines import Line
from safeloc.runtime.service.messages import Reader, Refused
from safeloc.runtime.streams.records import ValueRecord

NOW = "'source_over_mm' is now 'source_margin_above_mm'"


@cache
def program() -> Program:
    """The restrictive state behind any source, whose inputs are an interval."""
    return Program(load_target("delocalized"))


def test_inputs_of_a_step() -> None:
    """The host's mistake: the cycle is not over."""
    with pytest.raises(InputError, match=rf"{NOW}\.$"):
        Controller(program(), period_ms=100).step_inputs({"source_over_mm": 3})


def test_a_record() -> None:
    """Not used, and the rejection says what it is called now."""
    record = ValueRecord(time_ms=50, name="source_over_mm", value=3)
    (fault,) = Controller(program(), period_ms=100).step([record]).rejections
    assert f"no input source_over_mm; {NOW}" == fault.detail


def test_a_line() -> None:
    """Of a process that reads the inputs of steps."""
    reader = Reader(program(), {}, inputs=True, numbered=False, first={})
    refused = reader.read(Line(1, json.dumps({"source_over_mm": 3}).encode()))
    assert isinstance(refused, Refused)
    assert f"delocalized has no input 'source_over_mm'; {NOW}" == refused.reason
