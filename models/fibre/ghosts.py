"""Ghosts of the fibre machine's world: the true position of the end, the section really passed, and the detector's last messages."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import BoolVar, Lit, NumVar, boolean, choice, enumeration, number
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM


@dataclass(frozen=True, eq=False)
class Ghosts:
    """The world's variables.

    truth, true_run   true position of the end, and its true run in the cycle, nm
    edge, next_true_edge     edge of the section that the end passed last; freely chosen: the edge that it sees in this cycle, nm
    count          true number of sections below the end; next_count: freely chosen, after the cycle
    real           the section being passed is one of the line, not a false change; next_real: freely chosen
    band           last amplitude: normal, or changed by a section
    upwards        the last measured run other than zero was upwards
    possible_run_since_amplitude        measured run since the last amplitude, plus its greatest error, nm
    measured_run_error          greatest error of the measured run since the last edge or reference, nm
    section_is_the_maps         the section being passed is of the kind that the map gave, and was entered where the map has its edge
    far_edge_on_map, long_on_map      other edge of that section on the map, mm; the map has it as a long one
    ahead_by       true number of sections below, less the number with which the map was asked, when the section was entered
    """

    truth: NumVar
    true_run: NumVar
    edge: NumVar
    next_true_edge: NumVar
    count: NumVar
    next_count: NumVar
    real: BoolVar
    next_real: BoolVar
    band: NumVar
    upwards: BoolVar
    possible_run_since_amplitude: NumVar
    measured_run_error: NumVar
    section_is_the_maps: BoolVar
    far_edge_on_map: NumVar
    long_on_map: BoolVar
    ahead_by: NumVar


def ghosts(
    declared: Declared, bands: tuple[Lit, ...], places_mm: int, farthest_mm: int, sections: int, tolerance_mm: int
) -> Ghosts:
    """Return fresh variables for places up to `places_mm`, `sections` sections, and runs of a cycle up to `farthest_mm`.

    The first one of `bands` is the band at the start: the normal amplitude.
    """
    line, step = 8 * places_mm * NM_PER_MM, 2 * farthest_mm * NM_PER_MM
    unheard, wrong = tolerance_mm * NM_PER_MM, 2 * (tolerance_mm + farthest_mm) * NM_PER_MM
    return Ghosts(
        truth=declared.ghost(number("truth_nm", NM, -line, line), first=ANY),
        true_run=declared.choice(number("true_run_nm", NM, -step, step)),
        edge=declared.ghost(number("true_edge_nm", NM, -line, line), first=ANY),
        next_true_edge=declared.choice(number("next_true_edge_nm", NM, -line, line)),
        count=declared.ghost(number("true_count", COUNT, -2 * sections, 2 * sections), first=ANY),
        next_count=declared.choice(number("next_true_count", COUNT, -2 * sections, 2 * sections)),
        real=declared.ghost(boolean("section_is_real"), first=ANY),
        next_real=declared.choice(boolean("next_section_is_real")),
        band=declared.ghost(choice("last_band", enumeration(bands)), first=bands[0]),
        upwards=declared.ghost(boolean("ran_upwards"), first=True),
        possible_run_since_amplitude=declared.ghost(
            number("possible_run_since_amplitude_nm", NM, 0, unheard), first=unheard
        ),
        measured_run_error=declared.ghost(number("measured_run_error_nm", NM, 0, wrong), first=wrong),
        section_is_the_maps=declared.ghost(boolean("section_is_the_maps"), first=False),
        far_edge_on_map=declared.ghost(number("far_edge_on_map_mm", MM, -places_mm, places_mm), first=0),
        long_on_map=declared.ghost(boolean("long_on_map"), first=False),
        ahead_by=declared.ghost(number("ahead_by", COUNT, -3 * sections, 3 * sections), first=0),
    )
