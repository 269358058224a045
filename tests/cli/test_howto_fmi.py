"""The how-to page on simulators: its master runs as it stands there, and prints what the page says."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.calling import Call
from tests.codegen.c_folder import needs_compiler

PAGES = Path(__file__).parents[2] / "docs" / "howto"
PAGE = (PAGES / "fmi.md").read_text(encoding="utf-8")


@pytest.mark.thorough
@needs_compiler
def test_the_master_prints_what_the_page_says(call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the page's own commands; a refused measurement alone is left out, and the step is taken again."""
    pytest.importorskip("fmpy", reason="needs fmpy (extra fmi)")
    monkeypatch.setattr("safeloc.proof.exported.lasting", lambda _system: None)
    monkeypatch.chdir(tmp_path)
    [export] = re.findall(r"^    safeloc (export .*)$", PAGE, re.MULTILINE)
    assert call(*export.split()).code == 0
    [program] = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "master.py").write_text(program, encoding="utf-8")
    ran = subprocess.run([sys.executable, "master.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    [expected] = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)
    assert (ran.returncode, ran.stdout) == (0, expected), ran.stderr


def test_simulator_and_controller_get_the_same_intervals() -> None:
    """The unit's run and the C task of the page on hosts are one scenario: what they report is equal."""
    [unit] = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)
    task = re.findall(r"```text\n(.*?)```", (PAGES / "host.md").read_text(encoding="utf-8"), re.DOTALL)
    reported = [line for line in unit.splitlines() if line.startswith("cycle")]
    assert reported in [[line for line in text.splitlines() if line.startswith("cycle")] for text in task]
