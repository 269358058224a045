"""docs/tutorial.md runs as it stands: its files, its edits, its commands with what they print, in order."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "tutorial.md"
BLOCK = re.compile(r"^```(python|diff|console)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
EXIT = re.compile(r"  # exit code (\d+)$")
STEP = re.compile(r"^ +\d+  .*$", re.MULTILINE)
"""A step of a counterexample, which begins with its indented number."""


def blocks() -> list[tuple[str, str]]:
    """Every block of the page with its kind."""
    return BLOCK.findall(PAGE.read_text(encoding="utf-8"))


def test_every_block_is_of_a_kind_that_is_run() -> None:
    """No block escapes: as many fences as blocks that are run, twice."""
    assert 2 * len(blocks()) == PAGE.read_text(encoding="utf-8").count("```")
    assert {"python", "diff", "console"} == {kind for kind, _ in blocks()}


@pytest.mark.thorough
def test_the_page_runs(tmp_path: Path) -> None:
    """From the first block to the last one, in an empty folder."""
    for kind, text in blocks():
        if kind == "python":
            name = text.splitlines()[0].removeprefix("# ")
            (tmp_path / name).write_text(text, encoding="utf-8")
        elif kind == "diff":
            edit(tmp_path / "train.py", text)
        else:
            for command, code, lines in commands(text):
                shown(command, code, lines, tmp_path)


def edit(path: Path, text: str) -> None:
    """Apply an edit: whole lines without `+` stand in the file, once; then those without `-` do. `@@` begins another place."""
    for hunk in text.split("@@\n"):
        old, new = ("".join(f"\n{line[1:]}" for line in hunk.splitlines() if line[0] in kept) for kept in (" -", " +"))
        before = f"\n{path.read_text(encoding='utf-8')}"
        assert 1 == before.count(f"{old}\n"), f"not once in {path.name}:\n{hunk}"
        path.write_text(before.replace(f"{old}\n", f"{new}\n").removeprefix("\n"), encoding="utf-8")


def commands(text: str) -> Iterator[tuple[str, int, list[str]]]:
    """Yield each command of a console with its exit code and the lines shown of what it prints."""
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        command, *lines = part.splitlines()
        code = EXIT.search(command)
        yield EXIT.sub("", command), int(code[1]) if code else 0, lines


def shown(command: str, code: int, lines: list[str], folder: Path) -> None:
    """Run a command; every line shown is the begin of a line that it prints, in order, apart from the numbers of a counterexample."""
    programs = folder / ".programs"
    programs.mkdir(exist_ok=True)
    for name, call in (("safeloc", "-m safeloc"), ("python", "")):
        (programs / name).write_text(f'#!/bin/sh\nexec {sys.executable} {call} "$@"\n')
        (programs / name).chmod(0o755)
    environment = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        ["sh", "-c", command], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    everything = done.stdout + done.stderr
    assert code == done.returncode, f"{command}\n{everything}"
    left = iter(same(everything.replace(f"{folder}/", "")).splitlines())
    for line in lines:
        assert any(found.startswith(same(line)) for found in left), f"{command}: not printed: {line}\n{everything}"


def same(text: str) -> str:
    """The text with one digit for each number of a run's steps: a solver may find another run. All else is compared as printed."""
    return STEP.sub(lambda step: re.sub(r"-?\d+", "0", step[0]), text)


def test_counts_are_compared_and_the_numbers_of_a_run_are_not() -> None:
    """A count that is off by one is another line; the same step of another run is not."""
    assert same("all holds: 9 proved, 9 shown by a run") != same("all holds: 10 proved, 9 shown by a run")
    assert same("   2  run on  [wheel_mm=211]  place_mm=212") == same("   2  run on  [wheel_mm=7]  place_mm=-8")
