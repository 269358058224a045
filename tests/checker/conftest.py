"""Proofs that are made once for all tests of the checker."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import pytest

from safeloc.proof.provers import proved_base, recheck
from tests.checker.small_proofs import NAMES, Evidence, made
from tests.cli.calling import Call, caller


@pytest.fixture(scope="session")
def proofs() -> dict[str, Evidence]:
    """Of each small declaration."""
    return {name: made(name) for name in NAMES}


@pytest.fixture(scope="session")
def whole_proofs() -> dict[str, Evidence]:
    """The same, with every hypothesis that a prover had, needed or not."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(recheck, "only_needed", lambda query: query)
        patched.setattr(proved_base, "_KNOWN", WeakKeyDictionary())  # else what `proofs` has proved is used again
        return {name: made(name) for name in NAMES}


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """Runs `safeloc ARGUMENTS` in this process."""
    return caller(monkeypatch, capsys)
