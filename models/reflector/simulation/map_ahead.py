"""The map of vehicles on one route, cycle by cycle: the next reflector follows from what each machine reports."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from safeloc.models.reflector.simulation.radar import MODELS
from safeloc.models.reflector.simulation.scene import Route
from safeloc.simulation.many_runs import Array

TOLD = ("valid", "reflector_model", "reflector_position_mm", "position_mm", "margin_below_mm")
"""Outputs of the reflector machine that the map's answer follows from."""


class MapAhead:
    """The map of vehicles on one route: it answers with the next reflector beyond what each machine reports."""

    def __init__(self, route: Route, inputs: Mapping[str, Array]) -> None:
        """Begin with arrays [cycle, vehicle] of the map's inputs, in which no reflector is present."""
        reflectors = sorted(route.reflectors, key=lambda one: one.position_mm)
        self._places = np.array([one.position_mm for one in reflectors], dtype=np.int64)
        said = {
            "next_position_mm": [one.position_mm for one in reflectors],
            "next_model": [MODELS.index(one.model) for one in reflectors],
            "next_view_from_mm": [one.view_from_mm for one in reflectors],
            "next_view_to_mm": [one.view_to_mm for one in reflectors],
            "next_clear_mm": [route.clear_mm(one) for one in reflectors],
        }
        self._said = {name: np.array([*values, inputs[name].flat[0]], dtype=np.int64) for name, values in said.items()}
        self._inputs = inputs
        self._balises_mm = np.array([one.position_mm for one in route.balises], dtype=np.int64)
        self._references = np.array([one.reference for one in route.balises], dtype=np.bool_)
        self._ahead = np.searchsorted(self._places, self._balises_mm, side="right")

    def answer(self, cycle: int, told: Mapping[str, Array], balises: NDArray[np.int64]) -> None:
        """Write the next reflector: beyond the balise that was passed, else the target, else the reported position.

        balises  numbers of those passed, -1 for none: array [vehicle]
        """
        reported = told["position_mm"] - told["margin_below_mm"]
        here = np.where(told["reflector_model"] != 0, told["reflector_position_mm"], reported)
        number = np.where(told["valid"], np.searchsorted(self._places, here, side="right"), len(self._places))
        passed = balises >= 0
        met = passed.any()
        if met:
            number = np.where(passed, self._ahead[balises], number)
        found = number < len(self._places)
        if not found.any():
            return
        for name, values in self._said.items():
            self._inputs[name][cycle] = values[number]
        self._inputs["next_position_mm.present"][cycle] = found
        if met:
            tested = found & passed & self._references[balises]
            off = self._inputs["next_position_mm"][cycle] - self._balises_mm[balises]
            self._inputs["next_reference_mm"][cycle][tested] = off[tested]
            self._inputs["next_reference_mm.present"][cycle][tested] = True
