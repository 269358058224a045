"""`safeloc verify --quick`: tests and recordings only. It says so everywhere, and is never taken for a complete run."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from safeloc.catalogue import load_target
from safeloc.language.verdict import NotAsked, Vacuous, Violated, word
from safeloc.proof.cache.reports import report_key
from safeloc.proof.cache.targets import asked
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from safeloc.proof.verification.calls import prove_target
from safeloc.proof.verification.one import Plan
from safeloc.proof.verification.unasked import QUICK, as_left_open, left_open
from safeloc.report.data import schema
from safeloc.report.headline import KindAndVerdict, headline
from tests.cli.calling import DOOR, DOOR_FILE, QUICK_VERIFY, Call, wrong_door

TEMPLATE = Path(__file__).parents[2] / "safeloc" / "templates" / "machine" / "odometer.py"


COMPOSITION = TEMPLATE.parents[1] / "composition" / "supervised.py"


def read(folder: Path) -> dict[str, Any]:
    """The data of a report."""
    data: dict[str, Any] = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    jsonschema.validate(data, schema())
    return data


def test_it_says_what_was_not_asked(call: Call, tmp_path: Path) -> None:
    """Exit code 3; every property and obligation stands in the data and on the page, and nothing says that it holds."""
    called = call("verify", f"{TEMPLATE}:machine", "--quick", "--out", str(tmp_path), *QUICK_VERIFY)
    assert 3 == called.code
    open_ = {one.id for one in left_open(load_target(f"{TEMPLATE}:machine"))}
    rows = read(tmp_path)["results"]
    assert open_ == {row["id"] for row in rows if row["kind"] not in ("test", "replay")}
    assert {"not asked"} == {row["verdict"] for row in rows if row["id"] in open_}
    assert {"held"} == {row["verdict"] for row in rows if row["kind"] == "replay"}
    number = sum(row["verdict"] == "not asked" for row in rows)
    assert called.out.startswith("quick: no proof was asked for: ")
    assert f", {number} not asked\n" in called.out
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert '<span class="verdict">quick: no proof was asked for</span>' in page
    assert all(name in page for name in open_)
    assert "all holds" not in page + called.out
    assert "no run of this report can be taken over; <code>safeloc open " in page


def test_the_page_made_again_says_the_same(call: Call, tmp_path: Path) -> None:
    """The report folder alone shows that the run was a quick one."""
    call("verify", DOOR, "--quick", "--out", str(tmp_path), *QUICK_VERIFY)
    page = tmp_path / "index.html"
    first = page.read_text(encoding="utf-8")
    assert '<span class="verdict">quick: ' in first
    page.unlink()
    assert 0 == call("report", str(tmp_path)).code
    assert first == page.read_text(encoding="utf-8")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("spec", [f"{TEMPLATE}:machine", f"{COMPOSITION}:whole"])
def test_what_is_left_open_is_what_is_proved(spec: str) -> None:
    """A complete run has a finding of each property, lemma, mode and transition that a quick one leaves open."""
    target = load_target(spec)
    complete = {one.id for one in prove_target(target, limits=Limits(seconds=10))}
    left = {one.id for one in left_open(target)}
    assert set() == left - complete
    more = ("antecedents", "case ", "overflow of ghosts", "assumption lasts", "dead ends")  # checked along with another
    assert set() == {one for one in complete - left if not one.split("/")[2].startswith(more)}


def test_a_violation_comes_first(call: Call, tmp_path: Path) -> None:
    """A wrong machine that a test catches: exit code 1, and still what was not asked."""
    called = call("verify", wrong_door(tmp_path), "--quick", "--out", str(tmp_path / "r"), "--examples", "40")
    assert 1 == called.code
    assert "not all holds; quick: " in called.out.splitlines()[-1]


@pytest.mark.thorough
def test_a_quick_result_is_never_a_complete_one(call: Call, tmp_path: Path) -> None:
    """With one cache: the complete run proves anew after a quick one, and the quick one proves nothing after it."""
    cache = ("--cache", str(tmp_path / "cache"), "--out", str(tmp_path / "r"), *QUICK_VERIFY)
    kinds = []
    for quick in ((), ("--quick",), (), ("--quick",), ("--quick", "--fresh")):
        called = call("verify", DOOR, *quick, *cache)
        rows = read(tmp_path / "r")["results"]
        kinds.append((called.code, "proved" in {row["verdict"] for row in rows}, bool(read(tmp_path / "r")["kept"])))
    assert [(0, True, False), (3, False, False), (0, True, True), (3, False, True), (3, False, False)] == kinds


def test_the_keys_of_the_cache_hold_it() -> None:
    """Findings and reports of a quick run have keys of their own."""
    whole, quick = (Plan(Limits(), 1, 1, 0, quick) for quick in (False, True))
    target = load_target(DOOR)
    assert asked(target, "verified", whole).key != asked(target, "verified", quick).key
    assert report_key(["odometry"], None, whole) != report_key(["odometry"], None, quick)


@pytest.mark.parametrize("option", ["--recheck", "--evidence"])
def test_what_is_about_proofs_is_refused(call: Call, tmp_path: Path, option: str) -> None:
    """There are no proofs to check or to take apart."""
    called = call("verify", DOOR, "--quick", option, "--out", str(tmp_path / "r"))
    assert 2 == called.code
    assert f"{option} is about proofs, and --quick makes none" in " ".join(called.err.replace("│", " ").split())
    assert not (tmp_path / "r").exists()


def test_json(call: Call, tmp_path: Path) -> None:
    """The data alone on standard output, with the verdict of the whole."""
    called = call("verify", DOOR, "--quick", "--json", "--out", str(tmp_path), *QUICK_VERIFY)
    assert (3, "") == (called.code, called.err)
    assert "not asked" == json.loads(called.out)["verdict"]


def test_a_machine_without_properties(call: Call, tmp_path: Path) -> None:
    """It is told as in a complete run, beside what a quick one leaves open."""
    text = DOOR_FILE.read_text(encoding="utf-8")
    path = tmp_path / "bare.py"
    path.write_text(text[: text.index("properties = [")], encoding="utf-8")
    called = call("verify", f"{path}:machine", "--quick", "--out", str(tmp_path / "r"), *QUICK_VERIFY)
    assert 3 == called.code
    assert "not asked door/property/nothing asked" in called.out
    assert "quick: " in called.out


def test_a_case_that_did_not_occur_is_left_open() -> None:
    """A quick run did not search for it, so it does not say vacuous; other results stay."""
    vacuous = Finding("m/test/p", "m", "test", "p", Vacuous("x never occurred"), "Hypothesis", 1.0)
    opened = as_left_open(vacuous)
    assert isinstance(opened.result, NotAsked)
    assert opened.result.reason.startswith("x never occurred; a quick run proves nothing")
    assert QUICK == opened.method
    violated = Finding("m/test/p", "m", "test", "p", Violated(None, "Hypothesis"), "Hypothesis", 1.0)
    assert violated is as_left_open(violated)
    assert "violated" == word(violated.result)


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        ([], "quick: no proof was asked for"),
        (["held"], "quick: no proof was asked for"),
        (["proved", "held"], "quick: no proof was asked for"),
        (["not asked"], "quick: no proof was asked for"),
        (["unknown"], "undecided: at least one result is neither proved nor refuted; quick: no proof was asked for"),
        (["violated", "held"], "not all holds; quick: no proof was asked for"),
    ],
)
def test_the_headline(found: list[str], expected: str) -> None:
    """It never says that something holds; what is worse than not asked comes first."""
    rows = [KindAndVerdict("test", verdict) for verdict in found]
    assert expected == headline([*rows, KindAndVerdict("property", "not asked", quick=True)])
