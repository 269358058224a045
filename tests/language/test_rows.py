"""Groups of updates that make one row of a transition table."""

from __future__ import annotations

import re

import pytest

from safeloc.errors import ModelError
from safeloc.language.expr import boolean, number
from safeloc.language.rows import together
from safeloc.language.units import COUNT

COUNTED, SEEN = number("counted", COUNT, 0, 9), boolean("seen")


def test_groups_become_one_row() -> None:
    """A row sets what its groups set, in their order."""
    assert {COUNTED: 0, SEEN: True} == together({COUNTED: 0}, {}, {SEEN: True})


def test_a_variable_set_twice_is_refused() -> None:
    """No group overrides another one in silence, not even with the same value."""
    message = r"^.*test_rows\.py:\d+: seen: set by two groups of one row; leave the variable out of one of them\.$"
    with pytest.raises(ModelError, match=message):
        together({COUNTED: 0, SEEN: True}, {SEEN: True})


def test_every_variable_set_twice_is_named() -> None:
    """The message names them all."""
    with pytest.raises(ModelError, match=re.escape("counted, seen: set by two groups")):
        together({COUNTED: 0, SEEN: True}, {COUNTED: 1, SEEN: False})
