"""Properties of the example of a new machine."""

from __future__ import annotations

from safeloc.language.spec import Property, always, reachable
from safeloc.models.standstill import Standstill

REQUIREMENTS = ("OWN-1",)


def properties(model: Standstill) -> list[Property]:
    """While the vehicle is said to stand it creeps at most; it can be said to stand."""
    standing, creeps = model.machine.flag("standing"), model.own.speed <= model.own.config.error_mm_s
    return [
        always(
            "standing",
            standing.implies(creeps),
            statement="while the machine says that the vehicle stands, its true speed is no more than the error",
            requirements=REQUIREMENTS,
            assumption="measured within its error",
        ),
        reachable("may stand", standing, statement="the vehicle can be said to stand", requirements=REQUIREMENTS),
    ]
