"""Designs against all choices there are on small lines, and on the lines that ship."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from itertools import chain, combinations

import pytest

from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.audit import audit
from safeloc.railway.design.designing import Task, design
from safeloc.railway.design.figures import Added, Costs
from safeloc.railway.design.options import Options, standing
from safeloc.railway.design.reach import Reach
from safeloc.railway.design.stretches import stretches
from safeloc.railway.map.elements import BaliseGroup
from safeloc.railway.map.imports.balise_table import read_balise_table
from safeloc.railway.map.imports.geojson import read_geojson
from safeloc.railway.map.model import Line
from safeloc.railway.map.toml_files import find_line
from tests.data_sources import data_file
from tests.railway.map.made import fork, group, reflector, straight

COSTS = Costs(add_group_eur=100_000)


def holds(line: Line, layout: LayoutConfig) -> bool:
    """The line passes its audit, and the balise machine holds its position from group to group, whatever lies off its place."""
    return not audit(line, layout).violated and all(one.spare_mm >= 0 for one in stretches(line, Reach(layout)))


def subsets(numbers: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """All subsets."""
    return chain.from_iterable(combinations(numbers, size) for size in range(len(numbers) + 1))


def cheapest(line: Line, layout: LayoutConfig) -> int | None:
    """The least cost of all choices of what stands on a line, by trying each."""
    options = Options(line, tuple(standing(line, COSTS, ())))
    fitting = [one for one in subsets(range(len(options.every))) if holds(options.with_only(one), layout)]
    return min((sum(options.costs[number] for number in one) for one in fitting), default=None)


def crowded(seed: int) -> Line:
    """A fork, or a straight track, with more groups and reflectors than it needs."""
    draw = random.Random(seed)
    edges = ("stem", "left", "right") if seed % 2 else ("e0",)
    lengths = dict.fromkeys(edges, 500_000) if seed % 2 else {"e0": 1_200_000}
    groups = tuple(
        group(number + 1, edge, place, place + 3_000)
        for number, edge in enumerate(edges * (1 if seed % 2 else 5))
        for place in [draw.randrange(10, lengths[edge] // 1_000 - 10) * 1_000]
    )
    reflectors = tuple(
        reflector(f"r{number}", one.edge, min(one.position_mm + 60_000, lengths[one.edge]), draw.choice("AB"))
        for number, one in enumerate(groups[:3])
    )
    more = {"balise_groups": groups, "reflectors": reflectors}
    if seed % 2:
        return fork(stem_mm=500_000, left_mm=500_000, right_mm=500_000, **more)
    return straight(1_200_000, **more)


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("seed", [3, 4, 1, 2, 5, 6])
def test_no_choice_of_what_stands_is_cheaper(seed: int) -> None:
    """Where nothing has to be added, the design costs what the cheapest of all choices costs; else no choice fits."""
    line, layout = crowded(seed), LayoutConfig()
    found = design(Task(line, layout, COSTS))
    assert found is not None
    assert holds(found.line, layout)
    tried = cheapest(line, layout)
    added = any(found.options.every[number].new for number in found.chosen)
    if added:
        assert tried is None or found.cost_eur <= tried
    else:
        assert found.cost_eur == tried
    assert found.least_eur <= found.cost_eur


def test_a_vehicle_that_tells_its_track_has_no_group_too_near_before_a_joint() -> None:
    """The cheapest line for others has a group at the end of the stem; with the rule it stands as near as permitted, or elsewhere."""
    line, layout = crowded(1), LayoutConfig(tells_track=True)
    plain, found = (design(Task(line, one, COSTS)) for one in (LayoutConfig(), layout))
    assert plain is not None and found is not None
    assert not holds(plain.line, layout)
    assert holds(found.line, layout)
    assert plain.cost_eur <= found.cost_eur


def test_nothing_stands() -> None:
    """On an empty track of 1.3 km two groups do: no single one on a grid of 10 m does, and two take the least cost."""
    line, layout = straight(1_300_000), LayoutConfig()
    alone = (straight(1_300_000, balise_groups=(group(1, "e0", at, at + 3_000),)) for at in range(0, 1_297_000, 10_000))
    assert not any(holds(one, layout) for one in alone)
    found = design(Task(line, layout, COSTS))
    assert found is not None
    assert holds(found.line, layout)
    assert (2, 200_000, 200_000) == (len(found.line.balise_groups), found.cost_eur, found.least_eur)


def test_every_other_group_of_the_valley_does_for_60_m() -> None:
    """Seven of fifteen stay, the weights show that no fewer do, and the line without any one of the seven does not hold."""
    layout = LayoutConfig(tolerance_mm=60_000)
    found = design(Task(find_line("valley"), layout))
    assert found is not None
    assert (7, 14_000, 14_000) == (len(found.chosen), found.cost_eur, found.least_eur)
    assert holds(found.line, layout)
    for number in found.chosen:
        assert not holds(found.options.with_only(found.chosen - {number}), layout)


def test_what_has_to_stay() -> None:
    """The reflector of a stop point stays, and what was asked to stay."""
    found = design(Task(find_line("fig2"), LayoutConfig()))
    assert found is not None
    stops = {one.reflector for one in find_line("fig2").stop_points}
    assert stops <= {one.id for one in found.line.reflectors}
    kept = design(Task(find_line("valley"), LayoutConfig(tolerance_mm=60_000), keep=["B1"]))
    assert kept is not None
    assert "B1" in {one.id for one in kept.line.balise_groups}


def test_a_tolerance_that_nothing_keeps() -> None:
    """Groups so near each other that the position holds would have windows that meet."""
    assert design(Task(straight(300_000), LayoutConfig(tolerance_mm=8_200))) is None


@pytest.mark.thorough
def test_a_real_network() -> None:
    """Brussels airport, on which nothing stands: groups are added, the line holds, and the weights leave little room below its cost."""
    line = read_geojson(data_file("trains/network_airport.geojson"))[0]
    found = design(Task(line, LayoutConfig()))
    assert found is not None
    assert holds(found.line, LayoutConfig())
    assert all(isinstance(found.options.every[number].element, BaliseGroup) for number in found.chosen)
    assert found.least_eur <= found.cost_eur <= found.least_eur * 103 // 100


def test_a_real_line_with_its_groups() -> None:
    """Utrecht to Amsterdam: of 488 groups few are kept, since windows of most meet, and few are added; the line holds for 60 m."""
    line, layout = (
        read_balise_table(data_file("balises/Baliselocations-V2.xlsx")).line,
        LayoutConfig(tolerance_mm=60_000),
    )
    assert audit(line, layout).violated
    found = design(Task(line, layout))
    assert found is not None
    assert holds(found.line, layout)
    before, after = ({one.id for one in each.balise_groups} for each in (line, found.line))
    assert before - after
    assert before & after
    assert after - before
    assert found.least_eur <= found.cost_eur <= found.least_eur * 120 // 100


@pytest.mark.thorough
def test_reflectors_are_added_where_they_cost_less() -> None:
    """Of 1.3 km one group and two reflectors hold, for 16 000 EUR where two groups cost 20 000; the group has its function test."""
    line, layout = straight(1_300_000), LayoutConfig()
    found = design(Task(line, layout, added=Added(reflector_models=1)))
    assert found is not None
    assert holds(found.line, layout)
    assert (1, 2, 16_000) == (len(found.line.balise_groups), len(found.line.reflectors), found.cost_eur)
    assert found.least_eur <= found.cost_eur
    assert {"R1", "R2"} == {one.id for one in found.line.reflectors}
    assert all("function test" not in one.as_text() for one in found.report.violated)
    for number in found.chosen:
        assert not holds(found.options.with_only(found.chosen - {number}), layout)


@pytest.mark.thorough
def test_reflectors_that_cost_more_are_not_added() -> None:
    """Where one costs as much as a group, groups do; without models of reflectors none is an option."""
    line, dear = straight(1_300_000), Costs(add_reflector_eur=10_000)
    found = design(Task(line, LayoutConfig(), dear, Added(reflector_models=1)))
    assert found is not None
    assert (2, 0) == (len(found.line.balise_groups), len(found.line.reflectors))
    without = design(Task(line, LayoutConfig()))
    assert without is not None
    assert all(isinstance(one.element, BaliseGroup) for one in without.options.every)
