"""Fixtures of the command line tests."""

from __future__ import annotations

import pytest

from tests.cli.calling import Call, caller


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """Runs `safeloc ARGUMENTS` in this process."""
    return caller(monkeypatch, capsys)
