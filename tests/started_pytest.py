"""A pytest of its own, as a user's: without plugins that happen to be installed, and without a cache."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest
from _pytest.assertion.rewrite import AssertionRewritingHook

from tests.forked import instead_of_exec

_OPTIONS = ("--disable-plugin-autoload", "-p", "no:cacheprovider")
_FORKED = ("-p", "no:faulthandler")
"""The thread that ends a hanging test stays in the process of the tests: pytest's plugin would wait for it for ever in a fork."""


def run_pytest(
    *arguments: str, folder: Path | None = None, environment: Mapping[str, str] | None = None, anew: bool = False
) -> subprocess.CompletedProcess[str]:
    """Run pytest to its end in a folder.

    anew  start Python anew, as a user does; otherwise it is forked from the process of the tests, with what that has loaded
    """
    words = ["pytest", *_OPTIONS, *arguments]
    if anew:
        command = [sys.executable, "-m", *words]
        return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)

    def program() -> int:
        sys.meta_path[:] = [one for one in sys.meta_path if not isinstance(one, AssertionRewritingHook)]
        sys.path.insert(0, os.getcwd())  # as `python -m` does
        return pytest.main([*words[1:], *_FORKED])

    begin = instead_of_exec(program, words, environment)
    return subprocess.run(
        words, cwd=folder, preexec_fn=begin, restore_signals=False, capture_output=True, text=True, check=False
    )
