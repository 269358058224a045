"""A long run goes on from its file."""

from __future__ import annotations

from pathlib import Path

from tests.kept_lines import keep, kept_lines


def test_what_is_kept_is_read_again(tmp_path: Path) -> None:
    """Line by line; without a file there is nothing."""
    file = tmp_path / "run.jsonl"
    assert kept_lines(file) == []
    for number in range(3):
        keep(file, {"case": number})
    assert [{"case": 0}, {"case": 1}, {"case": 2}] == kept_lines(file)


def test_half_a_line_is_done_again(tmp_path: Path) -> None:
    """A kill cuts the last line off: it does not count, and the next one does not stick to it."""
    file = tmp_path / "run.jsonl"
    file.write_text('{"case": 0}\n{"ca', encoding="utf-8")
    assert [{"case": 0}] == kept_lines(file)
    keep(file, {"case": 1})
    assert [{"case": 0}, {"case": 1}] == kept_lines(file)
