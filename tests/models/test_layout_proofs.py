"""What the layout rules are for, proved for all lengths by z3 and again by cvc5; a looser rule does not suffice."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safeloc.language.expr import (
    Bool,
    Lit,
    Num,
    abs_,
    as_num,
    between,
    exact_to,
    floor_div,
    maximum,
    number,
    with_unit,
)
from safeloc.language.units import MM, NM, PPM, PPM_PER_ONE
from safeloc.models import layout_rules as rules
from safeloc.models.layout_rules import LayoutConfig
from tests.models.sufficient_rules import Claim, require_loose, require_sufficient

LAYOUTS = {
    "default": LayoutConfig(),
    "fine": LayoutConfig(
        tolerance_mm=10_000, odometry_constant_mm=1_000, odometry_rate_ppm=20_000, sensor_offset_mm=1_500
    ),
    "coarse": LayoutConfig(
        tolerance_mm=90_000, odometry_rate_ppm=250_000, antenna_offset_mm=7_000, map_accuracy_mm=900
    ),
}
"""Rates of one in so many: cvc5 does not decide the two roundings of others together. `test_layout_rules` tries any rate."""
REACH = 10**9


def mm(name: str, low: int = 0) -> Num:
    """A length."""
    return number(name, MM, low, REACH)


SPACING, VIEW_FROM, VIEW_TO = mm("spacing"), mm("view_from"), mm("view_to")
TRUE_MM, ESTIMATE = mm("true", -REACH), mm("estimate", -REACH)
MEASURED, FIX, OTHER, STATED = mm("measured"), mm("fix_error"), mm("other", -REACH), mm("stated")
POSITIVE = [one >= 0 for one in (SPACING, VIEW_FROM, VIEW_TO, MEASURED, FIX, STATED)]


def near(first: Num, second: Num, bound: int) -> Bool:
    """Two lengths differ by at most so much."""
    return abs_(first - second) <= bound


def kept(layout: LayoutConfig, loose: Bool) -> Claim:
    """Wherever both references are read, and however the run between is measured, its error stays 1 mm below the tolerance."""
    true, read = SPACING + OTHER, FIX + STATED
    law = exact_to(MEASURED - true - layout.odometry_constant_mm, NM) <= MEASURED * Lit(layout.odometry_rate_ppm, PPM)
    goal = rules.odometry_error_nm(MEASURED, FIX, layout) <= exact_to(as_num(layout.tolerance_mm - 1, MM), NM)
    rule = rules.stretch_is_tolerable(SPACING, FIX, read, layout)
    return Claim([law, between(-read, OTHER, read)], rule, loose, goal)


def stretch(layout: LayoutConfig) -> Claim:
    """The margin is rounded up: without that, as the rule once was, the last millimetre of error is too much."""
    spare = as_num(layout.tolerance_mm - layout.odometry_constant_mm, MM) - FIX
    unrounded = floor_div(with_unit(spare * (PPM_PER_ONE - layout.odometry_rate_ppm), MM), layout.odometry_rate_ppm)
    return kept(layout, SPACING <= unrounded - layout.odometry_constant_mm - (FIX + STATED))


def between_readings(layout: LayoutConfig) -> Claim:
    """Both readings may be off: it does not suffice to count the error of the one that gives the position."""
    return kept(layout, rules.stretch_is_tolerable(SPACING, FIX, FIX, layout))


def next_is_searched(layout: LayoutConfig) -> Claim:
    """While the next reflector is searched, by any estimate, the previous one (at 0 on the map) is out of view."""
    searching, survey = (
        ESTIMATE >= SPACING - VIEW_FROM - layout.tolerance_mm,
        between(-layout.map_accuracy_mm, OTHER, layout.map_accuracy_mm),
    )
    rule = rules.alone_in_search_window(SPACING, VIEW_FROM, VIEW_TO, layout)
    loose = VIEW_FROM - VIEW_TO + 2 * layout.tolerance_mm < SPACING
    return Claim(
        [near(ESTIMATE, TRUE_MM, layout.tolerance_mm), searching, survey], rule, loose, TRUE_MM > OTHER - VIEW_TO
    )


def previous_is_searched(layout: LayoutConfig) -> Claim:
    """While the previous reflector (at 0) is searched, by any estimate, the next one is not yet in view."""
    searching, survey = (
        ESTIMATE <= -VIEW_TO + layout.tolerance_mm,
        between(-layout.map_accuracy_mm, OTHER, layout.map_accuracy_mm),
    )
    rule = rules.alone_in_search_window(SPACING, VIEW_FROM, VIEW_TO, layout)
    loose = VIEW_FROM - VIEW_TO + 2 * layout.tolerance_mm < SPACING
    return Claim(
        [near(ESTIMATE, TRUE_MM, layout.tolerance_mm), searching, survey],
        rule,
        loose,
        TRUE_MM < SPACING + OTHER - VIEW_FROM,
    )


def separable(layout: LayoutConfig) -> Claim:
    """An echo of the one, placed by estimate and measurement, does not fall on the place of the other (at 0)."""
    placed, fix = SPACING + ESTIMATE - TRUE_MM + OTHER, layout.reflector_fix_mm
    given = [near(ESTIMATE, TRUE_MM, layout.tolerance_mm), between(-fix, OTHER, fix)]
    loose = SPACING > 2 * layout.tolerance_mm
    return Claim(given, rules.separable_by_distance(SPACING, layout), loose, abs_(placed) > layout.tolerance_mm + fix)


def windows(layout: LayoutConfig) -> Claim:
    """No place lies in the expectation windows of both groups."""
    either = layout.tolerance_mm + layout.detection_accuracy_mm
    given = [abs_(OTHER) <= FIX + either]
    rule = rules.expectation_windows_apart(SPACING, FIX, STATED, layout)
    loose = FIX + STATED + layout.tolerance_mm < SPACING
    return Claim(given, rule, loose, abs_(OTHER - SPACING) > STATED + either)


def nearest_range(layout: LayoutConfig) -> Claim:
    """In the whole view zone, no range is measured within the distance in which the radar cannot evaluate an echo."""
    given = [SPACING >= VIEW_TO, between(-layout.radar_error_mm, OTHER, layout.radar_error_mm)]
    loose = as_num(layout.radar_blind_mm, MM) <= VIEW_TO
    return Claim(
        given, rules.view_zone_in_range(VIEW_FROM, VIEW_TO, layout), loose, SPACING + OTHER >= layout.radar_blind_mm
    )


def stop(layout: LayoutConfig) -> Claim:
    """Stopped anywhere in the window, and wherever the survey left the reflector, the radar has it in view."""
    before, after, survey = mm("before"), mm("after"), layout.map_accuracy_mm
    seen = SPACING - OTHER + TRUE_MM + layout.sensor_offset_mm
    given = [before >= 0, after >= 0, between(-before, OTHER, after), between(-survey, TRUE_MM, survey)]
    rule = rules.stop_reflector_in_view(SPACING, before, after, VIEW_FROM, VIEW_TO, layout)
    loose = rules.stop_reflector_in_view(SPACING, as_num(0, MM), after, VIEW_FROM, VIEW_TO, layout)
    return Claim(given, rule, loose, between(VIEW_TO, seen, VIEW_FROM))


def function_test(layout: LayoutConfig) -> Claim:
    """Wherever the balise is read and whatever the survey, the radar has the reflector in view then."""
    most = FIX + layout.map_accuracy_mm
    seen = SPACING + OTHER - (layout.antenna_offset_mm - layout.sensor_offset_mm)
    rule = rules.reference_measurement_possible(SPACING, FIX, VIEW_FROM, VIEW_TO, layout)
    loose = between(VIEW_TO, SPACING, VIEW_FROM)
    return Claim([between(-most, OTHER, most)], rule, loose, between(VIEW_TO, seen, VIEW_FROM))


def search_start(layout: LayoutConfig) -> Claim:
    """When the view zone begins, the telegram has let the search begin, by any estimate of the way since the balise."""
    begins, survey = TRUE_MM >= SPACING + OTHER - VIEW_FROM, layout.map_accuracy_mm
    given = [between(-survey, OTHER, survey), near(ESTIMATE, TRUE_MM, layout.tolerance_mm), begins, ESTIMATE >= 0]
    rule = rules.search_starts_in_time(STATED, SPACING, VIEW_FROM, layout)
    loose = STATED <= maximum(SPACING - VIEW_FROM - layout.tolerance_mm, as_num(0, MM))
    return Claim(given, rule, loose, ESTIMATE >= STATED)


def edge(layout: LayoutConfig) -> Claim:
    """A vehicle that ran over the end of its edge (at 0) in a cycle is still on the next one, whatever it ran beyond."""
    run = [between(-layout.cycle_run_mm, OTHER, 0), TRUE_MM - OTHER <= layout.cycle_run_mm]
    rule = rules.edge_outlasts_a_cycle(SPACING, layout)
    return Claim(run, rule, 2 * SPACING >= layout.cycle_run_mm, TRUE_MM <= SPACING)


def group(layout: LayoutConfig) -> Claim:
    """When a group (its last balise at 0) has been read, up to a cycle late, the front end is not beyond the joint."""
    off = layout.detection_accuracy_mm + layout.map_accuracy_mm
    run = TRUE_MM - OTHER - layout.antenna_offset_mm
    rule = rules.group_tells_its_edge(SPACING, layout)
    given = [between(-off, OTHER, off), between(0, run, layout.cycle_run_mm)]
    return Claim(given, rule, SPACING >= layout.antenna_offset_mm + off, TRUE_MM <= SPACING)


CLAIMS: dict[str, Callable[[LayoutConfig], Claim]] = {
    claim.__name__: claim
    for claim in (
        stretch,
        between_readings,
        next_is_searched,
        previous_is_searched,
        separable,
        windows,
        nearest_range,
        stop,
        function_test,
        search_start,
        edge,
        group,
    )
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", CLAIMS)
def test_the_rule_suffices(name: str, layout: str) -> None:
    """For every length: proved by z3, confirmed by cvc5; the rule itself can be kept."""
    claim = CLAIMS[name](LAYOUTS[layout])
    require_sufficient(name, POSITIVE, claim)


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", CLAIMS)
def test_a_looser_rule_does_not_suffice(name: str, layout: str) -> None:
    """With the obvious but looser rule there is a counterexample."""
    claim = CLAIMS[name](LAYOUTS[layout])
    require_loose(name, POSITIVE, claim)
