"""Configurations: cycles become times, comments and all else stay, doubt is refused."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from safeloc.catalogue import ENTRIES, read_config
from safeloc.errors import InputError
from tests.runtime.migration.migrating import changed, migrated

TOML = "# ours\nmute_limit_cycles = 7  # seven\nintegrity_limit_cycles = 1_0\n\n[area]\nperiod_ms = 500\n"


def test_toml(tmp_path: Path) -> None:
    """Times are cycles of the period that the file says, and the file is one of today."""
    made = migrated(tmp_path / "sections.toml", TOML)
    assert "# ours\nmute_ms = 3500  # seven\nintegrity_wait_ms = 5000\n\n[area]\nperiod_ms = 500\n" == made.text
    assert [
        "mute_limit_cycles = 7 -> mute_ms = 3500 (line 2)",
        "integrity_limit_cycles = 10 -> integrity_wait_ms = 5000 (line 3)",
    ] == changed(made)
    config = read_config(ENTRIES["sections"].config, made.write(in_place=False))
    assert (3_500, 7) == (config.mute_ms, config.mute_limit_cycles)  # type: ignore[attr-defined]


def test_json(tmp_path: Path) -> None:
    """Without a period it is that of the default, 1 s; in whatever table the field stands."""
    made = migrated(tmp_path / "whole.json", '{"sections": {"mute_limit_cycles" : 3, "area": {}}, "more": [1]}')
    assert '{"sections": {"mute_ms" : 3000, "area": {}}, "more": [1]}' == made.text


@pytest.mark.parametrize(("name", "text"), [("a.toml", "mute_ms = 5\n"), ("a.json", "{}"), ("b.toml", "")])
def test_a_configuration_of_today_is_left_alone(tmp_path: Path, name: str, text: str) -> None:
    """Nothing is changed."""
    assert () == migrated(tmp_path / name, text).changes


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.toml", "mute_limit_cycles = ", ": no TOML ("),
        ("a.json", "{", ": no JSON ("),
        ("a.json", "[3]", ": expected a configuration, an object of fields; got list."),
        ("a.toml", "mute_limit_cycles = 1.5\n", ": mute_limit_cycles is 1.5 cycles of 1000 ms; give whole numbers."),
        ("a.toml", "mute_limit_cycles = 1\nmute_ms = 3\n", ": has both 'mute_limit_cycles' and 'mute_ms', an old field"),
        ("a.toml", "sections = {mute_limit_cycles = 1}\n", ": mute_limit_cycles cannot be found in the text"),
        (
            "a.toml", 'doc = """\nmute_limit_cycles = 1\n"""\nmute_limit_cycles = 1\n',
            ": the fields mute_limit_cycles = 1 are ambiguous in the text; change them by hand.",
        ),
    ],
)  # fmt: skip
def test_what_is_not_understood_is_refused(tmp_path: Path, name: str, text: str, message: str) -> None:
    """With the reason; nothing is guessed."""
    path = tmp_path / name
    with pytest.raises(InputError, match=rf"^{re.escape(str(path) + message)}"):
        migrated(path, text)


def test_an_old_field_is_refused_with_the_new_one(tmp_path: Path) -> None:
    """Where a configuration is read."""
    path = tmp_path / "sections.toml"
    path.write_text("mute_limit_cycles = 7\n", encoding="utf-8")
    message = r"mute_limit_cycles: .*; it is mute_ms now, a time instead of cycles \(safeloc migrate\) \(line 1\)$"
    with pytest.raises(InputError, match=message):
        read_config(ENTRIES["sections"].config, path)
