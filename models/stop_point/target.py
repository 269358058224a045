"""The catalogue entry of the stop-point machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from safeloc.models import stop_point
from safeloc.models.stop_point.configurations import CONFIGURATIONS
from safeloc.models.stop_point.picture import picture
from safeloc.models.stop_point.variables import StopPointConfig, parts
from safeloc.properties import stop_point as claims
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Hazard, Pair, Target, single


def target(config: StopPointConfig) -> Target:
    """Make the machine."""
    model = stop_point.build(parts(config))
    properties, simulate = claims.properties(model), partial(_simulated, config)
    return single(model.machine, properties, config, simulate=simulate, pictures=(picture(config),))


def _simulated(config: StopPointConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.stop_point.simulate import simulate_stop  # numpy is loaded only where something is simulated

    return simulate_stop(config, seed=seed)


ENTRIES = (
    Entry(
        "stop_point",
        "precise stop at a platform, with repositioning",
        StopPointConfig,
        target,
        Family.MARKERS,
        place=30,
        simulates=True,
        configurations=CONFIGURATIONS,
        pairs=(
            Pair("brakes beside speed error", "speed_error_mm_s:down", "brake_mm_s2:down"),
            Pair("reaction time beside speed error", "speed_error_mm_s:down", "reaction_ms:up"),
            Pair("brakes beside reaction time", "reaction_ms:down", "brake_mm_s2:down"),
            Pair("reaction time beside brakes", "brake_mm_s2:up", "reaction_ms:up"),
            Pair("speed error beside brakes", "brake_mm_s2:up", "speed_error_mm_s:up"),
        ),
        no_interval="It gives orders to brake and to move; the position is an input.",
        hazard=Hazard(
            "the train is not braked before the window at the platform ends, moves there where it may not, or is reported in position elsewhere",
            (
                "brake order in time",
                "never on beyond the window",
                "never back before the window",
                "in position within the window",
            ),
        ),
    ),
)
