"""An exported folder of C, written, compiled and checked as its user does it."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

from safeloc.codegen.c99 import Run, to_c
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.proof.drawn_runs.sampled import drawn_run

needs_compiler = pytest.mark.skipif(
    not (shutil.which("cc") and shutil.which("make")), reason="needs a C compiler called cc, and make"
)


def runs_of(system: TransitionSystem, steps: int = 60) -> list[Run]:
    """Drawn runs, lawful and not."""
    return [drawn_run(system, seed, steps, lawful=seed == 0) for seed in range(3)]


def written(folder: Path, files: Mapping[str, str]) -> Path:
    """The files in the folder."""
    folder.mkdir(exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def exported(folder: Path, system: TransitionSystem, runs: Sequence[Run] | None = None) -> Path:
    """The folder of a system, with drawn runs to check by unless others are given."""
    return written(folder, to_c(without_ghosts(system), runs or runs_of(system)))


def make(folder: Path, *targets: str) -> tuple[int, str]:
    """Exit code and everything printed."""
    done = subprocess.run(["make", *targets], cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def replaced(folder: Path, file: str, old: str, new: str) -> None:
    """Changes a generated text, which must hold `old`."""
    path = folder / file
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
