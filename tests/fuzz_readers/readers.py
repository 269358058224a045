"""Every reader with something that it reads, as a function of bytes that raises only for a defect.

A reader may hand over what it read, or refuse it with an InputError that names the file. Anything else, an
UnforeseenError among it, is a defect.
"""

from __future__ import annotations

import gzip
import json
import tempfile
import zipfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from io import BytesIO
from pathlib import Path

from safeloc.catalogue import load_target
from safeloc.errors import InputError, SnapshotError, UnforeseenError
from safeloc.railway.guard.fields import Columns
from safeloc.railway.guard.nmea import nmea_deliveries
from safeloc.railway.guard.streams import csv_deliveries, jsonl_deliveries
from safeloc.railway.map.imports.formats import FORMATS
from safeloc.railway.map.recorded_run import read_fixes
from safeloc.railway.map.toml_files import load_line, shipped_lines
from safeloc.runtime.embedding import Controller, Program
from safeloc.runtime.outside import UNFORESEEN
from safeloc.runtime.service.lines import LineCutter
from safeloc.runtime.service.messages import Reader, Refused
from safeloc.runtime.streams.record_files import read_raw, read_records
from safeloc.runtime.streams.records import RECORD
from safeloc.runtime.streams.steps import read_steps
from safeloc.sensing.fibre.recordings import read_array
from safeloc.sensing.satellite.android import read_android
from safeloc.sensing.satellite.corrected import read_corrected
from safeloc.sensing.satellite.navigation import read_navigation
from safeloc.sensing.satellite.observations import read_observations
from tests.railway.map.imports.documents import STATION
from tests.railway.map.imports.test_geojson import SWITCH
from tests.railway.map.imports.test_ttobench import TRACK


@dataclass(frozen=True)
class Fuzzed:
    """A reader by name: what it does with bytes, and sound examples to begin with."""

    name: str
    read: Callable[[bytes], object]
    examples: Callable[[], Iterable[bytes]]


@cache
def _folder() -> Path:
    return Path(tempfile.mkdtemp(prefix="safeloc-fuzz-"))


def _file(suffix: str, *readers: Callable[[Path], object]) -> Callable[[bytes], object]:
    """Readers of files: what they refuse begins with the file."""

    def read(data: bytes) -> None:
        path = _folder() / f"fuzzed{suffix}"
        path.write_bytes(data)
        for one in readers:
            try:
                one(path)
            except UnforeseenError:
                raise
            except InputError as error:
                if not str(error).startswith((str(path), path.name)):
                    raise AssertionError(f"refused without its place: {error}") from error

    return read


def _lines(*, inputs: bool) -> Callable[[bytes], object]:
    """The reader of a process never raises."""

    def read(data: bytes) -> None:
        reader = _reader(inputs)
        for line in LineCutter().feed(data + b"\n"):
            told = reader.read(line)
            if isinstance(told, Refused) and UNFORESEEN in told.reason:
                raise AssertionError(told.reason)

    return read


@cache
def _reader(inputs: bool) -> Reader:
    return Reader(_program(), {}, inputs=inputs, numbered=False, first={})


@cache
def _program() -> Program:
    return Program(load_target("odometry"))


@cache
def _controller() -> Controller:
    return Controller(_program())


def _snapshot(data: bytes) -> None:
    """A damaged snapshot is a SnapshotError, and changes nothing."""
    before = _controller().snapshot()
    try:
        _controller().restore(data)
    except SnapshotError:
        assert before == _controller().snapshot()


def _positions(form: str) -> Callable[[bytes], object]:
    columns = Columns(time="t", x="x", y="y", speed="v")

    def read(data: bytes) -> None:
        lines = data.decode("utf-8", "replace").splitlines(keepends=True)
        try:
            said = {
                "csv": lambda: csv_deliveries(lines, columns, "fuzzed"),
                "jsonl": lambda: jsonl_deliveries(lines, columns),
                "nmea": lambda: nmea_deliveries(lines),
            }[form]()
            wrong = [one.wrong for one in said if UNFORESEEN in one.wrong]
        except InputError as error:
            if isinstance(error, UnforeseenError) or not str(error).startswith("fuzzed"):
                raise
            return
        if wrong:
            raise AssertionError(wrong[0])

    return read


# ------------------------------------------------------------------ sound examples

ROWS: tuple[dict[str, object], ...] = (
    {"kind": "distance", "time_ms": 100, "end": "front", "unit": "wheel", "distance_mm": -12},
    {"kind": "pulses", "time_ms": 100, "end": "rear", "unit": "wheel", "pulses": 3},
    {"kind": "marker", "time_ms": 140, "end": "front", "marker": 7, "position_mm": 5, "accuracy_mm": 2, "since_mm": 1},
    {"kind": "value", "time_ms": 150, "name": "door", "value": True},
    {"kind": "truth", "time_ms": 160, "position_nm": 123456789},
)
STEPS = (
    {"schema": "safeloc-stream/1", "machine": "odometry", "first": {}, "kept": ["front_wheel_mm"]},
    {"front_wheel_mm": 1200, "front_marker": 7, "truth_mm": 5}, {"rear_radar_mm": None}, {"front_wheel_mm": -1},
)  # fmt: skip


def _jsonl(rows: Iterable[object]) -> bytes:
    return "".join(json.dumps(row) + "\n" for row in rows).encode()


def _csv(rows: Iterable[dict[str, object]]) -> bytes:
    listed = list(rows)
    names = list(dict.fromkeys(name for row in listed for name in row))
    cells = ([str(row.get(name, "")) for name in names] for row in listed)
    return "\n".join(",".join(row) for row in (names, *cells)).encode()


def _parquet() -> Iterable[bytes]:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        return
    texts = [{**row, "value": "true"} if "value" in row else row for row in ROWS]
    for rows in (texts, STEPS[1:]):
        made = BytesIO()
        parquet.write_table(pyarrow.Table.from_pylist(list(rows)), made)
        yield made.getvalue()


def _xlsx() -> Iterable[bytes]:
    """A workbook without compression, so that what is changed in it is XML."""
    import openpyxl

    book, packed, plain = openpyxl.Workbook(), BytesIO(), BytesIO()
    sheet = book.active
    assert sheet is not None
    sheet.append(["NID_C", "NID_BG", "Lint", "Km", "Or BG", "Or Lint", "Spoornr"])
    sheet.append([426, 139, "Ut-As", 1_200.5, "Utrecht", "Z", "spoor 1"])
    book.save(packed)
    with zipfile.ZipFile(packed) as source, zipfile.ZipFile(plain, "w") as target:
        for name in source.namelist():
            target.writestr(name, source.read(name))
    return [plain.getvalue()]


def _arrays() -> Iterable[bytes]:
    import numpy as np

    for save in (lambda file: np.save(file, np.zeros((3, 2), np.float32)),
                 lambda file: np.savez(file, data=np.zeros((3, 2), np.int16), scale=2.0, fs_hz=500.0, dx_m=1.0)):  # fmt: skip
        made = BytesIO()
        save(made)
        yield made.getvalue()


OBSERVATIONS = """     3.04           OBSERVATION DATA    M                   RINEX VERSION / TYPE
G    2 C1C D1C                                              SYS / # / OBS TYPES
                                                            END OF HEADER
> 2022 03 15 09 27 26.2000000  0  1
G05  21000000.123        -1234.567
> 2022 03 15 09 27 26.4000000  0  0
"""
NAVIGATION = (
    "     3.04           N: GNSS NAV DATA    M: MIXED            RINEX VERSION / TYPE\n"
    "                                                            END OF HEADER\n"
    "G05 2022 03 15 10 00 00" + " 1.000000000000D-04" * 3 + "\n" + ("    " + " 1.000000000000D+00" * 4 + "\n") * 7
)
CORRECTED = (
    "time_s,satellite,pseudorange_m,rate_m_per_s,x_m,y_m,z_m,vx_m_per_s,vy_m_per_s,vz_m_per_s\n"
    "1300000000.5,G05,21000000.125,-300.5,26560000,0,0,0,2700,1500\n"
    "1300000001.5,G05,21000000.125,,26560000,0,0,0,2700,1500\n"
)
ANDROID = (
    "# Raw,TimeNanos,FullBiasNanos,BiasNanos,Svid,TimeOffsetNanos,State,ReceivedSvTimeNanos,"
    "PseudorangeRateMetersPerSecond,CarrierFrequencyHz,ConstellationType\n"
    "Raw,1000000000,-1151285107000000000,0.0,5,0.0,9,235506925000000,-12.5,1575420000.0,1\n"
)
POSITIONS = [
    {"t": 1500, "x": 4.5, "y": 50.9, "v": 12.3},
    {"t": "2022-03-15T09:27:26Z", "x": "4.5", "y": "50", "v": None},
]
NMEA = "$GPRMC,092726.20,A,5053.19326,N,00427.88308,E,10.000,,150322,,,A*7E\n$GPRMC,,V,,,,,,,,,,N*53\n"

FUZZED = (
    Fuzzed("lines of records", _lines(inputs=False), lambda: [_jsonl(ROWS), *(_jsonl([{"vehicle": "7", "number": 5, **row}]) for row in ROWS)]),
    Fuzzed("lines of steps", _lines(inputs=True), lambda: [_jsonl(STEPS), _jsonl([{"cycle": 3, "vehicle": "a", "front_wheel_mm": 1}])]),
    Fuzzed("JSONL", _file(".jsonl", read_raw, read_records, read_steps), lambda: [_jsonl(ROWS), _jsonl(STEPS)]),
    Fuzzed("packed JSONL", _file(".jsonl.gz", read_raw, read_steps), lambda: [gzip.compress(_jsonl(rows), mtime=0) for rows in (ROWS, STEPS)]),
    Fuzzed("CSV", _file(".csv", read_raw, read_records, read_steps), lambda: [_csv(ROWS), _csv(STEPS[1:])]),
    Fuzzed("Parquet", _file(".parquet", read_raw, read_steps), _parquet),
    Fuzzed("snapshots", _snapshot, lambda: [_controller().snapshot()]),
    Fuzzed("lines as TOML", _file(".toml", load_line), lambda: [path.read_bytes() for path in shipped_lines().values()]),
    Fuzzed("lines as JSON", _file(".json", load_line), lambda: [load_line(path).model_dump_json().encode() for path in list(shipped_lines().values())[:1]]),
    Fuzzed("railML", _file(".railml", FORMATS["railml"]), lambda: [STATION.encode()]),
    Fuzzed("GeoJSON", _file(".geojson", FORMATS["geojson"]), lambda: [json.dumps(SWITCH).encode()]),
    Fuzzed("TTOBench", _file(".json", FORMATS["ttobench"]), lambda: [json.dumps(TRACK).encode()]),
    Fuzzed("XLSX", _file(".xlsx", FORMATS["balises"]), _xlsx),
    Fuzzed("RINEX observations", _file(".obs", read_observations), lambda: [OBSERVATIONS.encode()]),
    Fuzzed("RINEX navigation", _file(".nav", read_navigation), lambda: [NAVIGATION.encode()]),
    Fuzzed("Android", _file(".txt", read_android), lambda: [ANDROID.encode()]),
    Fuzzed("corrected ranges", _file(".csv", read_corrected), lambda: [CORRECTED.encode()]),
    Fuzzed("fixes", _file(".csv", read_fixes), lambda: [b"timestamp,longitude,latitude,position_type\n2022-03-15T09:27:26Z,4.5,50.9,FIX\n2022-03-15T09:27:27Z,4.6,50.9,FIX\n"]),
    Fuzzed("positions as CSV", _positions("csv"), lambda: [_csv(POSITIONS)]),
    Fuzzed("positions as JSONL", _positions("jsonl"), lambda: [_jsonl(POSITIONS)]),
    Fuzzed("NMEA", _positions("nmea"), lambda: [NMEA.encode()]),
    Fuzzed("arrays", _file(".npz", read_array), _arrays),
)  # fmt: skip
KINDS = frozenset(row["kind"] for row in ROWS)
assert {RECORD.validate_python(row).kind for row in ROWS} == KINDS
