"""Routes of long lines: compared behind every choice, with work that grows with the line and not with its routes."""

from __future__ import annotations

import pytest

from benchmarks.long_line import ELEMENTS_PER_BLOCK, long_line
from safeloc.railway.audit import audit, routes
from safeloc.railway.audit.findings import Likeness, RoutePair
from safeloc.railway.audit.routes import route_count
from safeloc.railway.map.elements import Node, Switch, TrackEdge
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import Place
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Topology
from tests.railway.map.made import fork, group, reflector, straight


def test_routes_are_counted_without_walking_them() -> None:
    """Five in Fig. 3; doubling with every block of a line with crossovers."""
    assert 5 == route_count(Topology(find_line("fig3")))
    counts = [route_count(Topology(long_line(blocks))) or 0 for blocks in (1, 2, 3, 100)]
    assert [5, 13, 34] == counts[:3]
    assert 10**40 < counts[3]


def test_a_long_line_keeps_every_rule() -> None:
    """With more routes than can be walked, every rule is still checked everywhere."""
    report = audit(long_line(60))
    assert () == report.findings
    assert None is report.routes
    assert 60 * ELEMENTS_PER_BLOCK + 6 == sum(report.elements.values())
    assert 60 * 12 == report.cases["reflector after its balise"]
    assert 60 * 2 == report.cases["models on branches"]
    assert (
        60 * 2 + 1 == report.cases["routes told apart"]
    )  # behind each switch, and from the two entries with reflectors


def spoilt(line: Line, identity: str, model: str) -> Line:
    """The line with one reflector of another model."""
    elements = tuple(one.model_copy(update={"model": model}) if one.id == identity else one for one in line.reflectors)
    return line.model_copy(update={"reflectors": elements})


def test_one_wrong_model_in_a_long_line_is_found() -> None:
    """The first reflector behind a crossover, of the model that stands on the other track."""
    line = spoilt(long_line(60), "2-30-3", "D")
    rules = {finding.rule for finding in audit(line).violated}
    assert "models on branches" in rules
    assert "reflectors across tracks" in rules


def siding(*, second_mm: int, **more: object) -> Line:
    """A passing loop: two tracks between two switches, then common track with a reflector."""
    nodes = tuple(Node(id=name) for name in ("west", "s", "t", "east"))
    shape = (
        ("before", "west", "s", 100_000),
        ("main", "s", "t", 300_000),
        ("side", "s", "t", second_mm),
        ("after", "t", "east", 200_000),
    )
    edges = tuple(
        TrackEdge(id=name, from_node=start, to_node=end, length_mm=length, travel="increasing")
        for name, start, end, length in shape
    )
    switches = (
        Switch(id="s", node="s", stem="before", left="main", right="side"),
        Switch(id="t", node="t", stem="after", left="side", right="main"),
    )
    elements = {"balise_groups": (group(1, "before", 10_000, 13_000),), **more}
    return Line(name="siding", version="1", nodes=nodes, edges=edges, switches=switches, **elements)  # type: ignore[arg-type]


def route_faults(line: Line) -> list[tuple[int | None, int | None]]:
    """Faults by models and with everything, for every pair."""
    return [(pair.by_models.least, pair.by_all.least) for pair in audit(line).route_pairs]


def test_a_siding_without_references_is_not_told_apart() -> None:
    """Both ways see the same reflector behind: nothing tells which one was run."""
    line = siding(second_mm=300_000, reflectors=(reflector("r", "after", 50_000),))
    assert [(0, 0)] == route_faults(line)
    assert "routes told apart" in {finding.rule for finding in audit(line).violated}


def test_a_siding_much_longer_is_told_by_distance() -> None:
    """Where the one way is 70 m longer, the reflector behind comes 70 m later, and that shows."""
    line = siding(second_mm=370_000, reflectors=(reflector("r", "after", 50_000),))
    assert [(0, None)] == route_faults(line)


def many(line: Line, monkeypatch: pytest.MonkeyPatch) -> list[tuple[int | None, int | None]]:
    """The same faults, compared as on a line of too many routes."""
    monkeypatch.setattr(routes, "MOST_ROUTES", 0)
    return route_faults(line)


@pytest.mark.parametrize(("accuracy_mm", "told"), [(300, True), (12_000, False)])
def test_a_coarse_group_tells_a_longer_way_only_beyond_its_own_accuracy(accuracy_mm: int, told: bool) -> None:
    """70 m more show by a group known to 0.3 m; the window of one known to 12 m reaches 2 (30 + 12 + 1) m."""
    behind = group(9, "after", 50_000, location_accuracy_mm=accuracy_mm)
    rules = {finding.rule for finding in audit(siding(second_mm=370_000, balise_groups=(behind,))).violated}
    assert told == ("routes told apart" not in rules)


@pytest.mark.parametrize("longer_mm", [0, 30_000, 70_000])
def test_few_and_many_routes_are_compared_alike(longer_mm: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Behind a choice, what comes after the ways have met again still comes later on the longer one."""
    line = siding(second_mm=300_000 + longer_mm, reflectors=(reflector("r", "after", 50_000),))
    whole = route_faults(line)
    expected = [] if whole == [(0, None)] else whole
    assert expected == many(line, monkeypatch)


def test_figure_3_compared_behind_its_switches(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where 302 and 304 part, three misread or missed reflectors confuse; at 306 one."""
    monkeypatch.setattr(routes, "MOST_ROUTES", 0)
    found = {pair.place.edge: pair.by_all.least for pair in audit(find_line("fig3")).route_pairs}
    assert {"301": 2, "302-304": 1, "304-306": 1} == found


def test_balises_tell_tracks_apart() -> None:
    """A balise in each track is read or missed, but never taken for the other."""
    groups = (group(1, "before", 10_000, 13_000), group(2, "main", 150_000), group(3, "side", 150_000))
    line = siding(second_mm=300_000, balise_groups=groups)
    assert [(0, None)] == route_faults(line)


def test_one_equipped_track_is_told_by_its_balise() -> None:
    """A balise in one of the tracks: one missed balise makes it look like the other."""
    line = siding(second_mm=300_000, balise_groups=(group(1, "before", 10_000, 13_000), group(2, "main", 150_000)))
    assert [(0, 1)] == route_faults(line)


def test_reversed_travel_is_another_route() -> None:
    """Over one balise of known orientation the two directions differ; over one of unknown orientation they do not."""
    both = fork(stem_mm=100_000, left_mm=100_000, right_mm=100_000)
    edge = both.edges[0].model_copy(update={"travel": "both", "to_node": "end"})
    nodes = (Node(id="west"), Node(id="end"))
    told, untold = (
        Line(name="l", version="1", nodes=nodes, edges=(edge,), balise_groups=(group(1, "stem", *places),))
        for places in ((50_000, 53_000), (50_000,))
    )
    assert [(0, None)] == route_faults(told)
    assert [(0, 0)] == route_faults(untold)


def test_likeness_in_words() -> None:
    """Which looks like which, and after how many."""
    pair = RoutePair("a > b", "a > c", "ADCD", "DCD", Likeness(1, None), Likeness(None, None), 3, Place("a", 0))
    assert "ADCD / DCD: by models alone ADCD looks like DCD after 1; with distances and balises never; " \
        "DCD is a suffix of ADCD" == pair.as_text()  # fmt: skip
    nameless = RoutePair("a > b", "a > c", "", "", Likeness(0, 0), Likeness(3, 2), 0, Place("a", 0))
    assert "a > b / a > c: by models alone not distinguishable; with distances and balises a > c looks like a > b " \
        "after 2" == nameless.as_text()  # fmt: skip


def test_very_short_edges_are_walked() -> None:
    """Thousands of edges of a metre are no depth problem."""
    assert 1 == audit(straight(*[1_000] * 2_000)).routes


def test_many_references_are_compared_behind_choices(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where comparing end to end takes too much work, two routes are compared as many are."""
    seen = tuple(
        reflector(f"r{place}", "main", place, "AB"[place // 10_000 % 2]) for place in range(0, 300_000, 10_000)
    )
    line = siding(second_mm=300_000, reflectors=seen)
    assert (2, [(30, 30)]) == (audit(line).routes, route_faults(line))
    monkeypatch.setattr(routes, "MOST_WORK", 2_000)
    assert (None, [(30, 30)]) == (audit(line).routes, route_faults(line))


def two_tracks(models: str, other: str, *, travel: str = "increasing") -> Line:
    """Two tracks without a switch between them, with reflectors of these models every 50 m."""
    tracks = (("p", models), ("q", other))
    return Line(
        name="two",
        version="1",
        nodes=tuple(Node(id=f"{end}{track}") for track, _ in tracks for end in "ab"),
        edges=tuple(
            TrackEdge(id=track, from_node=f"a{track}", to_node=f"b{track}", length_mm=400_000, travel=travel)  # type: ignore[arg-type]
            for track, _ in tracks
        ),
        reflectors=tuple(
            reflector(f"{track}{index}", track, 50_000 + 50_000 * index, model)
            for track, row in tracks
            for index, model in enumerate(row)
        ),
    )


@pytest.mark.parametrize("most_routes", [24, 0])
@pytest.mark.parametrize(("other", "faults"), [("ABAC", 0), ("ABBC", 1), ("ACCB", 3)])
def test_tracks_without_a_common_start_are_compared(
    monkeypatch: pytest.MonkeyPatch, most_routes: int, other: str, faults: int
) -> None:
    """With few routes from end to end, with many from the entries on: with the same result."""
    monkeypatch.setattr(routes, "MOST_ROUTES", most_routes)
    line = two_tracks("ABAC", other)
    assert [(faults, faults)] == route_faults(line)
    found = [finding.rule for finding in audit(line).violated if finding.rule == "routes told apart"]
    assert ["routes told apart"] * (faults == 0) == found


def test_opposite_directions_are_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    """Up one track and down the other the same models are seen in the same order."""
    monkeypatch.setattr(routes, "MOST_ROUTES", 0)
    line = two_tracks("ABAC", "CABA", travel="both")
    down = tuple(
        one.model_copy(update={"direction": "decreasing"}) if one.edge == "q" else one for one in line.reflectors
    )
    [pair] = audit(line.model_copy(update={"reflectors": down})).route_pairs
    assert ("ABAC", "ABAC", 0) == (pair.first_models, pair.second_models, pair.by_all.least)


def test_pairs_of_entries_that_are_not_compared_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """By their number; nothing is left silently."""
    monkeypatch.setattr(routes, "MOST_ROUTES", 0)
    monkeypatch.setattr(routes, "_ENTRY_PAIRS", 0)
    found = [finding for finding in audit(two_tracks("A", "A")).findings if finding.rule == "ways compared"]
    assert ["1 of 1 pairs of entries to the map are not compared"] == [finding.subject for finding in found]


def ladder(steps: int) -> Line:
    """Two tracks with a crossover every 20 m, so that ways double."""
    nodes, edges, switches = [Node(id="a0"), Node(id="b0")], [], []
    for step in range(steps):
        shape = (("p", f"a{step}", f"x{step}"), ("q", f"b{step}", f"y{step}"), ("l", f"x{step}", f"y{step}"))
        shape += (("m", f"x{step}", f"u{step}"), ("n", f"y{step}", f"v{step}"), ("k", f"v{step}", f"u{step}"))
        shape += (("r", f"u{step}", f"a{step + 1}"), ("s", f"v{step}", f"b{step + 1}"))
        nodes += [Node(id=f"{kind}{step}") for kind in "xyuv"]
        nodes += [Node(id=f"{kind}{step + 1}") for kind in "ab"]
        edges += [
            TrackEdge(id=f"{kind}{step}", from_node=start, to_node=end, length_mm=10_000, travel="increasing")
            for kind, start, end in shape
        ]
        joints = (("x", "p", "m", "l"), ("y", "n", "q", "l"), ("v", "n", "s", "k"), ("u", "r", "m", "k"))
        switches += [
            Switch(
                id=f"{node}{step}",
                node=f"{node}{step}",
                stem=f"{stem}{step}",
                left=f"{left}{step}",
                right=f"{right}{step}",
            )
            for node, stem, left, right in joints
        ]
    return Line(name="ladder", version="1", nodes=tuple(nodes), edges=tuple(edges), switches=tuple(switches))


def test_too_many_ways_are_told() -> None:
    """Where not all ways behind a choice are compared, the audit says so."""
    found = [finding for finding in audit(ladder(8)).findings if finding.rule == "ways compared"]
    assert {"advice"} == {finding.severity for finding in found}
    assert any("more than 32 ways lead on from x0, on p0 at 10000 mm" in finding.as_text() for finding in found)
