"""A solver confirms a protection level, and refutes one that is too small with errors that exceed it."""

from __future__ import annotations

from fractions import Fraction

import pytest

from safeloc.errors import InputError
from safeloc.language.verdict import Proved, Violated
from safeloc.proof.provers.protection import protected

SHARES = {"G01": Fraction(3, 7), "G02": Fraction(-10, 7), "G03": Fraction(1)}
BOUNDS = {"G01": 7_000, "G02": 700, "G03": 1}


def test_the_level_is_proved_to_the_last_digit() -> None:
    """The level 3 000 + 1 000 + 1 holds; one less does not, and errors that exceed it are named."""
    assert isinstance(protected(SHARES, BOUNDS, 4_001), Proved)
    broken = protected(SHARES, BOUNDS, 4_000)
    assert isinstance(broken, Violated)
    assert "beyond 4000 with errors G01 " in broken.reason


def test_a_share_without_a_bound_is_refused() -> None:
    """A satellite of unknown error has no protection level, so an error names it."""
    with pytest.raises(InputError, match="no bound for G02"):
        protected(SHARES, {"G01": 1, "G03": 1}, 10)
