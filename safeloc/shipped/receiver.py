"""The guard of a receiver whose own quality flags do not bound its error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pydantic import BaseModel

from safeloc.language.nodes import Value
from safeloc.language.system import lower
from safeloc.models import guard
from safeloc.models.guard import configurations as guard_configurations
from safeloc.models.guard.variables import GuardConfig, parts
from safeloc.properties import guard as guard_properties
from safeloc.reported import Reported
from safeloc.shipped.making import recorded
from safeloc.target import Entry, Target


def _guard(config: BaseModel) -> Target:
    assert isinstance(config, GuardConfig)
    model = guard.build(parts(config))
    return Target(
        "guard",
        (model.machine,),
        lower(model.machine),
        tuple(guard_properties.properties(model)),
        config,
        model.machine.doc,
        recorded("guard"),
        Reported(),
        lambda seed: _simulated(config, seed),
    )


def _simulated(config: GuardConfig, seed: int) -> Sequence[Mapping[str, Value]]:
    from safeloc.models.guard.simulate import simulate  # needed only where something is simulated

    return simulate(config, seed=seed)


ENTRIES = (
    Entry(
        "guard",
        "of a receiver's positions, those that map and motion allow",
        GuardConfig,
        _guard,
        guard_configurations.CONFIGURATIONS,
    ),
)
