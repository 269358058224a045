"""`safeloc recheck` of a proof around a stream: confirmed from the hand-over sets, and refused once anything is not what it was."""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from safeloc.checker.answer import CONFIRMED, WRONG
from safeloc.checker.around.checking import check_around, is_around
from safeloc.checker.folder import Checking
from safeloc.cli.around import AroundOptions, Proving, prove_around
from safeloc.cli.recheck import _lines
from safeloc.errors import InputError
from safeloc.proof.cache.store import Store
from safeloc.proof.provers.limits import Limits
from tests.cli.calling import Call, caller

NEAR = Path(__file__).parents[3] / "docs" / "examples" / "near.py"
SUM, APART, OLD = "place_mm <= 600", "truth_mm - place_mm <= 250", "age_cycles <= 4"


def proved(folder: Path, options: AroundOptions, code: int = 0) -> Path:
    """The folder of a proof around the simulated stream of the example."""
    store = Store(folder.parent / "cache")
    proving = Proving(None, None, Limits(), store, quiet=True)
    assert code == prove_around(f"{NEAR}:machine", replace(options, simulate="seed=0", out=folder), proving)
    return folder


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A claim for all inputs of the tube, one for those that obey the laws, and one from the tenth cycle on."""
    options = AroundOptions(within=["distance_mm=2"], claims=[SUM, APART, OLD])
    return proved(tmp_path_factory.mktemp("around") / "out", options)


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """A function that runs `safeloc ARGUMENTS`."""
    return caller(monkeypatch, capsys)


@pytest.fixture
def copy(written: Path, tmp_path: Path) -> Path:
    """A folder that may be spoilt."""
    return Path(shutil.copytree(written, tmp_path / "copy"))


def answers(folder: Path) -> list[str]:
    """The answers about the claims, in order."""
    return [row.answer for row in check_around(folder, jobs=1, seconds=10).rows]


def edited(folder: Path, change: Callable[[dict[str, Any]], None], *, asked: str | None = None) -> Checking:
    """What is found after an edit of the certificate, of the claim that is asked for or of all."""
    data = json.loads((folder / "around.json").read_text())
    change(data)
    if asked is not None:
        data["claims"] = [row for row in data["claims"] if row["claim"] == asked]
    (folder / "around.json").write_text(json.dumps(data))
    return check_around(folder, jobs=1, seconds=10)


def of_claim(found: Checking, claim: str) -> tuple[str, str]:
    """The answer about a claim, with the reason."""
    [row] = [row for row in found.rows if row.id.endswith(f"/{claim}")]
    return row.answer, row.why


def set_of(data: dict[str, Any], claim: str, number: int) -> dict[str, Any]:
    """The first piece of a hand-over of the passage of a claim."""
    [row] = [one for one in data["claims"] if one["claim"] == claim]
    piece: dict[str, Any] = data["passages"][row["passage"]]["handed"][number]["pieces"][0]
    return piece


def test_every_claim_is_confirmed(written: Path) -> None:
    """Every window of every passage, by both solvers."""
    assert is_around(written)
    assert [CONFIRMED] * 3 == answers(written)


def test_the_command(written: Path, call: Call) -> None:
    """It tells what is confirmed, and by how many goals."""
    assert call("recheck", str(written)).out.startswith("3 confirmed\nz3: ")
    assert "is about the certificates of a report" in call("recheck", str(written), "--proofs").err


def test_where_no_solver_was_asked() -> None:
    """All questions were decided by their terms: no solver is told as one that is not installed."""
    assert ["no results", "no solver was asked: there are no questions"] == _lines(Checking(), "questions")


def test_a_certificate_that_is_damaged(copy: Path) -> None:
    """A text that is no certificate is refused."""
    text = (copy / "around.json").read_text()
    (copy / "around.json").write_text(text[: len(text) // 2])
    with pytest.raises(InputError, match="not the certificate of a proof around a stream"):
        check_around(copy)
    (copy / "around.json").write_text(text.replace('"declaration": "', '"declaration": "0'))
    with pytest.raises(InputError, match="another digest"):
        check_around(copy)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("which", [0, 1])
def test_a_hand_over_that_is_widened(copy: Path, which: int) -> None:
    """From wider states the claim, or the next hand-over, does not follow."""

    def widen(data: dict[str, Any]) -> None:
        ranges = set_of(data, SUM, which)["ranges"]
        ranges["place_mm"] = [ranges["place_mm"][0], ranges["place_mm"][1] + 1]

    answer, why = of_claim(edited(copy, widen, asked=SUM), SUM)
    assert answer == WRONG
    assert "it does not follow" in why


def test_a_hand_over_that_is_narrowed(copy: Path) -> None:
    """Some stream leaves narrower states."""

    def narrow(data: dict[str, Any]) -> None:
        ranges = set_of(data, SUM, 0)["ranges"]
        ranges["place_mm"] = [ranges["place_mm"][0], ranges["place_mm"][1] - 1]

    answer, why = of_claim(edited(copy, narrow, asked=SUM), SUM)
    assert answer == WRONG
    assert "the states after cycle 20" in why


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("claim", [SUM, APART, OLD])
def test_a_hand_over_of_no_states(copy: Path, claim: str) -> None:
    """Without a piece nothing is left to be shown, and that no stream comes so far does not follow."""

    def none(data: dict[str, Any]) -> None:
        for passage in data["passages"]:
            passage["handed"][0]["pieces"] = []

    assert WRONG == of_claim(edited(copy, none, asked=claim), claim)[0]


def test_windows_that_are_left_out(copy: Path) -> None:
    """The cycles are shown together with those of the window before: a claim that fails in the last one is not confirmed."""

    def leave_out(data: dict[str, Any]) -> None:
        for passage in data["passages"]:
            passage["handed"] = []
            for row in (*passage["together"], *data["claims"]):
                if row["claim"] == SUM:
                    row["claim"] = "place_mm <= 599"
        [row] = [one for one in data["claims"] if one["claim"] == "place_mm <= 599"]
        row["id"] = row["id"].replace("600", "599")

    found = edited(copy, leave_out)
    assert (WRONG, CONFIRMED) == (of_claim(found, "place_mm <= 599")[0], of_claim(found, APART)[0])


@pytest.mark.thorough
def test_windows_in_another_order(copy: Path) -> None:
    """A hand-over before the one before it is refused."""

    def turn(data: dict[str, Any]) -> None:
        for passage in data["passages"]:
            passage["handed"].reverse()

    assert all("not in order" in row.why for row in edited(copy, turn).rows)


def test_another_stream(copy: Path) -> None:
    """A stream of another digest is refused, and with its digest the claims do not follow."""
    text = (copy / "given.jsonl").read_text()
    (copy / "given.jsonl").write_text(text.replace('"distance_mm": 10', '"distance_mm": 11', 1))
    with pytest.raises(InputError, match="another stream than the one of the certificate"):
        check_around(copy)

    def sign(data: dict[str, Any]) -> None:
        data["stream"]["digest"] = hashlib.sha256((copy / "given.jsonl").read_bytes()).hexdigest()

    assert of_claim(edited(copy, sign, asked=SUM), SUM)[0] == WRONG


def test_another_question(copy: Path) -> None:
    """Wider deviations, other cycles and another claim are not what was shown."""

    whole = (copy / "around.json").read_text()

    def exchanged(data: dict[str, Any]) -> None:
        data["claims"][2] |= {"claim": "age_cycles <= 3"}

    assert "it is the claim" in edited(copy, exchanged, asked="age_cycles <= 3").rows[0].why
    (copy / "around.json").write_text(whole)

    def wider(data: dict[str, Any]) -> None:
        data["within"]["distance_mm"] = 3

    assert of_claim(edited(copy, wider, asked=SUM), SUM)[0] == WRONG


def test_a_tube_without_a_lawful_stream(copy: Path) -> None:
    """Without a stream that obeys the laws, with one that breaks them, or with one of another tube nothing is proved."""
    text = (copy / "lawful.jsonl").read_text()
    (copy / "lawful.jsonl").write_text(text.replace('"true_cycle_distance_mm": 10', '"true_cycle_distance_mm": 51', 1))
    assert ["the stream that is to obey the laws: the stream breaks a law in cycle 1"] * 3 == [
        row.why for row in check_around(copy, jobs=1).rows
    ]
    (copy / "lawful.jsonl").write_text(text.replace('"distance_mm": 10', '"distance_mm": 13', 1))
    assert "leaves the tube in cycle 1" in of_claim(edited(copy, lambda _: None, asked=SUM), SUM)[1]

    def none(data: dict[str, Any]) -> None:
        data["witness"] = None

    assert "it is not shown that a stream of the tube obeys the laws" == of_claim(edited(copy, none, asked=SUM), SUM)[1]


def test_a_claim_that_is_broken(tmp_path: Path) -> None:
    """Its run is run again, and has to lie in the tube and to break the claim in its last cycle."""
    folder, claim = tmp_path / "out", "age_cycles <= 8"
    proved(folder, AroundOptions(drop=["fix_mm=1"], claims=[claim, "age_cycles <= 9"]), code=1)
    assert [CONFIRMED] * 2 == answers(folder)
    [run] = folder.glob("age-cycles*8.jsonl")
    lines = run.read_text().splitlines(keepends=True)
    run.write_text("".join(lines[:-1]))
    assert "does not break the claim in its last cycle" in of_claim(check_around(folder, jobs=1), claim)[1]
    run.write_text("".join([lines[0], lines[1].replace('"distance_mm": 10', '"distance_mm": 9'), *lines[2:]]))
    assert "leaves the tube in cycle 1" in of_claim(check_around(folder, jobs=1), claim)[1]


@pytest.mark.thorough
def test_late_and_missing_values(tmp_path: Path) -> None:
    """The checker has its own form of losses and delays."""
    ways = AroundOptions(delay=["distance_mm=2", "fix_mm=1"], within=["distance_mm=1"])
    folder = proved(tmp_path / "out", replace(ways, claims=["place_mm <= 550", "age_cycles <= 6"]))
    assert [CONFIRMED] * 2 == answers(folder)


@pytest.mark.thorough
def test_a_law_that_is_left_out(tmp_path: Path) -> None:
    """The certificate names it; with all laws it is about another question, for which the run is not lawful or is."""
    options = AroundOptions(within=["distance_mm=2"], without=["the vehicle is slow"], claims=[APART])
    folder = proved(tmp_path / "out", options)
    assert [CONFIRMED] == answers(folder)

    def other(data: dict[str, Any]) -> None:
        data["without"] = ["the step is measured"]

    assert of_claim(edited(folder, other), APART)[0] == WRONG


def test_a_claim_that_holds_of_all_lawful_streams(tmp_path: Path) -> None:
    """Its certificates are those of the general proof, and are checked as those of a report; one that is damaged is refused."""
    text = NEAR.read_text(encoding="utf-8") + (
        "\n\nfrom safeloc.language.spec import always\n\n"
        'properties = [always("the truth stays on the line", truth <= LINE_MM, statement="It does.")]\n'
    )
    (tmp_path / "near.py").write_text(text, encoding="utf-8")
    folder, store = tmp_path / "out", Store(tmp_path / "cache")
    proving = Proving(None, None, Limits(), store, quiet=True)
    options = AroundOptions(simulate="seed=0", within=["distance_mm=1"], out=folder)
    assert prove_around(f"{tmp_path / 'near.py'}:machine", options, proving) == 0
    data = json.loads((folder / "around.json").read_text())
    assert data["claims"][0]["passage"] is None
    assert [CONFIRMED] == answers(folder)
    for path in (folder / "certificates").iterdir():
        path.write_text(path.read_text().replace("(assert", "; (assert", 1))
    assert [WRONG] == answers(folder)
