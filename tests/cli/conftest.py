"""Fixtures of the command line tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.catalogue import ENTRIES, load_target
from safeloc.cli import listing
from safeloc.target import Target
from tests.cli.calling import Call, caller
from tests.shipped import shipped


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """Runs `safeloc ARGUMENTS` in this process; `list` reads shipped machines that are made once."""
    monkeypatch.setattr(listing, "load_target", _made_once)
    return caller(monkeypatch, capsys)


def _made_once(spec: str, config: Path | None = None) -> Target:
    return shipped(spec) if spec in ENTRIES and config is None else load_target(spec, config)
