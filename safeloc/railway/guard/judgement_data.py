"""A judgement as data: one object for each delivery, schema safeloc-guard/1."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Any

from safeloc.railway.guard.guard import Judgement
from safeloc.railway.guard.other_way import Beside
from safeloc.railway.map.places import Place

SCHEMA = "safeloc-guard/1"


def as_data(judgement: Judgement) -> dict[str, Any]:
    """Return the decision as plain data for a consumer.

    position  for a fix that is passed on: edge, place on it, position along the way, distance off the track (mm)
    withheld  the same for a fix that is withheld; no consumer should use it
    interval  the vehicle's interval along the way at `at_ms`, with the places of its ends; None while unknown
    beside    of a fix that is passed on along a given way with other tracks on the map: how many of the last fixes beside
              another track lie nearer to it than to the way, and whether the way is doubtful for that; else None
    """
    located = _located(judgement)
    return {
        "line": judgement.delivery.number,
        "time_ms": judgement.delivery.time_ms,
        "passed": judgement.passed,
        "reason": judgement.reason,
        "mode": judgement.mode,
        "position": located if judgement.passed else None,
        "interval": _interval(judgement),
        "withheld": None if judgement.passed else located,
        "beside": _beside(judgement.beside),
        "flag": judgement.delivery.flag,
        "detail": judgement.detail,
    }


def _located(judgement: Judgement) -> dict[str, Any] | None:
    if judgement.place is None:
        return None
    way, offset = judgement.position_mm, judgement.offset_mm
    return {**_place(judgement.place), "way_mm": way, "offset_mm": offset}


def _interval(judgement: Judgement) -> dict[str, Any] | None:
    if judgement.interval_mm is None:
        return None
    low, high = judgement.interval_mm
    begin, end = (None if place is None else _place(place) for place in judgement.ends)
    return {"at_ms": judgement.at_ms, "min_mm": low, "max_mm": high, "from": begin, "to": end}


def _beside(beside: Beside | None) -> dict[str, Any] | None:
    return None if beside is None else {"fixes": beside.fixes, "nearer": beside.nearer, "doubtful": beside.doubtful}


def _place(place: Place) -> dict[str, Any]:
    return {"edge": place.edge, "position_mm": place.position_mm}


def counted(judgements: Iterable[Judgement]) -> dict[str, int]:
    """Count deliveries by reason (PASSED for those passed on), the most frequent first."""
    return dict(Counter(judgement.reason for judgement in judgements).most_common())
