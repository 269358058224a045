"""The fibre front end: blocks of backscatter become trains, position signals and test patterns, or are refused.

    block -> in time? joins? -> energy in the band -> shaken fibre -> stretches -> tracks -> FibreFrame | NoFibre(reason)

A train is a candidate, never a position to rely on: the machine decides whether it is trusted. A quiet fibre is no evidence
that no train stands there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from safeloc.runtime.border import Reason
from safeloc.sensing.array_types import Flags, Singles
from safeloc.sensing.fibre.axles import Counter
from safeloc.sensing.fibre.blocks import Content, FibreBlock, NoFibre, Order, Refusal, admitted, unusable
from safeloc.sensing.fibre.emitters import Heard, Listener
from safeloc.sensing.fibre.energy import Analyser, Energies, Quiet, Smoother
from safeloc.sensing.fibre.features import End, FibreFrame, TrainSeen, Trouble
from safeloc.sensing.fibre.fibre_map import FibreMap, one_to_one
from safeloc.sensing.fibre.figures import FibreConfig
from safeloc.sensing.fibre.measures import at_last_frame, end, length, speed
from safeloc.sensing.fibre.reflections import Reflections, reflections
from safeloc.sensing.fibre.shaken_stretches import stretches
from safeloc.sensing.fibre.signals import Signaller
from safeloc.sensing.fibre.tracks import Fit, Follower, Track

Outcome = FibreFrame | NoFibre
_TINY = np.float32(np.finfo(np.float32).tiny)


@dataclass(frozen=True)
class _Watch:
    """The axle counter and the position signals of one track."""

    counter: Counter
    signaller: Signaller


@dataclass(frozen=True, eq=False)
class _Window:
    """One window: its energies, also averaged, [channels], and the block's light."""

    time_ms: float
    energy: Singles
    smooth: Singles
    light: Reflections | None


class FrontEnd:
    """The front end of one fibre. It takes blocks in the order of their delivery."""

    def __init__(self, config: FibreConfig, max_age_ms: int, where: FibreMap | None = None) -> None:
        self._config = config
        self._where = where or one_to_one(config.interrogator.fibre_mm)
        self._max_age_ms = max_age_ms
        self._order = Order(config, max_age_ms)
        self._analyser, self._listener = Analyser(config), Listener(config)
        self._quiet, self._tone_quiet = Quiet(config), Quiet(config)
        self._smoother = Smoother(config.detection.average_windows)
        self._follower = Follower(config)
        self._watches: dict[int, _Watch] = {}
        self._disturbed_until_ms: int | None = None

    def receive(self, block: FibreBlock | None, now_ms: int) -> Outcome:
        """Process the block of this cycle; None: nothing was delivered. A refusal ends all tracks."""
        outcome = NoFibre(Reason.MISSING) if block is None else self._read(block, now_ms)
        if isinstance(outcome, NoFibre):
            self._forget(keep_order=outcome.reason in (Refusal.DISTURBED, Refusal.LEARNING))
        return outcome

    def _forget(self, keep_order: bool) -> None:
        self._follower.drop()
        self._watches.clear()
        self._listener.reset()
        self._smoother.reset()
        if not keep_order:
            self._order.broken()

    def _read(self, block: FibreBlock, now_ms: int) -> Outcome:
        refused = self._order.judge(block, now_ms)
        if refused is not None:
            return refused
        content = admitted(self._config, block)
        if isinstance(content, NoFibre):
            return content
        energies = self._analyser.energies(content.phase_rate)
        refused = (
            unusable(self._config, energies.band) or self._order.changes(energies.band) or self._order.joins(block)
        )
        if refused is not None:
            return refused
        return self._checked(block, content, energies)

    def _checked(self, block: FibreBlock, content: Content, energies: Energies) -> Outcome:
        light = None if content.intensity is None else reflections(content.intensity, self._config)
        if light is not None and light.dark_percent > self._config.detection.lost_percent:
            return NoFibre(Refusal.DARK, f"{light.dark_percent:.0f} % of the channels")
        level = self._quiet.level
        if level is None:
            self._learn(energies)
            return NoFibre(Refusal.LEARNING)
        smooth = self._smoother.smooth(energies.band)
        shaken = smooth > level * np.float32(10 ** (self._config.detection.threshold_cdb / 1_000))
        if light is not None:
            shaken &= ~light.faded
        disturbed = self._disturbed(shaken, block.time_ms)
        if disturbed is not None:
            return disturbed
        frame = self._followed(block, energies, smooth, shaken, light)
        self._quiet.follow(energies.band, shaken)
        return frame

    def _learn(self, energies: Energies) -> None:
        self._quiet.learn(energies.band)
        if energies.tone is not None:
            self._tone_quiet.learn(energies.tone)

    def _disturbed(self, shaken: Flags, time_ms: int) -> NoFibre | None:
        """Refuse a block while too much of the fibre is shaken at once, and for some time after."""
        percent = 100 * float(shaken.mean(axis=1).max())
        if percent > self._config.detection.disturbed_percent:
            self._disturbed_until_ms = time_ms + self._config.detection.disturbed_hold_ms
        if self._disturbed_until_ms is not None and time_ms <= self._disturbed_until_ms:
            return NoFibre(Refusal.DISTURBED, f"{percent:.0f} %")
        return None

    def _followed(
        self, block: FibreBlock, energies: Energies, smooth: Singles, shaken: Flags, light: Reflections | None
    ) -> FibreFrame:
        assert self._quiet.level is not None
        ratio = np.divide(smooth, np.maximum(self._quiet.level, _TINY), dtype=np.float32)
        before = {track.number for track in self._follower.tracks if track.confirmed}
        heard: list[Heard] = []
        for window in range(len(ratio)):
            time_ms = block.time_ms - (len(ratio) - 1 - window) * self._config.window_ms
            ended = self._follower.follow(time_ms, stretches(ratio[window], shaken[window], self._config))
            self._watch(_Window(time_ms, energies.band[window], smooth[window], light), ended)
            heard += self._listen(energies, window, time_ms)
        trains = self._trains(light)
        lost = tuple(sorted(before - {train.track for train in trains}))
        return FibreFrame(block.time_ms, block.sequence, trains, lost, tuple(heard), *_troubles(light))

    def _watch(self, window: _Window, ended: Sequence[Track]) -> None:
        """Continue courses, counts and signals with one window."""
        tracks = self._follower.tracks
        for gone in ended:
            self._watches.pop(gone.number, None)
        for track in tracks:
            self._watches.setdefault(track.number, _Watch(Counter(self._config), Signaller(self._config)))
        for track in tracks:
            fit = track.fit()
            if fit is None:
                continue
            track.judge(fit, self._config)
            if track.confirmed:
                faded = None if window.light is None else window.light.faded
                self._watches[track.number].signaller.follow(track.last, fit, window.smooth, window.time_ms, faded)
                self._count(track, fit, window)

    def _count(self, track: Track, fit: Fit, window: _Window) -> None:
        stretch, counter = track.last, self._watches[track.number].counter
        if stretch.cut_low or stretch.cut_high:
            counter.runs(window.time_ms, fit.speed_mm_s)
        else:
            length, middle = fit.high_mm - fit.low_mm, (stretch.low_mm + stretch.high_mm) / 2
            counter.follow(window.time_ms, middle, length, fit.speed_mm_s, window.energy)

    def _listen(self, energies: Energies, window: int, time_ms: float) -> list[Heard]:
        level = self._tone_quiet.level
        if energies.tone is None or level is None:
            return []
        tone = energies.tone[window] / np.maximum(level, _TINY)
        return self._listener.listen(tone, time_ms)

    def _trains(self, light: Reflections | None) -> tuple[TrainSeen, ...]:
        seen = [self._train(track, light) for track in self._follower.tracks if track.confirmed]
        return tuple(train for train in seen if train is not None)

    def _train(self, track: Track, light: Reflections | None) -> TrainSeen | None:
        fitted = track.fit()
        if fitted is None:
            return None
        fit, stretch, watch = at_last_frame(fitted, self._config), track.last, self._watches[track.number]
        low = None if stretch.cut_low else self._end(fit.low_mm, fit.off_low_mm, -1, watch, light)
        high = None if stretch.cut_high else self._end(fit.high_mm, fit.off_high_mm, 1, watch, light)
        both_ends = low is not None and high is not None
        return TrainSeen(
            track.number,
            track.origin,
            low,
            high,
            speed(fit, self._config),
            length(fit, self._config, self._where) if both_ends else None,
            watch.counter.count,
            watch.signaller.taken(),
        )

    def _end(self, place_mm: float, off_mm: float, side: int, watch: _Watch, light: Reflections | None) -> End:
        found = end(place_mm, off_mm, side, self._config, self._where, light)
        return replace(found, amplitude_cdb=watch.signaller.amplitude_cdb(side))


def _troubles(light: Reflections | None) -> tuple[tuple[Trouble, ...], tuple[str, ...]]:
    if light is None:
        return (), ()
    found = {
        Trouble.END_REFLECTS: light.end_reflects,
        Trouble.POINT_MISSING: bool(light.missing),
        Trouble.DARK: light.dark_percent > 0,
    }
    return tuple(trouble for trouble, there in found.items() if there), light.missing


def read_all(blocks: Sequence[FibreBlock], front: FrontEnd) -> list[Outcome]:
    """Process the blocks of a recording, each at its own time."""
    return [front.receive(block, block.time_ms) for block in blocks]
