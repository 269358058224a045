"""The catalogue entry of a counted entry."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from safeloc.models import counted_entry
from safeloc.models.counted_entry import NAME, CountedEntryConfig
from safeloc.models.counted_entry.configurations import CONFIGURATIONS
from safeloc.models.counted_entry.simulate import simulate
from safeloc.properties import axle_counter as counter_claims
from safeloc.properties import counted_entry as claims
from safeloc.properties import verification as verification_claims
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Hazard, Target, recorded

DOC = (
    "Axle counter and verification in one step: a train that the counter has counted, and whose fibre position is verified by that "
    "record. The fibre may be wrong in everything; that the record is true is proved, not assumed."
)


def target(config: CountedEntryConfig) -> Target:
    """Make the composition, with the properties of each of its machines."""
    whole = counted_entry.compose_machines(config)
    properties, system = tuple(claims.properties(whole)), whole.composition.system
    members = {
        whole.counter.machine.name: tuple(counter_claims.properties(whole.counter)),
        whole.verified.machine.name: tuple(verification_claims.properties(whole.verified)),
    }
    return Target(
        NAME, system.machines, system, properties, config, DOC, recorded(NAME), None, partial(_simulated, config), members=members
    )  # fmt: skip


def _simulated(config: CountedEntryConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    return simulate(config, seed=seed)


ENTRIES = (
    Entry(
        NAME,
        "axle counter and verification as one device: the record of a train that passed, and the fibre compared with it",
        CountedEntryConfig,
        target,
        Family.FIBRE,
        place=55,
        simulates=True,
        members=("axle_counter", "train", "verification_doubted"),
        pairs_of=("axle_counter", "verification_doubted"),
        configurations=CONFIGURATIONS,
        no_interval="Its position may miss the true one as far as `place_doubt_mm`, since nothing is assumed of the fibre.",
        hazard=Hazard(
            "a position is farther from the true one than the reported doubt, or is given for a train that was counted otherwise",
            (
                "verification_doubted: the reported doubt holds",
                "verification_doubted: a wrong count withholds",
                "verification_doubted: a wrong length withholds",
                "no position without an undisturbed record",
            ),
        ),
    ),
)
