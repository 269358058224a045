"""The machines that ship, by name: each with its configuration, properties, recorded streams and simulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from pydantic import BaseModel

from safeloc.machine import Machine
from safeloc.models import (
    axle_counter,
    axle_head,
    axle_section,
    balise,
    delocalized,
    emitter,
    fibre,
    odometry,
    reflector,
    route,
    satellite,
    satellite_selection,
    sections,
    stop_point,
    supervised_odometry,
    train_order,
    travel_direction,
    turn_off,
    verification,
)
from safeloc.models.balise_parts.variables import BaliseConfig
from safeloc.models.balise_parts.variables import parts as balise_parts
from safeloc.models.odometry_parts.variables import OdometryConfig, parts
from safeloc.models.reflector_parts.picture import picture as reflector_picture
from safeloc.models.reflector_parts.variables import ReflectorConfig
from safeloc.models.reflector_parts.variables import parts as reflector_parts
from safeloc.models.route_parts.picture import picture as route_picture
from safeloc.models.route_parts.variables import RouteConfig
from safeloc.models.route_parts.variables import parts as route_parts
from safeloc.models.satellite_parts.variables import SatelliteConfig
from safeloc.models.stop_point_parts.picture import picture as stop_picture
from safeloc.models.stop_point_parts.variables import StopPointConfig
from safeloc.models.stop_point_parts.variables import parts as stop_point_parts
from safeloc.nodes import Value
from safeloc.properties import axle_counter as counter_properties
from safeloc.properties import axle_head as head_properties
from safeloc.properties import axle_section as axle_section_properties
from safeloc.properties import balise as balise_properties
from safeloc.properties import delocalized as delocalized_properties
from safeloc.properties import emitter as emitter_properties
from safeloc.properties import fibre as fibre_properties
from safeloc.properties import odometry as odometry_properties
from safeloc.properties import odometry_faults as odometry_fault_properties
from safeloc.properties import reflector as reflector_properties
from safeloc.properties import route as route_properties
from safeloc.properties import satellite as satellite_properties
from safeloc.properties import satellite_selection as selection_properties
from safeloc.properties import sections as sections_properties
from safeloc.properties import stop_point as stop_point_properties
from safeloc.properties import supervised_odometry as supervised_properties
from safeloc.properties import train_order as order_properties
from safeloc.properties import travel_direction as direction_properties
from safeloc.properties import turn_off as turn_off_properties
from safeloc.properties import verification as verification_properties
from safeloc.reported import Reported
from safeloc.spec import Property
from safeloc.streams.steps import Cell
from safeloc.system import lower
from safeloc.target import Entry, Target

STREAMS = Path(__file__).parent / "models" / "streams"


def _shipped(name: str) -> tuple[Path, ...]:
    return tuple(sorted(STREAMS.glob(f"{name}*.jsonl")))


def _odometry(config: BaseModel) -> Target:
    assert isinstance(config, OdometryConfig)
    model = odometry.build(parts(config, with_fault=config.single_fault_safe))
    with_fault = odometry_fault_properties.properties(model) if config.single_fault_safe else []
    return Target(
        "odometry",
        (model.machine,),
        lower(model.machine),
        (*odometry_properties.properties(model), *with_fault),
        config,
        model.machine.doc,
        _shipped("odometry"),
        Reported(),
        lambda seed: _simulated(config, seed),
    )


def _simulated(config: OdometryConfig, seed: int) -> Sequence[Mapping[str, Value]]:
    from safeloc.models.odometry_streams import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


def _delocalized(config: BaseModel) -> Target:
    assert isinstance(config, delocalized.DelocalizedConfig)
    machine = delocalized.machine(config)
    properties = tuple(delocalized_properties.properties(machine, config))
    reported = Reported(valid="restrictive", valid_is=False)
    return Target("delocalized", (machine,), lower(machine), properties, config, machine.doc, reported=reported)


def _supervised(config: BaseModel) -> Target:
    assert isinstance(config, OdometryConfig)
    whole = supervised_odometry.compose_machines(config)
    machines = (whole.source.machine, whole.guard)
    properties = tuple(supervised_properties.properties(whole))
    doc = "Odometry with the delocalized machine behind it, in one step: what the host of a vehicle sees."
    reported = Reported(
        position="delocalized.position_mm",
        under="delocalized.under_mm",
        over="delocalized.over_mm",
        valid="delocalized.restrictive",
        valid_is=False,
        truth="odometry.truth_nm",
    )
    system = whole.composition.system
    return Target("supervised_odometry", machines, system, properties, config, doc, reported=reported)


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
        _shipped("balise"),
        Reported(),
        lambda seed: _balise_simulated(config, seed),
    )


def _balise_simulated(config: BaliseConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.balise_streams import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


def _reflector(config: BaseModel) -> Target:
    assert isinstance(config, ReflectorConfig)
    model = reflector.build(reflector_parts(config))
    made = _made(model.machine, reflector_properties.properties(model), config)
    simulate = partial(_reflector_simulated, config)
    return replace(made, reported=Reported(), simulate=simulate, pictures=(reflector_picture(config),))


def _reflector_simulated(config: ReflectorConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.reflector_streams import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


def _stop_point(config: BaseModel) -> Target:
    assert isinstance(config, StopPointConfig)
    model = stop_point.build(stop_point_parts(config))
    made = _made(model.machine, stop_point_properties.properties(model), config)
    return replace(made, simulate=partial(_stop_simulated, config), pictures=(stop_picture(config),))


def _stop_simulated(config: StopPointConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.stop_point_streams import simulate_stop  # numpy is loaded only where something is simulated

    return simulate_stop(config, seed=seed)


def _turn_off(config: BaseModel) -> Target:
    assert isinstance(config, turn_off.TurnOffConfig)
    model = turn_off.build(turn_off.parts(config))
    return _made(model.machine, turn_off_properties.properties(model), config)


def _travel_direction(config: BaseModel) -> Target:
    assert isinstance(config, travel_direction.DirectionConfig)
    model = travel_direction.build(travel_direction.parts(config))
    return _made(model.machine, direction_properties.properties(model), config)


def _route(config: BaseModel) -> Target:
    assert isinstance(config, RouteConfig)
    model = route.build(route_parts(config))
    made = _made(model.machine, route_properties.properties(model), config)
    return replace(made, reported=Reported(), pictures=(route_picture(config),))


def _sections(config: BaseModel) -> Target:
    assert isinstance(config, sections.SectionsConfig)
    whole = sections.compose_machines(config)
    machines = (whole.area.machine, *(one.machine for one in whole.sections))
    properties = tuple(sections_properties.properties(whole))
    doc = "Trains of a line area between axle counters, and the virtual sections that it is cut into, in one step."
    system = whole.composition.system
    return Target("sections", machines, system, properties, config, doc, _shipped("sections"))


def _selection(config: BaseModel) -> Target:
    assert isinstance(config, satellite_selection.SelectionConfig)
    model = satellite_selection.build(satellite_selection.parts(config))
    return _made(model.machine, selection_properties.properties(model), config)


def _satellite(config: BaseModel) -> Target:
    assert isinstance(config, SatelliteConfig)
    whole = satellite.compose_machines(config)
    machines = (whole.selection.machine, whole.machine)
    properties = tuple(satellite_properties.properties(whole))
    doc = "Selection of usable satellites, and position along the track from them alone, in one step."
    reported = Reported(
        position="position.position_mm",
        under="position.under_mm",
        over="position.over_mm",
        valid="position.valid",
        truth="position.truth_nm",
    )
    return Target("satellite", machines, whole.composition.system, properties, config, doc, reported=reported)


def _fibre(config: BaseModel) -> Target:
    assert isinstance(config, fibre.FibreConfig)
    model = fibre.build(fibre.parts(config))
    made = _made(model.machine, fibre_properties.properties(model), config)
    return replace(made, reported=Reported(), simulate=lambda seed: _fibre_simulated(config, seed))


def _fibre_simulated(config: fibre.FibreConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.fibre_streams import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


def _verification(config: BaseModel) -> Target:
    assert isinstance(config, verification.VerificationConfig)
    model = verification.build(verification.parts(config))
    made = _made(model.machine, verification_properties.properties(model), config)
    return replace(
        made, reported=Reported(valid="trusted"), simulate=lambda seed: _verification_simulated(config, seed)
    )


def _verification_simulated(config: verification.VerificationConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.fibre_streams import simulate_stay  # numpy is loaded only where something is simulated

    return simulate_stay(config, seed=seed)


def _axle_head(config: BaseModel) -> Target:
    assert isinstance(config, axle_head.AxleHeadConfig)
    model = axle_head.build(axle_head.parts(config))
    return _made(model.machine, head_properties.properties(model), config)


def _axle_counter(config: BaseModel) -> Target:
    assert isinstance(config, axle_counter.AxleCounterConfig)
    model = axle_counter.build(axle_counter.parts(config))
    return _made(model.machine, counter_properties.properties(model), config)


def _axle_section(config: BaseModel) -> Target:
    assert isinstance(config, axle_section.AxleSectionConfig)
    model = axle_section.build(axle_section.parts(config))
    return _made(model.machine, axle_section_properties.properties(model), config)


def _train_order(config: BaseModel) -> Target:
    assert isinstance(config, train_order.TrainOrderConfig)
    model = train_order.build(train_order.parts(config))
    return _made(model.machine, order_properties.properties(model), config)


def _emitter(config: BaseModel) -> Target:
    assert isinstance(config, emitter.EmitterConfig)
    model = emitter.build(emitter.parts(config))
    return _made(model.machine, emitter_properties.properties(model), config)


def _made(machine: Machine, properties: Sequence[Property], config: BaseModel) -> Target:
    """A single machine with the streams that ship under its name."""
    name = machine.name
    return Target(name, (machine,), lower(machine), tuple(properties), config, machine.doc, _shipped(name))


ENTRIES: Mapping[str, Entry] = {
    entry.name: entry
    for entry in (
        Entry("odometry", "odometry between markers read at the front and at the rear", OdometryConfig, _odometry),
        Entry("delocalized", "the restrictive state behind any source", delocalized.DelocalizedConfig, _delocalized),
        Entry("supervised_odometry", "odometry and delocalized in one step", OdometryConfig, _supervised),
        Entry("balise", "balise groups, supervised by linking, and an odometer between them", BaliseConfig, _balise),
        Entry("reflector", "radar reflectors, and odometry between them", ReflectorConfig, _reflector),
        Entry("stop_point", "precise stop at a platform, with repositioning", StopPointConfig, _stop_point),
        Entry("sections", "clear or not: virtual sections of a line area", sections.SectionsConfig, _sections),
        Entry("route", "which route through switches, from models and places of reflectors", RouteConfig, _route),
        Entry(
            "selection",
            "usable satellites, by a map-bound prediction",
            satellite_selection.SelectionConfig,
            _selection,
        ),
        Entry("satellite", "position along the track from usable satellites", SatelliteConfig, _satellite),
        Entry("turn_off", "straight on or turning off, seen by radar", turn_off.TurnOffConfig, _turn_off),
        Entry("fibre", "place from localization sections in a fibre", fibre.FibreConfig, _fibre),
        Entry(
            "verification",
            "a train's fibre position, verified against an axle counter",
            verification.VerificationConfig,
            _verification,
        ),
        Entry("axle_head", "axles and direction from two overlapping pulses", axle_head.AxleHeadConfig, _axle_head),
        Entry("axle_counter", "a train's entry record from its axles", axle_counter.AxleCounterConfig, _axle_counter),
        Entry(
            "axle_section",
            "clear or occupied by axles counted in and out",
            axle_section.AxleSectionConfig,
            _axle_section,
        ),
        Entry("train_order", "whose a pattern is, by order on the track", train_order.TrainOrderConfig, _train_order),
        Entry("emitter", "function check of the fibre by a test emitter", emitter.EmitterConfig, _emitter),
        Entry(
            "travel_direction",
            "direction of travel from reflectors around a balise",
            travel_direction.DirectionConfig,
            _travel_direction,
        ),
    )
}
