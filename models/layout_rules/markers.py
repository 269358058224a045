"""Rules for markers beside the track, which readers at both ends of a vehicle read: the odometry machine needs them of a line.

A marker sets the position when the leading reader passes it, and again, by the vehicle's length later, when the trailing one does. The
position is kept as far from a reading as the margin that it leaves stays within the tolerance. The margin is the machine's own, nm for nm:

    accuracy + tolerance of the length + run within the reader's latency + constant + rate x distance measured since the marker

The next reading counts at the end of its cycle only, and needs a position that is still kept then: one cycle's distance is held back for it.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, as_num, floor_div, with_unit
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM, PPM_PER_ONE
from safeloc.models.layout_rules import LayoutConfig


def longest_measured_mm(fix_error_nm: Num, layout: LayoutConfig) -> Num:
    """Return the longest distance measured since a marker with which the position is kept, mm. The rate must not be 0."""
    spare = as_num((layout.tolerance_mm - layout.odometry_constant_mm) * NM_PER_MM, NM) - fix_error_nm
    return floor_div(with_unit(spare, MM), layout.odometry_rate_ppm)


def longest_run_mm(fix_error_nm: Num, held_back_mm: Num, layout: LayoutConfig) -> Num:
    """Return the longest true run since a marker within which the position is never withdrawn, mm.

    held_back_mm  distance that has to be left to measure then: that of a cycle before a reading counts, 0 at the end of the map
    """
    too_long = longest_measured_mm(fix_error_nm, layout) + 1 - held_back_mm
    least_true = with_unit(too_long * (PPM_PER_ONE - layout.odometry_rate_ppm), NM)
    late = layout.odometry_constant_mm * NM_PER_MM + layout.readers.unsteady_nm
    return floor_div(with_unit(least_true - (late + 1), MM), NM_PER_MM)


def marker_is_near(distance_mm: Num, fix_error_nm: Num, apart_mm: Num, held_back_mm: Num, layout: LayoutConfig) -> Bool:
    """Require the position to be kept from a reading of a marker to the next one (MRK-D1, MRK-D5).

    distance_mm  run between both readings, by places on the map and the vehicle's length
    apart_mm     by how much longer it may truly be
    """
    if layout.odometry_rate_ppm == 0:
        return fix_error_nm <= (layout.tolerance_mm - layout.odometry_constant_mm) * NM_PER_MM
    return distance_mm <= longest_run_mm(fix_error_nm, held_back_mm, layout) - apart_mm


def markers_read_one_by_one(spacing_mm: Num, within_mm: Num, layout: LayoutConfig) -> Bool:
    """Require two markers on a route to be read in their order on the map, and in two cycles (MRK-1).

    A reader reports one marker a cycle, and a marker that the map has behind the last one is refused.
    within_mm  the distance from their places on the map within which both lie, added up
    """
    return within_mm + layout.readers.cycle_run_mm < spacing_mm


def markers_can_wait(under_the_vehicle: Num, layout: LayoutConfig) -> Bool:
    """Require no more markers between leading and trailing reader than can wait for the trailing one (MRK-1)."""
    return under_the_vehicle <= as_num(layout.readers.pending_markers, COUNT)
