"""Groups of the digital map as the balise machine meets them: the worked figure, and a real table."""

from __future__ import annotations

from collections import Counter

from safeloc.language.interpret import run
from safeloc.models.balise.groups import Group, announcement, groups_along, telegram
from safeloc.models.balise.simulate import simulate
from safeloc.models.balise.variables import BaliseConfig
from safeloc.railway.map.imports.balise_table import read_balise_table
from safeloc.railway.map.model import Line
from safeloc.railway.map.routes import Inventory, through_routes
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Topology
from safeloc.simulation.motion import Leg
from tests.data_sources import data_file
from tests.models.balise_runs import board_only, label, on_board, out, step, wrong


def along(line: Line, edge: str) -> list[list[Group]]:
    """The groups of every way along one edge."""
    inventory = Inventory(line)
    return [groups_along(r, inventory) for r in through_routes(Topology(line), 1_000) if r.runs[0].edge == edge]


def test_groups_of_figure_1() -> None:
    """Balise 106 at 400 m, two balises in order, 0.3 m; its telegram tells of reflector 109 at 480 m (RFL-9)."""
    (groups,) = along(find_line("fig1"), "103")
    assert groups == [Group(107, 400_000, 2, "NOMINAL", 300, "SERVICE_BRAKE", True, 80_000, 0)]


def test_figure_1_is_run_with_its_own_map() -> None:
    """RFL-5, RFL-9: the position after balise 106 is its place within 0.3 m and 1 m; the reflector is at 480 m."""
    ((group,),) = along(find_line("fig1"), "103")
    config = BaliseConfig(trust_first_group=True, antenna_mm=0)
    start = step(1_000, telegram(Group(1, 330_000), since_mm=0), {"national_accuracy_mm": 1_000})
    stream = [start, step(1_000, announcement(group)), *(step() for _ in range(68))]
    trace = run(on_board(config), [*stream, step(1_000, telegram(group, since_mm=0))])
    assert label(trace, "telegram") == "ACCEPTED"
    assert (out(trace)["position_mm"], out(trace)["margin_above_mm"]) == (400_000, 5_000 + 1_000 + 300)
    assert (out(trace)["reflector_mm"], out(trace)["search_mm"]) == (480_000, 400_000)


def test_a_single_balise_on_the_map_has_the_orientation_it_is_told() -> None:
    """Of a group of one, the map's nominal direction counts, and turns with the direction of the run."""
    line = read_balise_table(data_file("balises/Baliselocations-V2.xlsx")).line
    one, other = along(line, "Bkl-Hmla spoor 711")
    turned = {"NOMINAL": "REVERSE", "REVERSE": "NOMINAL", "UNKNOWN": "UNKNOWN"}
    assert [group.identity for group in other] == [group.identity for group in reversed(one)]
    assert [group.orientation for group in other] == [turned[group.orientation] for group in reversed(one)]


def test_a_vehicle_runs_over_real_groups() -> None:
    """Eight real groups of one track, up to 664 m apart: each one is a reference, nothing is missed, nothing is wrong."""
    line = read_balise_table(data_file("balises/Baliselocations-V2.xlsx")).line
    groups = along(line, "Bkl-Hmla spoor 711")[0]
    config = BaliseConfig(tolerance_mm=60_000)
    stream = simulate(
        config, seed=1, legs=[Leg(33_000, 80)], groups=groups, missed=0, foreign=0.01, national_accuracy_mm=3_000
    )
    trace = run(on_board(config), [board_only(record) for record in stream])
    verdicts = Counter(label(trace, "telegram", index) for index in range(len(trace.steps)))
    assert (verdicts["CANDIDATE"], verdicts["ACCEPTED"]) == (1, 7)
    assert {label(trace, "reaction", index) for index in range(len(trace.steps))} == {"NONE"}
    assert wrong(stream, trace) == []
