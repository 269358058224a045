"""Groups over which the radar may be tested, and the reflectors that need one of them before them (RFL-6, RFL-7)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.railway.audit.references import function_test_figures
from safeloc.railway.audit.rules import Rules
from safeloc.railway.design.least_cost import Demand
from safeloc.railway.design.options import Options
from safeloc.railway.map.elements import BaliseGroup, Reflector
from safeloc.railway.map.topology import Run


def testable(options: Options, rules: Rules) -> dict[int, list[tuple[Run, int]]]:
    """Return the groups that have some reflector in view ahead, chosen or not, each with the places where vehicles pass it so.

    No other group can have a function test, whatever is chosen.
    """
    walk = options.walk
    farthest = max((one.view_from_mm for one in walk.line.reflectors), default=0)
    found = dict[int, list[tuple[Run, int]]]()
    for seen in walk.everywhere() if walk.line.reflectors else ():
        if isinstance(seen.element, BaliseGroup):
            reach = farthest + rules.layout.antenna_offset_mm
            ahead = (one for one in walk.ahead(seen.run, seen.offset_mm, reach) if isinstance(one.element, Reflector))
            if any(_is_in_view(rules, seen.element, one.element, one.distance_mm) for one in ahead):
                found.setdefault(options.number_of(seen.element), []).append((seen.run, seen.offset_mm))
    return found


def _is_in_view(rules: Rules, group: BaliseGroup, reflector: object, distance_mm: int) -> bool:
    assert isinstance(reflector, Reflector)
    return not rules.function_test.broken(function_test_figures(rules.layout, group, reflector, distance_mm))


def before_reflectors(options: Options, rules: Rules) -> Iterator[Demand]:
    """Yield the demand of each reflector for a group before it that can have a function test; none at a seam, beyond which one may lie."""
    groups = testable(options, rules)
    for run, there in options.walk.references.items():
        behind = _behind(options, run)
        if any(options.walk.topology.comes_over_seam(one) for one in behind):
            continue
        for offset, element in there:
            if isinstance(element, Reflector):
                fitting = (
                    number
                    for number, places in groups.items()
                    if any(one in behind and (one != run or at <= offset or _loops(options, run)) for one, at in places)
                )
                yield Demand(frozenset(fitting), frozenset([options.number_of(element)]))


def _behind(options: Options, run: Run) -> set[Run]:
    """Return the run and all runs from which it can be reached."""
    found, open_ = {run}, [run]
    while open_:
        for before in options.walk.topology.before(open_.pop()):
            if before not in found:
                found.add(before)
                open_.append(before)
    return found


def _loops(options: Options, run: Run) -> bool:
    return any(run in _behind(options, before) for before in options.walk.topology.before(run))
