"""Checks what the occupied track assumes of the map: lengths of edges, ways at joints, and balise groups near joints (RFL-D6)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.railway.audit.findings import Ledger
from safeloc.railway.audit.rules import Rules
from safeloc.railway.audit.stretches import name
from safeloc.railway.map.elements import BaliseGroup
from safeloc.railway.map.places import Place
from safeloc.railway.map.topology import Run
from safeloc.railway.map.walk import Walk


def check_edges(walk: Walk, rules: Rules, ledger: Ledger) -> None:
    """Check each edge, each of its ends at which a vehicle may go on, and each group before such an end."""
    for edge in walk.line.edges:
        ledger.check(rules.edge_length, Place(edge.id, 0), f"edge {edge.id}", length_mm=edge.length_mm)
    for run in walk.runs:
        after = walk.topology.after(run)
        if not after:
            continue
        length, node = walk.topology.length_mm(run), walk.topology.end(run)
        names = ", ".join(sorted(one.edge for one in after))
        ledger.check(
            rules.ways_at_joints, walk.place(run, length), f"{node} from {run.edge} to {names}", ways=len(after)
        )
    for one in groups_before_joints(walk):
        subject = f"{name(one.group)} before {walk.topology.end(one.run)}, {one.run.direction}"
        ledger.check(rules.group_before_joint, walk.place(one.run, one.offset_mm), subject, to_joint_mm=one.to_joint_mm)


@dataclass(frozen=True)
class BeforeJoint:
    """A group at `offset_mm` of a run that ends at a joint, and how far it is from its last balise in direction of travel to the joint."""

    group: BaliseGroup
    run: Run
    offset_mm: int
    to_joint_mm: int


def groups_before_joints(walk: Walk) -> Iterator[BeforeJoint]:
    """Yield each group for each end of its edge at which a vehicle may go on."""
    for run in walk.runs:
        length = walk.topology.length_mm(run)
        for offset, element in walk.references[run] if walk.topology.after(run) else ():
            if isinstance(element, BaliseGroup):
                yield BeforeJoint(element, run, offset, length - _last_balise_mm(element, run, length))


def _last_balise_mm(group: BaliseGroup, run: Run, length_mm: int) -> int:
    """Return where the last balise lies in direction of travel, from the beginning of the run: with it the group has been read."""
    places = [balise.position_mm for balise in group.balises]
    return max(places) if run.direction == "increasing" else length_mm - min(places)
