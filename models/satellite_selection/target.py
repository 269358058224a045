"""The catalogue entry of the selection of satellites."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from safeloc.models import satellite_selection
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.models.satellite_selection.configurations import CONFIGURATIONS
from safeloc.properties import satellite_selection as claims
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Hazard, Pair, Target, single


def target(config: SelectionConfig) -> Target:
    """Make the machine."""
    model = satellite_selection.build(satellite_selection.parts(config))
    properties = claims.properties(model)
    made = single(model.machine, properties, config, simulate=lambda seed: _simulated(config, seed))
    return replace(made, hazard=_hazard(config))


def _hazard(config: SelectionConfig) -> Hazard:
    """Return the hazard: a satellite that violates one figure only is bounded only where one excludes it."""
    if config.removal == "both":
        return Hazard("a satellite is usable that violates every figure", ("channel *: a violation is not usable",))
    bounded = "a satellite is usable whose range or speed is off by more than the bound"
    return Hazard(bounded, ("channel *: a usable * is bounded",))


def _simulated(config: SelectionConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.satellite.simulate import (
        simulate_selection,  # numpy is loaded only where something is simulated
    )

    return simulate_selection(config, seed=seed)


ENTRIES = (
    Entry(
        "selection",
        "usable satellites, by a map-bound prediction",
        SelectionConfig,
        target,
        Family.SATELLITES,
        place=10,
        simulates=True,
        configurations=CONFIGURATIONS,
        pairs=(
            Pair("noise beside threshold of ranges", "range_threshold_mm:up", "range_noise_mm:up", "design"),
            Pair("prediction beside noise of ranges", "range_noise_mm:down", "range_prediction_mm:up", "design"),
            Pair("clock beside noise of ranges", "range_noise_mm:down", "range_clock_mm:up", "design"),
            Pair("noise beside threshold of speeds", "speed_threshold_mm_s:up", "speed_noise_mm_s:up", "design"),
            Pair("accuracy of the almanac beside its age", "almanac_limit_s:down", "almanac_accuracy_mrad:up"),
        ),
        no_interval="It reports a list of usable satellites.",
        silent=("selection",),
    ),
)
