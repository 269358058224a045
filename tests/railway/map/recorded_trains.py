"""The recorded runs: the network, the path that each train took, and its fixes on it. Skips visibly without the data."""

from __future__ import annotations

from functools import cache

from safeloc.railway.map.imports.geojson import read_geojson
from safeloc.railway.map.imports.geojson_path import read_path, route_over
from safeloc.railway.map.model import Line
from safeloc.railway.map.placing import with_balise_groups
from safeloc.railway.map.recorded_run import OnRoute, on_route, read_fixes
from safeloc.railway.map.routes import Route
from safeloc.railway.map.topology import Topology
from tests.data_sources import data_file

PATHS = {
    "28876": "log_28876_L36-B-path-calculation.geojson",
    "31176": "log_31176_25N-B_to_L36C-B-path-calculation.geojson",
    "29083": "log_29083_L36-A-path-calculation.geojson",
}
EDGES_31259 = (
    "5916", "2026", "7855", "7818", "9754", "5831", "2013", "9755", "2014", "7819", "7154", "9422", "1388",
)  # fmt: skip
"""No path was published with this log; of all ways through the network this one lies nearest to it."""


@cache
def network() -> Line:
    """The track network around the airport."""
    return read_geojson(data_file("trains/network_airport.geojson")).line


@cache
def route_of(log: str) -> Route:
    """The way the train took."""
    topology = Topology(network())
    if log in PATHS:
        return read_path(data_file(f"trains/{PATHS[log]}"), topology).route
    return route_over([f"88_L_{number}" for number in EDGES_31259], topology)


@cache
def fixes_of(log: str) -> tuple[OnRoute, ...]:
    """All fixes of the log, projected to the way."""
    return on_route(read_fixes(data_file(f"trains/log_{log}.csv")), route_of(log))


def equipped(log: str, spacing_mm: int) -> Route:
    """The way with balise groups placed along it, the first one 50 m ahead of where the recording begins."""
    route = route_of(log)
    places = range(fixes_of(log)[0].position_mm + 50_000, route.length_mm, spacing_mm)
    line = with_balise_groups(route, places, accuracy_mm=1_000)
    return Route(Topology(line), route.runs, route.start_mm, route.end_mm)
