"""The catalogue entry of the restrictive state behind a source."""

from __future__ import annotations

from safeloc.language.system import lower
from safeloc.models import delocalized
from safeloc.models.delocalized import DelocalizedConfig
from safeloc.properties import delocalized as claims
from safeloc.reported import Reported
from safeloc.target import Entry, Family, Pair, Target


def target(config: DelocalizedConfig) -> Target:
    """Make the machine; no recordings of it ship."""
    machine = delocalized.machine(config)
    properties = tuple(claims.properties(machine, config))
    reported = Reported(valid="restrictive", valid_is=False)
    return Target("delocalized", (machine,), lower(machine), properties, config, machine.doc, reported=reported)


ENTRIES = (
    Entry(
        "delocalized",
        "the restrictive state behind any source",
        DelocalizedConfig,
        target,
        Family.ODOMETRY,
        place=20,
        pairs=(Pair("length of the line beside tolerance", "tolerance_mm:down", "position_limit_mm:up", "design"),),
        silent=("delocalized",),
    ),
)
