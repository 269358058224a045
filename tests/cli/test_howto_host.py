"""The page on hosts: both programs compile and run as they stand there, and print what the page says."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from tests.cli.calling import Call
from tests.codegen.c_folder import needs_compiler

PAGE = (Path(__file__).parents[2] / "docs" / "howto" / "host.md").read_text(encoding="utf-8")


def block(kind: str) -> list[str]:
    """The texts of one kind, in order."""
    return re.findall(rf"```{kind}\n(.*?)```", PAGE, re.DOTALL)


@needs_compiler
def test_the_task_in_c_prints_what_the_page_says(call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the page's own commands; the measurement that no train can have run is named on the error output."""
    monkeypatch.setattr("safeloc.proof.exported.lasting", lambda _system: None)
    monkeypatch.chdir(tmp_path)
    [export] = re.findall(r"^    safeloc (export .*)$", PAGE, re.MULTILINE)
    assert call(*export.split()).code == 0
    folder = tmp_path / "odometry_c"
    [task] = block("c")
    (folder / "task.c").write_text(task, encoding="utf-8")
    [build] = re.findall(r"^    (cc .*) && \./task$", PAGE, re.MULTILINE)
    built = subprocess.run(build.split(), cwd=folder, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stderr
    done = subprocess.run([str(folder / "task")], capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert done.stderr.startswith("input front_wheel_mm is not in -9918 .. 9918 mm")
    [printed] = block("text")
    assert printed == done.stdout


def test_the_node_in_python_prints_what_the_page_says(capsys: pytest.CaptureFixture[str]) -> None:
    """The class and the run past two markers, in one program."""
    names: dict[str, object] = {"__name__": "host"}
    for text in block("python"):
        exec(compile(text, "host.md", "exec"), names)
    said = re.search(r"((?:^    [0-9(].*\n)+)", PAGE, re.MULTILINE)
    assert said is not None
    assert "".join(line.removeprefix("    ") for line in said[0].splitlines(keepends=True)) == capsys.readouterr().out
