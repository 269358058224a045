"""What there is to prove, test, replay and report: the shipped machines by name, and a user's own by address."""

from __future__ import annotations

import difflib
import importlib
import importlib.util
import json
import sys
import tomllib
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Any

from pydantic import BaseModel, ValidationError

from safeloc.composition import Composition
from safeloc.errors import InputError, SafelocError
from safeloc.machine import Machine
from safeloc.models import (
    balise,
    delocalized,
    odometry,
    reflector,
    stop_point,
    supervised_odometry,
    travel_direction,
    turn_off,
)
from safeloc.models.balise_parts.variables import BaliseConfig
from safeloc.models.balise_parts.variables import parts as balise_parts
from safeloc.models.odometry_parts.variables import OdometryConfig, parts
from safeloc.models.reflector_parts.variables import ReflectorConfig
from safeloc.models.reflector_parts.variables import parts as reflector_parts
from safeloc.models.stop_point_parts.variables import StopPointConfig
from safeloc.models.stop_point_parts.variables import parts as stop_point_parts
from safeloc.nodes import Value
from safeloc.properties import balise as balise_properties
from safeloc.properties import delocalized as delocalized_properties
from safeloc.properties import odometry as odometry_properties
from safeloc.properties import reflector as reflector_properties
from safeloc.properties import stop_point as stop_point_properties
from safeloc.properties import supervised_odometry as supervised_properties
from safeloc.properties import travel_direction as direction_properties
from safeloc.properties import turn_off as turn_off_properties
from safeloc.reported import Reported, usual_names
from safeloc.spec import Property
from safeloc.streams.steps import Cell
from safeloc.system import TransitionSystem, lower


@dataclass(frozen=True, eq=False)
class Target:
    """A system with everything that is to be shown of it.

    streams   recorded step streams that ship with it and are replayed by `verify`
    reported  which outputs are the reported interval; None for a machine that reports none
    simulate  seed -> steps of simulated sensors, where there is a simulation
    """

    name: str
    machines: tuple[Machine, ...]
    system: TransitionSystem
    properties: tuple[Property, ...]
    config: BaseModel | None = None
    doc: str = ""
    streams: tuple[Path, ...] = ()
    reported: Reported | None = None
    simulate: Callable[[int], Sequence[Mapping[str, Cell]]] | None = None


Maker = Callable[[BaseModel], Target]


@dataclass(frozen=True, eq=False)
class Entry:
    """A shipped machine: its configuration class and how to make it."""

    name: str
    summary: str
    config: type[BaseModel]
    make: Maker


STREAMS = Path(__file__).parent / "models" / "streams"


def _shipped(name: str) -> tuple[Path, ...]:
    return tuple(sorted(STREAMS.glob(f"{name}*.jsonl")))


def _odometry(config: BaseModel) -> Target:
    assert isinstance(config, OdometryConfig)
    model = odometry.build(parts(config))
    return Target(
        "odometry",
        (model.machine,),
        lower(model.machine),
        tuple(odometry_properties.properties(model)),
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
    return replace(made, reported=Reported(), simulate=lambda seed: _reflector_simulated(config, seed))


def _reflector_simulated(config: ReflectorConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.reflector_streams import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


def _stop_point(config: BaseModel) -> Target:
    assert isinstance(config, StopPointConfig)
    model = stop_point.build(stop_point_parts(config))
    made = _made(model.machine, stop_point_properties.properties(model), config)
    return replace(made, simulate=lambda seed: _stop_simulated(config, seed))


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
        Entry("turn_off", "straight on or turning off, seen by radar", turn_off.TurnOffConfig, _turn_off),
        Entry(
            "travel_direction",
            "direction of travel from reflectors around a balise",
            travel_direction.DirectionConfig,
            _travel_direction,
        ),
    )
}


def load_target(spec: str, config: Path | None = None) -> Target:
    """A shipped machine by name, or a user's own as `package.module:name` or `path/to/file.py:name`.

    A user's name is a Machine, a Composition, or a function that returns one (called without arguments, or with the
    content of the configuration file). Its module may define `properties`, a list or a function of the machine, and
    `reported`, a Reported that names the outputs of the interval.
    Raises InputError that says what was looked for and what exists.
    """
    if ":" in spec:
        return _own(spec, config)
    if spec not in ENTRIES:
        close = difflib.get_close_matches(spec, ENTRIES, n=1)
        hint = f" Did you mean {close[0]!r}?" if close else ""
        if spec.endswith(".py"):
            hint = f" For a machine in this file give its name as well: {spec}:machine."
        raise InputError(
            f"no machine {spec!r}; there are {', '.join(ENTRIES)}, or package.module:name for your own.{hint}"
        )
    entry = ENTRIES[spec]
    return entry.make(read_config(entry.config, config))


def read_config(kind: type[BaseModel], path: Path | None) -> BaseModel:
    """A configuration from TOML or JSON, all defaults without a file; InputError naming file and fields."""
    content = {} if path is None else _content(path)
    try:
        return kind.model_validate(content)
    except ValidationError as error:
        wrong = [f"  - {'.'.join(map(str, e['loc'])) or 'whole file'}: {e['msg']}{_given(e)}" for e in error.errors()]
        fields = "1 field is" if len(wrong) == 1 else f"{len(wrong)} fields are"
        raise InputError("\n".join([f"{path or 'configuration'}: {fields} wrong:", *wrong])) from error


def _given(error: Mapping[str, Any]) -> str:
    """What stands there, unless it is the whole file."""
    return "" if isinstance(error["input"], (dict, list)) else f" (got {error['input']!r})"


def _content(path: Path) -> dict[str, Any]:
    try:
        text = path.read_text(encoding="utf-8")
        content = json.loads(text) if path.suffix == ".json" else tomllib.loads(text)
    except (OSError, ValueError) as error:
        raise InputError(
            f"{path}: cannot be read as {'JSON' if path.suffix == '.json' else 'TOML'}: {error}"
        ) from error
    if not isinstance(content, dict):
        raise InputError(f"{path}: expected a table of fields.")
    return content


def _own(spec: str, config: Path | None) -> Target:
    where, _, name = spec.rpartition(":")
    module = _module(where)
    if not hasattr(module, name):
        names = [key for key, value in vars(module).items() if isinstance(value, (Machine, Composition))]
        raise InputError(f"{where} has no {name!r}; machines in it: {names or 'none'}.")
    found = getattr(module, name)
    if callable(found):
        with _as_input_error(spec):
            found = found(_content(config)) if config is not None else found()
    if isinstance(found, Machine):
        return _target(module, found, lower(found), found.doc)
    if isinstance(found, Composition):
        return _target(module, found, found.system, "")
    raise InputError(
        f"{spec} is of type {type(found).__name__}; expected a Machine, a Composition or a function returning one."
    )


def _target(module: ModuleType, found: Machine | Composition, system: TransitionSystem, doc: str) -> Target:
    declared = getattr(module, "reported", None)
    reported = declared if isinstance(declared, Reported) else usual_names(system.outputs)
    missing = [name for name in reported.outputs if name not in system.outputs] if reported else []
    if missing:
        raise InputError(f"{module.__name__}.reported names {missing[0]!r}; outputs are {', '.join(system.outputs)}.")
    properties = _properties(module, found)
    return Target(system.name, system.machines, system, properties, None, doc, reported=reported)


def _module(where: str) -> ModuleType:
    if where.endswith(".py"):
        path = Path(where)
        found = importlib.util.spec_from_file_location(path.stem, path)
        if not path.is_file() or found is None or found.loader is None:
            raise InputError(f"{where}: no such Python file.")
        module = importlib.util.module_from_spec(found)
        try:
            with _as_input_error(where):
                found.loader.exec_module(module)
        except ModuleNotFoundError as error:
            raise InputError(f"{where}: {error}. Install it, or start safeloc where it can be found.") from error
        return module
    if str(Path.cwd()) not in sys.path:
        sys.path.insert(0, str(Path.cwd()))
    try:
        with _as_input_error(where):
            return importlib.import_module(where)
    except ModuleNotFoundError as error:
        raise InputError(
            f"cannot import {where!r}: {error}. Give a module on the path, or path/to/file.py:name."
        ) from error


@contextmanager
def _as_input_error(where: str) -> Iterator[None]:
    """A user's file that fails is wrong input, not a violated property; the cause stays attached."""
    try:
        yield
    except (SafelocError, ModuleNotFoundError):
        raise
    except Exception as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        raise InputError(f"{where} fails: {type(error).__name__}: {error} ({place.filename}:{place.lineno})") from error


def _properties(module: ModuleType, found: Machine | Composition) -> tuple[Property, ...]:
    declared: Sequence[Property] | Callable[[Any], Sequence[Property]] = getattr(module, "properties", ())
    listed = declared(found) if callable(declared) else declared
    wrong = [item for item in listed if not isinstance(item, Property)]
    if wrong:
        raise InputError(
            f"{module.__name__}.properties holds {wrong[0]!r}; expected always(...), never(...), within(...)."
        )
    return tuple(listed)
