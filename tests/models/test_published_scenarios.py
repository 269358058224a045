"""Operational scenarios of the Hybrid Level 3 principles, pair by pair of section and step, in each setting of an area.

An area with three detection sections inside, each setting of borders and of reports of integrity. A section is compared by what it means
for the interlocking (FREE or not), and by its state. docs/sections.md has the counts, and the reasons for what differs.
"""

from __future__ import annotations

from collections import Counter
from functools import cache
from itertools import dropwhile, takewhile
from pathlib import Path
from typing import Any

import pytest

from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.trace import Trace
from safeloc.language.verdict import Held
from safeloc.models.area import AreaConfig
from safeloc.models.area.judgement import EVIDENCE
from safeloc.models.sections import Sections, SectionsConfig, compose_machines
from safeloc.models.sections.simulate import first_state, simulate
from safeloc.properties.sections import properties
from tests.models.published_scenarios import CUTS, DETECTION, SCENARIOS, SECTION_MM, TENTH_MM, scene, seconds

SETTINGS = (("counted", True), ("occupancy", True), ("counted", False), ("occupancy", False))
"""Borders, and whether a report of integrity is trusted, in the order of the columns of the page."""
KINDS = SAME, AS_RESTRICTIVE, STRICTER, FREER = "same", "as restrictive", "stricter", "freer"
PAIRS, REASONS = "Pairs of section and step:", "Why pairs differ:"
"""The lines of the page before the tables."""
DETECTED, TOLD = "detection says clear", "the train tells its place again"
CASES = [(name, setting) for setting in SETTINGS for name in SCENARIOS]


@cache
def model(setting: tuple[str, bool]) -> Sections:
    """Area of two trains and three detection sections, and eight sections."""
    borders: Any = setting[0]
    area = AreaConfig(trains=2, borders=borders, integrity_is_trusted=setting[1], inner_detection=len(DETECTION))
    return compose_machines(SectionsConfig(area=area, sections=len(CUTS)))


def ran(name: str, setting: tuple[str, bool]) -> Trace:
    """The scenario in the setting."""
    one = model(setting)
    config = SectionsConfig(area=one.area.own.config, sections=len(CUTS))
    place = scene(SCENARIOS[name], counted=setting[0] == "counted")
    return run(one.composition.system, simulate(config, place, seed=3), first=first_state(place))


def pairs(name: str, trace: Trace) -> Counter[tuple[str, str]]:
    """Count how pairs of step and section differ, and why: the evidence of a stricter one, the reason of a freer one."""
    what, table = SCENARIOS[name], model(SETTINGS[0]).sections[0].machine.modes
    found: Counter[tuple[str, str]] = Counter()
    for published, second in zip(what.states, seconds(what), strict=True):
        state = trace.steps[second].state
        for section, theirs in enumerate(published, 1):
            how = _how(theirs, table[int(state[f"section_{section}.mode"])].label[0])
            why = _reason(trace, second, section) if how == FREER else ""
            if how == STRICTER:
                why = EVIDENCE[int(state[f"section_{section}.evidence"])].label
            found[how, why] += 1
    return found


def _how(theirs: str, ours: str) -> str:
    if theirs == ours:
        return SAME
    if "F" not in theirs + ours:
        return AS_RESTRICTIVE
    return STRICTER if theirs == "F" else FREER


def _reason(trace: Trace, second: int, section: int) -> str:
    """Return why a section is FREE that the scenario has not free: detection there is clear, or the train tells its place again."""
    inputs = trace.steps[second].inputs
    inner = next(n for n, (start, end) in enumerate(DETECTION, 1) if start <= CUTS[section - 1][0] <= end)
    if inputs[f"area.inner_{inner}_clear"]:
        return DETECTED
    assert inputs["area.train_1_trusted"], (second, section)
    return TOLD


def counts(found: Counter[tuple[str, str]]) -> str:
    """Return the counts as a cell of the page."""
    return " / ".join(str(sum(n for (how, _), n in found.items() if how == one)) for one in KINDS)


def rows(heading: str) -> dict[str, list[str]]:
    """Return the rows of the table under a line of the page, by their first cell."""
    page = (Path(__file__).parents[2] / "docs" / "sections.md").read_text(encoding="utf-8")
    lines = page.split(heading, 1)[1].splitlines()
    table = list(takewhile(lambda line: line.startswith("|"), dropwhile(lambda line: not line.startswith("|"), lines)))
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in table[2:]]
    return {row[0]: row[1:] for row in cells}


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize(("name", "setting"), CASES, ids=[f"{name} {setting}" for name, setting in CASES])
def test_a_published_scenario(name: str, setting: tuple[str, bool]) -> None:
    """The assumption and every claim hold, so no section is FREE under a vehicle; the counts are those of the page."""
    trace = ran(name, setting)
    assert [] == [verdict for verdict in check_all(trace, properties(model(setting))) if not isinstance(verdict, Held)]
    assert rows(PAIRS)[name][SETTINGS.index(setting)] == counts(pairs(name, trace))


@pytest.mark.thorough
def test_the_page_tells_totals_and_reasons() -> None:
    """Totals in each setting, and how many pairs are stricter or freer for which reason."""
    totals, told = rows(PAIRS)["all"], rows(REASONS)
    expected: dict[str, list[str]] = {name: [] for name in told}
    for setting, total in zip(SETTINGS, totals, strict=True):
        found: Counter[tuple[str, str]] = sum((pairs(name, ran(name, setting)) for name in SCENARIOS), Counter())
        assert total == counts(found)
        reasons = {f"{how}: {why}": n for (how, why), n in found.items() if why}
        assert reasons.keys() <= told.keys()
        for name in told:
            expected[name].append(str(reasons.get(name, 0)))
    assert expected == told


def test_the_scenarios_are_whole() -> None:
    """Each step has a place of the train and eight states, and no state is FREE where the train's front is."""
    for name, what in SCENARIOS.items():
        assert {len(what.fronts)} == {len(what.states), len(what.behind or what.states)}, name
        for front, states in zip(what.fronts, what.states, strict=True):
            assert len(states) == len(CUTS), name
            assert states[(front * TENTH_MM - 1) // SECTION_MM] != "F", (name, front)
