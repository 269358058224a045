"""The catalogue entry of the machine of the unlinked group."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.models import unlinked_group
from safeloc.models.unlinked_group.configurations import CONFIGURATIONS
from safeloc.models.unlinked_group.variables import UnlinkedGroupConfig, parts
from safeloc.properties import unlinked_group as claims
from safeloc.reported import Reported
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Pair, Target, single


def target(config: UnlinkedGroupConfig) -> Target:
    """Make the machine."""
    model = unlinked_group.build(parts(config))
    return single(
        model.machine,
        claims.properties(model),
        config,
        reported=Reported(position="distance_mm", truth="true_distance_nm"),
        simulate=lambda seed: _simulated(config, seed),
    )


def _simulated(config: UnlinkedGroupConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.unlinked_group.simulate import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


ENTRIES = (
    Entry(
        "unlinked_group",
        "distance beyond the last unlinked balise group, beside the position",
        UnlinkedGroupConfig,
        target,
        Family.MARKERS,
        place=15,
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
