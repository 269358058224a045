"""The command line called as a shell would, in this process."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

from safeloc.cli import main

DOOR_FILE = Path(__file__).parents[1] / "data" / "door_controller.py"
DOOR = f"{DOOR_FILE}:machine"
QUICK = ("--seconds", "10", "--jobs", "1")
QUICK_VERIFY = (*QUICK, "--examples", "5", "--steps", "15")


@dataclass(frozen=True)
class Called:
    """What a shell would have seen."""

    code: int
    out: str
    err: str


Call = Callable[..., Called]


def caller(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """A function that runs `safeloc ARGUMENTS`."""

    def call(*arguments: str) -> Called:
        monkeypatch.setattr(sys, "argv", ["safeloc", *arguments])
        with pytest.raises(SystemExit) as end:
            main()
        printed = capsys.readouterr()
        return Called(0 if end.value.code is None else int(end.value.code), printed.out, printed.err)

    return call


def wrong_door(folder: Path) -> str:
    """The door with a wrong guard: it opens on release at any speed."""
    text = DOOR_FILE.read_text(encoding="utf-8")
    wrong = text.replace("released & (speed <= STANDSTILL_MM_S)", "released")
    assert wrong != text
    path = folder / "wrong_door.py"
    path.write_text(wrong, encoding="utf-8")
    return f"{path}:machine"


def started(command: Sequence[str], **pipes: int) -> subprocess.Popen[str]:
    """A command in a process group of its own that Ctrl-C ends, as in a terminal, whoever started the tests in what way."""

    def listen() -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)

    return subprocess.Popen(command, text=True, start_new_session=True, preexec_fn=listen, **pipes)  # type: ignore[call-overload, no-any-return]
