"""What the command line prints stands there as it was written."""

from __future__ import annotations

import pytest

from safeloc.cli.console import err, out


def test_a_line_number_is_no_picture(capsys: pytest.CaptureFixture[str]) -> None:
    """`:100:` has the form of a name of a picture."""
    for console in (out, err):
        console.print("line.toml:100: markers: wrong", markup=False)
    assert list(capsys.readouterr()) == ["line.toml:100: markers: wrong\n"] * 2
