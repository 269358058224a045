"""Margins that were found, kept for reports."""

from __future__ import annotations

from typing import Any

from safeloc.assurance.kept_results import KeptResults
from safeloc.assurance.margins.makers import margins_key
from safeloc.proof.cache.store import Store
from safeloc.target import Target

MARGINS = KeptResults("margins for reports", margins_key)
"""By target: the limits of all figures in `world` or `design`, or the fronts of its `pairs`."""


def keep_margins(store: Store, target: Target, part: str, data: Any) -> None:
    """Keep a part of a target's margins, beside the parts that are kept already."""
    had = MARGINS.kept(store, target) or {}
    if had.get(part) != data:
        MARGINS.keep(store, target, {**had, part: data})
