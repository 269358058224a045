"""The catalogue entry of the balise machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.models import balise
from safeloc.models.balise.configurations import CONFIGURATIONS
from safeloc.models.balise.variables import BaliseConfig, parts
from safeloc.properties import balise as claims
from safeloc.reported import Reported
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Pair, Target, single


def target(config: BaliseConfig) -> Target:
    """Make the machine."""
    model = balise.build(parts(config))
    properties = claims.properties(model)
    return single(
        model.machine, properties, config, reported=Reported(), simulate=lambda seed: _simulated(config, seed)
    )


def _simulated(config: BaliseConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.balise.simulate import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


ENTRIES = (
    Entry(
        "balise",
        "balise groups, supervised by linking, and an odometer between them",
        BaliseConfig,
        target,
        Family.MARKERS,
        place=10,
        simulates=True,
        configurations=CONFIGURATIONS,
        pairs=(
            Pair("rate beside constant", "odometer.constant_mm:down", "odometer.rate_ppm:up"),
            Pair("constant beside rate", "odometer.rate_ppm:down", "odometer.constant_mm:up"),
            Pair("line speed beside cycle time", "period_ms:down", "max_speed_mm_s:up"),
            Pair("constant beside detection accuracy", "detection_mm:down", "odometer.constant_mm:up"),
            Pair("age of telegrams beside line speed", "max_speed_mm_s:down", "telegram_age_limit_ms:up"),
        ),
        records_of={"front_wheel_mm": "odometer_mm"},
    ),
)
