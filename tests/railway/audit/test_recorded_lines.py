"""Lines that nobody here made are read and audited: real balise groups, a real network, published lines."""

from __future__ import annotations

import pytest

from safeloc.railway.audit import audit
from safeloc.railway.audit.findings import AuditReport
from safeloc.railway.map.imports.formats import importer
from safeloc.railway.map.toml_files import from_toml, to_toml
from tests.data_sources import DATA, data_file

TRACKS = sorted(path.name for path in (DATA / "lines_ttobench" / "tracks").glob("*.json"))


def audited(name: str, form: str) -> AuditReport:
    """A recorded line, imported, written, read again and audited."""
    path = data_file(name)
    imported = importer(path, form)(path)
    return audit(from_toml(to_toml(imported.line), name))


def test_real_balise_groups() -> None:
    """Utrecht to Amsterdam: 488 groups; with national values of 12 m, groups 80 m apart have windows that meet."""
    report = audited("balises/Baliselocations-V2.xlsx", "balises")
    assert 488 == report.elements["balise_groups"]
    assert {"odometry stretch", "balise windows"} == {finding.rule for finding in report.violated}
    windows = [finding.figures for finding in report.violated if finding.rule == "balise windows"]
    assert {86_000} == {figures.required for figures in windows if figures is not None}


def test_a_real_network() -> None:
    """Brussels airport without any reference: no stretch can be run, no branch told apart, and every finding has a place."""
    report = audited("trains/network_airport.geojson", "geojson")
    assert (74, 41) == (report.elements["edges"], report.cases["routes told apart"])
    assert {"odometry stretch", "routes told apart"} == {finding.rule for finding in report.violated}
    assert report.cases["odometry stretch"] == sum(finding.rule == "odometry stretch" for finding in report.violated)


@pytest.mark.parametrize("name", TRACKS or ["absent"])
def test_published_lines(name: str) -> None:
    """Published lines hold no references: too long a stretch one way and the other."""
    report = audited(f"lines_ttobench/tracks/{name}", "ttobench")
    assert {"odometry stretch"} <= {finding.rule for finding in report.violated}
