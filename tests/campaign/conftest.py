"""The command line for these tests."""

from __future__ import annotations

import pytest

from tests.cli.calling import Call, caller


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """A function that runs `safeloc ARGUMENTS`."""
    return caller(monkeypatch, capsys)
