"""The command line on a terminal of 80 columns: every name can be typed as it stands there, a finding takes two lines at most."""

from __future__ import annotations

import os
import pty
import re
import subprocess
import sys

import pytest

from safeloc.cli.console import folded
from safeloc.cli.finding_lines import finding_lines
from safeloc.language.verdict import Held, Proved, Result
from safeloc.proof.results import Finding
from tests.cli.calling import DOOR, Call

COMMAND = [sys.executable, "-c", "from safeloc.cli import main; main()"]
SAID = "1-induction with the proved ranges and lemmas, re-checked by yices 2.6.5 or cvc5 1.4.2"
NAMES = (
    "door/property/short",
    "door/property/open while moving and this is a long name",
    "localizer_sections/property/section_1 is never clear with a vehicle that was not counted",
    "odometry/replay/odometry-service: front reader over its marker is inside the window of the reader",
)


def finding(name: str, method: str = SAID, result: Result | None = None) -> Finding:
    """A finding of this id."""
    return Finding(name, "door", "property", name, Held("Hypothesis", 1, 1) if result is None else result, method, 0.5)


def on_a_terminal(*arguments: str, columns: int = 80) -> list[str]:
    """The lines that a terminal shows, without its colours; the command sees a terminal at both of its outputs."""
    ours, its = pty.openpty()
    environment = {**os.environ, "COLUMNS": str(columns), "TERM": "xterm"}
    with subprocess.Popen([*COMMAND, *arguments], stdout=its, stderr=subprocess.DEVNULL, env=environment) as process:
        os.close(its)
        shown = b""
        while True:
            try:
                more = os.read(ours, 65536)
            except OSError:  # how Linux tells that the other end is closed
                break
            if not more:
                break
            shown += more
        os.close(ours)
    assert process.returncode == 0
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown.decode()).replace("\r", "").splitlines()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("method", [SAID, "bmc"])
def test_a_finding_takes_two_lines_and_keeps_its_name(name: str, method: str) -> None:
    """The id is there in full, in one piece where it fits; no line is wider than the terminal."""
    lines = finding_lines(finding(name, method), 80)
    assert len(lines) <= 2
    assert max(map(len, lines)) <= 80
    assert name in " ".join(line.strip() for line in lines)
    assert (name in lines[0]) == (len(name) <= 70)


def test_a_name_without_blanks_is_wider_than_the_terminal_rather_than_cut() -> None:
    """The terminal then breaks it where it likes, and copying it still gives the name."""
    name = "door/property/" + "n" * 90
    assert finding_lines(finding(name), 80)[1] == f"          {name}"


def test_what_is_cut_is_the_method() -> None:
    """It ends in dots where there is no room for it, and is left out where there is none at all."""
    assert finding_lines(finding(NAMES[1], SAID), 60)[-1].endswith(" ...]")
    assert finding_lines(finding("door/property/" + "long name " * 12 + "end", SAID), 80)[-1].endswith("end")


def test_folding_cuts_no_word() -> None:
    """Names with hyphens and blanks are broken at blanks only."""
    text = "odometry  odometry-wheel-slide-of-a-very-long-name  and more words"
    assert folded(text, 30) == ["odometry", "    odometry-wheel-slide-of-a-very-long-name", "    and more words"]
    assert folded("", 30) == [""]


def test_listing_on_a_terminal() -> None:
    """`safeloc list properties` of a machine: broken between words, each name there in full."""
    lines = on_a_terminal("list", "properties", "odometry")
    assert max(map(len, lines)) <= 80
    whole = " ".join(line.strip() for line in lines)
    assert "odometry no resurrection MRK-1 MRK-D1 a position is reported again only through a marker" in re.sub(
        " +", " ", whole
    )


@pytest.mark.thorough
def test_replay_on_a_terminal_shows_changes_of_mode() -> None:
    """A recording of 1050 steps: the first and last ones, every change of mode, and how many lie between; no name is cut."""
    lines = on_a_terminal("replay", "odometry", "odometry-service")
    steps = [int(line.split()[0]) for line in lines if re.match(r"\d+ ", line)]
    assert len(steps) < 150
    left_out = sum(int(line.split()[1]) for line in lines if line.startswith("... "))
    assert len(steps) + left_out == 1050
    assert (1, 1050) == (steps[0], steps[-1])
    assert any(line == "held      odometry/replay/odometry-service: no resurrection" for line in lines)
    findings = [line for line in lines if line.startswith("held  ")]
    assert len(findings) > 30
    assert not any("…" in line for line in findings)


def test_in_a_pipe_a_finding_is_a_line(call: Call) -> None:
    """For grep: verdict, id and method in one line, whatever its width."""
    printed = call("test", DOOR, "--examples", "1", "--steps", "2").out.splitlines()
    assert all(re.match(r"held +\S+/test/.* {2}\[Hypothesis.*\]$", line) for line in printed[:2])


def test_machines_may_follow_the_word(call: Call) -> None:
    """`list config odometry` is `list config --machine odometry`; what is of no machine refuses one."""
    assert call("list", "config", "odometry") == call("list", "config", "--machine", "odometry")
    assert call("list", "lines", "odometry").code == 2


def test_a_proof_says_no_more_than_before() -> None:
    """Colours stand in front of the id; the text is the same as in a pipe."""
    assert finding_lines(finding("a/property/b", "1-induction", Proved(None, "1-induction")), 80) == [
        "proved    a/property/b  [1-induction]"
    ]
