"""Balises and the reflectors behind them: order, prescribed distance, function test, direction (RFL-6 to RFL-9, RFL-D5)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.audit.findings import Ledger
from safeloc.railway.audit.rules import UNBOUNDED, Figures, Rules
from safeloc.railway.audit.stretches import longest, name
from safeloc.railway.map.elements import BaliseGroup, Reflector
from safeloc.railway.map.topology import Run
from safeloc.railway.map.walk import Reference, Seen, Walk, carried

_SLACK_MM = 1_000_000
"""The search for a reflector goes this much farther than its stated distance, so that the report can give the true one."""


class References:
    """Balise groups with their reflectors, for one vehicle's figures."""

    def __init__(self, walk: Walk, rules: Rules, ledger: Ledger) -> None:
        self.walk, self.rules, self.ledger = walk, rules, ledger
        self._testing: dict[Run, set[str]] = {}
        self._reach = longest(0, rules.layout)

    def check(self) -> None:
        """Check all references; function tests first, since reflectors are counted from the last balise with a function test."""
        for seen in self.walk.everywhere():
            if isinstance(seen.element, BaliseGroup):
                self._function_test(seen, seen.element)
                self._telegrams(seen, seen.element)
                self._direction(seen, seen.element)
        self._reflectors_follow()

    def _next_reflectors(self, seen: Seen) -> Iterator[tuple[Seen, Reflector]]:
        for ahead in self.walk.first_ahead(seen.run, seen.offset_mm, self._reach, is_reflector):
            assert isinstance(ahead.element, Reflector)
            yield ahead, ahead.element

    def _function_test(self, seen: Seen, group: BaliseGroup) -> None:
        ahead = list(self._next_reflectors(seen))
        possible = [
            self.ledger.check(
                self.rules.function_test,
                self.walk.place(seen.run, seen.offset_mm),
                f"{name(group)} with {name(reflector)}",
                **function_test_figures(self.rules.layout, group, reflector, one.distance_mm),
            )
            for one, reflector in ahead
        ]
        if possible and all(possible):
            self._testing.setdefault(seen.run, set()).add(group.id)

    def _telegrams(self, seen: Seen, group: BaliseGroup) -> None:
        for announced in group.telegram_reflectors:
            if announced.direction == seen.run.direction:
                reach = announced.distance_mm + _SLACK_MM
                ahead = self.walk.ahead(seen.run, seen.offset_mm, reach)
                found = next(
                    (one for one in ahead if one.element.id == announced.reflector and is_reflector(one.element)), None
                )
                self._announced(
                    seen, group, found, announced.reflector, announced.distance_mm, announced.search_from_mm
                )

    def _announced(
        self, seen: Seen, group: BaliseGroup, found: Seen | None, reflector: str, stated: int, search_from: int | None
    ) -> None:
        place = self.walk.place(seen.run, seen.offset_mm)
        subject = f"{name(group)}, {seen.run.direction}, to reflector {reflector}"
        if found is None and self.walk.line.part and reflector not in {one.id for one in self.walk.line.reflectors}:
            return  # on a part of the map that is not loaded
        if found is None:
            self.ledger.add(self.rules.reference_distance, place, f"{subject}: it is not ahead on any route")
            return
        assert isinstance(found.element, Reflector)
        distance = found.distance_mm
        self.ledger.check(self.rules.reference_distance, place, subject, stated_mm=stated, distance_mm=distance)
        prescribed = self.rules.layout.prescribed_distance_mm
        if prescribed is not None:
            self.ledger.check(self.rules.reference_distance, place, subject, stated_mm=prescribed, distance_mm=distance)
        if search_from is not None:
            view = found.element.view_from_mm
            self.ledger.check(
                self.rules.search_start,
                place,
                subject,
                search_from_mm=search_from,
                distance_mm=distance,
                view_from_mm=view,
            )

    def _direction(self, seen: Seen, group: BaliseGroup) -> None:
        """Check that the reflector models before and after a balise without orientation differ: they determine the direction."""
        if group.orientation is not None:
            return
        behind = [one for one in self.walk.behind(seen.run, seen.offset_mm, self._reach) if is_reflector(one.element)]
        last = min(behind, key=lambda one: one.distance_mm, default=None)
        for _, after in self._next_reflectors(seen) if last else ():
            assert last is not None and isinstance(last.element, Reflector)
            place = self.walk.place(seen.run, seen.offset_mm)
            subject = f"{name(group)} between {name(last.element)} and {name(after)}"
            self.ledger.check(self.rules.direction, place, subject, same_model=last.element.model == after.model)

    # -------------------------------------------------------------- reflectors since a balise

    def _reflectors_follow(self) -> None:
        arriving, loops = carried(self.walk, self._entering, self._leaving, self._through, _greatest)
        for loop in loops:
            if any(is_reflector(element) for run in loop for _, element in self.walk.references[run]):
                self._missing(loop[0], 0, "a loop with reflectors")
        for run, count in arriving.items():
            for offset, element, since in self._counted(run, count):
                self._follows(run, offset, element, since)

    def _follows(self, run: Run, offset: int, element: Reference, since: int) -> None:
        if since > UNBOUNDED:
            self._missing(run, offset, f"{name(element)}, {run.direction}")
        else:
            place = self.walk.place(run, offset)
            self.ledger.check(self.rules.after_balise, place, name(element), reflectors_since_balise=since)

    def _missing(self, run: Run, offset: int, subject: str) -> None:
        self.ledger.cases[self.rules.after_balise.name] += 1
        missing = f"{subject}: on some route no balise with a function test comes before it"
        most = self.rules.layout.reflectors_per_balise
        figures = Figures("reflectors since balise", UNBOUNDED, "<=", most, "count")
        self.ledger.add(self.rules.after_balise, self.walk.place(run, offset), missing, figures)

    def _counted(self, run: Run, count: int) -> Iterator[tuple[int, Reference, int]]:
        testing = self._testing.get(run, set())
        for offset, element in self.walk.references[run]:
            if is_reflector(element):
                count += 1
                yield offset, element, count
            elif element.id in testing:
                count = 0

    def _entering(self, run: Run) -> int:
        """Return the reflectors since a balise at the edge of the map; 0 at a seam, since the balise may lie on the part before."""
        return 0 if self.walk.topology.comes_over_seam(run) else UNBOUNDED

    def _leaving(self, run: Run) -> int | None:
        return self._through(run, 0) if run in self._testing else None

    def _through(self, run: Run, count: int) -> int:
        testing = self._testing.get(run, set())
        for _, element in self.walk.references[run]:
            count = count + 1 if is_reflector(element) else 0 if element.id in testing else count
        return count


def _greatest(counts: Iterable[int]) -> int:
    return max(counts)


def function_test_figures(
    layout: LayoutConfig, group: BaliseGroup, reflector: Reflector, distance_mm: int
) -> dict[str, int]:
    """Return the figures of the rule on function tests, for a group and a reflector so far ahead of it."""
    return {
        "distance_mm": distance_mm,
        "read_within_mm": layout.balise_fix_mm(group.location_accuracy_mm),
        "view_from_mm": reflector.view_from_mm,
        "view_to_mm": reflector.view_to_mm,
    }


def is_reflector(element: Reference) -> bool:
    """Return whether the element is a reflector rather than a balise group."""
    return isinstance(element, Reflector)
