"""`safeloc verify --sarif FILE --junit FILE`: two files of the report, where a CI server looks for them."""

from __future__ import annotations

import importlib
import io
import json
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest

from safeloc.proof.cache.reports import KeptReport
from tests.cli.calling import DOOR, QUICK_VERIFY, Call, wrong_door

verify = importlib.import_module("safeloc.cli.verify")  # the package has the command under this name


def test_both_files_are_those_of_the_report(call: Call, tmp_path: Path) -> None:
    """Also where something is violated, which is when a server needs them; folders on the way are made."""
    report, sarif, junit = tmp_path / "report", tmp_path / "code" / "scan.sarif", tmp_path / "tests.xml"
    asked = ("verify", wrong_door(tmp_path), "--out", str(report), *QUICK_VERIFY)
    assert 1 == call(*asked, "--sarif", str(sarif), "--junit", str(junit)).code
    assert [(report / "results.sarif").read_text(), (report / "junit.xml").read_text()] == [
        sarif.read_text(),
        junit.read_text(),
    ]
    (run,) = json.loads(sarif.read_text())["runs"]
    (violated,) = (one for one in run["results"] if (one["ruleId"], one["level"]) == ("property", "error"))
    assert "door/property/opens at speed" == violated["partialFingerprints"]["safelocId/v1"]
    (suite,) = ElementTree.parse(junit).getroot()
    failed = [case.get("name") for case in suite if case.find("failure") is not None]
    assert ("door", "opens at speed") == (suite.get("name"), failed[0])


def test_a_report_from_the_cache_has_them_too(call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a run in which nothing has changed the report comes back whole, and an old copy is replaced."""
    packed, sarif = io.BytesIO(), tmp_path / "scan.sarif"
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("results.sarif", "of the kept report")
    kept = KeptReport("all holds", "2026-01-01T00:00:00Z", packed.getvalue())
    monkeypatch.setattr(verify, "kept_report", lambda store, key: kept)
    sarif.write_text("of yesterday")
    called = call("verify", "axle_head", "--out", str(tmp_path / "report"), "--sarif", str(sarif))
    assert (0, "of the kept report") == (called.code, sarif.read_text())


@pytest.mark.parametrize(
    ("place", "told"),
    [
        ("report/results.sarif", "lies within the report, whose files have digests."),
        ("a file/scan.sarif", "cannot be written; name a file in a folder in which you may write."),
        (".", "cannot be written; name a file in a folder in which you may write."),
    ],
)
def test_a_place_that_cannot_be_is_told_before_the_proofs(call: Call, tmp_path: Path, place: str, told: str) -> None:
    """No report is written, and none that was there is lost."""
    (tmp_path / "a file").write_text("")
    report = tmp_path / "report"
    called = call("verify", DOOR, "--out", str(report), "--sarif", str(tmp_path / place), *QUICK_VERIFY)
    assert 2 == called.code
    assert told in " ".join(called.err.split())
    assert not report.exists()


def test_one_place_for_both_is_refused(call: Call, tmp_path: Path) -> None:
    """The second would replace the first."""
    both = str(tmp_path / "results")
    called = call("verify", DOOR, "--out", str(tmp_path / "r"), "--sarif", both, "--junit", both, *QUICK_VERIFY)
    assert 2 == called.code
    assert "two files cannot be written to one place" in " ".join(called.err.split())
