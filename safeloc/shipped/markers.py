"""Machines that use balises and radar reflectors: position, stop, route, direction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from pydantic import BaseModel

from safeloc.language.system import lower
from safeloc.models import balise, reflector, route, stop_point, travel_direction, turn_off
from safeloc.models.balise import configurations as balise_configurations
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.balise.variables import parts as balise_parts
from safeloc.models.reflector import configurations as reflector_configurations
from safeloc.models.reflector.picture import picture as reflector_picture
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.reflector.variables import parts as reflector_parts
from safeloc.models.route import configurations as route_configurations
from safeloc.models.route.picture import picture as route_picture
from safeloc.models.route.variables import RouteConfig
from safeloc.models.route.variables import parts as route_parts
from safeloc.models.stop_point import configurations as stop_point_configurations
from safeloc.models.stop_point.picture import picture as stop_picture
from safeloc.models.stop_point.variables import StopPointConfig
from safeloc.models.stop_point.variables import parts as stop_point_parts
from safeloc.properties import balise as balise_properties
from safeloc.properties import reflector as reflector_properties
from safeloc.properties import route as route_properties
from safeloc.properties import stop_point as stop_point_properties
from safeloc.properties import travel_direction as direction_properties
from safeloc.properties import turn_off as turn_off_properties
from safeloc.reported import Reported
from safeloc.runtime.streams.steps import Cell
from safeloc.shipped.making import recorded, single
from safeloc.target import Entry, Target


def _balise(config: BaseModel) -> Target:
    assert isinstance(config, BaliseConfig)
    model = balise.build(balise_parts(config))
    return Target(
        "balise",
        (model.machine,),
        lower(model.machine),
        tuple(balise_properties.properties(model)),
        config,
        model.machine.doc,
        recorded("balise"),
        Reported(),
        lambda seed: _balise_simulated(config, seed),
    )


def _balise_simulated(config: BaliseConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.balise.simulate import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


def _reflector(config: BaseModel) -> Target:
    assert isinstance(config, ReflectorConfig)
    model = reflector.build(reflector_parts(config))
    made = single(model.machine, reflector_properties.properties(model), config)
    simulate = partial(_reflector_simulated, config)
    return replace(made, reported=Reported(), simulate=simulate, pictures=(reflector_picture(config),))


def _reflector_simulated(config: ReflectorConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.reflector.simulate import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


def _stop_point(config: BaseModel) -> Target:
    assert isinstance(config, StopPointConfig)
    model = stop_point.build(stop_point_parts(config))
    made = single(model.machine, stop_point_properties.properties(model), config)
    return replace(made, simulate=partial(_stop_simulated, config), pictures=(stop_picture(config),))


def _stop_simulated(config: StopPointConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.stop_point.simulate import simulate_stop  # numpy is loaded only where something is simulated

    return simulate_stop(config, seed=seed)


def _turn_off(config: BaseModel) -> Target:
    assert isinstance(config, turn_off.TurnOffConfig)
    model = turn_off.build(turn_off.parts(config))
    return single(model.machine, turn_off_properties.properties(model), config)


def _travel_direction(config: BaseModel) -> Target:
    assert isinstance(config, travel_direction.DirectionConfig)
    model = travel_direction.build(travel_direction.parts(config))
    return single(model.machine, direction_properties.properties(model), config)


def _route(config: BaseModel) -> Target:
    assert isinstance(config, RouteConfig)
    model = route.build(route_parts(config))
    made = single(model.machine, route_properties.properties(model), config)
    return replace(made, reported=Reported(), pictures=(route_picture(config),))


ENTRIES = (
    Entry(
        "balise",
        "balise groups, supervised by linking, and an odometer between them",
        BaliseConfig,
        _balise,
        balise_configurations.CONFIGURATIONS,
    ),
    Entry(
        "reflector",
        "radar reflectors, and odometry between them",
        ReflectorConfig,
        _reflector,
        reflector_configurations.CONFIGURATIONS,
    ),
    Entry(
        "stop_point",
        "precise stop at a platform, with repositioning",
        StopPointConfig,
        _stop_point,
        stop_point_configurations.CONFIGURATIONS,
    ),
    Entry(
        "route",
        "which route through switches, from models and places of reflectors",
        RouteConfig,
        _route,
        route_configurations.CONFIGURATIONS,
    ),
    Entry("turn_off", "straight on or turning off, seen by radar", turn_off.TurnOffConfig, _turn_off),
    Entry(
        "travel_direction",
        "direction of travel from reflectors around a balise",
        travel_direction.DirectionConfig,
        _travel_direction,
    ),
)
