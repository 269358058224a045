"""The catalogue entry of the route machine."""

from __future__ import annotations

from safeloc.models import route
from safeloc.models.route.configurations import CONFIGURATIONS
from safeloc.models.route.picture import picture
from safeloc.models.route.variables import RouteConfig, parts
from safeloc.properties import route as claims
from safeloc.reported import Reported
from safeloc.target import Entry, Family, Pair, Target, single


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
        pairs=(
            Pair("rate beside constant", "odometer.constant_mm:down", "odometer.rate_ppm:up"),
            Pair("constant beside rate", "odometer.rate_ppm:down", "odometer.constant_mm:up"),
            Pair("line speed beside cycle time", "period_ms:down", "max_speed_mm_s:up"),
            Pair("cycle time beside line speed", "max_speed_mm_s:down", "period_ms:up"),
            Pair("creep beside rate", "odometer.rate_ppm:down", "odometer.floor_mm_s:up"),
        ),
        records_of={"front_wheel_mm": "odometer_mm"},
    ),
)
