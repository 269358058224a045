"""Pieces of a report: made here or in processes, they are the same."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from safeloc.errors import EngineError
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.report import data
from safeloc.report.folder import write_folder
from safeloc.report.pieces import Piece, made_pieces
from tests.shipped import shipped


def square(number: int) -> Callable[[], int]:
    """Make the square of a number."""
    return lambda: number * number


@pytest.mark.parametrize("jobs", [1, 2])
def test_each_is_there_in_order(jobs: int) -> None:
    """By its key."""
    found = made_pieces({("square", number): Piece(square(number)) for number in range(5)}, jobs)
    assert [*found.items()] == [(("square", number), number * number) for number in range(5)]


def test_a_process_that_is_ended_is_no_loss() -> None:
    """The piece is made here then: as where the system is short of memory."""
    here = os.getpid()

    def mortal() -> str:
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return "made"

    assert made_pieces({"mortal": Piece(mortal), "other": Piece(lambda: "too")}, 2) == {
        "mortal": "made",
        "other": "too",
    }


def test_an_exception_is_told() -> None:
    """With the piece that it befell."""

    def wrong() -> None:
        raise ValueError("no such thing")

    with pytest.raises(EngineError, match=r"^report: \('script', 'door'\): ValueError: no such thing$"):
        made_pieces({("script", "door"): Piece(wrong)}, 2)


def test_a_report_made_by_several_processes_is_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """File by file."""
    monkeypatch.setattr(data.time, "strftime", lambda *_: "2026-01-01T00:00:00Z")
    target = shipped("delocalized")
    findings = prove(target.system, target.properties[:2], Limits())
    files = []
    for jobs in (1, 2):
        place = tmp_path / str(jobs)
        write_folder(place, findings, [target], jobs=jobs)
        files.append({path.relative_to(place): path.read_bytes() for path in place.rglob("*") if path.is_file()})
    assert files[0] == files[1]
    assert {"certificates", "machines"} <= {name.parts[0] for name in files[0]}
