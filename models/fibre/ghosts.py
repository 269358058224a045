"""What no detector reads: where the end of the train really is, which section it really passes, and what was really told."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import BoolVar, Lit, NumVar, boolean, choice, enumeration, number
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM


@dataclass(frozen=True, eq=False)
class Ghosts:
    """The world's variables.

    truth, step    where the end is, and what it really runs in the cycle, nm
    edge, spot     the section's edge that was passed last, and, freely chosen, the one that is seen in this cycle, nm
    count          sections really below the end; next_count: freely chosen, after the cycle
    real           the section being passed is one of the line, not a false change; next_real: freely chosen
    band           the amplitude as it was told last: normal, or changed by a section
    upwards        the last run that was told and was not zero was upwards
    unheard        what the end was told to have run since the amplitude was last told, and what that may be wrong by, nm
    wrong          what the run told since the last edge, or a reference, may be wrong by, nm
    of_map         the section being passed is of the kind that the map told, and was entered where the map has its edge
    far, long      where the map has its other edge, and whether it is a long one by the map
    ahead_by       by how many the sections really below were more than those that the map was asked with, at its entry
    """

    truth: NumVar
    step: NumVar
    edge: NumVar
    spot: NumVar
    count: NumVar
    next_count: NumVar
    real: BoolVar
    next_real: BoolVar
    band: NumVar
    upwards: BoolVar
    unheard: NumVar
    wrong: NumVar
    of_map: BoolVar
    far: NumVar
    long: BoolVar
    ahead_by: NumVar


def ghosts(
    declared: Declared, bands: tuple[Lit, ...], places_mm: int, farthest_mm: int, sections: int, tolerance_mm: int
) -> Ghosts:
    """Fresh variables: of a line with places up to `places_mm` and so many sections, and runs of a cycle up to `farthest_mm`.

    Of `bands` the first one is told first: the normal amplitude.
    """
    line, step = 8 * places_mm * NM_PER_MM, 2 * farthest_mm * NM_PER_MM
    unheard, wrong = tolerance_mm * NM_PER_MM, 2 * (tolerance_mm + farthest_mm) * NM_PER_MM
    return Ghosts(
        truth=declared.ghost(number("truth_nm", NM, -line, line), first=ANY),
        step=declared.choice(number("true_run_nm", NM, -step, step)),
        edge=declared.ghost(number("true_edge_nm", NM, -line, line), first=ANY),
        spot=declared.choice(number("next_true_edge_nm", NM, -line, line)),
        count=declared.ghost(number("true_count", COUNT, -2 * sections, 2 * sections), first=ANY),
        next_count=declared.choice(number("next_true_count", COUNT, -2 * sections, 2 * sections)),
        real=declared.ghost(boolean("section_is_real"), first=ANY),
        next_real=declared.choice(boolean("next_section_is_real")),
        band=declared.ghost(choice("band_last_told", enumeration(bands)), first=bands[0]),
        upwards=declared.ghost(boolean("ran_upwards"), first=True),
        unheard=declared.ghost(number("told_unheard_nm", NM, 0, unheard), first=unheard),
        wrong=declared.ghost(number("told_run_error_nm", NM, 0, wrong), first=wrong),
        of_map=declared.ghost(boolean("section_is_the_maps"), first=False),
        far=declared.ghost(number("told_far_mm", MM, -places_mm, places_mm), first=0),
        long=declared.ghost(boolean("told_long"), first=False),
        ahead_by=declared.ghost(number("ahead_by", COUNT, -3 * sections, 3 * sections), first=0),
    )
