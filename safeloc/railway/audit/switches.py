"""Checks reflectors behind switches: models on the branches differ, and the switch lies in their view (RFL-11, RFL-12)."""

from __future__ import annotations

from itertools import combinations

from safeloc.railway.audit.findings import Ledger
from safeloc.railway.audit.references import is_reflector
from safeloc.railway.audit.rules import Rules
from safeloc.railway.audit.stretches import longest, name
from safeloc.railway.map.elements import Reflector
from safeloc.railway.map.topology import Run
from safeloc.railway.map.walk import Seen, Walk


def check_switches(walk: Walk, rules: Rules, ledger: Ledger) -> None:
    """Check the first reflectors behind every facing switch.

    Where both ways meet again before the first reflector, it is the same one, and does not distinguish the routes.
    """
    reach = longest(0, rules.layout) + max((one.view_from_mm for one in walk.line.reflectors), default=0)
    for run in walk.runs:
        after = walk.topology.after(run)
        if len(after) < 2:
            continue
        firsts = {branch: walk.first_ahead(branch, 0, reach, is_reflector) for branch in after}
        for one, other in combinations(after, 2):
            _branches(walk, rules, ledger, run, firsts[one], firsts[other])
        for seen in {seen.element.id: seen for branch in after for seen in firsts[branch]}.values():
            _in_view(walk, rules, ledger, run, seen)


def _branches(walk: Walk, rules: Rules, ledger: Ledger, run: Run, left: list[Seen], right: list[Seen]) -> None:
    length = walk.topology.length_mm(run)
    for one in left:
        for other in right:
            if (
                isinstance(one.element, Reflector)
                and isinstance(other.element, Reflector)
                and one.element != other.element
            ):
                ledger.check(
                    rules.branches,
                    walk.place(run, length),
                    f"behind {walk.topology.end(run)}: {name(one.element)} and {name(other.element)}",
                    same_model=one.element.model == other.element.model,
                )


def _in_view(walk: Walk, rules: Rules, ledger: Ledger, run: Run, seen: Seen) -> None:
    if isinstance(seen.element, Reflector):
        ledger.check(
            rules.switch_view,
            walk.place(run, walk.topology.length_mm(run)),
            f"{walk.topology.end(run)} before {name(seen.element)}",
            distance_mm=seen.distance_mm,
            view_from_mm=seen.element.view_from_mm,
            view_to_mm=seen.element.view_to_mm,
        )
