"""Vehicles on lines for tests: driven, followed by the machine on board, and what it said."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from safeloc.catalogue import ENTRIES, Target
from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.language.expr import TRUE, Expr, Num
from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.nodes import Value
from safeloc.language.spec import always
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.units import Enumeration
from safeloc.language.verdict import Held
from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.line_runs.configs import LineVehicle
from safeloc.models.line_runs.drive import Journey, Stream, streams
from safeloc.models.line_runs.faults import parse
from safeloc.railway.map.elements import Balise, BaliseGroup
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import Place
from safeloc.railway.map.routes import Route, routes_between, through_routes
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Topology
from safeloc.railway.map.walk import Walk
from tests.railway.map.made import straight

TRUSTING = LineVehicle(trust_first=True)
FEW = straight(
    1_200_000,
    balise_groups=tuple(
        BaliseGroup(
            id=f"g{number}", edge="e0", identity=number, location_accuracy_mm=300,
            balises=(Balise(position_mm=place), Balise(position_mm=place + 3_000)),
        )
        for number, place in enumerate(range(100_000, 1_100_000, 150_000), 1)
    ),
)  # fmt: skip
"""Seven linked groups, 150 m apart: enough to be told of beforehand."""


EXACT = LineVehicle(
    layout=LayoutConfig(detection_accuracy_mm=0, radar_error_mm=50, map_accuracy_mm=20), trust_first=True, in_time=True
)
"""A vehicle for stops within half a metre: what its radar's self-test leaves open fits the window."""


@cache
def walk_of(name: str) -> Walk:
    """A shipped line to walk along; `few` is that of seven groups, `fig2-fine` has balises known to 5 cm."""
    if name == "fig2-fine":
        line = find_line("fig2")
        groups = tuple(one.model_copy(update={"location_accuracy_mm": 50}) for one in line.balise_groups)
        return Walk(line.model_copy(update={"balise_groups": groups}))
    return Walk(FEW if name == "few" else find_line(name))


@cache
def routes_of(name: str) -> dict[str, Route]:
    """The routes of a line from end to end, by their models."""
    return {route.models(): route for route in through_routes(walk_of(name).topology, 100)}


def between(line: Line, edge: str, start_mm: int, end_mm: int) -> Route:
    """A piece of one edge as a route."""
    return routes_between(Topology(line), Place(edge, start_mm), Place(edge, end_mm))[0]


def driven(
    line: str,
    machine: str,
    *faults: str,
    models: str = "",
    route: Route | None = None,
    vehicle: LineVehicle = TRUSTING,
    seed: int = 1,
) -> Iterator[Stream]:
    """The streams of a machine on one route of a line: that of these models, or else the first; one by one."""
    every = routes_of(line)
    taken = route or (every[models] if models else next(iter(every.values())))
    rivals = [taken] if route else list(every.values())
    return streams(Journey(taken, walk_of(line), vehicle, seed, rivals, parse(faults, [machine])), machine)  # fmt: skip


def first(
    line: str,
    machine: str,
    *faults: str,
    models: str = "",
    route: Route | None = None,
    vehicle: LineVehicle = TRUSTING,
    seed: int = 1,
) -> Stream:
    """The first of them."""
    return next(driven(line, machine, *faults, models=models, route=route, vehicle=vehicle, seed=seed))  # fmt: skip


@dataclass(frozen=True)
class Said:
    """What a machine said after each step: outputs (members by name), mode, and the transitions that fired."""

    outputs: Sequence[Mapping[str, Value | str]]
    modes: Sequence[str]
    fired: Sequence[str]
    standing: Sequence[str]

    def every(self, name: str) -> set[Value | str]:
        """All values of an output or a named state."""
        return {one[name] for one in self.outputs}


_BOARDS: dict[tuple[str, str], tuple[Target, Compiled]] = {}


def _board(stream: Stream) -> tuple[Target, Compiled]:
    key = (stream.machine, stream.config.model_dump_json())
    if key not in _BOARDS:
        target = ENTRIES[stream.machine].make(stream.config)
        _BOARDS[key] = target, compile_system(without_ghosts(target.system))
    return _BOARDS[key]


def _labels(system: TransitionSystem) -> dict[str, Sequence[str]]:
    """The members of enumerated outputs and state."""
    terms: dict[str, Expr] = {**{var.name: var for var in system.state}, **system.outputs}
    return {
        name: term.unit.members
        for name, term in terms.items()
        if isinstance(term, Num) and isinstance(term.unit, Enumeration)
    }


def said(stream: Stream) -> Said:
    """The machine on board, with nothing but what a vehicle has."""
    target, code = _board(stream)
    system = without_ghosts(target.system)
    known, modes = {var.name for var in system.inputs}, target.machines[0].modes
    labels = _labels(system)
    state, outputs = code.first(), list[Mapping[str, Value | str]]()
    seen, fired, standing = list[str](), list[str](), list[str]()
    for step in stream.steps:
        state, names = code.step(state, code.read({name: value for name, value in step.items() if name in known}))
        inside = dict(zip(code.state_names, state, strict=True))
        now = {**inside, **code.named_outputs(state)}
        if target.reported is not None:
            standing.append(target.reported.standing(now, int(step["truth_mm"])))
        outputs.append({name: labels[name][int(value)] if name in labels else value for name, value in now.items()})
        seen.append(modes[int(inside["mode"])].label)
        fired += code.fired(names).values()
    return Said(outputs, seen, fired, standing)


def followed(stream: Stream) -> tuple[Target, Trace]:
    """The run of the whole machine, its environment included, by the interpreter."""
    target, _ = _board(stream)
    known = {var.name for var in target.system.inputs}
    rows = [{name: value for name, value in step.items() if name in known} for step in stream.steps]
    return target, run(target.system, rows)


def broken(stream: Stream) -> list[str]:
    """The properties that do not hold on a stream, all the way and with the assumption kept all the way."""
    target, trace = followed(stream)
    asked = [prop for prop in target.properties if prop.kind != "reachable"]
    return [
        prop.name for prop, found in zip(asked, check_all(trace, asked), strict=True) if not isinstance(found, Held)
    ]


def kept_all_the_way(stream: Stream) -> bool:
    """Return whether every step of a stream obeys the assumption."""
    _, trace = followed(stream)
    [found] = check_all(trace, [always("anything", TRUE)])
    return isinstance(found, Held)
