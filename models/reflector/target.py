"""The catalogue entry of the reflector machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from safeloc.models import reflector
from safeloc.models.reflector.configurations import CONFIGURATIONS
from safeloc.models.reflector.picture import picture
from safeloc.models.reflector.variables import ReflectorConfig, parts
from safeloc.properties import reflector as claims
from safeloc.reported import Reported
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Target, single


def target(config: ReflectorConfig) -> Target:
    """Make the machine."""
    model = reflector.build(parts(config))
    properties, simulate = claims.properties(model), partial(_simulated, config)
    return single(
        model.machine, properties, config, reported=Reported(), simulate=simulate, pictures=(picture(config),)
    )


def _simulated(config: ReflectorConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.reflector.simulate import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


ENTRIES = (
    Entry(
        "reflector",
        "radar reflectors, and odometry between them",
        ReflectorConfig,
        target,
        Family.MARKERS,
        place=20,
        configurations=CONFIGURATIONS,
        silent=("reflector",),
    ),
)
