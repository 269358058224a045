"""The catalogue entry of the machine that makes a train's entry record."""

from __future__ import annotations

from safeloc.models import axle_counter
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.models.axle_counter.configurations import CONFIGURATIONS
from safeloc.models.axle_counter.simulate import simulate
from safeloc.properties import axle_counter as claims
from safeloc.target import Entry, Family, Hazard, Pair, Target, single


def target(config: AxleCounterConfig) -> Target:
    """Make the machine."""
    model = axle_counter.build(axle_counter.parts(config))
    properties = claims.properties(model)
    return single(model.machine, properties, config, simulate=lambda seed: simulate(config, seed=seed))


ENTRIES = (
    Entry(
        "axle_counter",
        "a train's entry record from its axles",
        AxleCounterConfig,
        target,
        Family.FIBRE,
        place=50,
        simulates=True,
        configurations=CONFIGURATIONS,
        pairs=(
            Pair("line speed beside cycle time", "period_ms:down", "max_speed_mm_s:up"),
            Pair("cycle time beside line speed", "max_speed_mm_s:down", "period_ms:up"),
            Pair("braking beside cycle time", "period_ms:down", "change_mm_s2:up"),
            Pair("braking beside line speed", "max_speed_mm_s:down", "change_mm_s2:up"),
            Pair("distance of axles beside headway", "headway_ms:up", "axle_gap_mm:up"),
        ),
        no_interval="It reports a train's record: axles, length, speed.",
        hazard=Hazard(
            "an undisturbed record of a train is false",
            (
                "count is true",
                "direction is true",
                "length is true",
                "speed is true",
                "place is true",
            ),
        ),
    ),
)
