"""Every command that README and docs show is one that the command line takes: its name, its options, the machines it names."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest

from safeloc.cli.commands import COMMANDS, loaded
from safeloc.railway.map.toml_files import shipped_lines
from safeloc.shipped_machines import ENTRIES

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
TAKE_A_MACHINE = ("prove", "explain", "replay", "simulate", "export", "run", "cores", "margins", "faults", "mutate")
"""Commands whose first argument is a machine, in the pages a name or a file of one's own."""


def shown(page: Path) -> Iterator[list[str]]:
    """The words behind `safeloc` of each command: in blocks, indented, or between backticks."""
    text = re.sub(r"\\\n\s*", " ", page.read_text(encoding="utf-8"))
    in_words = re.findall(r"`safeloc ([a-z][^`]*)`", text)
    in_lines = re.findall(r"^(?:    |\$ )?(?:python -m )?safeloc ([a-z].*)$", text, re.MULTILINE)
    for command in [*in_words, *in_lines]:
        line = re.split(r"\s(?:#|&&|\||>|<)\s?|\s#|\s\.\.\.$", command)[0]
        if words := _split(line):
            yield words


def _split(line: str) -> list[str]:
    try:
        return shlex.split(line, comments=True)
    except ValueError:  # a command that is cut off in a sentence
        return line.split()


EVERY = [(page, words) for page in PAGES for words in shown(page)]


def test_the_pages_show_commands() -> None:
    """Of nearly every kind, so that this looks at something."""
    assert set(COMMANDS) - {words[0] for _, words in EVERY} == set()
    assert len(EVERY) > 200


@pytest.mark.parametrize("name", COMMANDS)
def test_every_option_that_is_shown_is_there(name: str) -> None:
    """Under the command with which it is shown."""
    known = {option for parameter in loaded(name).params for option in (*parameter.opts, *parameter.secondary_opts)}
    used = {
        (page.relative_to(ROOT).as_posix(), word.partition("=")[0])
        for page, words in EVERY
        if words[0] == name
        for word in words[1:]
        if re.fullmatch(r"--[a-z][a-z-]*(=.*)?", word)
    }
    assert {(page, option) for page, option in used if option not in known} == set()


def test_every_command_that_is_shown_is_there() -> None:
    """Whatever its options."""
    unknown = {(page.relative_to(ROOT).as_posix(), words[0]) for page, words in EVERY if words[0] not in COMMANDS}
    assert unknown == set()


def test_every_machine_that_is_shown_ships() -> None:
    """Or it is a line that ships, a file or module of one's own, or a word in capitals that stands for any machine."""
    named = {
        (page.relative_to(ROOT).as_posix(), words[0], words[1])
        for page, words in EVERY
        if words[0] in TAKE_A_MACHINE and len(words) > 1 and re.fullmatch(r"[a-z_]+", words[1])
    }
    assert named
    assert {one for one in named if one[2] not in _known(one[1])} == set()


def _known(command: str) -> set[str]:
    """What a command takes by name: machines, and `margins` also lines."""
    return {*ENTRIES, *(shipped_lines() if command == "margins" else ())}
