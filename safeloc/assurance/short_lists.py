"""Short texts of long lists of names."""

from __future__ import annotations

from collections.abc import Sequence

_SHOWN = 3


def first_few(names: Sequence[str]) -> str:
    """Return the first three names, and the number of further ones."""
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(names[:_SHOWN]) + more
