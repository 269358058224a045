"""Proofs that are made once for all tests of the checker."""

from __future__ import annotations

import pytest

from tests.checker.evidence import NAMES, Evidence, made
from tests.cli.calling import Call, caller


@pytest.fixture(scope="session")
def proofs() -> dict[str, Evidence]:
    """Of each small declaration."""
    return {name: made(name) for name in NAMES}


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """Runs `safeloc ARGUMENTS` in this process."""
    return caller(monkeypatch, capsys)
