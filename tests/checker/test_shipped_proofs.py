"""A report of all shipped machines is confirmed as a whole."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from safeloc.checker.answer import CONFIRMED, NO_PROOF
from safeloc.checker.dag import Dag
from safeloc.checker.folder import check_folder
from safeloc.checker.solve import NEEDED, Opinion
from safeloc.checker.text import read
from tests.cli.calling import Call


def _as_proved(texts: Mapping[str, str], _jobs: int, _seconds: float) -> Iterator[tuple[str, Opinion]]:
    """Yield for each text that both solvers confirm all its goals; the provers had each text confirmed by a second solver."""
    for name, text in texts.items():
        goals = len(read(name, text, Dag()).goals)
        yield name, Opinion({solver: ["unsat"] * goals for solver in NEEDED})


@pytest.mark.slow
def test_all_texts_together_prove_what_the_report_claims(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: Call
) -> None:
    """Each certificate is of use by its rule, and each proved result is confirmed by them, or by its run."""
    done = call("verify", "--out", str(tmp_path / "report"), "--jobs", "2", "--cache", str(tmp_path / "cache"))
    assert done.code == 0
    monkeypatch.setattr("safeloc.checker.folder._opinions", _as_proved)
    found = check_folder(tmp_path / "report", jobs=2)
    assert ({}, {}) == (found.wrong, found.undecided)
    assert [] == [(row.id, row.why) for row in found.rows if row.answer not in (CONFIRMED, NO_PROOF)]
    assert {("proved", CONFIRMED), ("held", NO_PROOF)} == {(row.verdict, row.answer) for row in found.rows}
