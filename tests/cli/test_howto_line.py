"""The page on a line of one's own: the audit finds what it quotes, what it adds is enough, and its commands run."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.cli.calling import Call

PAGE = (Path(__file__).parents[2] / "docs" / "howto" / "line.md").read_text(encoding="utf-8")


@pytest.fixture
def parts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[str, str]:
    """The two parts of the file, in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    first, second = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    return first, second


def test_the_bare_line_is_refused_as_quoted(call: Call, parts: tuple[str, str]) -> None:
    """Each quoted finding is printed, and no rule is violated that the page does not speak of."""
    Path("station.toml").write_text(parts[0], encoding="utf-8")
    called = call("audit", "station.toml")
    assert called.code == 1
    quoted = re.findall(r"^    (violated .*)$", PAGE, re.MULTILINE)
    assert len(quoted) == 2
    for line in quoted:
        assert line in called.out
    rules = set(re.findall(r"^violated +(.*?) \[", called.out, re.MULTILINE))
    assert rules == {"odometry stretch", "routes told apart"}


@pytest.mark.thorough
def test_what_the_page_adds_is_enough(call: Call, parts: tuple[str, str]) -> None:
    """Only advice is left, about the group that the page names; the runs replay and hold."""
    Path("station.toml").write_text("\n".join(parts), encoding="utf-8")
    called = call("audit", "station.toml")
    assert called.code == 0
    assert "violated " not in called.out
    assert set(re.findall(r"^advice .*group (B\d+)", called.out, re.MULTILINE)) == {"B104"}
    (simulate,) = re.findall(r"^    safeloc (simulate .*)$", PAGE, re.MULTILINE)
    assert call(*simulate.split()).code == 0
    (replay,) = re.findall(r"^    safeloc (replay .*)$", PAGE, re.MULTILINE)
    assert call(*replay.split()).code == 0
