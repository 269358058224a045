"""The catalogue entry of the guard of a receiver whose own quality flags do not bound its error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.language.nodes import Value
from safeloc.models import guard
from safeloc.models.guard.configurations import CONFIGURATIONS
from safeloc.models.guard.variables import GuardConfig, parts
from safeloc.properties import guard as claims
from safeloc.reported import Reported
from safeloc.target import Entry, Family, Pair, Target, single


def target(config: GuardConfig) -> Target:
    """Return the guard with its properties, as verification and simulation use it."""
    model = guard.build(parts(config))
    properties = claims.properties(model)
    return single(
        model.machine, properties, config, reported=Reported(), simulate=lambda seed: _simulated(config, seed)
    )


def _simulated(config: GuardConfig, seed: int) -> Sequence[Mapping[str, Value]]:
    from safeloc.models.guard.simulate import simulate  # needed only where something is simulated

    return simulate(config, seed=seed)


ENTRIES = (
    Entry(
        "guard",
        "of a receiver's positions, those that map and motion allow",
        GuardConfig,
        target,
        Family.RECEIVER,
        place=10,
        simulates=True,
        pairs=(
            Pair("error of fixes beside charge off the track", "offset_charge_permille:down", "fix_error_mm:up"),
            Pair("charge off the track beside error of fixes", "fix_error_mm:down", "offset_charge_permille:up"),
            Pair("error of speed beside error of fixes", "fix_error_mm:down", "speed_error_mm_s:up"),
            Pair("line speed beside cycle time", "period_ms:down", "max_speed_mm_s:up"),
            Pair("brakes beside cycle time", "period_ms:down", "brake_mm_s2:up"),
        ),
        configurations=CONFIGURATIONS,
    ),
)
