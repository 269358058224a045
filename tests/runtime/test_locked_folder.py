"""A locked folder: the next one comes in when the one before is out, whatever ended it."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import pytest

from safeloc.runtime.locked_folder import locked


def test_one_at_a_time(tmp_path: Path) -> None:
    """Eight that begin together add one each to a number in a file, and none is lost."""
    file, together = tmp_path / "number", Barrier(8)
    file.write_text("0", encoding="utf-8")

    def add_one(_: int) -> None:
        together.wait(60)
        with locked(tmp_path):
            number = int(file.read_text(encoding="utf-8"))
            file.write_text(str(number + 1), encoding="utf-8")

    with ThreadPoolExecutor(8) as pool:
        assert [None] * 8 == [*pool.map(add_one, range(8))]
    assert file.read_text(encoding="utf-8") == "8"


def test_an_error_leaves_no_lock(tmp_path: Path) -> None:
    """The folder can be had again at once."""
    with pytest.raises(ZeroDivisionError), locked(tmp_path):
        raise ZeroDivisionError
    with locked(tmp_path):
        pass
