"""Hypothesis profiles: `ci` repeats the same examples in every run, `deep` looks for new ones and takes longer.

SAFELOC_HYPOTHESIS=deep pytest tests
"""

from __future__ import annotations

import os
from itertools import count
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

SLOW_BUT_FINE = (HealthCheck.too_slow, HealthCheck.data_too_large)

settings.register_profile(
    "ci", derandomize=True, deadline=None, max_examples=60, database=None, suppress_health_check=SLOW_BUT_FINE
)
settings.register_profile("deep", deadline=None, max_examples=1000, suppress_health_check=SLOW_BUT_FINE)
settings.load_profile(os.environ.get("SAFELOC_HYPOTHESIS", "ci"))

NUMBERS = count()


@pytest.fixture(scope="session")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the folders of all tests stand in which findings are kept."""
    return tmp_path_factory.mktemp("kept")


@pytest.fixture(autouse=True)
def nothing_kept(monkeypatch: pytest.MonkeyPatch, kept: Path) -> None:
    """No test finds what an earlier run of anybody found, and none leaves anything with the user."""
    monkeypatch.setenv("SAFELOC_CACHE", str(kept / str(next(NUMBERS))))
