"""Whatever fields a record or a step has, of whatever kinds and in whatever order: read, or refused with its place."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError, StreamError, UnforeseenError
from safeloc.runtime.embedding import Controller
from safeloc.runtime.outside import UNFORESEEN
from safeloc.runtime.service.fleet import Fleet, FleetSettings
from safeloc.runtime.service.lines import Line
from safeloc.runtime.streams.record_files import FIELDS, OWN, read_raw, read_records, record_or_fault
from safeloc.runtime.streams.records import Unusable
from safeloc.runtime.streams.steps import read_steps
from tests.runtime.embedding.driving import shipped

SCALARS = st.one_of(
    st.none(), st.booleans(), st.integers(-3, 3_000), st.integers(), st.floats(), st.text(max_size=5),
    st.sampled_from([10**30, -(2**63), 2**63, "1", "nan", "front", "rear", "wheel", "\ud800", "\u0661", "", "truth", "cycle"]),
)  # fmt: skip
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=2) | st.dictionaries(st.text(max_size=2), inner, max_size=2),
    max_leaves=4,
)
SOUND = {
    "kind": st.sampled_from([*OWN, "cycle", "balise"]), "time_ms": st.integers(0, 1_000), "end": st.sampled_from(["front", "rear"]),
    "unit": st.sampled_from(["wheel", "radar", "gps"]), "name": st.sampled_from(["front_marker", "front_wheel_mm", "truth", "x"]),
}  # fmt: skip
NAMES = st.sampled_from(
    [
        *FIELDS,
        "vehicle",
        "number",
        "cycle",
        "schema",
        "first",
        "kept",
        "machine",
        "truth_mm",
        "front_wheel_mm",
        "front_marker",
        "x",
    ]
)


@st.composite
def rows(draw: st.DrawFn) -> dict[str, Any]:
    """A sound beginning with anything after it, before it, or instead of it."""
    kind = draw(st.sampled_from(list(OWN)))
    own = {name: draw(SOUND.get(name, st.integers(-5, 5_000))) for name in OWN[kind] if draw(st.integers(0, 9))}
    row = {**own, "kind": kind, **draw(st.dictionaries(NAMES, VALUES, max_size=3))}
    return dict(draw(st.permutations(list(row.items()))))


def refusal_of(read: Callable[[], object]) -> InputError | None:
    """Why it was refused; None if it was not. Anything else comes out."""
    try:
        read()
    except InputError as refused:
        return refused
    return None


def text_of(row: dict[str, Any]) -> str:
    """As a line."""
    return json.dumps(row)


@given(rows())
def test_any_row_is_a_record_a_fault_or_refused(row: dict[str, Any]) -> None:
    """And a record says what stands in the row: nothing is put in the place of anything."""
    refused = refusal_of(lambda: record_or_fault(row))
    assert not isinstance(refused, UnforeseenError)
    if refused is not None:
        return
    record = record_or_fault(row)
    assert record.time_ms == row["time_ms"]
    if not isinstance(record, Unusable):
        said = record.model_dump(exclude_unset=True)
        assert said == {name: value for name, value in row.items() if name in said}
        assert all(row[name] is None for name in row.keys() - said.keys())


@given(st.lists(rows(), max_size=6), st.booleans(), st.booleans())
def test_any_lines_leave_a_fleet_running(said: list[dict[str, Any]], inputs: bool, numbered: bool) -> None:
    """Nothing raises, nothing is a defect, and a refusal names its line."""
    fleet = Fleet(shipped("odometry"), FleetSettings(100, inputs=inputs, numbered=numbered))
    for number, row in enumerate(said, 1):
        for told in fleet.handle("peer", Line(number, text_of(row).encode()), from_start=True):
            assert UNFORESEEN not in str(told.get("reason", ""))
            assert told.get("event") != "refused" or told["line"] == number
    fleet.finish()


Read = Callable[[Path], object]


@pytest.mark.parametrize("read", [read_raw, read_records, read_steps])
@given(st.lists(rows(), min_size=1, max_size=4))
def test_any_lines_of_a_file_are_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, read: Read, said: list[dict[str, Any]]
) -> None:
    """A refusal names file and line."""
    path = tmp_path_factory.getbasetemp() / "any.jsonl"
    path.write_text("".join(text_of(row) + "\n" for row in said), encoding="utf-8")
    _read_or_refused(read, path)


CELLS = st.one_of(
    st.text(max_size=6),
    st.integers(-9, 9_999).map(str),
    st.sampled_from(["true", "NaN", "1e3", "\u0661", '"', "a,b", "1_0", "wheel"]),
)


@pytest.mark.parametrize("read", [read_raw, read_records, read_steps])
@given(st.lists(st.sampled_from([*FIELDS, "x", "", "front_wheel_mm"]), min_size=1, max_size=6), st.data())
def test_any_table_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, read: Read, names: list[str], data: st.DataObject
) -> None:
    """Columns of any kind, in any order, twice, with any cells."""
    width = st.lists(CELLS, min_size=len(names), max_size=len(names))
    table = [names, *data.draw(st.lists(width, max_size=3))]
    path = tmp_path_factory.getbasetemp() / "any.csv"
    path.write_text("\n".join(",".join(row) for row in table), encoding="utf-8", newline="")
    _read_or_refused(read, path)


def _read_or_refused(read: Read, path: Path) -> None:
    refused = refusal_of(lambda: read(path))
    if refused is not None:
        assert isinstance(refused, StreamError)
        assert re.match(rf"{re.escape(str(path))}:\d+: ", str(refused)), str(refused)


@given(st.lists(st.tuples(st.integers(0, 10_000), st.integers(0, 255)), min_size=1, max_size=4))
def test_a_damaged_snapshot_changes_nothing(changes: list[tuple[int, int]]) -> None:
    """It is an InputError, or the same content."""
    controller = Controller(shipped("odometry"))
    before = controller.snapshot()
    damaged = bytearray(before)
    for at, byte in changes:
        damaged[at % len(damaged)] = byte
    assert not isinstance(refusal_of(lambda: controller.restore(bytes(damaged))), UnforeseenError)
    assert before == controller.snapshot()
