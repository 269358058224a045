"""An undecided property in a report: its counterexample to induction is a run that can be stepped through, and no violation."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safeloc.proof.provers import portfolio
from safeloc.proof.provers.limits import Limits
from safeloc.proof.verification.calls import prove_target
from safeloc.report.folder import render_folder, write_folder
from safeloc.runtime.streams.columns import read_runs
from tests.explain.pump import OPEN, target

RESULT = f"pump/property/{OPEN.name}"


def test_the_run_is_stored_and_its_last_step_is_marked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The verdict stays undecided, also when the page is rendered again."""
    monkeypatch.setattr(portfolio, "_ENGINES", portfolio._QUICK)  # Spacer would prove it
    here = target(OPEN)
    write_folder(tmp_path, prove_target(here, only=[OPEN.name], limits=Limits(depth=3), jobs=1), [here])
    render_folder(tmp_path)
    data = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    [row] = [one for one in data["results"] if one["id"] == RESULT]
    assert (row["verdict"], row["trace"]) == ("unknown", {"steps": Limits().induction})
    run = read_runs(tmp_path / "traces" / "pump.js").plain(RESULT)
    counts = [run["first"]["counted"], *(step["state"]["counted"] for step in run["steps"])]
    assert [count > 20 for count in counts] == [False, False, False, True]
    page = (tmp_path / "page" / "pump.view.js").read_text(encoding="utf-8")
    assert page and "violated" not in (tmp_path / "junit.xml").read_text(encoding="utf-8")
