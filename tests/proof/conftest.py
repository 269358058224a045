"""The second solver of a test: with or without yices."""

from __future__ import annotations

import pytest

from safeloc import yices


@pytest.fixture
def without_yices(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave every proof to cvc5, as if yices were not installed."""
    monkeypatch.setattr(yices, "program", lambda: None)
