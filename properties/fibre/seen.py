"""Inputs of the fibre machine in a cycle, in figures of their own: edges, runs, and the map's sections (FWG-1 to FWG-15).

All terms are over the inputs of the cycle and the state before it. The error of a run counts in whole millimetres, rounded up:
"within a figure and that error" is written as a comparison in nm with one millimetre more.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import Bool, Lit, Num, abs_, all_of, any_of, before, ite, was, with_unit
from safeloc.language.machine import Machine
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.models.fibre import variables as v
from safeloc.models.fibre.variables import Parts


def followed(machine: Machine) -> Bool:
    """Return the condition that the end is followed in this cycle and was before: neither WAITING nor FAULTED."""
    waiting, _, _, faulted = machine.modes
    return all_of(mode.ne(idle) for mode in (machine.mode, before(machine.mode)) for idle in (waiting, faulted))


@dataclass(frozen=True, eq=False)
class Seen:
    """One cycle as seen by an observer who knows the source and the configuration."""

    own: Parts

    # -------------------------------------------------------------- amplitude

    @cached_property
    def rises(self) -> Bool:
        """The amplitude leaves normal upwards: a coupled or more sensitive section."""
        amplitude = self.own.amplitude
        return before(self.own.band).eq(v.NORMAL) & amplitude.present & (amplitude.value >= self.own.config.change_cdb)

    @cached_property
    def falls(self) -> Bool:
        """The amplitude leaves normal downwards: a damped or less sensitive section."""
        amplitude = self.own.amplitude
        return (
            before(self.own.band).eq(v.NORMAL) & amplitude.present & (amplitude.value + self.own.config.change_cdb <= 0)
        )

    @cached_property
    def changes(self) -> Bool:
        """The amplitude leaves normal."""
        return self.rises | self.falls

    @cached_property
    def returns(self) -> Bool:
        """The amplitude is normal again."""
        amplitude, least = self.own.amplitude, self.own.config.return_cdb
        from_above = before(self.own.band).eq(v.RAISED) & (amplitude.value <= least)
        from_below = before(self.own.band).eq(v.LOWERED) & (amplitude.value + least >= 0)
        return amplitude.present & (from_above | from_below)

    @cached_property
    def normal(self) -> Bool:
        """The amplitude is normal after the cycle."""
        return self.returns | (before(self.own.band).eq(v.NORMAL) & ~self.changes)

    # -------------------------------------------------------------- run

    @cached_property
    def forwards(self) -> Bool:
        """The end runs upwards; if it stands, or no run is measured, it ran upwards last."""
        run = self.own.run
        return (run.present & (run.value > 0)) | (was(self.own.forwards) & ~(run.present & (run.value < 0)))

    @cached_property
    def added_error_nm(self) -> Num:
        """Greatest error of the run, nm: rate and floor of a measured run, the farthest run if none was measured."""
        own, config = self.own, self.own.config
        part = with_unit(abs_(own.run.value) * config.rate_ppm, NM) + config.floor_mm * NM_PER_MM
        stands = own.run.present & own.run.value.eq(0)
        farthest = -(-config.max_speed_mm_s * config.period_ms // 1_000) * NM_PER_MM
        return ite(stands, Lit(0, NM), ite(own.run.present, part, Lit(farthest, NM)))

    @cached_property
    def wrong_nm(self) -> Num:
        """Greatest error of the run since the last edge, nm."""
        return before(self.own.drift) + self.added_error_nm

    @cached_property
    def blind_nm(self) -> Num:
        """Greatest run since the last amplitude, with this cycle's, nm."""
        measured = with_unit(ite(self.own.run.present, abs_(self.own.run.value), 0) * NM_PER_MM, NM)
        return measured + before(self.own.run_since_amplitude) + self.added_error_nm

    @cached_property
    def late(self) -> Bool:
        """The amplitude was absent for so much run that a change cannot be placed within the tolerance."""
        return before(self.own.run_since_amplitude) > self._room_nm

    @property
    def _room_nm(self) -> int:
        return (self.own.config.tolerance_mm - self.own.config.edge_tolerance_mm) * NM_PER_MM

    @cached_property
    def run(self) -> Num:
        """Run since the last edge, mm."""
        kept = before(self.own.run_since_edge)
        return ite(self.own.run.present, kept + self.own.run.value, kept)

    @cached_property
    def place(self) -> Num:
        """Place of the end by the last edge and the run, mm."""
        return before(self.own.edge) + self.run

    @cached_property
    def lost(self) -> Bool:
        """The pattern was silent for too long, or the place of the end or of an edge is no longer known within the tolerance."""
        own, config = self.own, self.own.config
        measured = own.run.present | (before(own.silent_cycles) < config.gap_limit_cycles)
        edge = (self.changes | self.returns) & self.late
        return any_of([~measured, edge, self.wrong_nm > self._room_nm, abs_(self.run) > config.position_limit_mm])

    def _within(self, off: Num, figure_mm: int) -> Bool:
        """Return the condition that `off` is within the figure and the error of the run."""
        return with_unit((abs_(off) - figure_mm - 1) * NM_PER_MM, NM) < self.wrong_nm

    def _within_edges(self, off: Num, figure_mm: int) -> Bool:
        """Return the same between two edges; the second was passed anywhere since the last amplitude."""
        return with_unit((abs_(off) - figure_mm - 1) * NM_PER_MM, NM) < self.blind_nm + self.wrong_nm

    # -------------------------------------------------------------- the section that is passed

    @cached_property
    def _inside(self) -> Num:
        return ite(was(self.own.upwards), self.run, -self.run)

    def _like(self, length_mm: int) -> Bool:
        return self._within_edges(self._inside - length_mm, 2 * self.own.config.edge_tolerance_mm)

    @cached_property
    def turned_back(self) -> Bool:
        """The end left the section where it had entered: no run, and no section so short."""
        return self._like(0) & ~self._like(self.own.config.short_mm)

    @cached_property
    def long(self) -> Bool:
        """Only a long section has this run."""
        return self._like(self.own.config.long_mm) & ~self._like(self.own.config.short_mm)

    @cached_property
    def short(self) -> Bool:
        """Only a short section has this run."""
        config = self.own.config
        return self._like(config.short_mm) & ~self._like(config.long_mm) & ~self._like(0)

    # -------------------------------------------------------------- the map's section that is met

    @cached_property
    def near(self) -> Num:
        """The edge that is met first, of the section ahead or behind, mm."""
        return ite(self.forwards, self.own.ahead.near, self.own.behind.near)

    @cached_property
    def expected(self) -> Bool:
        """The map has a section of this kind where the end may be, and its number is in range."""
        own, figure = self.own, 2 * self.own.config.edge_tolerance_mm
        known = ite(self.forwards, own.ahead.known, own.behind.known)
        raised = ite(self.forwards, own.ahead.rises, own.behind.rises)
        kind = (raised & self.rises) | (~raised & self.falls)
        return known & kind & self._within_edges(self.place - self.near, figure) & ~self.full

    @cached_property
    def one(self) -> Num:
        """One up or one down, by the direction."""
        return ite(self.forwards, Lit(1, COUNT), Lit(-1, COUNT))

    @cached_property
    def full(self) -> Bool:
        """The range of section numbers is exhausted."""
        limit = self.own.config.section_limit
        count = before(self.own.sections_counted)
        return (self.forwards & (count >= limit)) | (~self.forwards & (count <= -limit))

    # -------------------------------------------------------------- disagreements

    @cached_property
    def flaws(self) -> dict[Lit, Bool]:
        """Each disagreement by its reason."""
        own, config = self.own, self.own.config
        among = before(own.band).ne(v.NORMAL)
        fits = (self.long & was(own.long_by_map)) | (self.short & ~was(own.long_by_map))
        longest = config.long_mm + 2 * config.edge_tolerance_mm
        return {
            v.FALSE_SECTION: self.changes & ~self.expected,
            v.MISSED_SECTION: before(own.band).eq(v.NORMAL) & ~self.changes & self._missed,
            v.WRONG_LENGTH: self.returns & ~self.turned_back & ~fits,
            v.NO_END_OF_SECTION: among
            & ~self._within(self.run, longest)
            & (~self.returns | ~self._within_edges(self.run, longest)),
            v.FLIGHT_DIFFERS: own.flight_position.present
            & self._off(own.flight_position.value, config.flight_threshold_mm),
            v.REFLECTION_DIFFERS: own.reflecting_point.present
            & self._off(own.reflecting_point.value, config.reflection_threshold_mm),
        }

    @cached_property
    def _missed(self) -> Bool:
        """The place, with all its error, is beyond an edge of the map: of the section ahead, or behind."""
        own, figure = self.own, 2 * self.own.config.edge_tolerance_mm
        above, below = self.place - own.ahead.near, own.behind.near - self.place
        far_above = (above > 0) & ~self._within(above, figure)
        far_below = (below > 0) & ~self._within(below, figure)
        return (own.ahead.known & far_above) | (own.behind.known & far_below)

    def _off(self, amplitude: Num, threshold_mm: int) -> Bool:
        """Return the condition that a place differs from the entered section's, or from the end's with its error."""
        entered = abs_(amplitude - self.near) > Lit(threshold_mm, MM)
        return (self.changes & entered) | (~self.changes & ~self._within(amplitude - self.place, threshold_mm))
