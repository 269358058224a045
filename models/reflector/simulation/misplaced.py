"""Reflectors and balises that do not stand where the map has them, for each vehicle, and what of it the world may explain otherwise.

A reflector that stands off its place looks like a radar that measures wrong, and the world may choose its systematic error at first, and how it
drifts and scales within its figures. So the survey is wrong only where no such choice explains the echoes: those
of all reflectors, in all cycles.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import NM_PER_MM, NM_PER_UM
from safeloc.models.reflector.simulation.scene import NOWHERE
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.vocabulary.reflectors import MODEL
from safeloc.simulation.many_runs import Array
from safeloc.simulation.physics.gauss_markov import Floats
from safeloc.simulation.physics.lawful_bias import FREE, lawful_bias

Whole = NDArray[np.int64]
_NOTHING = [one.label for one in MODEL].index(NOWHERE)


@dataclass(frozen=True, eq=False)
class Misplaced:
    """Distances of things beyond their places on the map, mm, by those places: arrays [vehicle].

    reflectors  that stand there
    balises     where they are read: their error of the map, and what the reader adds
    errs        vehicles whose reflectors err: what of it the world may explain otherwise is explained
    """

    reflectors: Mapping[int, Floats]
    balises: Mapping[int, Floats]
    errs: NDArray[np.bool_]

    def explain(self, config: ReflectorConfig, inputs: Mapping[str, Array], now_nm: Whole) -> None:
        """Write into the inputs the radar's error, and origin and scale of each echo, that keep the laws if any do."""
        which = np.flatnonzero(self.errs)
        if len(which):
            echoes = [_Echoes(config, inputs, slot, now_nm, which) for slot in range(1, config.echo_slots + 1)]
            low = np.maximum.reduce([one.permitted[0] for one in echoes])
            high = np.minimum.reduce([one.permitted[1] for one in echoes])
            bias = lawful_bias(low, high, config.radar_drift_mm_s * config.period_ms * NM_PER_UM)
            inputs["next_radar_bias_nm"][:, which] = bias
            for one in echoes:
                one.explain(bias)


class _Echoes:
    """The echoes in one slot of some vehicles: arrays [cycle, vehicle]."""

    def __init__(
        self, config: ReflectorConfig, inputs: Mapping[str, Array], slot: int, now_nm: Whole, which: Whole
    ) -> None:
        def of(name: str) -> Whole:
            return np.asarray(inputs[f"echo_{slot}_{name}"][:, which])

        self._inputs, self._slot, self._which = inputs, slot, which
        there = inputs["frame_present"][:, which] & inputs[f"echo_{slot}_range_mm.present"][:, which]
        self.real = there & (of("true_model") != _NOTHING)
        self._origin, place = of("origin_nm"), of("map_place_mm") * NM_PER_MM
        survey = config.map_accuracy_mm * NM_PER_MM
        self._least, self._most = place - survey, place + survey
        self._scale = of("range_mm") * config.radar_scale_ppm
        radar_nm = now_nm[:, which] - config.radar_offset_mm * NM_PER_MM
        near, bound = self._origin - radar_nm - of("range_mm") * NM_PER_MM, of("error_mm") * NM_PER_MM
        self._slack_low, self._slack_high = np.minimum(-bound - near, 0), np.maximum(bound - near, 0)

    @property
    def permitted(self) -> tuple[Whole, Whole]:
        """Return the least and the greatest error of the radar that explains the echo of each cycle."""
        low = self._origin - self._most - self._scale + self._slack_low
        high = self._origin - self._least + self._scale + self._slack_high
        return np.where(self.real, low, -FREE), np.where(self.real, high, FREE)

    def explain(self, bias: Whole) -> None:
        """Write origin and scale: with the radar's error they make up the range; the origin leaves the survey's accuracy where they must."""
        wanted = self._origin - bias
        origin = np.minimum(np.maximum(wanted, self._least), self._most)
        scaled = np.minimum(np.maximum(wanted - origin, -self._scale), self._scale)
        left = wanted - origin - scaled
        kept = np.minimum(np.maximum(-left, self._slack_low), self._slack_high).astype(np.int64) == -left
        for name, values in (("origin_nm", np.where(kept, origin, wanted - scaled)), ("scaled_nm", scaled)):
            column = self._inputs[f"echo_{self._slot}_{name}"]
            column[:, self._which] = np.where(self.real, values, column[:, self._which])
