"""The catalogue entry of the route machine."""

from __future__ import annotations

from safeloc.models import route
from safeloc.models.route.configurations import CONFIGURATIONS
from safeloc.models.route.picture import picture
from safeloc.models.route.variables import RouteConfig, parts
from safeloc.properties import route as claims
from safeloc.reported import Reported
from safeloc.target import Entry, Family, Target, single


def target(config: RouteConfig) -> Target:
    """Make the machine."""
    model = route.build(parts(config))
    properties = claims.properties(model)
    return single(model.machine, properties, config, reported=Reported(), pictures=(picture(config),))


ENTRIES = (
    Entry(
        "route",
        "which route through switches, from models and places of reflectors",
        RouteConfig,
        target,
        Family.MARKERS,
        place=40,
        configurations=CONFIGURATIONS,
        silent=("route",),
        records_of={"front_wheel_mm": "odometer_mm"},
    ),
)
