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


def compiled(command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """What the compiler says."""
    return subprocess.run(command.split(), cwd=folder, capture_output=True, text=True, check=False)


@needs_compiler
def test_the_task_in_c_prints_what_the_page_says(call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the page's own commands; the measurement that no train can have run is named on the error output, and alone
    left out. The interface that the page pins is the exported one, and another one does not compile."""
    monkeypatch.setattr("safeloc.proof.exported.lasting", lambda _system: None)
    monkeypatch.chdir(tmp_path)
    [export] = re.findall(r"^    safeloc (export .*)$", PAGE, re.MULTILINE)
    assert call(*export.split()).code == 0
    folder = tmp_path / "odometry_c"
    task, _, pinned = block("c")
    (folder / "task.c").write_text(task, encoding="utf-8")
    [build] = re.findall(r"^    (cc .*) && \./task$", PAGE, re.MULTILINE)
    built = compiled(build, folder)
    assert built.returncode == 0, built.stderr
    done = subprocess.run([str(folder / "task")], capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert done.stderr == "input front_wheel_mm is not in -9918 .. 9918 mm; left out\n"
    assert block("text")[0] == done.stdout
    (folder / "pinned.c").write_text(pinned, encoding="utf-8")
    assert compiled("cc -std=c99 -c pinned.c", folder).returncode == 0
    (folder / "pinned.c").write_text(re.sub(r"0x[0-9a-f]+", "0x1", pinned), encoding="utf-8")
    assert "odometry has another interface" in compiled("cc -std=c99 -c pinned.c", folder).stderr


@needs_compiler
def test_what_the_host_checks_itself_prints_what_the_page_says(tmp_path: Path) -> None:
    """NaN, a fraction, a record twice and a late one make the distance of their cycle absent, under the sanitizers too."""
    (tmp_path / "records.c").write_text(block("c")[1], encoding="utf-8")
    flags = "-std=c99 -Wall -Wextra -Werror -pedantic -fsanitize=undefined -fno-sanitize-recover=all"
    built = compiled(f"cc {flags} -o records records.c", tmp_path)
    assert built.returncode == 0, built.stderr
    done = subprocess.run([str(tmp_path / "records")], capture_output=True, text=True, check=False)
    assert (done.stderr, done.stdout) == ("", block("text")[1])


def test_the_node_in_python_prints_what_the_page_says(capsys: pytest.CaptureFixture[str]) -> None:
    """The class and the run past two markers, in one program."""
    names: dict[str, object] = {"__name__": "host"}
    for text in block("python"):
        exec(compile(text, "host.md", "exec"), names)
    said = re.search(r"((?:^    [0-9(].*\n)+)", PAGE, re.MULTILINE)
    assert said is not None
    assert "".join(line.removeprefix("    ") for line in said[0].splitlines(keepends=True)) == capsys.readouterr().out
