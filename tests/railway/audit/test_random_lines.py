"""The audit works on the graph; walked route by route, random lines give the same findings."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from hypothesis import given, settings

from safeloc.language.expr import as_num
from safeloc.language.interpret import holds
from safeloc.language.units import MM
from safeloc.models import layout_rules as rules
from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.audit import audit
from safeloc.railway.audit.findings import AuditReport
from safeloc.railway.audit.stretches import begins_mm, ends_mm, fix_error_mm
from safeloc.railway.map.clearance import clear_mm
from safeloc.railway.map.elements import BaliseGroup, Reflector
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import Place
from safeloc.railway.map.routes import Met, Route, through_routes
from safeloc.railway.map.topology import Topology
from safeloc.railway.map.walk import Walk
from tests.railway.map.random_lines import lines

LAYOUT = LayoutConfig(tolerance_mm=20_000, odometry_rate_ppm=100_000, sensor_offset_mm=1_500, antenna_offset_mm=700)


def places(report: AuditReport, rule: str) -> set[Place]:
    """Where a rule is broken."""
    return {finding.place for finding in report.findings if finding.rule == rule}


def routes(line: Line) -> list[Route]:
    """Every route over the line."""
    return through_routes(Topology(line), 10_000)


def references(route: Route) -> Iterator[tuple[Met, BaliseGroup | Reflector]]:
    """Balise groups and reflectors on the way."""
    for met in route.objects():
        if isinstance(met.element, (BaliseGroup, Reflector)):
            yield met, met.element


def stretch_breaks(route: Route) -> Iterator[Place]:
    """References reached too late on this route, and the end of the map."""
    end, fix = 0, 0
    for met, element in references(route):
        distance, read = max(begins_mm(element, met.position_mm, LAYOUT) - end, 0), fix_error_mm(element, LAYOUT)
        if too_long(distance, fix, read):
            yield Place(element.edge, element.position_mm)
        end, fix = ends_mm(element, met.position_mm, LAYOUT), read
    if too_long(max(route.length_mm - end, 0), fix, 0):
        yield route.place(route.length_mm)


def too_long(distance: int, fix: int, read: int) -> bool:
    """Whether the rule of the layout is broken between a reference with that error of a fix and one that is read within `read`."""
    figures = (as_num(one, MM) for one in (distance, fix, fix + read))
    return not holds(rules.stretch_is_tolerable(*figures, LAYOUT), {})


@given(lines())
def test_stretches_are_those_of_all_routes(line: Line) -> None:
    """A reference is reached too late by the audit exactly where some route reaches it too late."""
    expected = {place for route in routes(line) for place in stretch_breaks(route)}
    assert expected == places(audit(line, LAYOUT), "odometry stretch")


def neighbour_breaks(route: Route) -> Iterator[tuple[str, str, int]]:
    """Equal models too near on this route, each pair once with its spacing."""
    seen = [(met.position_mm, one) for met, one in references(route) if isinstance(one, Reflector)]
    for (there, first), (here, second) in combinations(seen, 2):
        if first.model == second.model:
            yield first.id, second.id, here - there


@given(lines())
def test_neighbours_are_those_of_all_routes(line: Line) -> None:
    """Two equal reflectors are too near by the audit exactly where they are too near on some route."""
    nearest: dict[frozenset[str], int] = {}
    for route in routes(line):
        for first, second, spacing in neighbour_breaks(route):
            pair = frozenset((first, second))
            nearest[pair] = min(spacing, nearest.get(pair, spacing))
    found = [one for one in audit(line, LAYOUT).findings if one.rule == "neighbours told apart"]
    views = {one.id: (one.view_from_mm, one.view_to_mm) for one in line.reflectors}
    widest = max((view for view, _ in views.values()), default=0)
    reach = widest + 2 * LAYOUT.tolerance_mm
    assert len(found) <= sum(spacing <= reach for spacing in nearest.values())
    assert len(found) >= sum(spacing <= 2 * LAYOUT.tolerance_mm for spacing in nearest.values())


@given(lines())
def test_reflectors_without_balise_are_those_of_all_routes(line: Line) -> None:
    """Where some route leads to a reflector without any balise before it, the audit finds the reflector."""
    expected: set[Place] = set()
    for route in routes(line):
        for _, element in references(route):
            if isinstance(element, BaliseGroup):
                break
            expected.add(Place(element.edge, element.position_mm))
    assert expected <= places(audit(line, LAYOUT), "reflector after its balise")


@given(lines())
def test_an_audited_line_gives_the_reflector_machine_room(line: Line) -> None:
    """Where both rules on reflectors hold, the clearance that the machine is told keeps its layout rule."""
    report = audit(line, LAYOUT)
    if not places(report, "neighbours told apart") | places(report, "reflectors across tracks"):
        for clear in clear_mm(Walk(line), 1_000_000).values():
            assert holds(rules.separable_by_distance(as_num(clear, MM), LAYOUT), {})


@settings(max_examples=30)
@given(lines())
def test_the_audit_is_repeatable_and_serializable(line: Line) -> None:
    """Twice the same report, and all of it plain data."""
    first, second = audit(line, LAYOUT), audit(line, LAYOUT)
    assert first == second
    assert (not first.violated) == first.as_data()["holds"]
