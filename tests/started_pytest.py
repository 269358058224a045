"""The command that starts a pytest of its own, as a user's: without plugins that happen to be installed, and without a cache."""

from __future__ import annotations

import sys


def pytest_command(path: str) -> list[str]:
    """Return the command that runs the tests of a file or a folder."""
    return [sys.executable, "-m", "pytest", "-q", "--disable-plugin-autoload", "-p", "no:cacheprovider", path]
