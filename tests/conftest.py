"""Hypothesis profiles: `ci` repeats the same examples in every run, `deep` looks for new ones and takes longer.

SAFELOC_HYPOTHESIS=deep pytest tests
"""

from __future__ import annotations

import gc
import os
import signal
from collections.abc import Generator
from itertools import count
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from safeloc.codegen import compiled
from tests.generated_once import GeneratedOnce, compiled_once
from tests.ordinary import by_test, ordinary

SLOW_BUT_FINE = (HealthCheck.too_slow, HealthCheck.data_too_large)

settings.register_profile(
    "ci", derandomize=True, deadline=None, max_examples=60, database=None, suppress_health_check=SLOW_BUT_FINE
)
settings.register_profile("deep", deadline=None, max_examples=1000, suppress_health_check=SLOW_BUT_FINE)
settings.load_profile(os.environ.get("SAFELOC_HYPOTHESIS", "ci"))

# A shell that runs the tests in the background lets them ignore what Ctrl-C sends, and so would every process that a test starts.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

NUMBERS = count()
GENERATING = ("codegen", "fuzz", "language")
"""Folders with tests of generated code itself."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the cases that `make test` runs, before `-m` chooses."""
    for case in (case for cases in by_test(items) for case in ordinary(cases)):
        case.add_marker("ordinary")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Let the garbage collector rest while modules are imported: all of them stay, and it took a seventh of the time."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


def pytest_collection_finish() -> None:
    """Spare the garbage collector what stays: items and modules, and terms of machines; it took a tenth of all time.

    What is garbage by now stays too: to find it takes most of a second in each process, and it is a sixth of the objects.
    """
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)
    _first_example()


@settings(max_examples=1)
@given(st.none())
def _first_example(_: None) -> None:
    """Let Hypothesis begin here: with its first example it looks through all objects, of which there are few beside those that stay."""


def pytest_sessionfinish() -> None:
    """Let nothing be collected at the end: pytest looks five times through all that the tests have left, which the process gives back anyway."""
    gc.freeze()


@pytest.fixture(scope="session")
def cache_folders(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the folders of all tests stand in which findings are kept."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(autouse=True)
def nothing_kept(monkeypatch: pytest.MonkeyPatch, cache_folders: Path) -> None:
    """No test finds what an earlier run of anybody found, and none leaves anything with the user."""
    monkeypatch.setenv("SAFELOC_CACHE", str(cache_folders / str(next(NUMBERS))))


@pytest.fixture(scope="session")
def generated_once(tmp_path_factory: pytest.TempPathFactory) -> GeneratedOnce:
    """The generator of this run of the tests, of all its processes."""
    several = "PYTEST_XDIST_WORKER" in os.environ
    return GeneratedOnce(tmp_path_factory.getbasetemp().parent / "generated" if several else None)


@pytest.fixture(autouse=True)
def machines_generated_once(
    request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, generated_once: GeneratedOnce
) -> None:
    """The Python of equal declarations is generated once and compiled once in a process, outside the tests of generated code."""
    if request.path.relative_to(Path(__file__).parent).parts[0] not in GENERATING:
        monkeypatch.setattr(compiled, "to_python", generated_once)
        monkeypatch.setattr(compiled, "_code", compiled_once)
