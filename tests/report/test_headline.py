"""The headline: never better than what was found, and `all holds` only where something was proved."""

from __future__ import annotations

from itertools import product
from xml.etree import ElementTree

import jsonschema
import pytest

from safeloc.codegen.c99_layout import layout_of
from safeloc.language.system import without_ghosts
from safeloc.language.verdict import WORST_FIRST, Held, NotAsked, Proved, Result, Vacuous
from safeloc.proof.results import Finding
from safeloc.report.data import report_data, schema
from safeloc.report.headline import ALWAYS_COUNTED, KindAndVerdict, counted, headline
from safeloc.report.junit import to_junit
from safeloc.report.page import to_html
from tests.report.lamp import findings, target


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        ([], "not asked: there was no property to check"),
        ([("property", "not asked")], "not asked: there was no property to check"),
        ([("obligation", "proved"), ("property", "not asked")], "not asked: at least one machine had no property"),
        ([("property", "proved"), ("test", "held")], "all holds"),
        ([("replay", "held")], "held on recordings: 1 check; nothing was proved"),
        ([("replay", "held")] * 3, "held on recordings: 3 checks; nothing was proved"),
        ([("test", "held")] * 2, "held in tests: 2 checks; nothing was proved"),
        ([("test", "held"), ("replay", "held")], "held in tests and on recordings: 2 checks; nothing was proved"),
        ([("property", "proved"), ("property", "vacuous")], "vacuous: "),
        ([("property", "vacuous"), ("property", "unknown")], "undecided: "),
        ([("property", "unknown"), ("property", "violated")], "not all holds"),
    ],
)
def test_the_sentence(found: list[tuple[str, str]], expected: str) -> None:
    """It follows the worst verdict, and says what was only held."""
    assert headline([KindAndVerdict(*one) for one in found]).startswith(expected)


def test_all_holds_needs_a_proof_and_nothing_against_it() -> None:
    """Over every pair of verdicts: only proved and held together say so, and not held alone."""
    for pair in product(WORST_FIRST, repeat=2):
        says = headline([KindAndVerdict("property", verdict) for verdict in pair]) == "all holds"
        assert says == (set(pair) <= {"proved", "held"} and "proved" in pair)


def test_every_verdict_is_counted() -> None:
    """In words, from best to worst; what is always counted also where there is none."""
    found = [KindAndVerdict("property", verdict) for verdict in WORST_FIRST]
    every = "1 proved, 1 held in tests and replays, 1 not asked, 1 vacuous, 1 undecided, 1 violated"
    assert every == counted(found)
    by_run = KindAndVerdict("property", "proved", by_run=True)
    assert "1 proved, 2 shown by a run" == counted([found[-1], by_run, by_run])
    assert "0 proved, 0 held in tests and replays, 0 undecided, 0 violated" == counted([], ALWAYS_COUNTED)


def made(kind: str, result: Result) -> Finding:
    """A finding of the lamp."""
    return Finding(f"lamp/{kind}/it", "lamp", kind, "it", result, "none", 0.0)  # type: ignore[arg-type] # a kind


PROOF = Proved(None, "construction", certificates={"b.smt2": "", "a.smt2": ""}, by_construction="constant divisors")


def test_a_page_of_a_replay_does_not_say_all_holds() -> None:
    """What was held on a recording says so."""
    page = to_html(report_data([made("replay", Held("replay", 1, 9))], [target()]))
    assert '<span class="verdict">held on recordings: 1 check; nothing was proved</span>' in page
    assert "all holds" not in page


def test_what_is_vacuous_or_not_asked_stands_on_the_page() -> None:
    """With its reason, in a table of its own; the data keep to the schema."""
    both = [made("property", Vacuous("never <b>")), made("test", NotAsked("no <i>property"))]
    data = report_data(both, [target()])
    jsonschema.validate(data, schema())
    assert ["vacuous", "not asked"] == [row["verdict"] for row in data["results"]]
    page = to_html(data)
    assert "1 not asked, 1 vacuous, 0 undecided" in page
    shown = page[page.index("Vacuous or not asked</h2>") : page.index('<h2 id="lamp"')]
    assert "never &lt;b&gt;" in shown
    assert "no &lt;i&gt;property" in shown


def test_data_name_certificates_and_what_needs_none() -> None:
    """Files in order, what is true by construction; of the machine what was asked for and its digest."""
    data = report_data([made("obligation", PROOF)], [target()])
    jsonschema.validate(data, schema())
    (row,) = data["results"]
    assert (["a.smt2", "b.smt2"], "constant divisors") == (row["certificates"], row["by_construction"])
    (machine,) = data["machines"]
    assert "" == machine["spec"]
    assert 64 == len(machine["declaration"])
    exported = layout_of(without_ghosts(target().system)).digest
    assert exported == machine["exported"] != machine["declaration"]
    assert f"<td>exported code and snapshots of lamp</td><td>{exported}</td>" in to_html(data)


def test_junit_counts_what_says_nothing_as_errors() -> None:
    """A server must not show it in green."""
    both = [made("property", Vacuous("never")), made("test", NotAsked("no property")), *findings()[:1]]
    suite = ElementTree.fromstring(to_junit(both))[0]
    assert ("3", "0", "2") == (suite.get("tests"), suite.get("failures"), suite.get("errors"))
    assert ["vacuous: never", "not asked: no property"] == [one.get("message") for one in suite.iter("error")]
