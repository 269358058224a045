"""A measured distance is no longer called a step: old names are converted, or refused with the new one."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import ValidationError

from safeloc.catalogue import ENTRIES, load_target, read_config
from safeloc.errors import InputError, StreamError
from safeloc.language.interpret import read_inputs
from safeloc.runtime.streams.record_files import read_records
from safeloc.runtime.streams.records import DistanceRecord
from safeloc.runtime.streams.steps import read_steps
from tests.runtime.migration.migrating import changed, migrated

OLD = '{"kind": "distance", "time_ms": 100, "end": "front", "unit": "wheel", "step_mm": 1200}\n'
HEADER = "kind,time_ms,end,unit,"


def test_records(tmp_path: Path) -> None:
    """The field of a distance record is converted, and the file is one of today."""
    made = migrated(tmp_path / "records.jsonl", OLD + OLD)
    assert ["step_mm -> distance_mm (2 times, first in line 1)"] == changed(made)
    record = DistanceRecord(time_ms=100, end="front", unit="wheel", distance_mm=1200)
    assert (record, record) == read_records(made.write(in_place=False))


def test_streams(tmp_path: Path) -> None:
    """Inputs and ghosts of a stream of steps, alone and behind a machine's name."""
    text = '{"step_mm": 3, "true_step_nm": 4, "axle_counter.true_step_to_axle_nm": 5, "report.step_um": 6}\n'
    made = migrated(tmp_path / "run.jsonl", text)
    assert {
        "distance_mm": 3,
        "true_cycle_distance_nm": 4,
        "axle_counter.true_distance_to_axle_nm": 5,
        "report.true_cycle_distance_um": 6,
    } == read_steps(made.write(in_place=False)).steps[0]


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("old.jsonl", OLD, r":1: 'step_mm' is now 'distance_mm': correct the name \(safeloc migrate\)\.$"),
        (
            "old.csv",
            f"{HEADER}step_mm\n",
            r":1: no record has a column 'step_mm'; .* 'step_mm' is now 'distance_mm'\.$",
        ),
    ],
)
def test_an_old_record_is_refused_with_the_new_name(tmp_path: Path, name: str, text: str, message: str) -> None:
    """As JSONL and as a table."""
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    with pytest.raises(StreamError, match=message):
        read_records(path)


def test_the_old_keyword_is_refused_beside_the_new_one() -> None:
    """A record that a program makes names both: the field that is missing, and the one that there is no more."""
    with pytest.raises(
        ValidationError, match=r"(?s)\ndistance_mm\n  Field required.*\nstep_mm\n  Extra inputs are not"
    ):
        DistanceRecord(time_ms=100, end="front", unit="wheel", step_mm=1200)  # type: ignore[call-arg]


def test_an_old_input_is_refused_with_the_new_name() -> None:
    """Of the machine that had it."""
    with pytest.raises(InputError, match=r"; 'step_mm' is now 'distance_mm'"):
        read_inputs(load_target("reflector").system, {"step_mm": 3})


def test_a_configuration(tmp_path: Path) -> None:
    """The field keeps its value, as it is written; the old one is refused with the new one."""
    text = "max_step_mm = 4_500 # of a cycle\n"
    made = migrated(tmp_path / "arbitration.toml", text)
    assert "max_cycle_distance_mm = 4_500 # of a cycle\n" == made.text
    assert ["max_step_mm = 4500 -> max_cycle_distance_mm = 4500 (line 1)"] == changed(made)
    with pytest.raises(
        InputError, match=r"max_step_mm: .*; it is max_cycle_distance_mm now \(safeloc migrate\) \(line 1\)$"
    ):
        read_config(ENTRIES["arbitration"].config, tmp_path / "arbitration.toml")
