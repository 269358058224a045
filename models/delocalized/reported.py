"""The interval of a composition with the restrictive state behind it: what the host is given."""

from __future__ import annotations

from safeloc.reported import Reported


def interval_of_the_host(truth: str = Reported().truth) -> Reported:
    """Return the names of the outputs that make up the interval; `truth` names the ghost that has the true position."""
    return Reported(
        position="delocalized.position_mm",
        below="delocalized.margin_below_mm",
        above="delocalized.margin_above_mm",
        valid="delocalized.restrictive",
        valid_is=False,
        truth=truth,
    )
