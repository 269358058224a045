"""The catalogue entry of the machine of a test emitter."""

from __future__ import annotations

from safeloc.models import emitter
from safeloc.models.emitter import EmitterConfig
from safeloc.models.emitter.configurations import CONFIGURATIONS
from safeloc.models.emitter.simulate import simulate
from safeloc.properties import emitter as claims
from safeloc.target import Entry, Family, Hazard, Pair, Target, single


def target(config: EmitterConfig) -> Target:
    """Make the machine."""
    model = emitter.build(emitter.parts(config))
    properties = claims.properties(model)
    return single(model.machine, properties, config, simulate=lambda seed: simulate(config, seed=seed))


ENTRIES = (
    Entry(
        "emitter",
        "function check of the fibre by a test emitter",
        EmitterConfig,
        target,
        Family.FIBRE,
        place=80,
        simulates=True,
        configurations=CONFIGURATIONS,
        pairs=(
            Pair("jitter beside time between patterns", "due_cycles:down", "window_cycles:up"),
            Pair("time between patterns beside jitter", "window_cycles:down", "due_cycles:up"),
            Pair("answer beside time between patterns", "due_cycles:up", "answer_cycles:up", "design"),
            Pair("patterns to recover beside jitter", "window_cycles:down", "passes_to_recover:up", "design"),
        ),
        no_interval="It tells whether the fibre passed its function check.",
        hazard=Hazard(
            "a chain that does not work passes its function check",
            (
                "a dead chain is reported",
                "silence is reported",
                "a pattern that passes came through the chain",
            ),
        ),
        silent=("emitter",),
    ),
)
