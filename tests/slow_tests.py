"""All tests that take minutes: python -m tests.slow_tests --out FILE [--jobs 2] [--which "slow"] [--match WORDS]

One line of FILE a test, with its outcome and processor seconds, written when it is done. Started again with the same FILE it goes on
with the tests that are not in it, and tries again those that failed; a test of another version counts as done, so take the file away to
begin anew. The last line of output is `N passed, N failed`.

This module is also the plugin of the pytest that it starts (`tests.slow_tests.Keeping`).
"""

from __future__ import annotations

import argparse
import resource
import sys
from collections.abc import Generator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from tests.kept_lines import keep, kept_lines

OPTION, DONE, PROCESSOR_S = "--kept-outcomes", "done", "processor_s"
FAILED = "failed"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is left, and return the exit code: 1 if a test failed, or if pytest could not run them all."""
    parser = argparse.ArgumentParser(prog="python -m tests.slow_tests", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="a line a test; read again to go on")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--which", default="slow", help="marks of the tests, as in pytest's -m")
    parser.add_argument("--match", default="", help="words in their names, as in pytest's -k")
    parser.add_argument("place", nargs="*", help="only in these files or folders")
    asked = parser.parse_args(arguments)
    own = ["-p", "tests.slow_tests", OPTION, str(asked.out), "-m", asked.which, "-k", asked.match]
    shared = ["-n", str(asked.jobs), "--dist", "loadfile"]
    ended = pytest.main([*own, *shared, "-q", "-p", "no:cacheprovider", *asked.place])
    outcomes = [one for one in last_outcomes(asked.out).values() if one != "skipped"]
    wrong = outcomes.count(FAILED)
    print(f"{len(outcomes) - wrong} passed, {wrong} failed")
    fine = (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED, pytest.ExitCode.NO_TESTS_COLLECTED)
    return int(wrong > 0 or ended not in fine)


def last_outcomes(file: Path) -> dict[str, str]:
    """Return how each test of the file ended when it was run last."""
    return {line["test"]: line["outcome"] for line in kept_lines(file)}


# ------------------------------------------------------------------ the plugin


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the name of the file."""
    parser.addoption(OPTION, type=Path)


def pytest_configure(config: pytest.Config) -> None:
    """Let the process that starts the others write, and each of these leave out what is done."""
    inputs = getattr(config, "workerinput", None)
    if inputs is not None:
        config.pluginmanager.register(LeavingOut(inputs[DONE]))
    elif (file := config.getoption(OPTION)) is not None:
        config.pluginmanager.register(Keeping(file))


class Keeping:
    """Writes a line for each test that ended; tells the processes what is done, as it stood before the first of them began."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self._done = sorted(test for test, outcome in last_outcomes(file).items() if outcome != FAILED)
        self._worst: dict[str, str] = {}

    def pytest_configure_node(self, node: Any) -> None:
        """Tell a process; the hook is of xdist."""
        node.workerinput[DONE] = self._done

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note a stage of a test; a test whose process crashed has one, which is none of the three."""
        if report.outcome != "passed":
            self._worst[report.nodeid] = report.outcome
        if report.when not in ("setup", "call"):
            outcome = self._worst.pop(report.nodeid, report.outcome)
            keep(self._file, {"test": report.nodeid, "outcome": outcome, **_numbers(report.user_properties)})


class LeavingOut:
    """Leaves out what is done, and measures the rest."""

    def __init__(self, done: Sequence[str]) -> None:
        self._done = frozenset(done)
        self._before_s = 0.0

    def pytest_collection_modifyitems(self, config: pytest.Config, items: list[pytest.Item]) -> None:
        """Deselect."""
        done = [item for item in items if item.nodeid in self._done]
        config.hook.pytest_deselected(items=done)
        items[:] = [item for item in items if item.nodeid not in self._done]

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self) -> None:
        """Begin to measure."""
        self._before_s = _processor_s()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_teardown(self, item: pytest.Item) -> Generator[None, object, object]:
        """Say what the test took, with the processes that it started and waited for."""
        try:
            return (yield)
        finally:
            item.user_properties.append((PROCESSOR_S, round(_processor_s() - self._before_s, 1)))


def _numbers(properties: Sequence[tuple[str, object]]) -> Mapping[str, object]:
    return {name: value for name, value in properties if name == PROCESSOR_S}


def _processor_s() -> float:
    used = (resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


if __name__ == "__main__":
    sys.exit(main())
