"""The picture of a run of the route machine, as in source 001, fig. 3."""

from __future__ import annotations

from safeloc.models.route.variables import RouteConfig
from safeloc.railway.pictures import Hypothesis, Recognition, Sighting, TrackPlan


def picture(config: RouteConfig) -> Recognition:
    """Return the possible routes over the distance, with the plan of the line if the recording's line is known."""
    routes = tuple(_route(number) for number in range(1, config.routes + 1))
    sighting = Sighting("sighting_range_mm", "sighting_error_mm", "sighting_model", "course_taken", "start_error_mm")
    return Recognition("Route recognition", routes, sighting, plan)


def _route(number: int) -> Hypothesis:
    name = f"route_{number}"
    inputs = (f"{name}_reflector_mm", f"{name}_model", f"{name}_course")
    return Hypothesis(number, f"{name}_possible", f"{name}_low_mm", f"{name}_high_mm", *inputs)


def plan(recording: str) -> TrackPlan | None:
    """Return the plan of fig3 for the named runs: all are over this line, its routes numbered in the order of the map."""
    from safeloc.models.route.recorded_runs import ON_DEMAND, RUNS  # numpy is loaded only where a picture is drawn

    if recording not in {f"route-{name}" for name in (*RUNS, *ON_DEMAND)}:
        return None
    from safeloc.railway.map.plan import track_plan  # networkx and the map as well
    from safeloc.railway.map.routes import through_routes
    from safeloc.railway.map.toml_files import find_line
    from safeloc.railway.map.topology import Topology

    topology = Topology(find_line("fig3"))
    routes = through_routes(topology, 100)
    return track_plan([route for route in routes if route.runs[0].direction == "increasing"])
