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
from safeloc.target import Entry, Family, Pair, Target, single


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
        simulates=True,
        configurations=CONFIGURATIONS,
        pairs=(
            Pair("rate beside constant", "odometer.constant_mm:down", "odometer.rate_ppm:up"),
            Pair("constant beside rate", "odometer.rate_ppm:down", "odometer.constant_mm:up"),
            Pair("constant beside accuracy of balises", "balise_accuracy_mm:down", "odometer.constant_mm:up"),
            Pair("accuracy of the map beside latency of frames", "frame_latency_ms:down", "map_accuracy_mm:up"),
            Pair("scale of the radar beside its drift", "radar_drift_mm_s:down", "radar_scale_ppm:up"),
        ),
        silent=("reflector",),
    ),
)
