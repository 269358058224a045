"""Every recorded and published map: imported, written, read again, audited."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from safeloc.railway.audit import audit
from safeloc.railway.map.imports.formats import importer
from safeloc.railway.map.imports.notes import Imported
from safeloc.railway.map.model import sealed
from safeloc.railway.map.toml_files import from_toml, to_toml
from tests.data_sources import data_file

TRACKS = (
    "00_reference", "00_reference_with_tunnels", "00_var_gradient_minus_10", "00_var_gradient_minus_5",
    "00_var_gradient_minusplus_6", "00_var_gradient_plus_10", "00_var_gradient_plus_5", "00_var_speed_limit_100",
    "00_var_speed_limit_110", "00_var_speed_limit_120", "00_var_speed_limit_wind", "CH_Fribourg_Bern",
    "CH_Stadelhofen_Altstetten", "CH_StGallen_Wil", "CN_Songjiazhuang_Yizhuang", "SE_Vasteras_Kolback",
)  # fmt: skip
FILES = {
    "trains/network_airport.geojson": "geojson",
    "balises/Baliselocations-V2.xlsx": "balises",
    **{f"lines_ttobench/tracks/{name}.json": "ttobench" for name in TRACKS},
}


@cache
def imported(name: str) -> Imported:
    """The file as a line."""
    path: Path = data_file(name)
    return importer(path, FILES[name])(path)


@pytest.mark.parametrize("name", FILES)
def test_what_is_written_is_read_again(name: str) -> None:
    """Nothing is lost between import, TOML and loading; the checksum fits."""
    line = sealed(imported(name).line)
    assert line == from_toml(to_toml(line), "again")


@pytest.mark.parametrize("name", FILES)
def test_real_lines_are_audited(name: str) -> None:
    """None of them is laid out for the default vehicle, and the audit says where: each has too long a stretch."""
    report = audit(imported(name).line)
    assert report.cases["odometry stretch"] > 0
    assert "odometry stretch" in {finding.rule for finding in report.findings}


def test_most_of_the_real_balises_are_near_enough() -> None:
    """Of 1324 stretches on the tracks of Utrecht-Amsterdam few are longer than odometry allows."""
    report = audit(imported("balises/Baliselocations-V2.xlsx").line)
    assert 1_324 == report.cases["odometry stretch"]
    too_long = sum(finding.rule == "odometry stretch" for finding in report.findings)
    assert 0 < too_long < 400
