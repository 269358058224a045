"""Findings of the audit: violated rules with place and figures, and the number of checked cases of every rule."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from itertools import groupby
from typing import Any

from safeloc.language.nodes import Value
from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.audit.rules import UNBOUNDED, Figures, Rule
from safeloc.railway.map.elements import TrackEdge
from safeloc.railway.map.places import Place, kilometre_text


@dataclass(frozen=True)
class Finding:
    """A rule that is broken, with place, subject and figures. `severity` is `violated` or `advice`."""

    severity: str
    rule: str
    requirements: tuple[str, ...]
    subject: str
    place: Place
    kilometre: str
    figures: Figures | None

    @property
    def shortfall(self) -> float:
        """The distance of the figure from the required one, as a share of the latter; infinite without figures or without
        a bound.
        """
        if self.figures is None or abs(self.figures.actual) >= UNBOUNDED // 2:
            return math.inf
        return abs(self.figures.actual - self.figures.required) / max(1, abs(self.figures.required))

    def as_text(self) -> str:
        """Return one line for people."""
        kilometre = f", km {self.kilometre}" if self.kilometre else ""
        figures = f": {_shown(self.figures)}" if self.figures else ""
        where = f"{self.place.edge} at {self.place.position_mm} mm{kilometre}"
        return f"{self.severity:9} {self.rule} [{' '.join(self.requirements)}] {self.subject}, on {where}{figures}"


def _shown(figures: Figures) -> str:
    """Return figures as people read them: `distance 502.000 m, must be <= 465.250 m`."""
    actual, required = _amount(figures.actual, figures.unit), _amount(figures.required, figures.unit)
    return f"{figures.what} {actual}, must be {figures.relation} {required}".lstrip()


def _amount(value: int, unit: str) -> str:
    if abs(value) >= UNBOUNDED // 2:
        return "without bound"
    return f"{value / 1000:.3f} m" if unit == "mm" else f"{value}"


def by_weight(findings: Sequence[Finding]) -> list[Finding]:
    """Return the findings in order: violated rules before advice, rules by their worst finding, findings by shortfall."""
    worst: dict[str, float] = {}
    for one in findings:
        worst[one.rule] = max(one.shortfall, worst.get(one.rule, 0.0))

    def weight(one: Finding) -> tuple[bool, float, str, float, Place, str]:
        return one.severity == "advice", -worst[one.rule], one.rule, -one.shortfall, one.place, one.subject

    return sorted(findings, key=weight)


def as_folded_text(findings: Sequence[Finding], most: int) -> list[str]:
    """Return lines for people, of findings in order of weight: at most `most` of each rule, and the number of the others."""
    lines: list[str] = []
    for rule, group in groupby(findings, key=lambda one: one.rule):
        those = list(group)
        lines += [finding.as_text() for finding in those[:most]]
        if len(those) > most:
            lines.append(f"{'':9} {rule}: {len(those) - most} more, none of them farther from what is required")
    return lines


@dataclass(frozen=True)
class Likeness:
    """The number of missed or misread reflectors after which each of two routes looks like the other; None: never."""

    first_as_second: int | None
    second_as_first: int | None

    @property
    def least(self) -> int | None:
        """The smaller of both numbers; None: never."""
        known = [count for count in (self.first_as_second, self.second_as_first) if count is not None]
        return min(known, default=None)

    def as_text(self, first: str, second: str) -> str:
        """Return a phrase for people, with the names of both routes."""
        match self.least:
            case None:
                return "never"
            case 0:
                return "not distinguishable"
            case least if least == self.first_as_second:
                return f"{first} looks like {second} after {least}"
            case least:
                return f"{second} looks like {first} after {least}"


@dataclass(frozen=True)
class RoutePair:
    """The number of misreadings after which one route looks like another.

    by_models      by the sequence of models alone
    by_all         with distances and balises taken into account
    common_suffix  reflectors at the end that look alike: a vehicle that joins there sees no difference
    """

    first: str
    second: str
    first_models: str
    second_models: str
    by_models: Likeness
    by_all: Likeness
    common_suffix: int
    place: Place

    def as_text(self) -> str:
        """Return one line for people: how many missed or misread reflectors make one route look like the other."""
        first, second = self._labels()
        alone, every = self.by_models.as_text(first, second), self.by_all.as_text(first, second)
        suffix = _suffix(self.first_models, self.second_models, self.common_suffix)
        return f"{first} / {second}: by models alone {alone}; with distances and balises {every}{suffix}"

    def _labels(self) -> tuple[str, str]:
        """Return names for both routes: their models if these differ, else their edges."""
        if self.first_models and self.second_models and self.first_models != self.second_models:
            return self.first_models, self.second_models
        return _label(self.first, self.first_models), _label(self.second, self.second_models)


def _label(name: str, models: str) -> str:
    return f"{name} ({models})" if models else name


def _suffix(first: str, second: str, common: int) -> str:
    shorter, longer = sorted((first, second), key=len)
    if common and common == len(shorter) and first != second:
        return f"; {shorter} is a suffix of {longer}"
    return f"; both end in {shorter[-common:]}" if common else ""


@dataclass(frozen=True)
class AuditReport:
    """The result of an audit for one vehicle's figures. `cases` is the number of checks of every rule; findings by weight."""

    vehicle: str
    line: str
    version: str
    checksum: str
    layout: LayoutConfig
    elements: dict[str, int]
    findings: tuple[Finding, ...]
    cases: dict[str, int]
    routes: int | None
    route_pairs: tuple[RoutePair, ...]

    @property
    def violated(self) -> tuple[Finding, ...]:
        """The broken rules, without advice."""
        return tuple(finding for finding in self.findings if finding.severity == "violated")

    def as_data(self) -> dict[str, Any]:
        """Return data for JSON (schema safeloc-audit/1)."""
        fields = asdict(self) | {"layout": self.layout.model_dump()}
        return {"schema": "safeloc-audit/1", "holds": not self.violated, **fields}


@dataclass
class Ledger:
    """Checks rules, and collects the findings and the number of checks."""

    edges: dict[str, TrackEdge]
    cases: Counter[str] = field(default_factory=Counter)
    findings: list[Finding] = field(default_factory=list)

    def check(self, rule: Rule, place: Place, subject: str, **values: Value) -> bool:
        """Check the rule for these figures; add a finding at `place` if it is violated."""
        self.cases[rule.name] += 1
        if not rule.broken(values):
            return True
        self.add(rule, place, subject, rule.figures(values))
        return False

    def add(self, rule: Rule, place: Place, subject: str, figures: Figures | None = None) -> None:
        """Add a finding without a check, for instance because an element that the rule requires is missing."""
        severity = "advice" if rule.advice else "violated"
        kilometre = kilometre_text(self.edges[place.edge], place.position_mm)
        self.findings.append(Finding(severity, rule.name, rule.requirements, subject, place, kilometre, figures))
