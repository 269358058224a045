"""The catalogue entries of the verification of a fibre position: as designed, and with a fibre that may be wrong in everything."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.models import verification
from safeloc.models.verification import VerificationConfig
from safeloc.models.verification.configurations import CONFIGURATIONS
from safeloc.properties import verification as claims
from safeloc.reported import Reported
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Hazard, Pair, Target, single


def target(config: VerificationConfig) -> Target:
    """Make the machine in a world whose fibre obeys its laws."""
    model = verification.build(verification.parts(config))
    return single(
        model.machine,
        claims.properties(model),
        config,
        reported=Reported(valid="trusted"),
        simulate=lambda seed: _simulated(config, seed),
    )


def doubted(config: VerificationConfig) -> Target:
    """Make the machine in a world in which nothing is assumed of the fibre."""
    model = verification.build_doubted(verification.parts(config))
    return single(model.machine, claims.properties(model), config)


def _simulated(config: VerificationConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.fibre.simulate import simulate_stay  # numpy is loaded only where something is simulated

    return simulate_stay(config, seed=seed)


_PAIRS = (
    Pair("length of the train beside its change", "length_change_mm:up", "length_tolerance_mm:up", "design"),
    Pair("jump beside age of the record", "reference_age_limit_cycles:down", "jump_mm:up", "design"),
    Pair("accuracy of speed beside brakes", "brake_mm_s2:down", "speed_tolerance_mm_s:up", "design"),
    Pair("doubt beside accuracy of places", "place_tolerance_mm:down", "place_doubt_limit_mm:up", "design"),
    Pair("currency beside age of the record", "reference_age_limit_cycles:down", "currency_cycles:up", "design"),
)

ENTRIES = (
    Entry(
        "verification",
        "a train's fibre position, verified against an axle counter",
        VerificationConfig,
        target,
        Family.FIBRE,
        place=20,
        simulates=True,
        configurations=CONFIGURATIONS,
        pairs=_PAIRS,
        silent=("verification",),
    ),
    Entry(
        "verification_doubted",
        "the same where the fibre may be wrong in everything",
        VerificationConfig,
        doubted,
        Family.FIBRE,
        place=30,
        pairs=_PAIRS,
        no_interval="Its recordings show intervals that miss the true position unnoticed; claimed is only how far (`place_doubt_mm`).",
        hazard=Hazard(
            "a position is farther from the true one than the reported doubt",
            (
                "the reported doubt holds",
                "a place at the counter",
                "a place later",
            ),
        ),
    ),
)
