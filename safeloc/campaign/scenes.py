"""From a stratum of a campaign to the machine and the simulation of its vehicles, and the draws for them."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from safeloc.campaign.declaration import Campaign, FaultDraw, Shard, Stratum
from safeloc.campaign.distributions import Choice, Distribution, Fixed
from safeloc.campaign.judged import libraries
from safeloc.campaign.tilting import Tilting, refusal
from safeloc.catalogue import ENTRIES, load_target
from safeloc.errors import InputError
from safeloc.language.interpret import start
from safeloc.language.nodes import Value
from safeloc.language.renamed import hint
from safeloc.models.line_runs.configs import LineVehicle
from safeloc.models.line_runs.many import ON_LINE, configured
from safeloc.models.line_runs.route_choice import chosen_routes
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer.simulation.many import LocalizerJourneys, require_journey
from safeloc.railway.audit.vehicle import SHIPPED, find_layout
from safeloc.railway.map.model import content_checksum
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Topology
from safeloc.runtime.embedding.cycle_length import configured_period_ms
from safeloc.simulated import first_values
from safeloc.simulation.faults import Fault, Kinds
from safeloc.simulation.many_runs import Array, Drawn, DrawnFigure, ManyRuns, ManySimulation, packed
from safeloc.simulation.vehicle_seed import VehicleSeed
from safeloc.simulation.vehicles import load_vehicle
from safeloc.target import Target

CYCLES = DrawnFigure("cycles", 0, 1_000_000, 0, "time in a run")
_MS: Mapping[str, float] = {"ms": 1, "s": 1_000}
LOCALIZER = "localizer"
_UNITS: Mapping[str, str] = {
    "_mm_s": "mm/s",
    "_mm": "mm",
    "_ms": "ms",
    "_ppm": "ppm",
    "_nm": "nm",
    "_db": "dB",
    "_hz": "Hz",
}
"""Ends of names, and the units that they mean."""


@dataclass(frozen=True, eq=False)
class Scene:
    """The machine of a stratum, and the simulation of its vehicles.

    content  what line, routes and vehicle hold: shards with another content are others
    """

    target: Target
    simulation: ManySimulation
    content: str = ""


@dataclass(frozen=True, eq=False)
class OwnSimulation:
    """Vehicles of a machine whose simulation knows seeds only: nothing can be drawn but the seed."""

    target: Target

    @property
    def figures(self) -> Mapping[str, DrawnFigure]:
        """No figures."""
        return {}

    @property
    def kinds(self) -> Mapping[str | int, Kinds]:
        """No faults."""
        return {}

    @property
    def timeless(self) -> Collection[str | int]:
        """No faults."""
        return ()

    @property
    def period_ms(self) -> int:
        """The length of a cycle, as far as the configuration says it; else 1 000 ms."""
        return configured_period_ms(self.target.name, self.target.config) or 1_000

    def runs(self, drawn: Drawn, cycles: int) -> ManyRuns:
        """Return the runs of the vehicles."""
        assert self.target.simulate is not None
        made = [self.target.simulate(int(seed.rng("simulation").integers(0, 2**31))) for seed in drawn.seeds]
        return ManyRuns(packed(self.target.system, made, cycles), self._first([first_values(run) for run in made]))

    def _first(self, chosen: Sequence[Mapping[str, Value]]) -> dict[str, Array | Value]:
        """Return the first values of all vehicles, of each variable that some run chooses."""
        states = [start(self.target.system, one) for one in chosen]
        names = {name for one in chosen for name in one}
        return {
            var.name: np.array([state[var] for state in states])
            for var in self.target.system.state
            if var.name in names
        }


@lru_cache(maxsize=16)
def _scene(
    machine: str, line: str | None, routes: tuple[str, ...], vehicle: str | None, trust_first: bool, place: str
) -> Scene:
    """Return the scene; `place` is the folder from which files are named."""
    if machine == LOCALIZER:
        require_journey(line or "")
        target = _loaded(machine)
        assert isinstance(target.config, LocalizerConfig)
        return Scene(target, LocalizerJourneys(target.config, target.system, line or "", libraries()), repr(line))
    if line is None:
        return _alone(machine, vehicle, place)
    known = find_line(_file(line, place))
    driven = _vehicle(vehicle, trust_first, place)
    config = configured(machine, driven)
    target = _made(machine, config.model_dump_json())
    chosen = chosen_routes(Topology(known), routes, None, None)
    content = f"{content_checksum(known)} {[one.route.name for one in chosen]} {driven!r}"
    return Scene(target, ON_LINE[machine](driven, chosen, config, target.system, libraries()), content)


@lru_cache(maxsize=4)
def _loaded(spec: str) -> Target:
    return load_target(spec)


@lru_cache(maxsize=16)
def _made(machine: str, config: str) -> Target:
    """Return the machine in a configuration (JSON), once in a process: strata with the same one share its compiled code."""
    entry = ENTRIES[machine]
    return replace(entry.make(entry.config.model_validate_json(config)), spec=machine)


def _alone(machine: str, vehicle: str | None, place: str) -> Scene:
    file, colon, name = machine.rpartition(":")
    target = _loaded(f"{_file(file, place)}{colon}{name}")
    if vehicle is not None:
        raise InputError(f"vehicles drive along lines; {machine} has no line here.")
    if target.simulate is None:
        raise InputError(f"{machine} has no simulation; a campaign runs machines that have one.")
    return Scene(target, OwnSimulation(target))


def _vehicle(name: str | None, trust_first: bool, place: str) -> LineVehicle:
    if name is None:
        return LineVehicle(trust_first=trust_first)
    path = SHIPPED / f"{name}.toml"
    file = str(path) if path.is_file() else _file(name, place)
    return LineVehicle(name, load_vehicle(Path(file)), find_layout(name if path.is_file() else file), trust_first)


def _file(name: str, place: str) -> str:
    """Return a file named from the folder of the campaign; any other name as it is."""
    beside = Path(place) / name
    return str(beside) if beside.is_file() else name


def scene_of(campaign: Campaign, stratum: Stratum) -> Scene:
    """Return the scene of a stratum. InputError, with its place in the file, for a machine, line, route or vehicle that does not fit."""
    declared = campaign.declared
    line = None if stratum.line is None else declared.lines[stratum.line]
    vehicle = None if stratum.vehicle is None else declared.vehicles[stratum.vehicle].vehicle
    try:
        return _scene(
            declared.machine,
            line.line if line else None,
            line.routes if line else (),
            vehicle,
            declared.trust_first,
            str(Path(campaign.name).parent),
        )
    except InputError as error:
        place: Sequence[str | int] = ("machine",) if stratum.line is None else ("lines", stratum.line)
        raise campaign.refuse(place, str(error)) from error


def check_strata(campaign: Campaign) -> None:
    """Refuse, with file and line, figures and faults that the simulations of the campaign do not have, and wrong units or ranges."""
    for stratum in campaign.strata:
        simulation = scene_of(campaign, stratum).simulation
        for name, (one, place) in campaign.figures_of(stratum).items():
            if name not in simulation.figures:
                known = ", ".join(simulation.figures) or "none"
                raise campaign.refuse(
                    place, f"there is no such figure; there are {known}.{hint(name, simulation.figures)}"
                )
            _factor(campaign, one, simulation.figures[name], place, simulation.period_ms)
        situation, at = campaign.situation_of(stratum), ("situations", stratum.situation)
        figures = {name: one for name, (one, _) in campaign.figures_of(stratum).items()}
        _check_tilt(campaign, figures, situation.tilt, at)
        for number, fault in enumerate(situation.faults):
            _check_fault(campaign, fault, (*at, "faults", number), simulation)
            _check_tilt(campaign, fault.drawn, fault.tilt, (*at, "faults", number))


def _check_tilt(
    campaign: Campaign,
    declared: Mapping[str, Distribution],
    tilts: Mapping[str, Distribution],
    place: Sequence[str | int],
) -> None:
    for name, one in tilts.items():
        why = refusal(declared.get(name), one)
        if why:
            raise campaign.refuse((*place, "tilt", name), why)


def _check_fault(campaign: Campaign, fault: FaultDraw, place: Sequence[str | int], simulation: ManySimulation) -> None:
    kinds = simulation.kinds
    if fault.where not in kinds:
        known = ", ".join(str(one) for one in kinds if one != "") or "none"
        meant = [f" Write where = {json.dumps(one)}." for one in kinds if one != "" and str(one) == str(fault.where)]
        hint = "".join(meant)
        raise campaign.refuse(
            (*place, "where"), f"nothing named {fault.where!r} can be faulty; there are {known}.{hint}"
        )
    figures = {name: _first(one) for name, one in fault.figures.items()}
    try:
        kinds[fault.where].require([Fault(fault.kind, fault.where, figures=figures)])
    except InputError as error:
        raise campaign.refuse((*place, "kind"), str(error)) from error
    for name, figure in fault.figures.items():
        unit = _unit_of(name)
        if figure.unit != unit:
            raise campaign.refuse((*place, "figures", name), f"its unit is {unit}, not {figure.unit!r}.")
    for name, one in (("begin", fault.begin), ("lasts", fault.lasts)):
        if one is not None and fault.where in simulation.timeless:
            raise campaign.refuse((*place, name), f"a fault of {fault.where} acts for the whole run; leave {name} out.")
        if one is not None:
            factor = _factor(campaign, one, CYCLES, (*place, name), simulation.period_ms)
            if name == "begin" and one.support[1] * factor >= campaign.declared.cycles:
                raise campaign.refuse(
                    (*place, name), f"{one.words} may begin after the run of {campaign.declared.cycles} cycles."
                )


def _unit_of(name: str) -> str:
    """Return the unit that the name of a fault's figure ends with; a figure without one is a count."""
    return next((unit for end, unit in _UNITS.items() if name.endswith(end)), "count")


def _first(one: Distribution) -> int | float:
    value = one.support[0]
    return int(value) if value.is_integer() else value


def _factor(
    campaign: Campaign, one: Distribution, figure: DrawnFigure, place: Sequence[str | int], period_ms: int
) -> float:
    """Return the factor from the unit of a distribution to that of the figure; refuse a wrong unit and a value out of range."""
    factor = 1.0
    if one.unit != figure.unit:
        if figure.unit != "cycles" or one.unit not in _MS:
            also = ", ms or s" if figure.unit == "cycles" else ""
            raise campaign.refuse(place, f"its unit is {figure.unit}{also}, not {one.unit!r} ({figure.what}).")
        factor = _MS[one.unit] / period_ms
    low, high = (value * factor for value in one.support)
    if low < figure.low or high > figure.high:
        raise campaign.refuse(place, f"{one.words} leaves the range {figure.low:g} to {figure.high:g} {figure.unit}.")
    if figure.discrete and not isinstance(one, Fixed | Choice):
        raise campaign.refuse(place, "each value is computed by itself: give a fixed value or a choice of some.")
    return factor


# ------------------------------------------------------------------ draws


def drawn_runs(campaign: Campaign, shard: Shard) -> tuple[Scene, Drawn, ManyRuns]:
    """Return the scene of a shard, what is drawn of its vehicles, and their runs; the same wherever it is run."""
    scene, drawn = scene_of(campaign, shard.stratum), drawn_of(campaign, shard)
    return scene, drawn, scene.simulation.runs(drawn, campaign.declared.cycles)


def drawn_of(campaign: Campaign, shard: Shard) -> Drawn:
    """Return what is drawn of the vehicles of a shard, before any of them runs."""
    simulation = scene_of(campaign, shard.stratum).simulation
    rng = np.random.default_rng([campaign.declared.seed, shard.number])
    number, declared = shard.end - shard.first, campaign.figures_of(shard.stratum)
    situation = campaign.situation_of(shard.stratum)
    tilting = Tilting(situation.tilted if situation.greatest_weight else None, number, rng)
    figures = {name: np.full(number, one.default) for name, one in simulation.figures.items()}
    for name in simulation.figures:
        if name in declared:
            one, place = declared[name]
            factor = _factor(campaign, one, simulation.figures[name], place, simulation.period_ms)
            figures[name] = tilting.draw(name, one, situation.tilt) * factor
    faults: list[list[Fault]] = [[] for _ in range(number)]
    for index, fault in enumerate(situation.faults):
        place = ("situations", shard.stratum.situation, "faults", index)
        for run, struck in enumerate(_faults(campaign, fault, place, simulation, tilting, number)):
            faults[run].append(struck)
    seeds = [VehicleSeed(campaign.declared.seed, (shard.number, vehicle)) for vehicle in range(number)]
    return Drawn(number, figures, faults, seeds, tilting.weights)


def _faults(
    campaign: Campaign,
    fault: FaultDraw,
    place: Sequence[str | int],
    simulation: ManySimulation,
    tilting: Tilting,
    number: int,
) -> list[Fault]:
    """Return the fault of each vehicle."""
    times = {}
    for name, one in (("begin", fault.begin), ("lasts", fault.lasts)):
        if one is not None:
            factor = _factor(campaign, one, CYCLES, (*place, name), simulation.period_ms)
            times[name] = np.rint(tilting.draw(name, one, fault.tilt) * factor).astype(np.int64)
    begin = times.get("begin", np.zeros(number, dtype=np.int64))
    end = None if "lasts" not in times else begin + np.maximum(1, times["lasts"])
    figures = {name: tilting.draw(name, one, fault.tilt) for name, one in fault.figures.items()}
    kinds = simulation.kinds[fault.where]
    return [
        Fault(
            fault.kind,
            fault.where,
            int(begin[run]),
            None if end is None else int(end[run]),
            {name: _like(kinds.figures[fault.kind][name], values[run]) for name, values in figures.items()},
        )
        for run in range(number)
    ]


def _like(default: object, value: np.float64) -> int | float:
    """Return a drawn figure as a whole number where its default is one."""
    return int(np.rint(value)) if isinstance(default, int) else float(value)
