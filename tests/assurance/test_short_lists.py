"""Long lists of names as short texts."""

from __future__ import annotations

import pytest

from safeloc.assurance.short_lists import first_few


@pytest.mark.parametrize(
    ("names", "expected"),
    [((), ""), (("a",), "a"), (("a", "b", "c"), "a, b, c"), (("a", "b", "c", "d", "e"), "a, b, c and 2 more")],
)
def test_the_first_three(names: tuple[str, ...], expected: str) -> None:
    """Three names, and how many more there are."""
    assert expected == first_few(names)
