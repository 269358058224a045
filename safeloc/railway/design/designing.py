"""The line of least cost that keeps a tolerance: demands of the rules, a selection of least cost, the audit of it, and so on until it passes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, gcd

from safeloc.errors import EngineError
from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.audit import audit
from safeloc.railway.audit.findings import AuditReport
from safeloc.railway.audit.rules import Rules
from safeloc.railway.design.demands import Stretching, apart, off_joints
from safeloc.railway.design.figures import Added, Costs
from safeloc.railway.design.function_tests import before_reflectors, tests
from safeloc.railway.design.least_cost import AtMost, Demand, bound, least, none_cheaper, weights
from safeloc.railway.design.marker_demands import marker_demands
from safeloc.railway.design.marker_places import marker_options
from safeloc.railway.design.options import Installed, Option, Options, standing
from safeloc.railway.design.places import new_options
from safeloc.railway.design.reach import Reach
from safeloc.railway.design.repairs import Repairs
from safeloc.railway.map.elements import BaliseGroup, Marker, Reflector
from safeloc.railway.map.model import Line

_MOST_AUDITS = 200
_ANY_GAP = 0.5
"""Share of the cost by which a selection may be dearer than need be where only its existence is asked."""
_ASKED_OPTIONS, _ASKED_SECONDS = 150, 20.0
"""Where weights leave a gap, the provers are asked of so many options at most, for so long."""


@dataclass(frozen=True)
class Task:
    """A question: the line, the vehicle's figures with the tolerance to be kept, costs, what may be added, and what has to stay."""

    line: Line
    layout: LayoutConfig
    costs: Costs = Costs()
    added: Added = Added()
    keep: Sequence[str] = ()


@dataclass(frozen=True, eq=False)
class Design:
    """A line of least cost.

    chosen     the numbers of the options that are on it
    line       the designed line
    report     its audit, without a violated rule
    demands    what rules and machine demand, as far as the search had to know
    weighted   weights of demands from which the lower bound is added up
    least_eur  the lower bound for every choice among the options, EUR
    apart_mm   places nearer than this counted as one
    audits     number of audits
    none_cheaper  where weights leave a gap: the provers show that no choice among the options costs less
    """

    task: Task
    options: Options
    reach: Reach
    chosen: frozenset[int]
    line: Line
    report: AuditReport
    demands: tuple[Demand, ...]
    weighted: dict[Demand, Fraction]
    least_eur: int
    apart_mm: int
    audits: int
    none_cheaper: bool = False

    @property
    def cost_eur(self) -> int:
        """The cost of all that is kept and added, EUR."""
        return sum(self.options.costs[number] for number in self.chosen)


def _considered(task: Task) -> tuple[Options, Reach, int]:
    """Return the options of a task, the limits of stretches, and how far apart places have to be to count as two."""
    reach = Reach(task.layout)
    if task.layout.markers is None:
        new, apart_mm = new_options(task.line, reach, task.added, task.costs)
    else:
        new, apart_mm = marker_options(task.line, Rules(task.layout), task.added, task.costs)
    return Options(task.line, (*standing(task.line, task.costs, task.keep, task.layout), *new)), reach, apart_mm


def _demanded(options: Options, reach: Reach) -> list[Demand]:
    """Return what is demanded of every selection before any is audited."""
    kept = [Demand(frozenset([number])) for number, one in enumerate(options.every) if one.kept_for]
    originals = [
        Demand(frozenset([options.number["balise group", one.element.duplicate_of]]), frozenset([number]))
        for number, one in enumerate(options.every)
        if isinstance(one.element, BaliseGroup) and one.element.duplicate_of is not None
    ]
    rules = Rules(reach.layout)
    reached = Stretching(options, reach).demands() if rules.layout.markers is None else marker_demands(options, rules)
    found = [
        *kept, *originals, *reached, *apart(options, rules),
        *off_joints(options, rules), *before_reflectors(options, rules),
    ]  # fmt: skip
    return list(dict.fromkeys(found))


@dataclass(frozen=True, eq=False)
class _Selection:
    """A selection of least cost that passes its audit, and what the search had to know for it."""

    options: Options
    reach: Reach
    apart_mm: int
    chosen: frozenset[int]
    report: AuditReport
    demands: tuple[Demand, ...]
    audits: int


def design(task: Task, seconds: float = 60.0) -> Design | None:
    """Return the line of least cost; None if no choice among the options keeps the tolerance."""
    found = _selected(task, seconds)
    return None if found is None else _with_bound(task, found)


def can_be_kept(task: Task, seconds: float = 60.0) -> bool:
    """Return whether some choice among the options keeps the tolerance."""
    return _selected(task, seconds, _ANY_GAP) is not None


def _selected(task: Task, seconds: float, gap: float = 0.0) -> _Selection | None:
    options, reach, apart_mm = _considered(task)
    demands, costs = _demanded(options, reach), _costs(options, reach)
    for audits in range(1, _MOST_AUDITS + 1):
        decided = least(costs, demands, seconds, gap, _at_most(task, options))
        if decided is None:
            return None
        chosen = frozenset(number for number in decided if number < len(options.every))
        report = audit(options.with_only(chosen), task.layout)
        if not report.violated:
            return _Selection(options, reach, apart_mm, chosen, report, tuple(demands), audits)
        more = [one for one in dict.fromkeys(Repairs(options, chosen, report).demands()) if one not in set(demands)]
        if not more or any(one.holds(decided) for one in more):
            raise EngineError(f"{task.line.name}: a finding demands nothing new: {report.violated[0].as_text()}")
        demands += more
    raise EngineError(f"{task.line.name}: no design passed its audit after {_MOST_AUDITS} selections.")


def _costs(options: Options, reach: Reach) -> list[int]:
    """Return the cost of everything that is decided: of the options, and nothing for whether a group has a function test."""
    return [*options.costs, *(0 for _ in tests(options, Rules(reach.layout)))]


def _at_most(task: Task, options: Options) -> AtMost | None:
    """Return how many new markers may be chosen; None if none is an option."""
    new = frozenset(n for n, one in enumerate(options.every) if one.new and isinstance(one.element, Marker))
    return AtMost(task.added.markers, new) if new else None


def _with_bound(task: Task, found: _Selection) -> Design:
    costs = _costs(found.options, found.reach)
    weighted = weights(costs, found.demands)
    least_eur = _rounded_up(bound(costs, weighted), costs)
    cost = sum(costs[number] for number in found.chosen)
    asked = least_eur < cost and len(costs) <= _ASKED_OPTIONS
    limited = _at_most(task, found.options)
    proved = asked and none_cheaper(costs, found.demands, cost, _ASKED_SECONDS, limited)
    line = _named_line(found.options, found.chosen)
    of = (found.options, found.reach, found.chosen)
    return Design(
        task, *of, line, found.report, found.demands, weighted, least_eur, found.apart_mm, found.audits, proved
    )


def _rounded_up(least: Fraction, costs: Sequence[int]) -> int:
    """Return the lower bound, rounded up to what a sum of costs can be."""
    step = gcd(*costs) or 1
    return ceil(least / step) * step


def _named_line(options: Options, chosen: frozenset[int]) -> Line:
    """Return the designed line; its new groups and reflectors are numbered along its edges."""
    order = {edge.id: number for number, edge in enumerate(options.line.edges)}
    line = options.with_only(chosen - {number for number in chosen if options.every[number].new})
    found: dict[type[Installed], list[Installed]] = {BaliseGroup: [], Reflector: [], Marker: []}
    for kind, elements in found.items():
        every = [n for n, one in enumerate(options.every) if one.new and isinstance(one.element, kind)]
        placed = sorted(chosen.intersection(every), key=lambda n: _along(options.every[n], order))
        for number, like in zip(placed, every, strict=False):
            elements.append(_named(options.every[number].element, options.every[like].element))
    groups = (*line.balise_groups, *(one for one in found[BaliseGroup] if isinstance(one, BaliseGroup)))
    reflectors = (*line.reflectors, *(one for one in found[Reflector] if isinstance(one, Reflector)))
    markers = (*line.markers, *(one for one in found[Marker] if isinstance(one, Marker)))
    return line.model_copy(update={"balise_groups": groups, "reflectors": reflectors, "markers": markers})


def _named(element: Installed, like: Installed) -> Installed:
    """Return an element under the name of another one."""
    more = {} if isinstance(like, Reflector) else {"identity": like.identity}
    return element.model_copy(update={"id": like.id, **more})


def _along(one: Option, order: dict[str, int]) -> tuple[int, int]:
    return order[one.element.edge], one.element.position_mm
