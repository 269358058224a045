"""A run as a data frame: the cells of the table that is written to files, with types that know absent values."""

from __future__ import annotations

import sys

import pandas
import pytest

from safeloc.errors import InputError
from safeloc.language.interpret import run
from safeloc.language.system import lower
from safeloc.report.run_files.frame import data_frame
from tests.report.run_files.test_run_files import HEADINGS, MACHINE, STREAM

RUN = run(lower(MACHINE), STREAM)


def test_columns_carry_units_and_keep_all_digits() -> None:
    """Numbers beyond what a floating-point number holds, labels as words, an absent input as NA; steps count from 1."""
    frame = data_frame(RUN)
    assert list(frame.columns) == HEADINGS and list(frame.index) == [1, 2, 3]
    assert list(frame["state.height [mm]"]) == [2**62, 2**62, -(2**62)]
    assert list(frame["fired.fired"]) == ["goes up", "(stay)", "comes down"]
    assert frame["input.far_mm"].isna().tolist() == [False, True, True]
    assert frame["output.tall"].dtype == pandas.BooleanDtype() and frame["state.laps"].dtype == pandas.Int64Dtype()


def test_time_and_truth_are_columns_where_they_are_known() -> None:
    """The time is that of the end of the step; an unknown truth is NA."""
    frame = data_frame(RUN, period_ms=100, truth_mm=(5, None, 7))
    assert list(frame["time_ms"]) == [100, 200, 300]
    assert frame["truth_mm"].isna().tolist() == [False, True, False] and frame["truth_mm"].loc[3] == 7


def test_a_run_without_steps_has_its_columns() -> None:
    frame = data_frame(run(lower(MACHINE), []))
    assert len(frame) == 0 and list(frame.columns) == HEADINGS


def test_truths_of_another_number_of_steps_are_refused() -> None:
    with pytest.raises(InputError, match="truth_mm: 2 values for a run of 3 steps"):
        data_frame(RUN, truth_mm=(1, 2))


def test_without_pandas_the_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(InputError, match=r"pip install 'safeloc\[notebook\]'"):
        data_frame(RUN)
