"""Terms of one cycle of the time of flight: bounds of the distance along the fibre, and of the place along the track."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import Bool, Lit, Num, ceil_div, ceil_to, floor_div, floor_to, ite, maximum
from safeloc.language.units import MM, PPM, PPM_PER_ONE, Unit
from safeloc.models.time_of_flight.variables import Parts

_M_S = Unit("m/s", length=1, time=-1)


@dataclass(frozen=True, eq=False)
class Flight:
    """Terms over the inputs of a cycle."""

    own: Parts

    # -------------------------------------------------------------- along the fibre

    @cached_property
    def low(self) -> Num:
        """Least distance Ls, mm: the shortest time at the lowest speed, half of it, and the pattern's error off."""
        time = maximum(self.own.delay.value - self.own.config.time_error_ps, 0)
        there_and_back = floor_to(time * Lit(self.own.config.slowest_m_s, _M_S), MM)
        return maximum(floor_div(there_and_back, 2) - self.own.config.pattern_error_mm, 0)

    @cached_property
    def high(self) -> Num:
        """Greatest distance Ls, mm: the longest time at the highest speed, half of it, and the pattern's error added."""
        time = self.own.delay.value + self.own.config.time_error_ps
        there_and_back = ceil_to(time * Lit(self.own.config.fastest_m_s, _M_S), MM)
        return ceil_div(there_and_back, 2) + self.own.config.pattern_error_mm

    @cached_property
    def beyond(self) -> Bool:
        """The delay tells a distance that certainly lies beyond the end of the fibre."""
        return self.own.delay.present & (self.low > self.own.config.fibre_mm)

    # -------------------------------------------------------------- along the track

    @cached_property
    def _nearest(self) -> Num:
        """Least run along the track from the surveyed point, in the direction of the fibre, mm."""
        fibre = self.low - self.own.map_distance
        return ite(fibre >= 0, floor_to(fibre * self._shorter, MM), fibre) - self.own.config.map_error_mm

    @cached_property
    def _farthest(self) -> Num:
        """Greatest run along the track from the surveyed point, in the direction of the fibre, mm."""
        fibre = self.high - self.own.map_distance
        return ite(fibre >= 0, fibre, ceil_to(fibre * self._shorter, MM)) + self.own.config.map_error_mm

    @property
    def _shorter(self) -> Lit:
        """The least run along the track for a length of cable."""
        return Lit(PPM_PER_ONE - self.own.config.slack_ppm, PPM)

    @cached_property
    def track_low(self) -> Num:
        """Least place along the track, mm."""
        return self.own.map_position + ite(self.own.map_upwards, self._nearest, -self._farthest)

    @cached_property
    def track_high(self) -> Num:
        """Greatest place along the track, mm."""
        return self.own.map_position + ite(self.own.map_upwards, self._farthest, -self._nearest)
