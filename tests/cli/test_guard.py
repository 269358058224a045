"""`safeloc guard`: streams in and out, counts, report, exit codes, and what is refused."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import pytest

from safeloc.models.guard.positions import FOLDER
from safeloc.railway.map.toml_files import to_toml
from tests.cli.calling import Call
from tests.railway.guard.made import CRS
from tests.railway.guard.test_other_way import BESIDE_M, double

pytest.importorskip("shapely")
pytest.importorskip("pyproj")
LINE, CSV, NMEA = (str(FOLDER / f"junction.{suffix}") for suffix in ("toml", "csv", "nmea"))
COLUMNS = ("--column", "speed=speed_m_s", "--column", "flag=quality")
WAY = ("--edges", "stem,main")


def objects(text: str) -> list[dict[str, Any]]:
    """One a line."""
    return [json.loads(line) for line in text.splitlines()]


def test_to_standard_output(call: Call) -> None:
    """One object a delivery; the counts go to standard error."""
    called = call("guard", LINE, CSV, *COLUMNS, *WAY, "--vehicle", "metro")
    rows = objects(called.out)
    assert (0, 154) == (called.code, len(rows))
    assert "154 deliveries: PASSED " in called.err
    passed = next(row for row in rows if row["passed"])
    assert {"edge", "position_mm", "way_mm", "offset_mm"} == set(passed["position"])
    assert passed["interval"]["min_mm"] < passed["position"]["way_mm"] < passed["interval"]["max_mm"]
    assert all(row["position"] is None and row["reason"] != "PASSED" for row in rows if not row["passed"])


def test_from_standard_input(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    """A stream that is piped in gives what the file gives; what is no UTF-8 in it is a line that is withheld."""

    class Piped:
        buffer = io.BytesIO(Path(CSV).read_bytes() + b"\xff\xfe\n")

    monkeypatch.setattr("sys.stdin", Piped())
    called = call("guard", LINE, "--format", "csv", *COLUMNS, *WAY)
    rows = objects(called.out)
    assert (0, 155, "MALFORMED") == (called.code, len(rows), rows[-1]["reason"])


@pytest.mark.parametrize("name", ["junction.csv", "./junction.csv", "linked.csv"])
def test_what_is_read_is_not_written_over(
    name: str, call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A recording given for --out as well is refused, by whatever name, and is still there."""
    monkeypatch.chdir(tmp_path)
    recorded = Path(CSV).read_bytes()
    Path("junction.csv").write_bytes(recorded)
    Path("linked.csv").symlink_to("junction.csv")
    called = call("guard", LINE, "junction.csv", *COLUMNS, *WAY, "--out", name)
    assert (2, recorded) == (called.code, Path("junction.csv").read_bytes())
    assert "would be overwritten" in called.err


def test_files_and_counts(call: Call, tmp_path: Path) -> None:
    """--out takes the objects, --json the counts, --report a page that needs nothing else."""
    out, folder = tmp_path / "passed.jsonl", tmp_path / "report"
    called = call(
        "guard", LINE, CSV, *COLUMNS, *WAY, "--vehicle", "metro", "--out", str(out), "--report", str(folder), "--json"
    )
    counts = json.loads(called.out)
    assert ("safeloc-guard/1", 154) == (counts["schema"], counts["deliveries"])
    assert counts["reasons"]["PASSED"] == sum(row["passed"] for row in objects(out.read_text(encoding="utf-8")))
    assert out.read_text(encoding="utf-8") == (folder / "judgements.jsonl").read_text(encoding="utf-8")
    assert (folder / "index.html").is_file()


def test_a_way_that_is_not_the_true_one(call: Call, tmp_path: Path) -> None:
    """The branch is given and the main line run, 4 m beside it: a warning at the first fix that makes it doubtful, and counts; nothing is withheld."""
    line, stream, out = tmp_path / "line.toml", tmp_path / "run.csv", tmp_path / "out.jsonl"
    line.write_text(to_toml(double()), encoding="utf-8")
    rows = [f"{second},{20 + 11 * second},{BESIDE_M}" for second in range(80)]
    stream.write_text("\n".join(["timestamp,longitude,latitude", *rows]) + "\n", encoding="utf-8")
    given = ("--edges", "stem,main", "--crs", CRS, "--time-unit", "s", "--vehicle", "metro")
    called = call(
        "guard", str(line), str(stream), *given, "--out", str(out), "--json", "--report", str(tmp_path / "page")
    )
    told = objects(out.read_text(encoding="utf-8"))
    first = next(one for one in told if one["beside"] and one["beside"]["doubtful"])
    assert f"warning: line {first['line']}: 11 of the last 11 fixes" in called.err
    assert called.err.count("warning") == 1
    counts = json.loads(called.out)
    assert counts["way_doubtful"] == sum(one["beside"]["doubtful"] for one in told if one["beside"]) > 10
    assert counts["reasons"]["PASSED"] + counts["reasons"]["UNCONFIRMED"] == 80
    assert "The given way is doubtful at" in (tmp_path / "page" / "index.html").read_text(encoding="utf-8")
    plain = call("guard", str(line), str(stream), *given, "--out", str(out))
    assert f"; the way is doubtful at {counts['way_doubtful']} of those passed on" in plain.out


def test_nmea(call: Call) -> None:
    """Sentences are taken by the suffix of their file."""
    pytest.importorskip("pynmeagps")
    called = call("guard", LINE, NMEA, *WAY, "--vehicle", "metro")
    assert (0, 150) == (called.code, len(objects(called.out)))


def test_json_lines_and_another_system(call: Call, tmp_path: Path) -> None:
    """Other names, times in seconds, speeds in km/h and projected coordinates."""
    stream = tmp_path / "s.jsonl"
    rows = [{"t": second, "e": 500_010.0, "n": 5_316_300.0, "kmh": 0, "ok": "yes"} for second in range(6)]
    stream.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
    names = ("time=t", "x=e", "y=n", "speed=kmh", "flag=ok")
    told = [part for name in names for part in ("--column", name)]
    called = call("guard", LINE, str(stream), *told, "--time-unit", "s", "--speed-unit", "km/h", "--crs", "EPSG:25832")
    found = objects(called.out)
    assert (0, {"UNCONFIRMED", "PASSED"}) == (called.code, {row["reason"] for row in found})
    assert [0, 1_000, 2_000, 3_000, 4_000, 5_000] == [row["time_ms"] for row in found]


def test_nothing_passed_on(call: Call, tmp_path: Path) -> None:
    """Exit code 3 where not one position was passed on, as where nothing can be decided."""
    stream = tmp_path / "s.csv"
    stream.write_text("timestamp,longitude,latitude\n0,9.0,48.0\n", encoding="utf-8")
    assert 3 == call("guard", LINE, str(stream)).code


def test_figures_of_the_file_go_before_those_of_the_vehicle(call: Call, tmp_path: Path) -> None:
    """A longer row is asked for, so more fixes are withheld."""
    figures = tmp_path / "guard.toml"
    figures.write_text("confirmations = 12\n", encoding="utf-8")
    few = call("guard", LINE, CSV, *COLUMNS, *WAY, "--vehicle", "metro")
    more = call("guard", LINE, CSV, *COLUMNS, *WAY, "--vehicle", "metro", "--config", str(figures))
    count = [sum(row["passed"] for row in objects(called.out)) for called in (few, more)]
    assert count[0] > count[1] > 0


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ((LINE, "none.csv"), "none.csv: cannot be read"),
        ((LINE, CSV, "--column", "speed=v"), "column 'v' is missing"),
        ((LINE, CSV, "--column", "z=v"), "expected WHAT=NAME"),
        ((LINE, CSV, "--vehicle", "tram"), "tram: no such file, and no shipped vehicle; shipped are desiro-br642"),
        ((LINE, CSV, "--crs", "EPSG:0"), "is no coordinate system"),
        ((LINE, CSV, "--edges", "main,stem,side"), "no vehicle can run over"),
        ((LINE, CSV, "--edges", "stem,main", "--path", "p.geojson"), "the route is given twice"),
        ((LINE, CSV, "--edges", "stem,main", "--first", "north"), "choose increasing or decreasing"),
        ((LINE, "s.dat"), "name csv, jsonl or nmea"),
        ((LINE, CSV, "--format", "xls"), "name csv, jsonl or nmea"),
        ((LINE, CSV, "--time-unit", "h"), "time unit 'h'"),
        (("fig1", CSV), "have no course"),
        ((LINE, CSV, "--json"), "give the positions a file with --out"),
        ((LINE, NMEA, "--sentence", "GSV"), "choose one of RMC"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_is_refused(call: Call, arguments: tuple[str, ...], told: str) -> None:
    """Wrong usage and input end with exit code 2 and say what to mend."""
    called = call("guard", *arguments)
    assert 2 == called.code
    assert told in " ".join(called.err.replace("│", " ").split())


def test_figures_that_pass_nothing_are_refused(call: Call, tmp_path: Path) -> None:
    """An added error beyond the tolerance is reported with its sum."""
    figures = tmp_path / "guard.toml"
    figures.write_text("tolerance_mm = 10_000\n", encoding="utf-8")
    called = call("guard", LINE, CSV, "--config", str(figures))
    assert 2 == called.code
    assert "has an error bound of 25000 mm" in called.err
