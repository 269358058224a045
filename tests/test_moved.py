"""A module that has moved is refused by its old name, and the message says the new one."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path

import pytest

import safeloc
from safeloc.moved import GONE, MOVED

ROOT = Path(safeloc.__file__).parent


@pytest.mark.parametrize("old", MOVED)
def test_an_old_name_tells_the_new_one(old: str) -> None:
    """The new one is there, and nothing stands under the old one."""
    with pytest.raises(
        ImportError, match=rf"^{re.escape(old)} is now {re.escape(MOVED[old])}; import it from there\.$"
    ):
        import_module(old)
    assert MOVED[old] == import_module(MOVED[old]).__name__
    here = ROOT.joinpath(*old.split(".")[1:])
    assert [] == [*here.rglob("*.py")]
    assert not here.with_suffix(".py").exists()


@pytest.mark.parametrize("old", GONE)
def test_a_module_that_is_gone_tells_what_to_do_instead(old: str) -> None:
    """Nothing stands under its name."""
    with pytest.raises(ImportError, match=rf"^{re.escape(old)}: {re.escape(GONE[old])}$"):
        import_module(old)
    assert not ROOT.joinpath(*old.split(".")[1:]).with_suffix(".py").exists()


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ("import safeloc.backends.smt", "safeloc.backends is now safeloc.codegen"),
        ("from safeloc.expr import number", "safeloc.expr is now safeloc.language.expr"),
        ("from safeloc.backends import c_loader", "safeloc.backends is now safeloc.codegen"),
        ("from safeloc import embedding", "safeloc.embedding is now safeloc.runtime.embedding"),
        ("from safeloc.line.toml_files import find_line", "safeloc.line is now safeloc.railway.map"),
        (
            "from safeloc.models.odometry_parts.variables import parts",
            "safeloc.models.odometry_parts is now safeloc.models.odometry",
        ),
        (
            "from safeloc.models import balise_streams",
            "safeloc.models.balise_streams is now safeloc.models.balise.simulate",
        ),
        (
            "from safeloc.models.odometry.error_law import WHEEL",
            "safeloc.models.odometry.error_law is now safeloc.models.vocabulary.error_law",
        ),
        (
            "import safeloc.properties.balise_step",
            "safeloc.properties.balise_step is now safeloc.properties.balise.step",
        ),
    ],
)
def test_however_it_is_imported(written: str, told: str) -> None:
    """A package, a module below it, what is taken from it, and a module taken from safeloc."""
    with pytest.raises(ImportError, match=rf"^{re.escape(told)}; import it from there\.$"):
        exec(written)


def test_what_an_update_left_behind_does_not_hide_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder without Python files would pass for an empty package."""
    (tmp_path / "backends" / "__pycache__").mkdir(parents=True)
    monkeypatch.setattr(safeloc, "__path__", [*safeloc.__path__, str(tmp_path)])
    with pytest.raises(ImportError, match=r"^safeloc\.backends is now safeloc\.codegen; import it from there\.$"):
        import_module("safeloc.backends")


def test_a_name_that_never_was_is_not_found() -> None:
    """Python's own message, which says no more than there is to say."""
    with pytest.raises(ModuleNotFoundError, match=r"^No module named 'safeloc\.line_'$"):
        import_module("safeloc.line_")
