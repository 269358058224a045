"""Layout rules: the proofs assume them of a line, and the audit checks them on the user's map.

Each rule is one function from lengths to a truth-valued term. A machine calls it with its symbolic map inputs and assumes
the term; the audit calls it with variables and evaluates the term on the figures of the map. There is no second copy.
Lengths are mm along the track in direction of travel; comparisons read `actual <= required` or `actual < required`.

    layout = LayoutConfig()
    assumption = distinguishable(same_model, spacing_mm, next_view_from_mm, previous_view_to_mm, layout)
"""

from __future__ import annotations

from math import gcd

from pydantic import Field, model_validator

from safeloc.config import Config, quantity
from safeloc.language.expr import (
    Bool,
    Lit,
    Num,
    abs_,
    all_of,
    as_num,
    between,
    exact_to,
    floor_div,
    maximum,
    with_unit,
)
from safeloc.language.units import COUNT, MM, NM, PPM, PPM_PER_ONE
from safeloc.models.layout_rules.marker_readers import MarkerReaders

_ROUNDING_MM = 1
"""By so much the machines keep their error below the tolerance, since margins are reported in whole mm, rounded up."""


class LayoutConfig(Config):
    """Figures of vehicle and sensors that the layout of a line has to suit."""

    tolerance_mm: int = quantity(30_000, "mm", 1, 500_000, "[S] OCORA 7239: 30 m on main line, 10 m in nodes")
    odometry_constant_mm: int = quantity(5_000, "mm", 0, 100_000, "[S] SUBSET-041: 5 m")
    odometry_rate_ppm: int = quantity(50_000, "ppm of measured distance", 0, 900_000, "[S] SUBSET-041: 5 %")
    balise_accuracy_mm: int = quantity(12_000, "mm", 0, 63_000, "[M] Q_NVLOCACC 12 m, for groups without an own figure")
    detection_accuracy_mm: int = quantity(1_000, "mm", 0, 10_000, "[S] openETCS: D_tol = Q_LOCACC + 1 m")
    radar_error_mm: int = quantity(200, "mm", 0, 300_000, "[M] FMCW, 1 GHz: 0.15 m, and surveying")
    radar_range_mm: int = quantity(150_000, "mm", 1_000, 10_000_000, "[M] minimum intensity up to 100 to 200 m")
    radar_blind_mm: int = quantity(2_000, "mm", 0, 100_000, "[M] nearer, an echo cannot be evaluated (source l. 209)")
    map_accuracy_mm: int = quantity(50, "mm", 0, 10_000, "[M] surveying of one place against another")
    antenna_offset_mm: int = quantity(0, "mm behind the front", 0, 500_000, "[D] none: balise antenna at the front end")
    sensor_offset_mm: int = quantity(0, "mm behind the front", 0, 500_000, "[D] none: radar at the front end")
    stop_window_mm: int = quantity(500, "mm", 1, 10_000, "[S] OCORA 7241: stop +- 0.50 m")
    stop_control_error_mm: int = quantity(150, "mm", 0, 10_000, "[M] what the brake control leaves")
    reflectors_per_balise: int = quantity(8, "count", 1, 1_000, "[M] source l. 111: 'after several reflectors'")
    route_faults_withstood: int = quantity(0, "count", 0, 100, "[D] 0: any two routes differ in what is seen on them")
    code_window: int = quantity(
        5, "sections", 2, 20, "[D] that of the fibre machine: sections whose symbols give the place"
    )
    code_reach: int = quantity(2, "sections", 1, 10, "[D] that of the fibre machine: so near, no two are alike")
    short_section_mm: int = quantity(150_000, "mm", 1_000, 1_000_000, "[D] that of the fibre machine")
    long_section_mm: int = quantity(400_000, "mm", 2_000, 10_000_000, "[D] that of the fibre machine")
    cable_slack_ppm: int = quantity(
        30_000, "ppm of track", 0, 1_000_000, "[M] a cable is 1 to 3 % longer than its track"
    )
    tells_track: bool = Field(
        default=False,
        description="the vehicle tells its track by the machine `occupied_track`, so that the map has to suit this machine too",
        json_schema_extra={"unit": "yes or no", "source": "[D] no: most vehicles tell a place on the line only"},
    )
    shortest_edge_mm: int = quantity(
        10_000, "mm", 1, 1_000_000, "[D] that of the occupied track: between two switches, or a switch and a crossing"
    )
    cycle_run_mm: int = quantity(4_445, "mm", 1, 1_000_000, "[D] that of the occupied track: 160 km/h for 100 ms")
    markers: MarkerReaders | None = Field(
        default=None,
        description="figures of the marker readers of a vehicle that the machine `odometry` locates; None: it has none",
        json_schema_extra={"unit": "table", "source": "[D] none: most vehicles read balises at one end only"},
    )
    prescribed_distance_mm: int | None = Field(
        default=None,
        gt=0,
        le=10_000_000,
        json_schema_extra={
            "unit": "mm",
            "source": "source l. 205: may be a variable of the system; None: the map says",
        },
    )

    @model_validator(mode="after")
    def _can_locate(self) -> LayoutConfig:
        if self.odometry_constant_mm >= self.tolerance_mm:
            raise ValueError(
                f"tolerance_mm {self.tolerance_mm} is not above odometry_constant_mm {self.odometry_constant_mm}: no "
                "distance can be run within it; raise the tolerance or use better odometry."
            )
        if self.shortest_edge_mm < self.cycle_run_mm:
            raise ValueError(
                f"shortest_edge_mm {self.shortest_edge_mm} is below cycle_run_mm {self.cycle_run_mm}: the vehicle could pass a whole "
                "edge within a cycle, unseen; raise it."
            )
        return self

    @property
    def readers(self) -> MarkerReaders:
        """The figures of the marker readers, or the defaults of a vehicle that has none."""
        return self.markers or MarkerReaders()

    @property
    def reflector_fix_mm(self) -> int:
        """Error of a position taken from a reflector, mm."""
        return self.radar_error_mm + self.map_accuracy_mm

    def balise_fix_mm(self, location_accuracy_mm: int | None) -> int:
        """Return the error of a position taken from a balise group, mm; by the national value if linking gives none."""
        own = self.balise_accuracy_mm if location_accuracy_mm is None else location_accuracy_mm
        return own + self.detection_accuracy_mm


# ------------------------------------------------------------------ odometry zone (RFL-D1)


def odometry_error_nm(measured_mm: Num, fix_error_mm: Num, layout: LayoutConfig) -> Num:
    """Return the error after a measured distance since a fix, nm: fix + constant + rate x distance, exact."""
    start = exact_to(fix_error_mm + layout.odometry_constant_mm, NM)
    return start + measured_mm * Lit(layout.odometry_rate_ppm, PPM)


def longest_measured_mm(fix_error_mm: Num, layout: LayoutConfig) -> Num:
    """Return the longest measured distance after a fix at which the machines keep their position, mm.

    They report margins rounded up to whole mm beside a place in whole mm; the error is therefore kept 1 mm below the tolerance
    (`Interval.usable`). The rate must not be 0, where no distance is too long.
    """
    spare = as_num(layout.tolerance_mm - _ROUNDING_MM - layout.odometry_constant_mm, MM) - fix_error_mm
    rate, one = _lowest_terms(layout.odometry_rate_ppm)
    return floor_div(with_unit(spare * one, MM), rate)


def _lowest_terms(rate_ppm: int) -> tuple[int, int]:
    """Return numerator and denominator of a rate in lowest terms, with which solvers fare better."""
    common = gcd(rate_ppm, PPM_PER_ONE)
    return rate_ppm // common, PPM_PER_ONE // common


def longest_stretch_mm(fix_error_mm: Num, layout: LayoutConfig) -> Num:
    """Return the longest true distance after a fix within which the machines never withdraw their position, mm.

    The error bound grows with the measured distance, and that may exceed the true one by the law itself:
    measured x (1 - rate) <= true + constant. The first measured distance that is too long bounds the true one from above.
    """
    too_long, (rate, one) = longest_measured_mm(fix_error_mm, layout) + 1, _lowest_terms(layout.odometry_rate_ppm)
    return floor_div(with_unit(too_long * (one - rate), MM) - 1, one) - layout.odometry_constant_mm


def stretch_is_tolerable(distance_mm: Num, fix_error_mm: Num, apart_mm: Num, layout: LayoutConfig) -> Bool:
    """Require the position to be kept from a fix to the next reference (RFL-D1; source l. 217, 235, 300).

    distance_mm  from where the one is read to where the other is, by their places on the map
    apart_mm     by how much farther apart the readings may truly be: each reference is read within its own error
    """
    if layout.odometry_rate_ppm == 0:
        return fix_error_mm <= layout.tolerance_mm - _ROUNDING_MM - layout.odometry_constant_mm
    return distance_mm <= longest_stretch_mm(fix_error_mm, layout) - apart_mm


# ------------------------------------------------------------------ balise and reflector (RFL-6, RFL-7, RFL-8, RFL-9)


def reflector_follows_balise(reflectors_since_balise: Num, layout: LayoutConfig) -> Bool:
    """Require a balise before a reflector, at most so many reflectors earlier (RFL-7; self-test, source l. 111)."""
    return reflectors_since_balise <= layout.reflectors_per_balise


def reference_distance_agrees(stated_mm: Num, map_distance_mm: Num, layout: LayoutConfig) -> Bool:
    """Require the telegram, or the variable of the system, to give the map's distance from balise to reflector (RFL-8, RFL-9)."""
    return abs_(stated_mm - map_distance_mm) <= layout.map_accuracy_mm


def reference_measurement_possible(
    distance_mm: Num, read_within_mm: Num, view_from_mm: Num, view_to_mm: Num, layout: LayoutConfig
) -> Bool:
    """Require the reflector to be in view over the balise, so that the self-test is possible (RFL-6).

    read_within_mm  the distance from its place on the map within which the balise is read
    """
    seen = distance_mm - (layout.antenna_offset_mm - layout.sensor_offset_mm)
    allowance = read_within_mm + layout.map_accuracy_mm
    return (seen + allowance <= view_from_mm) & (view_to_mm + allowance <= seen)


def search_starts_in_time(search_from_mm: Num, distance_mm: Num, view_from_mm: Num, layout: LayoutConfig) -> Bool:
    """Require the search to begin the tolerable error, and that of the survey, before the view zone, or at the balise (RFL-9)."""
    return search_from_mm <= maximum(distance_mm - view_from_mm - layout.tolerance_mm - layout.map_accuracy_mm, 0)


def view_zone_in_range(view_from_mm: Num, view_to_mm: Num, layout: LayoutConfig) -> Bool:
    """Require the radar to have the minimum intensity in the whole view zone, and never to measure too near (RFL-1; source l. 95, 209)."""
    nearest = as_num(layout.radar_blind_mm + layout.radar_error_mm, MM)
    return (view_from_mm <= layout.radar_range_mm) & (nearest <= view_to_mm)


# ------------------------------------------------------------------ neighbours (RFL-8, RFL-10)


def _zones_overlap(spacing_mm: Num, next_view_from_mm: Num, previous_view_to_mm: Num) -> Bool:
    """Return whether the next reflector comes into view before the previous one leaves it."""
    return spacing_mm <= next_view_from_mm - previous_view_to_mm


def alone_in_search_window(
    spacing_mm: Num, next_view_from_mm: Num, previous_view_to_mm: Num, layout: LayoutConfig
) -> Bool:
    """Require one of two neighbours to be out of view while the other is searched (RFL-8; source l. 151, 235).

    The search begins at an estimate the tolerable error before the view zone; truly up to that error earlier still.
    The window of the next reflector, from there to its end, is narrower than the spacing; so is the previous one's. The
    other one may stand nearer than the map has it, by the survey's accuracy.
    """
    window = next_view_from_mm - previous_view_to_mm + 2 * layout.tolerance_mm + layout.map_accuracy_mm
    return window < spacing_mm


def separable_by_distance(spacing_mm: Num, layout: LayoutConfig) -> Bool:
    """Require two places to differ by more than both errors, so that two echoes cannot fit one place on the map (source l. 217)."""
    errors = 2 * (layout.tolerance_mm + layout.reflector_fix_mm)
    return as_num(errors, MM) < spacing_mm


def distinguishable(
    same_model: Bool, spacing_mm: Num, next_view_from_mm: Num, previous_view_to_mm: Num, layout: LayoutConfig
) -> Bool:
    """Require that no echo of one of two neighbours on a route can be taken for the other's (RFL-8, RFL-10).

    Their models differ; or they are separable by distance and, with an odometry zone between their view zones, the search
    window holds only one of them.
    """
    overlap = _zones_overlap(spacing_mm, next_view_from_mm, previous_view_to_mm)
    alone = alone_in_search_window(spacing_mm, next_view_from_mm, previous_view_to_mm, layout)
    return distinguishable_across_tracks(same_model, spacing_mm, layout) & (~same_model | overlap | alone)


def distinguishable_across_tracks(same_model: Bool, spacing_mm: Num, layout: LayoutConfig) -> Bool:
    """Require two reflectors beside different tracks to differ in model or to be separable by distance (RFL-10)."""
    return ~same_model | separable_by_distance(spacing_mm, layout)


# ------------------------------------------------------------------ switches and direction (RFL-11, RFL-12, RFL-D5)


def branch_models_differ(same_model: Bool) -> Bool:
    """Require different models of the first reflectors on the two branches of a switch (RFL-11)."""
    return ~same_model


def switch_in_view(distance_mm: Num, view_from_mm: Num, view_to_mm: Num, layout: LayoutConfig) -> Bool:
    """Require the reflector behind a switch to be in view over the switch, so that turning off shows (RFL-12; source l. 296)."""
    return between(view_to_mm, distance_mm + layout.sensor_offset_mm, view_from_mm)


def direction_shows(same_model: Bool) -> Bool:
    """Require different models before and after a balise, so that their order tells the direction (RFL-D5)."""
    return ~same_model


def routes_distinguishable(faults_to_confuse: Num, layout: LayoutConfig) -> Bool:
    """Require that one route looks like another only with more missed or misread reflectors than have to be tolerated (RFL-D6)."""
    return as_num(layout.route_faults_withstood, COUNT) < faults_to_confuse


# ------------------------------------------------------------------ edges of the map (RFL-D6)


def edge_outlasts_a_cycle(length_mm: Num, layout: LayoutConfig) -> Bool:
    """Require no edge to be shorter than the occupied track takes, so that no vehicle passes two joints in a cycle."""
    return as_num(layout.shortest_edge_mm, MM) <= length_mm


def joint_has_two_ways(ways: Num) -> Bool:
    """Require at most two edges on which a vehicle may go on; a three-way switch is two switches."""
    return ways <= 2


def group_tells_its_edge(to_joint_mm: Num, layout: LayoutConfig) -> Bool:
    """Require the front end to be still on a balise group's edge when the group has been read, up to a cycle late.

    to_joint_mm  from the last balise of the group, in direction of travel, to the end of its edge
    """
    read = layout.antenna_offset_mm + layout.detection_accuracy_mm + layout.map_accuracy_mm
    return as_num(read + layout.cycle_run_mm, MM) <= to_joint_mm


# ------------------------------------------------------------------ balises (RFL-D4)


def expectation_windows_apart(
    spacing_mm: Num, first_accuracy_mm: Num, second_accuracy_mm: Num, layout: LayoutConfig
) -> Bool:
    """Require the expectation windows of two successive linked groups to have no place in common (SUBSET-026 3.4.4.4.5).

    A window reaches the tolerable error, the group's location accuracy and the detection accuracy to either side.
    """
    either = 2 * (layout.tolerance_mm + layout.detection_accuracy_mm)
    return first_accuracy_mm + second_accuracy_mm + either < spacing_mm


# ------------------------------------------------------------------ stop points (RFL-D7)


def stop_reflector_in_view(
    standstill_mm: Num,
    window_before_mm: Num,
    window_after_mm: Num,
    view_from_mm: Num,
    view_to_mm: Num,
    layout: LayoutConfig,
) -> Bool:
    """Require the stop point's reflector to be in view from anywhere in the stop window, wherever the survey left it (source l. 263)."""
    seen, survey = standstill_mm + layout.sensor_offset_mm, layout.map_accuracy_mm
    return all_of([seen + window_before_mm + survey <= view_from_mm, view_to_mm + survey <= seen - window_after_mm])


def standstill_distance_agrees(stated_mm: Num, map_distance_mm: Num, layout: LayoutConfig) -> Bool:
    """Require the set distance to the reflector to be that between stop point and reflector on the map (source l. 263)."""
    return abs_(stated_mm - map_distance_mm) <= layout.map_accuracy_mm


def stop_window_fits(window_before_mm: Num, window_after_mm: Num, layout: LayoutConfig) -> Bool:
    """Require the stop window to be as narrow as doors need it, and as wide as measuring and braking can keep it (RFL-D7)."""
    least = as_num(layout.reflector_fix_mm + layout.stop_control_error_mm, MM)
    most = layout.stop_window_mm
    return all_of(
        [least <= window_before_mm, least <= window_after_mm, window_before_mm <= most, window_after_mm <= most]
    )


# ------------------------------------------------------------------ position code of a fibre (FWG-10)


def sections_give_the_place(least_window: Num, layout: LayoutConfig) -> Bool:
    """Require any `code_window` sections in a row to occur once on the fibre, read either way.

    least_window  the least number of sections of which this is true
    """
    return least_window <= layout.code_window


def near_sections_differ(apart: Num, layout: LayoutConfig) -> Bool:
    """Require the nearest section with the same symbol to be farther than the reach of the code; 1: the next one."""
    return apart > layout.code_reach


def section_is_short_or_long(cable_mm: Num, layout: LayoutConfig) -> Bool:
    """Require a piece of cable that lies along a short section, or along at least a long one, with any slack."""
    short, long = layout.short_section_mm, layout.long_section_mm
    slack = PPM_PER_ONE + layout.cable_slack_ppm
    return between(short, cable_mm, short * slack // PPM_PER_ONE) | (cable_mm >= -(-long * slack // PPM_PER_ONE))


def code_withstands_an_error(misleading_readings: Num) -> Bool:
    """Require that no reading with one section missed, misread or false within a word gives another place."""
    return misleading_readings <= 0
