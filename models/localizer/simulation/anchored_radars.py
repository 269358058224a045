"""Radars of many localizers whose reflectors are anchored by balise groups, as arrays of the composition's inputs.

The radars' frames follow from the runs alone. The map's next reflector follows from what the reflector machine reports, and that from the
telegrams: so the machines up to the reflector machine run along, cycle by cycle.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from safeloc.codegen.batch_steps import Stepped, compile_steps
from safeloc.language.composition import compose
from safeloc.language.system import without_ghosts
from safeloc.models import motion
from safeloc.models.balise.groups import Group
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer.sources import PIECES
from safeloc.models.reflector.simulation.map_ahead import TOLD, MapAhead
from safeloc.models.reflector.simulation.scene import Balise, Route
from safeloc.simulation.many_runs import Array, through_border

_OF_THE_LINE = ("next_position_mm", "next_position_mm.present", "next_reference_mm", "next_reference_mm.present")
"""Inputs of the reflector machine alone that are inputs of the line here."""


def anchored_inputs(
    config: LocalizerConfig,
    route: Route,
    groups: Sequence[Group],
    radars: Mapping[str, Array],
    found: Mapping[str, Array],
    libraries: Path | None,
) -> dict[str, Array]:
    """Return the inputs of line and reflector machine, by their names in the composition: arrays [cycle, vehicle].

    route   reflectors; its balises are the groups from which the map has the distance to the next one
    groups  all groups on the line and on the map
    radars  inputs of the reflector machine alone, without the map's answers
    found   inputs of the composition, of motion and balise machine at least
    """
    own = {f"{'line' if name in _OF_THE_LINE else 'reflector'}.{name}": values for name, values in radars.items()}
    if not route.reflectors:  # the map answers nothing, so no input follows from what the machines report
        return own
    code, shape = _on_board(config.model_dump_json(), libraries), radars["frame_present"].shape
    given = {var.name: _whole((own if var.name in own else found)[var.name], shape) for var in code.system.inputs}
    runs = code.begin(through_border(code.system, given)[0])
    line = MapAhead(_all_of(route, groups), radars)
    for cycle, read in enumerate(_read(groups, found, shape)):
        line.answer(cycle, {name: runs.told[f"reflector.{name}"] for name in TOLD}, read)
        runs.step(cycle)
    return own


@lru_cache(maxsize=8)
def _on_board(config: str, libraries: Path | None) -> Stepped:
    """Return the machines up to the reflector machine without their world, compiled once for each configuration (JSON)."""
    vehicle = LocalizerConfig.model_validate_json(config)
    moves = motion.build(motion.parts(vehicle.motion))
    reading = PIECES["balise"](vehicle, moves, {})
    measuring = PIECES["reflector"](vehicle, moves, {"balise": reading})
    machines = (moves.machine, *reading.machines, *measuring.machines)
    whole = compose("anchored_radar", machines, {**reading.wires, **measuring.wires}, shared=moves.shared)
    return compile_steps(without_ghosts(whole.system), [f"reflector.{name}" for name in TOLD], folder=libraries)


def _whole(values: Array, shape: tuple[int, ...]) -> Array:
    """Return values in memory row by row; those that lie there so already, themselves."""
    return np.ascontiguousarray(np.broadcast_to(values, shape))


def _all_of(route: Route, groups: Collection[Group]) -> Route:
    """Return the route with every group as a balise: all of them anchor."""
    known = {one.position_mm for one in route.balises}
    balises = (Balise(one.identity, one.place_mm, reference=one.place_mm in known) for one in groups)
    return Route(tuple(balises), route.reflectors, route.missing, route.beside)


def _read(groups: Sequence[Group], found: Mapping[str, Array], shape: tuple[int, ...]) -> NDArray[np.int64]:
    """Return the number of the group that is read, -1 for none that the map has: array [cycle, vehicle]."""
    identities = np.broadcast_to(found["balise.telegram_group"], shape)
    present = np.broadcast_to(found["balise.telegram_group.present"], shape)
    read = np.full(shape, -1)
    for number, group in enumerate(groups):
        read[present & (identities == group.identity)] = number
    return read
