"""Each rule of the layout, on both sides of its bound, and why the bound is where it is."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from safeloc.language.expr import FALSE, TRUE, Bool, Num, as_num
from safeloc.language.interpret import evaluate
from safeloc.language.units import COUNT, MM, PPM_PER_ONE
from safeloc.models import layout_rules as rules
from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.occupied_track import OccupiedTrackConfig

LAYOUT = LayoutConfig()
OFFSET = LayoutConfig(sensor_offset_mm=2_000, antenna_offset_mm=5_000)
_OF_COUNTS = (
    rules.reflector_follows_balise, rules.routes_distinguishable, rules.sections_give_the_place, rules.near_sections_differ,
    rules.code_withstands_an_error, rules.joint_has_two_ways,
)  # fmt: skip
UNIT = dict.fromkeys(_OF_COUNTS, COUNT)
Rule = Callable[..., Bool]


def holds(rule: Rule, *figures: int | bool, layout: LayoutConfig = LAYOUT) -> bool:
    """The rule for these figures, lengths in mm."""
    return bool(evaluate([rule(*(_term(rule, figure) for figure in figures), layout)], {})[0])


def _term(rule: Rule, figure: int | bool) -> Num | Bool:
    if isinstance(figure, bool):
        return TRUE if figure else FALSE
    return as_num(figure, UNIT.get(rule, MM))


BOUNDS: dict[str, tuple[Rule, tuple[int | bool, ...], tuple[int | bool, ...], LayoutConfig]] = {
    "stretch": (rules.stretch_is_tolerable, (469_981, 0, 0), (469_982, 0, 0), LAYOUT),
    "sections of a word": (rules.sections_give_the_place, (5,), (6,), LAYOUT),
    "alike sections": (rules.near_sections_differ, (3,), (2,), LAYOUT),
    "no reading misleads": (rules.code_withstands_an_error, (0,), (1,), LAYOUT),
    "a short section, too short": (rules.section_is_short_or_long, (150_000,), (149_999,), LAYOUT),
    "a short section, too long": (rules.section_is_short_or_long, (154_500,), (154_501,), LAYOUT),
    "a long section": (rules.section_is_short_or_long, (412_000,), (411_999,), LAYOUT),
    "stretch after a coarse fix": (rules.stretch_is_tolerable, (222_981, 13_000, 0), (222_982, 13_000, 0), LAYOUT),
    "stretch between groups": (rules.stretch_is_tolerable, (442_681, 1_300, 2_600), (442_682, 1_300, 2_600), LAYOUT),
    "reflectors since balise": (rules.reflector_follows_balise, (8,), (9,), LAYOUT),
    "reference distance, longer": (rules.reference_distance_agrees, (80_050, 80_000), (80_051, 80_000), LAYOUT),
    "reference distance, shorter": (rules.reference_distance_agrees, (79_950, 80_000), (79_949, 80_000), LAYOUT),
    "function test, far": (
        rules.reference_measurement_possible,
        (98_650, 1_300, 100_000, 3_000),
        (98_651, 1_300, 100_000, 3_000),
        LAYOUT,
    ),
    "function test, near": (
        rules.reference_measurement_possible,
        (4_350, 1_300, 100_000, 3_000),
        (4_349, 1_300, 100_000, 3_000),
        LAYOUT,
    ),
    "function test, antenna behind the radar": (
        rules.reference_measurement_possible,
        (7_350, 1_300, 100_000, 3_000),
        (7_349, 1_300, 100_000, 3_000),
        OFFSET,
    ),
    "search start": (rules.search_starts_in_time, (69_950, 200_000, 100_000), (69_951, 200_000, 100_000), LAYOUT),
    "search start at the balise": (rules.search_starts_in_time, (0, 80_000, 100_000), (1, 80_000, 100_000), LAYOUT),
    "view zone, far": (rules.view_zone_in_range, (150_000, 3_000), (150_001, 3_000), LAYOUT),
    "view zone, near": (rules.view_zone_in_range, (100_000, 2_200), (100_000, 2_199), LAYOUT),
    "search window": (
        rules.alone_in_search_window,
        (157_051, 100_000, 3_000),
        (157_050, 100_000, 3_000),
        LAYOUT,
    ),
    "distance": (rules.separable_by_distance, (60_501,), (60_500,), LAYOUT),
    "neighbours": (rules.distinguishable, (True, 157_051, 100_000, 3_000), (True, 157_050, 100_000, 3_000), LAYOUT),
    "neighbours, overlapping": (
        rules.distinguishable,
        (True, 60_501, 100_000, 3_000),
        (True, 60_500, 100_000, 3_000),
        LAYOUT,
    ),
    "neighbours, models": (rules.distinguishable, (False, 1, 100_000, 3_000), (True, 1, 100_000, 3_000), LAYOUT),
    "across tracks": (rules.distinguishable_across_tracks, (True, 60_501), (True, 60_500), LAYOUT),
    "branches": (rules.branch_models_differ, (False,), (True,), LAYOUT),
    "switch in view, far": (rules.switch_in_view, (98_000, 100_000, 3_000), (98_001, 100_000, 3_000), OFFSET),
    "switch in view, near": (rules.switch_in_view, (1_000, 100_000, 3_000), (999, 100_000, 3_000), OFFSET),
    "direction": (rules.direction_shows, (False,), (True,), LAYOUT),
    "routes": (rules.routes_distinguishable, (1,), (0,), LAYOUT),
    "edge": (rules.edge_outlasts_a_cycle, (10_000,), (9_999,), LAYOUT),
    "ways at a joint": (rules.joint_has_two_ways, (2,), (3,), LAYOUT),
    "group before a joint": (rules.group_tells_its_edge, (5_495,), (5_494,), LAYOUT),
    "group before a joint, antenna": (rules.group_tells_its_edge, (10_495,), (10_494,), OFFSET),
    "balise windows": (rules.expectation_windows_apart, (74_001, 12_000, 0), (74_000, 12_000, 0), LAYOUT),
    "stop view, far": (
        rules.stop_reflector_in_view,
        (97_500, 450, 450, 100_000, 3_000),
        (97_501, 450, 450, 100_000, 3_000),
        OFFSET,
    ),
    "stop view, near": (
        rules.stop_reflector_in_view,
        (1_500, 450, 450, 100_000, 3_000),
        (1_499, 450, 450, 100_000, 3_000),
        OFFSET,
    ),
    "standstill": (rules.standstill_distance_agrees, (8_050, 8_000), (8_051, 8_000), LAYOUT),
    "stop window, narrow before": (rules.stop_window_fits, (400, 500), (399, 500), LAYOUT),
    "stop window, narrow after": (rules.stop_window_fits, (500, 400), (500, 399), LAYOUT),
    "stop window, wide before": (rules.stop_window_fits, (500, 500), (501, 500), LAYOUT),
    "stop window, wide after": (rules.stop_window_fits, (500, 500), (500, 501), LAYOUT),
}
PLAIN = (rules.code_withstands_an_error, rules.joint_has_two_ways, rules.branch_models_differ, rules.direction_shows)


@pytest.mark.parametrize("bound", BOUNDS)
def test_rules_hold_to_the_millimetre(bound: str) -> None:
    """The last figure that is allowed, and the first that is not."""
    rule, good, bad, layout = BOUNDS[bound]
    if rule in PLAIN:
        assert (True, False) == tuple(bool(evaluate([rule(_term(rule, one[0]))], {})[0]) for one in (good, bad))
        return
    assert holds(rule, *good, layout=layout)
    assert not holds(rule, *bad, layout=layout)


def error_nm(measured: int, fix: int, layout: LayoutConfig) -> int:
    """The added error after a measured distance."""
    return int(evaluate([rules.odometry_error_nm(as_num(measured, MM), as_num(fix, MM), layout)], {})[0])


def test_the_specified_odometry_uses_up_30_m_in_500_m() -> None:
    """SUBSET-041: 5 m + 5 % of 500 m measured are 30 m; 10 m are used up after 100 m, 7.5 m after 50 m."""
    assert [30_000, 10_000, 7_500] == [error_nm(s, 0, LAYOUT) // 10**6 for s in (500_000, 100_000, 50_000)]


@st.composite
def layouts(draw: st.DrawFn) -> tuple[LayoutConfig, int]:
    """Odometry of all kinds, and the error of a fix that leaves some tolerance."""
    constant = draw(st.sampled_from([0, 1, 5_000]) | st.integers(0, 20_000))
    rate = draw(st.sampled_from([1, 50_000, 900_000]) | st.integers(1, 900_000))
    tolerance = draw(st.integers(constant + 1, 100_000))
    fix = draw(st.integers(0, tolerance - constant - 1))
    return LayoutConfig(tolerance_mm=tolerance, odometry_constant_mm=constant, odometry_rate_ppm=rate), fix


def worst_measured(true_mm: int, layout: LayoutConfig) -> int:
    """The greatest distance that the law lets a true one be measured as: m - true <= constant + rate m."""
    scale = PPM_PER_ONE
    return (true_mm + layout.odometry_constant_mm) * scale // (scale - layout.odometry_rate_ppm)


@given(layouts())
def test_the_longest_stretch_is_safe_and_no_shorter_than_need_be(figures: tuple[LayoutConfig, int]) -> None:
    """However it is measured, its error stays 1 mm below the tolerance; 1 mm farther, or within that, some measurement's does not."""
    layout, fix = figures
    longest = int(evaluate([rules.longest_stretch_mm(as_num(fix, MM), layout)], {})[0])
    kept_nm = (layout.tolerance_mm - 1) * 10**6
    if longest >= 0:
        assert error_nm(worst_measured(longest, layout), fix, layout) <= kept_nm
    if longest >= -1:
        assert error_nm(worst_measured(longest + 1, layout), fix, layout) > kept_nm


def test_perfect_odometry_knows_no_longest_stretch() -> None:
    """Where nothing grows, only the fix and the constant have to fit."""
    layout = LayoutConfig(odometry_rate_ppm=0)
    assert holds(rules.stretch_is_tolerable, 10**9, 24_999, 0, layout=layout)
    assert not holds(rules.stretch_is_tolerable, 0, 25_000, 0, layout=layout)


WITHIN = st.sampled_from([-30_000, -29_999, 0, 29_999, 30_000]) | st.integers(-30_000, 30_000)


@given(st.integers(0, 300_000), st.integers(4_000, 100_000), st.integers(0, 3_999), WITHIN, st.integers(0, 400_000))
def test_a_search_window_holds_one_reflector(spacing: int, view: int, end: int, off: int, ahead: int) -> None:
    """Where the rule holds, the previous reflector is out of view whenever the next one is searched, by any estimate."""
    if not holds(rules.alone_in_search_window, spacing, view, end):
        return
    search_opens = spacing - view - LAYOUT.tolerance_mm  # by estimate, counted from the previous reflector
    truth = search_opens + ahead + off
    assert truth > -end


@given(st.integers(0, 200_000), WITHIN, st.integers(-250, 250), st.integers(-250, 250))
def test_separable_echoes_fit_one_place(spacing: int, off: int, measured: int, gate: int) -> None:
    """Where the rule holds, an echo of the one never falls on the place of the other, within both errors."""
    if holds(rules.separable_by_distance, spacing):
        echo = spacing + off + measured
        assert abs(echo) > LAYOUT.tolerance_mm + gate


def test_told_apart_on_a_route_is_told_apart_across_tracks() -> None:
    """The rule for one route is the stricter one, for every spacing."""
    for spacing in range(0, 200_000, 500):
        if holds(rules.distinguishable, True, spacing, 100_000, 3_000):
            assert holds(rules.distinguishable_across_tracks, True, spacing)


def test_tolerance_must_leave_room() -> None:
    """A tolerance at or below the constant cannot be kept by any distance."""
    with pytest.raises(
        ValidationError, match="is not above odometry_constant_mm 5000: no distance can be run within it"
    ):
        LayoutConfig(tolerance_mm=5_000)


def test_an_edge_must_outlast_a_cycle() -> None:
    """Otherwise a vehicle passes a whole edge within a cycle, which the occupied track cannot follow."""
    with pytest.raises(
        ValidationError, match="shortest_edge_mm 4000 is below cycle_run_mm 4445: the vehicle could pass"
    ):
        LayoutConfig(shortest_edge_mm=4_000)


def test_the_figures_are_those_of_the_occupied_track() -> None:
    """The audit's defaults are what the machine is proved with."""
    machine = OccupiedTrackConfig()
    assert machine.shortest_edge_mm == LAYOUT.shortest_edge_mm
    assert -(-machine.max_speed_mm_s * machine.period_ms // 1_000) == LAYOUT.cycle_run_mm


def test_figures_carry_unit_and_source() -> None:
    """Every figure says in what it is measured and where it comes from."""
    told = {name: field.json_schema_extra for name, field in LayoutConfig.model_fields.items()}
    assert all(isinstance(extra, dict) and {"unit", "source"} <= set(extra) for extra in told.values())


def test_national_value_stands_in_for_linking() -> None:
    """Location accuracy: as linking says, else the national value; detection is added (SUBSET-026 3.6.4.2.3)."""
    assert (1_300, 13_000) == (LAYOUT.balise_fix_mm(300), LAYOUT.balise_fix_mm(None))
