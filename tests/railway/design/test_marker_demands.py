"""Designs for vehicles that read markers, against all choices there are on small lines."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from itertools import chain, combinations

import pytest

from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.layout_rules.marker_readers import MarkerReaders
from safeloc.railway.audit import audit
from safeloc.railway.design.designing import Design, Task, design
from safeloc.railway.design.figures import Added, Costs
from safeloc.railway.design.options import Options, standing
from safeloc.railway.design.reach import Reach
from safeloc.railway.design.stretches import stretches
from safeloc.railway.map.imports.geojson import read_geojson
from safeloc.railway.map.model import Line
from safeloc.railway.map.toml_files import find_line
from tests.data_sources import data_file
from tests.railway.map.made import fork, group, marker, reflector, straight

READS = LayoutConfig(markers=MarkerReaders())
ALONE = LayoutConfig(markers=MarkerReaders(groups_are_markers=False))
DEAR = Costs(add_group_eur=1_000_000)


def holds(line: Line, layout: LayoutConfig = READS) -> bool:
    """The line passes its audit, and no stretch from reading to reading is longer than its limit."""
    return not audit(line, layout).violated and all(one.spare_mm >= 0 for one in stretches(line, Reach(layout)))


def subsets(numbers: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """All subsets."""
    return chain.from_iterable(combinations(numbers, size) for size in range(len(numbers) + 1))


def cheapest(line: Line, layout: LayoutConfig) -> int | None:
    """The least cost of all choices of what stands on a line, by trying each."""
    options = Options(line, tuple(standing(line, DEAR, (), layout)))
    free = [number for number, one in enumerate(options.every) if not one.kept_for]
    kept = tuple(number for number, one in enumerate(options.every) if one.kept_for)
    fitting = [one for some in subsets(free) if holds(options.with_only(one := (*kept, *some)), layout)]
    return min((sum(options.costs[number] for number in one) for one in fitting), default=None)


def crowded(seed: int) -> Line:
    """A fork, or a track run both ways, with more markers than it needs, of any accuracy, and a group."""
    draw = random.Random(seed)
    if seed % 2:
        edges = {"stem": 700_000, "left": 600_000, "right": 500_000}
    else:
        edges = {"e0": 1_500_000}
    placed = [
        marker(number, edge, draw.randrange(length // 10_000) * 10_000, draw.choice([0, 300, 300, 5_000, None]))
        for number, (edge, length) in enumerate(list(edges.items()) * (2 if seed % 2 else 6), 1)
    ]
    more = {"markers": tuple(placed), "balise_groups": (group(1, next(iter(edges)), 400_000, 403_000),)}
    if seed % 2:
        return fork(stem_mm=700_000, left_mm=600_000, right_mm=500_000, **more)
    return straight(1_500_000, travel="both", **more)


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("pending", [4, 1])
@pytest.mark.parametrize("seed", [3, 4, 1, 2, 5, 6, 7, 8])
def test_no_choice_of_what_stands_is_cheaper(seed: int, pending: int) -> None:
    """Where nothing has to be added, the design costs what the cheapest of all choices costs; else no choice fits, or it costs more."""
    line, layout = crowded(seed), LayoutConfig(markers=MarkerReaders(pending_markers=pending))
    found = design(Task(line, layout, DEAR, Added(markers=20)))
    assert found is not None
    assert holds(found.line, layout)
    tried = cheapest(line, layout)
    if any(found.options.every[number].new for number in found.chosen):
        assert tried is None or found.cost_eur <= tried
    else:
        assert found.cost_eur == tried
    without = design(Task(line, layout, DEAR))
    if tried is not None:
        assert without is not None and without.cost_eur == tried
    assert found.least_eur <= found.cost_eur


def alone_on_a_grid(length_mm: int, travel: str) -> bool:
    """One marker, anywhere on a grid of 10 m, does."""
    return any(
        holds(straight(length_mm, travel=travel, markers=(marker(1, "e0", at),)), ALONE)
        for at in range(0, length_mm + 1, 10_000)
    )


@pytest.mark.parametrize(
    ("length_mm", "travel", "number"),
    [(1_110_000, "increasing", 1), (1_130_000, "increasing", 2), (900_000, "both", 1)],
)
def test_nothing_stands(length_mm: int, travel: str, number: int) -> None:
    """So many markers are added as an empty track needs, and as no fewer do; the weights prove the cost."""
    assert alone_on_a_grid(length_mm, travel) == (number == 1)
    found = design(Task(straight(length_mm, travel=travel), ALONE, added=Added(markers=5)))
    assert found is not None
    assert holds(found.line, ALONE)
    assert (number, 2_500 * number, 2_500 * number) == (len(found.line.markers), found.cost_eur, found.least_eur)


@pytest.mark.thorough
def test_no_more_markers_than_may_be_added() -> None:
    """Of 3 km that need four markers one is a group where three may be added. Where two may be, three groups are needed: with two the
    longest hops add up to 2 988 m, since groups are known less well. Where groups do not count, the tolerance is not kept.
    """
    line = straight(3_000_000)
    assert [(4, 0), (3, 1), (2, 3)] == [
        kinds(design(Task(line, READS, added=Added(markers=most)))) for most in (9, 3, 2)
    ]
    assert design(Task(line, ALONE, added=Added(markers=3))) is None
    assert design(Task(line, ALONE)) is None


def kinds(found: Design | None) -> tuple[int, int]:
    """How many markers and groups there are."""
    assert found is not None
    assert holds(found.line)
    return len(found.line.markers), len(found.line.balise_groups)


def test_what_does_not_locate_the_vehicle_stays() -> None:
    """Reflectors stay for others, and so do groups that the readers do not read; markers stay where the vehicle reads none."""
    more = {"reflectors": (reflector("r", "e0", 460_000),), "balise_groups": (group(1, "e0", 400_000, 403_000),)}
    line = straight(800_000, markers=(marker(1, "e0", 300_000), marker(2, "e0", 350_000)), **more)
    found = design(Task(line, ALONE))
    assert found is not None
    assert (1, 1, 1) == (len(found.line.reflectors), len(found.line.balise_groups), len(found.line.markers))
    plain = design(Task(line, LayoutConfig()))
    assert plain is not None
    assert line.markers == plain.line.markers
    kept = design(Task(line, ALONE, keep=["m1", "m2"]))
    assert kept is not None
    assert line.markers == kept.line.markers


@pytest.mark.thorough
def test_the_valley_with_two_readers() -> None:
    """Twelve of fifteen groups go where six markers may be added, for 21 000 EUR in place of 30 000; without any one of them it does not hold."""
    found = design(Task(find_line("valley"), READS, added=Added(markers=6)))
    assert found is not None
    assert (6, 3, 21_000, 21_000) == (*kinds(found), found.cost_eur, found.least_eur)
    for number in found.chosen:
        assert not holds(found.options.with_only(found.chosen - {number}))


@pytest.mark.thorough
def test_a_real_network() -> None:
    """Brussels airport, on which nothing stands: markers are added, the line holds, and the weights prove the cost."""
    line = read_geojson(data_file("trains/network_airport.geojson"))[0]
    found = design(Task(line, ALONE, added=Added(markers=400)))
    assert found is not None
    assert holds(found.line, ALONE)
    assert 0 < len(found.line.markers) == found.cost_eur // 2_500
    assert found.least_eur == found.cost_eur
