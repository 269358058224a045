"""Demands of the audit's findings on every selection: at least one of the changes that could mend it.

The demands hold for all selections, not only for the one that was audited: a change that is not named cannot mend the finding. They
are weaker than the rule, so the audit may have to be asked several times.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

from safeloc.errors import InputError
from safeloc.railway.audit.findings import AuditReport, Finding
from safeloc.railway.audit.marker_readings import Readings
from safeloc.railway.audit.references import function_test_figures
from safeloc.railway.audit.rules import UNBOUNDED, Rules
from safeloc.railway.audit.stretches import longest
from safeloc.railway.design.function_tests import in_view
from safeloc.railway.design.least_cost import Demand
from safeloc.railway.design.options import Options
from safeloc.railway.map.elements import BaliseGroup, Reflector
from safeloc.railway.map.walk import Reference, Seen, Walk


@dataclass(frozen=True, eq=False)
class Repairs:
    """The demands of an audit's findings of one selection."""

    options: Options
    chosen: frozenset[int]
    report: AuditReport

    def demands(self) -> Iterator[Demand]:
        """Yield a demand for each violated rule. InputError for one that no selection can mend."""
        rules = Rules(self.report.layout)
        known: dict[str, Callable[[Finding], Iterator[Demand]]] = {
            rules.after_balise.name: self._after_balise,
            rules.branches.name: lambda one: self._branches(),
            rules.routes.name: self._routes,
            rules.markers_waiting.name: lambda one: self._waiting(rules),
        }
        for finding in self.report.violated:
            if finding.rule not in known:
                raise InputError(
                    f"{self.report.line}: no choice of balise groups, reflectors and markers mends this: {finding.as_text()}"
                )
            yield from known[finding.rule](finding)

    @cached_property
    def _walk(self) -> Walk:
        return Walk(self.options.with_only(self.chosen))

    def _left_out(self, kind: type[Reference]) -> frozenset[int]:
        every = enumerate(self.options.every)
        return frozenset(n for n, one in every if n not in self.chosen and isinstance(one.element, kind))

    def _those_chosen(self, kind: type[Reference]) -> frozenset[int]:
        return frozenset(number for number in self.chosen if isinstance(self.options.every[number].element, kind))

    # ------------------------------------------------------------------ reflectors behind balises

    def _after_balise(self, finding: Finding) -> Iterator[Demand]:
        """Another group that can have a function test, another first reflector behind one, or a reflector fewer."""
        there = finding.place.edge, finding.place.position_mm
        own = [n for n in self._those_chosen(Reflector) if self.options.every[n].place == there]
        spoiling = frozenset(self._spoiling_function_tests())
        too_many = finding.figures is not None and finding.figures.actual < UNBOUNDED
        seen = self._in_view
        testing = self._left_out(BaliseGroup) & frozenset(seen)
        if too_many or not own:
            yield Demand(testing | self._left_out(Reflector), self._those_chosen(Reflector))
            return
        shown = frozenset[int]().union(*(seen[group] for group in seen if group in self.chosen))
        yield Demand(testing | (shown - self.chosen), frozenset([*own, *spoiling]))

    @cached_property
    def _in_view(self) -> dict[int, frozenset[int]]:
        return in_view(self.options, Rules(self.report.layout))

    def _spoiling_function_tests(self) -> Iterator[int]:
        """Yield the first reflectors behind groups that are not in view there."""
        reach = longest(0, self.report.layout)
        rule = Rules(self.report.layout).function_test
        for seen in self._walk.everywhere():
            if isinstance(seen.element, BaliseGroup):
                for ahead in self._walk.first_ahead(seen.run, seen.offset_mm, reach, _is_reflector):
                    assert isinstance(ahead.element, Reflector)
                    distance = ahead.distance_mm
                    if rule.broken(function_test_figures(self.report.layout, seen.element, ahead.element, distance)):
                        yield self.options.number_of(ahead.element)

    # ------------------------------------------------------------------ markers

    def _waiting(self, rules: Rules) -> Iterator[Demand]:
        """Of more markers under the vehicle than can wait for its trailing reader one goes."""
        readings = Readings(self._walk, rules)
        for mark, run, offset in readings.everywhere():
            under = readings.under_the_vehicle(mark, run, offset)
            if rules.markers_waiting.broken({"under_the_vehicle": len(under)}):
                yield Demand(frozenset(), frozenset(self.options.number_of(one.element) for one in under))

    # ------------------------------------------------------------------ branches

    def _branches(self) -> Iterator[Demand]:
        """Of two first reflectors alike behind a switch one goes, or another one comes before it."""
        reach = longest(0, self.report.layout) + max(one.view_from_mm for one in self._walk.line.reflectors)
        for run in self._walk.runs:
            firsts = [self._walk.first_ahead(one, 0, reach, _is_reflector) for one in self._walk.topology.after(run)]
            for number, left in enumerate(firsts):
                for right in firsts[number + 1 :]:
                    yield from self._alike(left, right)

    def _alike(self, left: list[Seen], right: list[Seen]) -> Iterator[Demand]:
        for one in left:
            for other in right:
                first, second = one.element, other.element
                assert isinstance(first, Reflector)
                assert isinstance(second, Reflector)
                if first.id != second.id and first.model == second.model:
                    both = frozenset([self.options.number_of(first), self.options.number_of(second)])
                    yield Demand(self._left_out(Reflector), both)

    # ------------------------------------------------------------------ routes

    def _routes(self, finding: Finding) -> Iterator[Demand]:
        """Something more is seen on one of both ways. Without faults to withstand, two ways look alike because all that is seen on
        them does: taking a group away leaves them so, since a group is never taken for another one.
        """
        edges = {edge for way in _ways_of(finding.subject) for edge in way}
        there = frozenset(n for n, one in enumerate(self.options.every) if one.element.edge in edges)
        fewer = self._those_chosen(Reflector)
        if self.report.layout.route_faults_withstood:
            fewer |= self._those_chosen(BaliseGroup)
        yield Demand(there - self.chosen, there & fewer)


def _ways_of(subject: str) -> list[list[str]]:
    return [way.split(" > ") for way in subject.split(" and ")]


def _is_reflector(element: Reference) -> bool:
    return isinstance(element, Reflector)
