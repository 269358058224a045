"""The catalogue entry of the machine of a section between axle counters."""

from __future__ import annotations

from safeloc.models import axle_section
from safeloc.models.axle_section import AxleSectionConfig
from safeloc.models.axle_section.simulate import simulate
from safeloc.properties import axle_section as claims
from safeloc.target import Entry, Family, Hazard, Pair, Target, single


def target(config: AxleSectionConfig) -> Target:
    """Make the machine."""
    model = axle_section.build(axle_section.parts(config))
    properties = claims.properties(model)
    return single(model.machine, properties, config, simulate=lambda seed: simulate(config, seed=seed))


ENTRIES = (
    Entry(
        "axle_section",
        "clear or occupied by axles counted in and out",
        AxleSectionConfig,
        target,
        Family.FIBRE,
        place=60,
        simulates=True,
        pairs=(
            Pair("axles in a cycle beside longest train", "axle_limit:down", "axles_a_cycle:up"),
            Pair("longest train beside axles in a cycle", "axles_a_cycle:down", "axle_limit:up"),
        ),
        no_interval="It reports whether a section is clear.",
        hazard=Hazard("a section is reported clear with an axle in it", ("clear is clear",)),
    ),
)
