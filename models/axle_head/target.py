"""The catalogue entry of the machine of a counting head."""

from __future__ import annotations

from safeloc.models import axle_head
from safeloc.models.axle_head import AxleHeadConfig
from safeloc.models.axle_head.simulate import simulate
from safeloc.properties import axle_head as claims
from safeloc.target import Entry, Family, Hazard, Pair, Target, single


def target(config: AxleHeadConfig) -> Target:
    """Make the machine."""
    model = axle_head.build(axle_head.parts(config))
    properties = claims.properties(model)
    return single(model.machine, properties, config, simulate=lambda seed: simulate(config, seed=seed))


ENTRIES = (
    Entry(
        "axle_head",
        "axles and direction from two overlapping pulses",
        AxleHeadConfig,
        target,
        Family.FIBRE,
        place=40,
        simulates=True,
        pairs=(
            Pair("line speed beside sampling", "sample_us:down", "max_speed_mm_s:up"),
            Pair("sampling beside line speed", "max_speed_mm_s:down", "sample_us:up"),
            Pair("line speed beside overlap", "overlap_mm:up", "max_speed_mm_s:up", "design"),
            Pair("sampling beside overlap", "overlap_mm:up", "sample_us:up", "design"),
            Pair("overlap beside line speed", "max_speed_mm_s:down", "overlap_mm:down", "design"),
        ),
        no_interval="It reports axles and directions.",
        hazard=Hazard(
            "an axle is lost, or counted twice, or in the wrong direction, without a disturbance",
            ("every axle is counted",),
        ),
    ),
)
