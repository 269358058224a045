"""Makes the position signals of one train, from the amplitude at both its ends and their measured places."""

from __future__ import annotations

from safeloc.sensing.array_types import Flags, Singles
from safeloc.sensing.fibre.features import Bounds, SectionSignal
from safeloc.sensing.fibre.fibre_map import one_to_one
from safeloc.sensing.fibre.figures import FibreConfig
from safeloc.sensing.fibre.measures import by_index, end
from safeloc.sensing.fibre.sections import Change, Effect, Watcher, amplitude
from safeloc.sensing.fibre.shaken_stretches import Stretch
from safeloc.sensing.fibre.tracks import Fit
from safeloc.sensing.rounding import ExactBounds, exactly


class Signaller:
    """Watches both ends of one train."""

    def __init__(self, config: FibreConfig) -> None:
        self._config = config
        self._where = one_to_one(config.interrogator.fibre_mm)
        self._ends = {-1: Watcher(config), 1: Watcher(config)}
        self._made: list[SectionSignal] = []

    def follow(self, stretch: Stretch, fit: Fit, energy: Singles, time_ms: float, faded: Flags | None) -> None:
        """Process one window: stretch and course of the train, energy of every channel, and the channels with a meaningless phase."""
        for side, place, off, cut in (
            (-1, fit.low_mm, fit.off_low_mm, stretch.cut_low),
            (1, fit.high_mm, fit.off_high_mm, stretch.cut_high),
        ):
            if cut:
                continue
            level = amplitude(energy, fit.low_mm, fit.high_mm, side, self._config, faded)
            change = None if level is None else self._ends[side].follow(place, level)
            if change is not None and fit.speed_mm_s:
                direction = 1 if fit.speed_mm_s > 0 else -1
                se = end(place, off, side, self._config, self._where, None).fibre_mm
                self._made.append(self._signal(change, side == direction, direction, time_ms, se))

    def amplitude_cdb(self, side: int) -> int | None:
        """Return the amplitude over its normal level, at the end towards the coupler (-1) or away from it (+1)."""
        change = self._ends[side].change_cdb
        return None if change is None else round(change)

    def taken(self) -> tuple[SectionSignal, ...]:
        """Return the signals since the last call."""
        made, self._made = tuple(self._made), []
        return made

    def _signal(self, change: Change, leading: bool, direction: int, time_ms: float, se: Bounds) -> SectionSignal:
        return SectionSignal(
            change.effect,
            change.edge,
            change.entering,
            leading,
            direction,
            round(time_ms),
            se,
            self._length(change),
            self._near(change.effect, se),
        )

    def _length(self, change: Change) -> Bounds | None:
        if change.length_mm is None:
            return None
        run = exactly(change.length_mm)
        found = ExactBounds(run, run).widened(self._config.sections.length_error_mm + by_index(run, self._config))
        return Bounds.outward(ExactBounds(max(found.low, 0), found.high))

    def _near(self, effect: Effect, se: Bounds) -> str | None:
        """Return the only configured section with this effect within the search distance of Se; None: none, or several."""
        search = self._config.sections.search_mm
        near = [
            one.id
            for one in self._config.section_places
            if one.effect == effect.value and one.from_mm - search <= se.high and se.low <= one.to_mm + search
        ]
        return near[0] if len(near) == 1 else None
