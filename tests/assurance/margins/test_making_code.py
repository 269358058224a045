"""The code that makes a machine: every module of it, no words for readers, and nothing that makes no terms."""

from __future__ import annotations

import ast
import shutil
from pathlib import Path

import pytest

from safeloc.assurance.margins import making_code, read_modules
from safeloc.assurance.margins.making_code import making_code_digest, making_modules
from safeloc.assurance.margins.read_modules import ReadModule, read_module, readings_kept_in, without_words
from safeloc.catalogue import ENTRIES
from safeloc.proof.cache.engine import PACKAGE
from safeloc.proof.cache.store import Store

FOLDERS = sorted({entry.folder for entry in ENTRIES.values()})
NO_TERMS = {"simulate", "simulation", "picture", "pictures", "line_runs", "coupled_runs"}
READING = {"gzip", "importlib", "io", "json", "os", "pathlib", "tomllib"}


def test_it_follows_imports_into_declarations_alone() -> None:
    found = making_modules("transmission")
    assert {
        "safeloc.models.transmission.target",
        "safeloc.models.vocabulary.absent",
        "safeloc.properties.transmission",
    } <= set(found)
    assert not any(name.startswith(("safeloc.language", "safeloc.proof", "safeloc.models.odometry")) for name in found)
    assert "safeloc.models.odometry.world" in making_modules("supervised_odometry")


def test_words_for_readers_are_left_out() -> None:
    text = '"""Words."""\nA = 1  # why\n"""What A is."""\n\n\ndef f() -> str:\n    """Return it."""\n    return "#1"\n'
    assert without_words(text) == 'A = 1\ndef f() -> str:\n    return "#1"'


def test_what_was_read_of_a_module_is_kept_under_its_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another process parses no text again that is in the store, and what it does not need is forgotten."""
    one, other = "import os\nA = 1  # why\n", "from safeloc.models import odometry\n"

    def process(*texts: str) -> tuple[list[ReadModule], int]:
        parsed = list[str]()
        monkeypatch.setattr(read_modules, "_read", {})
        monkeypatch.setattr(read_modules, "_taken", {})
        monkeypatch.setattr(read_modules, "without_words", lambda text: parsed.append(text) or without_words(text))
        with readings_kept_in(Store(tmp_path)):
            return [read_module(text) for text in texts], len(parsed)

    expected = [ReadModule(read_module(text).code, read_module(text).imports) for text in (one, other)]
    assert expected[1].imports == ("safeloc", "safeloc.models", "safeloc.models.odometry")
    assert process(one, other) == (expected, 2)
    assert process(other, one, other) == ([expected[1], *expected], 0)
    assert process(one.replace("why", "that is why"))[1] == 1
    assert process(one)[1] == 1  # the process before had no need of it


@pytest.fixture(name="copied")
def _copied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the modules of a machine, in which the digest looks."""
    for path in making_modules("transmission").values():
        to = tmp_path / path.relative_to(PACKAGE)
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, to)
    monkeypatch.setattr(making_code, "PACKAGE", tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("module", "old", "new", "same"),
    [
        ("models/transmission/__init__.py", '"""', '"""More words.\n\n', True),
        ("models/vocabulary/absent.py", "\n\n\n", "\n# a comment\n\n\n\n", True),
        ("models/transmission/__init__.py", "age_limit_ms", "age_limit", False),
        ("models/vocabulary/absent.py", "NO_POSITION_MM: Final = NO_PLACE", "NO_POSITION_MM: Final = NO_BOUND", False),
        ("properties/transmission.py", "<=", "<", False),
    ],
)
def test_an_edit_of_code_gives_another_digest_and_one_of_words_does_not(
    copied: Path, module: str, old: str, new: str, same: bool
) -> None:
    def digest() -> str:
        making_code_digest.cache_clear()
        making_code._read.cache_clear()
        return making_code_digest("transmission")

    before, path = digest(), copied / module
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    assert (digest() == before) is same
    making_code_digest.cache_clear()


def test_nothing_that_is_left_out_and_no_file_makes_terms() -> None:
    """Only `target.py` leads to simulations and pictures, and no module can read a file that the digest would miss."""
    every = {name: path for folder in FOLDERS for name, path in making_modules(folder).items()}
    assert len(every) > 200
    for name, path in every.items():
        nodes = [
            one
            for one in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(one, ast.ImportFrom | ast.Import)
        ]
        imported = [node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)]
        imported += [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
        may = {"pathlib"} if name == "safeloc.models.sections.target" else set()  # it names its recordings
        assert not (READING - may) & {one.partition(".")[0] for one in imported}, name
        if not name.endswith(".target"):
            assert not [one for one in imported if NO_TERMS & set(one.split("."))], name
