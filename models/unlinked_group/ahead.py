"""The way that is left to a place of which an unlinked group told, from the report of its machine."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.errors import InputError
from safeloc.language.nodes import Value


def left_mm(told_mm: int, report: Mapping[str, Value | None], *, group: int) -> tuple[int, int]:
    """Return the least and the greatest distance from the front end to a place that a group told, mm; below 0: passed.

    told_mm  distance from balise 1 of the group to the place, in the direction in which the group was passed
    report   outputs of the machine
    group    identity of the group that told it

    The group itself lies within its location accuracy of where the distance was measured from. For a place where something becomes
    more restrictive take the least, for one where it ends the greatest. Raises InputError where the machine has no reference, or
    that of another group.
    """
    if not report["valid"]:
        raise InputError(
            f"no distance beyond group {group} is reported; a place that it told is to be treated as reached or as still ahead, "
            "whichever is more restrictive."
        )
    if report["group"] != group:
        raise InputError(
            f"the reported distance is that beyond group {report['group']}, not {group}; carry places of a group over when the "
            "next unlinked group is read."
        )
    names = ("distance_mm", "margin_above_mm", "margin_below_mm", "location_accuracy_mm")
    distance, above, below, accuracy = (int(report[name] or 0) for name in names)
    return told_mm - accuracy - distance - above, told_mm + accuracy - distance + below
