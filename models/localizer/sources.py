"""The sources of a localizer: machines, how they hear the vehicle, and what they state in common words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from safeloc.language.composition import Clause
from safeloc.language.expr import Bool, Expr, Num, NumVar, Optional, Var, ite, maximum
from safeloc.language.machine import Machine
from safeloc.models import balise, odometry, reflector, satellite_selection, verification
from safeloc.models import satellite as satellites
from safeloc.models.balise.variables import movement as balise_movement
from safeloc.models.balise.variables import parts as balise_parts
from safeloc.models.localizer.configuration import LocalizerConfig
from safeloc.models.motion import Motion
from safeloc.models.odometry.ghosts import Movement
from safeloc.models.odometry.variables import parts as odometry_parts
from safeloc.models.reflector import variables as reflecting
from safeloc.models.reflector_anchor.line import line
from safeloc.models.reflector_anchor.wires import anchor_wires, anchored_clauses, disproved
from safeloc.models.satellite import variables as satellite_words
from safeloc.models.satellite.world import REFERENCE, SELECTED
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.models.vocabulary.reasons import CONTRADICTION, LOCATED, NO_REFERENCE, SENSOR_FAILURE, TOLERANCE


@dataclass(frozen=True, eq=False)
class Stated:
    """Statement of a source's machine, in terms of that machine after the step."""

    valid: Bool
    position: Num
    below: Num
    above: Num
    reference: Bool
    reason: Num


@dataclass(frozen=True, eq=False)
class Piece:
    """A source: its machines in order, their wires, its statement, and the clauses that machines before it discharge.

    models  the objects that the machines were built as, for properties of each of them
    """

    machines: tuple[Machine, ...]
    wires: Mapping[Var, Expr]
    stated: Stated
    discharged: tuple[Clause, ...] = ()
    models: tuple[object, ...] = ()


def _same_distance(wanted: Optional, measured: Optional) -> dict[Var, Expr]:
    """Return the wires of an odometer input to a unit of the vehicle."""
    return {wanted.value: measured.value, wanted.present: measured.present}


def distance_of_motion(wanted: Optional, more: NumVar | None, moves: Motion) -> dict[Var, Expr]:
    """Return the wires of an odometer input to the distance that `motion` reports."""
    if moves.own.check is None or more is None:
        return _same_distance(wanted, moves.own.odometer.measured)
    says = moves.machine
    return {wanted.value: says.output("distance_mm"), wanted.present: moves.reported, more: says.output("more_nm")}


def _odometry(config: LocalizerConfig, moves: Motion, _: Mapping[str, Piece]) -> Piece:
    moved = Movement(moves.own.ghosts.truth, moves.own.ghosts.true_cycle_distance)
    own = odometry_parts(config.odometry, with_fault=config.odometry.single_fault_safe, moved=moved)
    model = odometry.build(own)
    wires = [
        _same_distance(unit.measured, measured) for unit, measured in zip(own.units, moves.own.inputs, strict=False)
    ]
    wired = {var: term for one in wires for var, term in one.items()}
    return Piece((model.machine,), wired, plainly(model.machine), models=(model,))


def _balise(config: LocalizerConfig, moves: Motion, _: Mapping[str, Piece]) -> Piece:
    seen = moves.own.ghosts
    moved = replace(balise_movement(config.balise), truth=seen.truth, true_cycle_distance=seen.true_cycle_distance)
    if seen.units is not None:
        moved = replace(moved, wander=seen.units.reported, next_wander=seen.units.next_reported)
    own = balise_parts(config.balise, moved=moved)
    model = balise.build(own)
    wires = distance_of_motion(own.odometer.measured, own.odometer.more, moves)
    discharged = law_of_motion(Clause(model.machine, balise.ODOMETER), moves)
    return Piece((model.machine,), wires, plainly(model.machine), discharged, (model,))


def law_of_motion(law: Clause, moves: Motion) -> tuple[Clause, ...]:
    """Return the clause of the distance's law if `motion` discharges it: with a check unit."""
    return () if moves.own.check is None else (law,)


def plainly(machine: Machine) -> Stated:
    """Return the statement of a machine whose outputs have the common names and reasons."""
    return Stated(
        machine.flag("valid"),
        *wired_interval(machine),
        machine.flag("reference_accepted"),
        machine.output("reason"),
    )


def _reflector(config: LocalizerConfig, moves: Motion, earlier: Mapping[str, Piece]) -> Piece:
    """Behind a balise machine it is anchored by the groups that this one accepts; else readings are inputs."""
    if "balise" in earlier:
        return anchored_reflector(config, moves, earlier["balise"], with_switch=False)
    return _measuring(config, moves)


def anchored_reflector(config: LocalizerConfig, moves: Motion, reading: Piece, *, with_switch: bool) -> Piece:
    """Return the reflector machine behind a balise machine, with the map's line; `with_switch`: this also has the next facing switch."""
    measuring = _measuring(config, moves)
    (groups,), (source,) = reading.models, measuring.models
    assert isinstance(groups, balise.Balise) and isinstance(source, reflector.ReflectorMachine)
    map_ = line(config.balise, config.reflector, with_switch=with_switch)
    wires = {**measuring.wires, **anchor_wires(groups, map_, source), source.own.contradicted: disproved(groups)}
    return Piece(
        (map_.machine, *measuring.machines), wires, measuring.stated, (*measuring.discharged, *anchored_clauses(source)), (map_, source),
    )  # fmt: skip


def _measuring(config: LocalizerConfig, moves: Motion) -> Piece:
    """The reflector machine by itself."""
    seen = moves.own.ghosts
    moving = replace(
        reflecting.moving(config.reflector), truth=seen.truth, true_cycle_distance=seen.true_cycle_distance
    )
    if seen.units is not None:
        moving = replace(moving, wander=seen.units.reported, next_wander=seen.units.next_reported)
    own = reflecting.Parts(config.reflector, moving)
    model = reflector.build(own)
    machine = model.machine
    error = machine.output("error")
    why = ite(error.eq(reflecting.TOLERANCE), TOLERANCE, CONTRADICTION)
    why = ite(error.one_of(reflecting.SENSOR_FAILURE, reflecting.NO_SELF_TEST), SENSOR_FAILURE, why)
    why = ite(error.one_of(reflecting.NO_POSITION, reflecting.NO_ERROR), NO_REFERENCE, why)
    stated = Stated(
        machine.flag("valid"),
        *wired_interval(machine),
        machine.flag("valid") & machine.flag("precise") & machine.flag("recognised"),
        why,
    )
    wires = distance_of_motion(own.odometer.measured, own.odometer.more, moves)
    return Piece((machine,), wires, stated, law_of_motion(Clause(machine, reflector.ODOMETER), moves), (model,))


def _satellite(config: LocalizerConfig, moves: Motion, earlier: Mapping[str, Piece]) -> Piece:
    selection = satellite_selection.build(satellite_selection.parts(config.satellite.selection))
    own = satellite_words.parts(config.satellite, truth=moves.own.ghosts.truth)
    machine = satellites.build(own)
    wires = satellites.selection_wires(own, selection)
    wires[own.next_truth] = moves.own.ghosts.truth
    trusted = next((earlier[name].stated for name in ("balise", "odometry", "reflector") if name in earlier), None)
    if trusted is not None:
        accuracy = maximum(trusted.below, trusted.above)
        referenced = trusted.reference & (accuracy <= own.accuracy.high)
        wires |= {
            own.reference.present: referenced,
            own.reference.value: ite(referenced, trusted.position, 0),
            own.accuracy: ite(referenced, accuracy, 0),
        }
    why = machine.output("reason")
    reason = ite(why.eq(satellite_words.TOLERANCE), TOLERANCE, NO_REFERENCE)
    reason = ite(why.eq(satellite_words.COASTED_OUT), SENSOR_FAILURE, reason)
    reason = ite(why.one_of(satellite_words.CONTRADICTION, satellite_words.DRIFT), CONTRADICTION, reason)
    stated = Stated(
        machine.flag("valid"),
        *wired_interval(machine),
        machine.flag("valid") & machine.output("fix").eq(satellite_words.ACCEPTED),
        ite(machine.flag("valid"), LOCATED, reason),
    )
    reference = () if trusted is None else (Clause(machine, REFERENCE),)
    return Piece((selection.machine, machine), wires, stated, (*reference, Clause(machine, SELECTED)), (selection,))


def _fibre(config: LocalizerConfig, moves: Motion, _: Mapping[str, Piece]) -> Piece:
    """The trackside's verified position; on board it is stated by the downlink."""
    model = verification.build(verification.parts(config.fibre, truth=moves.own.ghosts.truth))
    machine, trusted = model.machine, model.machine.flag("trusted")
    stated = Stated(
        trusted,
        *wired_interval(machine),
        trusted,
        NO_REFERENCE,
    )
    return Piece((machine,), {model.own.next_truth: moves.own.ghosts.truth}, stated, models=(model,))


PIECES = {
    "odometry": _odometry,
    "balise": _balise,
    "reflector": _reflector,
    "satellite": _satellite,
    "fibre": _fibre,
}
