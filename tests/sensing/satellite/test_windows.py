"""The variability of a satellite over its window."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.sensing.satellite.windows import Window


def test_no_figure_before_the_window_is_full() -> None:
    """Two epochs of three give none; the third does; the oldest leaves."""
    window = Window(3)
    assert [None, None, 1] == [window.add(1), window.add(3), window.add(2)]
    assert window.add(2) == 1  # variance of 3, 2, 2 is a third, rounded up


def test_a_gap_starts_anew() -> None:
    """An epoch without measurement empties the window."""
    window = Window(2)
    assert [None, 50, None, None] == [window.add(0), window.add(10), window.add(None), window.add(5)]


def test_one_epoch_is_no_window() -> None:
    """A variance needs two values."""
    with pytest.raises(InputError, match="two or more"):
        Window(1)
