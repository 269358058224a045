"""Fixtures of the import tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.railway.map.imports.notes import Imported
from safeloc.railway.map.imports.railml import read_railml
from tests.railway.map.imports.documents import Read


@pytest.fixture
def railml(tmp_path: Path) -> Read:
    """Writes a railML document and imports it."""

    def read(document: str) -> Imported:
        path = tmp_path / "station.railml"
        path.write_text(document, encoding="utf-8")
        return read_railml(path)

    return read
