"""A run as a file for other programs: what is written is what the run says, read back by the programs' own readers."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import mcap.reader
import pytest
from pyarrow import parquet
from vcd.reader import TokenKind, tokenize

from safeloc.errors import InputError
from safeloc.language.expr import boolean, ite, number, optional
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import lower
from safeloc.language.units import COUNT, MM, UM_S
from safeloc.report.run_files import FORMATS, format_of
from safeloc.report.run_files.columns import RunColumns, run_columns

A, B = modes("A", "B")
go, far, speed = boolean("go"), optional("far_mm", MM, -9, 9), number("speed_um_s", UM_S, 0, 10**12)
height, laps = number("height", MM, -(2**62), 2**62), number("laps", COUNT, 0, 9)
MACHINE = Machine(
    "lift 2",
    modes=(A, B),
    inputs=[go, far, speed],
    state={height: -1, laps: 0},
    outputs={"tall": height > 5, "shown": ite(height > 5, height, 0)},
    transitions=[
        Transition("goes up", A, B, go, {height: 2**62}, rank=0),
        Transition("comes down", B, A, ~go, {height: -(2**62), laps: laps + 1}, rank=0),
    ],
)
STREAM = [
    {"go": True, "far_mm": -3, "speed_um_s": 10**12},
    {"go": True, "speed_um_s": 0},
    {"go": False, "speed_um_s": 1},
]
HEADINGS = [
    "input.go", "input.far_mm", "input.speed_um_s", "fired.fired", "state.mode", "state.height [mm]", "state.laps",
    "output.tall", "output.shown [mm]",
]  # fmt: skip


def columns(**more: Any) -> RunColumns:
    """The run of the lift."""
    return run_columns(run(lower(MACHINE), STREAM), **more)


def test_each_variable_is_a_column_with_its_unit() -> None:
    """Labels are words, absent values None, and numbers keep all their digits."""
    made = columns()
    values = {one.heading: list(one.values) for one in made.columns}
    assert [*values] == HEADINGS
    assert values["input.far_mm"] == [-3, None, None]
    assert values["fired.fired"] == ["goes up", "(stay)", "comes down"]
    assert values["state.mode"] == ["B", "B", "A"]
    assert values["state.height [mm]"] == [2**62, 2**62, -(2**62)]
    assert values["output.tall"] == [True, True, False]
    assert made.truth_mm == []


def test_csv(tmp_path: Path) -> None:
    """A row a step, with the time of its end where cycles have a length, and the recorded truth where there is one."""
    path = tmp_path / "run.csv"
    format_of(path)(path, columns(period_ms=500, truth_mm=[None, 7, None]))
    rows = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))
    assert [*rows[0]] == ["step", "time_ms", *HEADINGS, "truth_mm"]
    assert [row["step"] for row in rows] == ["1", "2", "3"]
    assert [row["time_ms"] for row in rows] == ["500", "1000", "1500"]
    assert [row["truth_mm"] for row in rows] == ["", "7", ""]
    assert [row["input.far_mm"] for row in rows] == ["-3", "", ""]
    assert [row["input.go"] for row in rows] == ["true", "true", "false"]
    format_of(path)(path, columns())
    assert path.read_text(encoding="utf-8").splitlines()[0] == ",".join(["step", *HEADINGS])


def test_parquet(tmp_path: Path) -> None:
    """Typed columns, null where a value is absent."""
    path = tmp_path / "run.parquet"
    format_of(path)(path, columns(period_ms=100))
    table = parquet.read_table(path)
    assert table.column("state.height [mm]").to_pylist() == [2**62, 2**62, -(2**62)]
    assert table.column("input.far_mm").to_pylist() == [-3, None, None]
    assert table.column("output.tall").to_pylist() == [True, True, False]
    assert table.schema.metadata[b"machine"] == b"lift 2"


def waves(path: Path) -> tuple[dict[str, list[tuple[int, Any]]], Any]:
    """The changes of each variable by its full name, and the last time."""
    scopes, names, changes, now = list[str](), dict[str, str](), dict[str, list[tuple[int, Any]]](), 0
    with path.open("rb") as file:
        for token in tokenize(file):
            match token.kind:
                case TokenKind.SCOPE:
                    scopes.append(token.scope.ident)
                case TokenKind.UPSCOPE:
                    scopes.pop()
                case TokenKind.VAR:
                    names[token.var.id_code] = ".".join((*scopes, token.var.reference))
                case TokenKind.CHANGE_TIME:
                    now = token.time_change
                case TokenKind.CHANGE_SCALAR | TokenKind.CHANGE_VECTOR | TokenKind.CHANGE_STRING:
                    change = (
                        token.scalar_change
                        if token.kind is TokenKind.CHANGE_SCALAR
                        else (token.vector_change if token.kind is TokenKind.CHANGE_VECTOR else token.string_change)
                    )
                    changes.setdefault(names[change.id_code], []).append((now, change.value))
    return changes, now


def test_vcd(tmp_path: Path) -> None:
    """Changes at the ends of the steps; an absent number is x, and so is every one before the first step."""
    path = tmp_path / "run.vcd"
    format_of(path)(path, columns(period_ms=500))
    changes, last = waves(path)
    assert changes["lift_2.state.height_mm"] == [(0, "x"), (500, 2**62), (1500, (-(2**62)) & (2**64 - 1))]
    assert changes["lift_2.input.far_mm"] == [(0, "x"), (500, -3 & (2**64 - 1)), (1000, "x")]
    assert changes["lift_2.input.go"] == [(0, "x"), (500, "1"), (1500, "0")]
    assert changes["lift_2.fired.fired"][1:] == [(500, "goes_up"), (1000, "(stay)"), (1500, "comes_down")]
    assert last == 2000
    assert {name.split(".")[1] for name in changes} == {"input", "fired", "state", "output"}


def test_mcap(tmp_path: Path) -> None:
    """A message for each group and step, with its time and a schema that names the units."""
    path = tmp_path / "run.mcap"
    format_of(path)(path, columns(period_ms=500))
    with path.open("rb") as file:
        read = [
            (schema, channel.topic, message.log_time, json.loads(message.data))
            for schema, channel, message in mcap.reader.make_reader(file).iter_messages()
        ]
    states = [(time, data) for _, topic, time, data in read if topic == "/lift 2/state"]
    assert states == [
        (500_000_000, {"mode": "B", "height": 2**62, "laps": 0}),
        (1_000_000_000, {"mode": "B", "height": 2**62, "laps": 0}),
        (1_500_000_000, {"mode": "A", "height": -(2**62), "laps": 1}),
    ]
    inputs = [data for _, topic, _, data in read if topic == "/lift 2/input"]
    assert inputs[1] == {"go": True, "speed_um_s": 0}
    schema = next(schema for schema, topic, *_ in read if topic == "/lift 2/state")
    assert json.loads(schema.data)["properties"]["height"] == {"type": "integer", "description": "mm"}


def test_another_ending_is_refused() -> None:
    """The message names those that there are."""
    with pytest.raises(InputError, match=r"run\.xls: a run is written as \.csv, \.parquet, \.vcd, \.mcap"):
        format_of(Path("run.xls"))


@pytest.mark.parametrize(("ending", "package"), [(".vcd", "vcd"), (".mcap", "mcap.writer")])
def test_without_the_package_the_message_says_what_to_install(
    ending: str, package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Base installs have neither; CSV needs no package."""
    monkeypatch.setitem(__import__("sys").modules, package, None)
    with pytest.raises(InputError, match=r"install safeloc\[traces\], or write \.csv"):
        FORMATS[ending](tmp_path / f"run{ending}", columns())


def test_names_that_vcd_cannot_tell_apart_are_refused(tmp_path: Path) -> None:
    """A point and an underscore are the same there; other forms keep both."""
    made = columns()
    [go_column, *_] = made.columns
    pair = tuple(replace(go_column, name=name) for name in ("a.b", "a_b"))
    with pytest.raises(InputError, match=r"two variables would be called 'a_b' in VCD; write \.csv"):
        FORMATS[".vcd"](tmp_path / "run.vcd", replace(made, columns=pair))
    FORMATS[".csv"](tmp_path / "run.csv", replace(made, columns=pair))
    assert (tmp_path / "run.csv").read_text(encoding="utf-8").startswith("step,input.a.b,input.a_b\n")
