"""The checker's answer about a result, with the reason."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

CONFIRMED, WRONG, OPEN, NO_PROOF = "confirmed", "not confirmed", "cannot be checked", "no proof"
Row = Mapping[str, Any]
"""A result, as report.json contains it."""
Answer = tuple[str, str]
Check = Callable[[Row], Answer]


def proven(shown: bool) -> Answer:
    """Return the answer about a result that certificates have to prove."""
    return (CONFIRMED, "") if shown else (WRONG, "its certificates do not prove it")


def seen(shown: bool) -> Answer:
    """Return the answer about a result that a run has to show."""
    return (CONFIRMED, "") if shown else (WRONG, "its run does not show it")
