"""The long run over tests: each is run once, what failed is tried again, and nothing that ended is lost."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TESTS = """
import os
import pytest

@pytest.mark.slow
@pytest.mark.parametrize("number", range(3))
def test_counted(number):
    with open("ran", "a") as ran:
        ran.write(f"{number}\\n")
    assert number != 1 or os.path.exists("mended")

@pytest.mark.slow
def test_left_out():
    pytest.skip("not here")

@pytest.mark.slow
def test_that_ends_its_process():
    os._exit(3) if not os.path.exists("mended") else None

def test_ordinary():
    raise AssertionError
"""
CONFTEST = "def pytest_configure(config):\n    config.addinivalue_line('markers', 'slow: minutes')\n"


def run(folder: Path) -> subprocess.CompletedProcess[str]:
    """Run the command as `make test-long` does, in a folder of its own."""
    command = [sys.executable, "-m", "tests.slow_tests", "--out", "slow.jsonl", "--jobs", "1", "test_some.py"]
    environment = {"PYTHONPATH": str(ROOT), "PATH": "", "PYTEST_ADDOPTS": "-p no:hypothesispytest -p xdist", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # fmt: skip
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


@pytest.mark.thorough
def test_a_run_goes_on_from_its_file(tmp_path: Path) -> None:
    """A failure and a process that dies are failures; both are tried again, and what passed or was left out is not."""
    (tmp_path / "test_some.py").write_text(TESTS, encoding="utf-8")
    (tmp_path / "conftest.py").write_text(CONFTEST, encoding="utf-8")
    first = run(tmp_path)
    assert (1, "2 passed, 2 failed") == (first.returncode, first.stdout.splitlines()[-1]), first.stdout + first.stderr
    lines = [json.loads(line) for line in (tmp_path / "slow.jsonl").read_text(encoding="utf-8").splitlines()]
    found = {line["test"].partition("::")[2]: line["outcome"] for line in lines}
    assert found == {
        "test_counted[0]": "passed",
        "test_counted[1]": "failed",
        "test_counted[2]": "passed",
        "test_left_out": "skipped",
        "test_that_ends_its_process": "failed",
    }
    assert all(line["processor_s"] >= 0 for line in lines if "ends" not in line["test"])
    (tmp_path / "mended").touch()
    second = run(tmp_path)
    assert (0, "4 passed, 0 failed") == (second.returncode, second.stdout.splitlines()[-1]), second.stdout
    assert (tmp_path / "ran").read_text(encoding="utf-8").split() == ["0", "1", "2", "1"]
    third = run(tmp_path)
    assert (0, "4 passed, 0 failed") == (third.returncode, third.stdout.splitlines()[-1]), third.stdout
