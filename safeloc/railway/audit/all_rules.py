"""All checks of a line, in one report."""

from __future__ import annotations

from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.audit.edges import check_edges
from safeloc.railway.audit.findings import AuditReport, Ledger, by_weight
from safeloc.railway.audit.markers import check_markers
from safeloc.railway.audit.neighbours import check_balises, check_reflectors
from safeloc.railway.audit.position_codes import check_position_codes
from safeloc.railway.audit.references import References
from safeloc.railway.audit.routes import check_routes, route_count
from safeloc.railway.audit.rules import Rules
from safeloc.railway.audit.stops import check_stops
from safeloc.railway.audit.stretches import Stretches
from safeloc.railway.audit.switches import check_switches
from safeloc.railway.map.integrity import kinds
from safeloc.railway.map.model import Line, content_checksum
from safeloc.railway.map.walk import Walk


def audit(line: Line, layout: LayoutConfig | None = None, vehicle: str = "default figures") -> AuditReport:
    """Check every rule of the layout at every place to which it applies.

    layout   the vehicle's figures; without it the defaults
    vehicle  the vehicle's name in the report

    A vehicle with marker readers is located by the machine `odometry`: it is asked for the rules on markers, in place of those on
    odometry stretches from group to reflector and on routes that look alike.

    Several vehicles on one line (RFL-15) are audited one by one, since the line has to suit each.
    """
    layout = layout or LayoutConfig()
    walk, rules, ledger = Walk(line), Rules(layout), Ledger({edge.id: edge for edge in line.edges})
    if layout.markers is None:
        Stretches(walk, rules, ledger).check()
    else:
        check_markers(walk, rules, ledger)
    References(walk, rules, ledger).check()
    check_reflectors(walk, rules, ledger)
    check_balises(walk, rules, ledger)
    check_switches(walk, rules, ledger)
    if layout.tells_track:
        check_edges(walk, rules, ledger)
    check_stops(walk, rules, ledger)
    check_position_codes(walk, rules, ledger)
    routes, pairs = check_routes(walk, rules, ledger) if layout.markers is None else (route_count(walk.topology), ())
    return AuditReport(
        vehicle=vehicle,
        line=line.name,
        version=line.version,
        checksum=content_checksum(line),
        layout=layout,
        elements={kind: len(elements) for kind, elements in kinds(line).items() if elements},
        findings=tuple(by_weight(ledger.findings)),
        cases=dict(ledger.cases),
        routes=routes,
        route_pairs=pairs,
    )
