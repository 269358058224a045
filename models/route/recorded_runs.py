"""Recordings of the route machine that ship: runs over the line of source 001, fig. 3, whole and with a reflector missed.

`python -m safeloc.models.route.recorded_runs` writes them, `... recorded_runs FOLDER` those that are made on demand; the tests
check that they come out the same.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from safeloc.models.line_runs.configs import LineVehicle
from safeloc.models.line_runs.drive import Journey, streams
from safeloc.models.route.simulate import Steps, Way, simulate, way
from safeloc.models.route.variables import RouteConfig
from safeloc.railway.map.routes import Route, through_routes
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.walk import Walk
from safeloc.runtime.streams.steps import write_steps
from safeloc.simulation.motion import Leg

FOLDER, LINE, MOST_ROUTES = Path(__file__).with_name("recordings"), "fig3", 100
_STEADY = [Leg(30_000, 50.0)]
"""Up to 30 m/s, 50 s in all."""


@dataclass(frozen=True)
class Run:
    """A run along the route with these models.

    missed  number of the reflector that is never seen, counted from 0
    seed    seed of the drawn errors
    to_the_end   from standstill to the end of the route, as the line permits; otherwise 50 s of `_STEADY`
    """

    models: str
    seed: int
    to_the_end: bool = False
    missed: int | None = None


RUNS: Mapping[str, Run] = {
    "acd-every-reflector": Run("ACD", 1, to_the_end=True),
    "adcd-first-missed": Run("ADCD", 3, missed=0),
    "adcd-second-missed": Run("ADCD", 3, missed=1),
}
"""The recordings that ship, by the end of their names: the route is known; all are given up; it is known in spite of a reflector missed."""
ON_DEMAND: Mapping[str, Run] = {
    "adab-every-reflector": Run("ADAB", 1, to_the_end=True),
    "adad-every-reflector": Run("ADAD", 1, to_the_end=True),
    "adcd-every-reflector": Run("ADCD", 3),
    "dcd-every-reflector": Run("DCD", 5),
}
"""Runs along the other routes of the line, which do not ship: others show each of their transitions and cases."""


def recorded(run: Run) -> Steps:
    """Return the steps of a run; all routes of its direction are possible at the start."""
    walk = Walk(find_line(LINE))
    routes = [one for one in through_routes(walk.topology, MOST_ROUTES) if one.runs[0].direction == "increasing"]
    taken = [one.models() for one in routes].index(run.models)
    return _driven(walk, routes, taken, run.seed) if run.to_the_end else _steady(routes, taken, run)


def _driven(walk: Walk, routes: Sequence[Route], taken: int, seed: int) -> Steps:
    (stream,) = streams(Journey(routes[taken], walk, LineVehicle(), seed, tuple(routes), ()), "route")
    return [dict(step) for step in stream.steps]


def _steady(routes: Sequence[Route], taken: int, run: Run) -> Steps:
    ways: list[Way] = [way(number, one) for number, one in enumerate(routes, 1)]
    missed = [] if run.missed is None else [ways[taken].sights[run.missed].identity]
    return simulate(RouteConfig(), ways, taken + 1, seed=run.seed, legs=_STEADY, missed=missed)


def write(folder: Path = FOLDER, runs: Mapping[str, Run] = RUNS) -> list[Path]:
    """Write the recordings and return their paths."""
    paths = [folder / f"route-{name}.jsonl.gz" for name in runs]
    for path, run in zip(paths, runs.values(), strict=True):
        write_steps(path, recorded(run), machine="route")
    return paths


if __name__ == "__main__":
    for path in write(Path(sys.argv[1]), ON_DEMAND) if sys.argv[1:] else write():
        print(path)
