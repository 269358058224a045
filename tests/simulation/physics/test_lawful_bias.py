"""A systematic error explains a run exactly where one of all errors does."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from safeloc.simulation.physics.lawful_bias import FREE, lawful_bias

STRETCHES = st.lists(st.one_of(st.none(), st.tuples(st.integers(-3, 3), st.integers(0, 2))), min_size=1, max_size=4)


def explained(stretches: list[tuple[int, int] | None], most: int) -> bool:
    """Whether an error explains all cycles, by trying all of them."""
    for path in product(range(-5, 6), repeat=len(stretches)):
        within = all(one is None or one[0] <= at <= one[0] + one[1] for one, at in zip(stretches, path, strict=True))
        if within and all(abs(b - a) <= most for a, b in pairwise(path)):
            return True
    return False


@given(STRETCHES, st.integers(0, 2))
def test_an_error_is_found_where_there_is_one(stretches: list[tuple[int, int] | None], most: int) -> None:
    """Within all stretches, with no greater change than may be; where there is none, the changes stay within that all the same."""
    low = np.array([-FREE if one is None else one[0] for one in stretches], dtype=np.int64)[:, None]
    high = np.array([FREE if one is None else sum(one) for one in stretches], dtype=np.int64)[:, None]
    found = lawful_bias(low, high, most)
    assert (np.abs(np.diff(found, axis=0)) <= most).all()
    assert explained(stretches, most) == bool(((low <= found) & (found <= high)).all())


def test_without_anything_to_explain_it_is_nothing() -> None:
    """And each vehicle has its own."""
    low = np.full((3, 2), -FREE)
    low[1, 1] = 40
    assert [[0, 40], [0, 40], [0, 40]] == lawful_bias(low, np.full((3, 2), FREE), 0).tolist()
