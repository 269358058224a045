"""The text of a user's file is what is proved, whatever byte code lies beside it."""

from __future__ import annotations

import os
import py_compile
import sys
from pathlib import Path

import pytest

from safeloc.own_module import load_module

_SECOND_NS = 1_700_000_000_000_000_000


def _written(path: Path, text: str) -> None:
    """Write the file, always in the same second."""
    path.write_text(text, encoding="utf-8")
    os.utime(path, ns=(_SECOND_NS, _SECOND_NS))


def test_an_edit_within_a_second_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Python itself takes byte code for fresh if second and size of the file are those that it was made from."""
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    path = tmp_path / "guard.py"
    _written(path, "LIMIT = 5\n")
    py_compile.compile(str(path))
    assert load_module(str(path)).LIMIT == 5
    _written(path, "LIMIT = 6\n")
    assert load_module(str(path)).LIMIT == 6


@pytest.mark.parametrize("address", ["file", "module"])
def test_no_byte_code_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, address: str) -> None:
    """Neither of the file nor of what it imports; the setting of the interpreter is as it was, after an error too."""
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.chdir(tmp_path)
    _written(tmp_path / f"figures_{address}.py", "LIMIT = 5\n")
    _written(tmp_path / f"door_{address}.py", f"from figures_{address} import LIMIT as LIMIT\n")
    where = f"door_{address}" + (".py" if address == "file" else "")
    assert load_module(where).LIMIT == 5
    assert sorted(path.name for path in tmp_path.rglob("*")) == [f"door_{address}.py", f"figures_{address}.py"]
    assert not sys.dont_write_bytecode
    for one in (f"figures_{address}", f"door_{address}"):
        sys.modules.pop(one, None)
