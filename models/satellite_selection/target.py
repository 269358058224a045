"""The catalogue entry of the selection of satellites."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.models import satellite_selection
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.models.satellite_selection.configurations import CONFIGURATIONS
from safeloc.properties import satellite_selection as claims
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Target, single


def target(config: SelectionConfig) -> Target:
    """Make the machine."""
    model = satellite_selection.build(satellite_selection.parts(config))
    properties = claims.properties(model)
    return single(model.machine, properties, config, simulate=lambda seed: _simulated(config, seed))


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
        configurations=CONFIGURATIONS,
        no_interval="It reports a list of usable satellites.",
        silent=("selection",),
    ),
)
