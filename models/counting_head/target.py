"""The catalogue entry of a counting head through a cycle of the axle counter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from safeloc.models import counting_head
from safeloc.models.counting_head import NAME, CountingHeadConfig
from safeloc.models.counting_head.simulate import simulate
from safeloc.properties import axle_head as head_claims
from safeloc.properties import counting_head as claims
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Hazard, Target, recorded

DOC = (
    "A counting head, sample by sample, and the adding up of its samples through one cycle of the axle counter. What the counter assumes of each "
    "of its cycles is proved here of every row of samples that makes one."
)


def target(config: CountingHeadConfig) -> Target:
    """Make the composition, with the properties of the head."""
    whole = counting_head.compose_machines(config)
    system = whole.composition.system
    members = {whole.head.machine.name: tuple(head_claims.properties(whole.head))}
    return Target(
        NAME, system.machines, system, tuple(claims.properties(whole)), config, DOC, recorded(NAME), None, partial(_simulated, config), members=members
    )  # fmt: skip


def _simulated(config: CountingHeadConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    return simulate(config, seed=seed)


ENTRIES = (
    Entry(
        NAME,
        "a counting head through a cycle of the axle counter: its samples added up to what the counter hears",
        CountingHeadConfig,
        target,
        Family.FIBRE,
        place=45,
        simulates=True,
        members=("axle_head", "head_cycle"),
        pairs_of=("axle_head", "axle_counter"),
        no_interval="It reports axles and directions.",
        hazard=Hazard(
            "a cycle is reported to the axle counter with other axles than passed, and without a fault",
            ("a cycle is reported as the axle counter assumes",),
        ),
    ),
)
