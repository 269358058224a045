"""Checks odometry stretches: from every reference, and from every entry to the map, to the next reference (RFL-D1)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from safeloc.language.expr import as_num
from safeloc.language.interpret import evaluate
from safeloc.language.units import MM
from safeloc.models.layout_rules import LayoutConfig, longest_stretch_mm
from safeloc.railway.audit.findings import Ledger
from safeloc.railway.audit.rules import UNBOUNDED, Rules
from safeloc.railway.map.elements import BaliseGroup
from safeloc.railway.map.topology import Run
from safeloc.railway.map.walk import Reference, Walk, carried


@dataclass(frozen=True)
class _Since:
    """The last reference: distance since it, position error at it, and its name. It was read within that error of its place."""

    distance_mm: int
    fix_error_mm: int
    origin: str


class Stretches:
    """Checks the stretches of one line for one vehicle's figures."""

    def __init__(self, walk: Walk, rules: Rules, ledger: Ledger) -> None:
        self.walk, self.rules, self.ledger = walk, rules, ledger
        self.layout = rules.layout
        self._longest: dict[int, int] = {}

    def check(self) -> None:
        """Check every stretch; where several routes lead to one reference, the worst of them."""
        arriving, loops = carried(self.walk, self._entering, self._leaving, self._through, self._worst)
        for loop in loops:
            subject = f"a loop over {len(loop)} edges without any reference"
            place = self.walk.place(loop[0], 0)
            self.ledger.check(self.rules.stretch, place, subject, distance_mm=UNBOUNDED, fix_error_mm=0, apart_mm=0)
        for run, since in arriving.items():
            self._along(run, since)

    def _along(self, run: Run, since: _Since) -> None:
        for offset, element in self.walk.references[run]:
            begins, read_mm = begins_mm(element, offset, self.layout), fix_error_mm(element, self.layout)
            self._check(since, run, offset, begins, name(element), read_mm)
            since = self._after(element, offset)
        if not self.walk.topology.after(run):
            length = self.walk.topology.length_mm(run)
            self._check(since, run, length, length, "the end of the map", 0)

    def _check(self, since: _Since, run: Run, at_mm: int, begins: int, goal: str, read_mm: int) -> None:
        """Check the stretch to a goal, which is read within `read_mm` of its place on the map."""
        distance = max(since.distance_mm + begins, 0)
        self.ledger.check(
            self.rules.stretch,
            self.walk.place(run, at_mm),
            f"from {since.origin} to {goal}, {run.direction}",
            distance_mm=distance,
            fix_error_mm=since.fix_error_mm,
            apart_mm=since.fix_error_mm + read_mm,
        )

    def _entering(self, run: Run) -> _Since:
        return _Since(0, 0, f"the edge of the map at {self.walk.topology.start(run)}")

    def _leaving(self, run: Run) -> _Since | None:
        there = self.walk.references[run]
        if not there:
            return None
        after = self._after(there[-1][1], there[-1][0])
        return self._through(run, after)

    def _after(self, element: Reference, offset_mm: int) -> _Since:
        return _Since(-ends_mm(element, offset_mm, self.layout), fix_error_mm(element, self.layout), name(element))

    def _through(self, run: Run, since: _Since) -> _Since:
        return _Since(since.distance_mm + self.walk.topology.length_mm(run), since.fix_error_mm, since.origin)

    def _worst(self, several: Iterable[_Since]) -> _Since:
        return max(
            several, key=lambda since: since.distance_mm + since.fix_error_mm - self._longest_mm(since.fix_error_mm)
        )

    def _longest_mm(self, fix_error: int) -> int:
        if fix_error not in self._longest:
            self._longest[fix_error] = longest(fix_error, self.layout)
        return self._longest[fix_error]


def longest(fix_error: int, layout: LayoutConfig) -> int:
    """Return the longest true run after a fix over which the position is kept, in mm; practically unbounded if odometry errors do not grow."""
    if layout.odometry_rate_ppm == 0:
        return UNBOUNDED - fix_error
    return int(evaluate([longest_stretch_mm(as_num(fix_error, MM), layout)], {})[0])


def begins_mm(element: Reference, offset_mm: int, layout: LayoutConfig) -> int:
    """Return the position of the vehicle's front when it first reads the reference."""
    if isinstance(element, BaliseGroup):
        return offset_mm + layout.antenna_offset_mm
    return offset_mm - element.view_from_mm + layout.sensor_offset_mm


def ends_mm(element: Reference, offset_mm: int, layout: LayoutConfig) -> int:
    """Return the position of the vehicle's front when it last reads the reference."""
    if isinstance(element, BaliseGroup):
        return offset_mm + layout.antenna_offset_mm
    return offset_mm - element.view_to_mm + layout.sensor_offset_mm


def fix_error_mm(element: Reference, layout: LayoutConfig) -> int:
    """Return the error of a position taken from the reference: it is read within so much of its place on the map."""
    if isinstance(element, BaliseGroup):
        return layout.balise_fix_mm(element.location_accuracy_mm)
    return layout.reflector_fix_mm


def name(element: Reference) -> str:
    """Return the name of the reference for messages."""
    if isinstance(element, BaliseGroup):
        return f"balise group {element.id}"
    return f"reflector {element.id} ({element.model})"
