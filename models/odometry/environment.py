"""The environment of the odometry machine, and what helps to prove: ghosts, assumption, lemmas.

Every unit has a ghost for the one-off part of its error, its wander. Where one unit may be faulty, a further ghost
names it: that unit breaks its law as it likes, and its interval is judged by the wander of the other unit of its device.
Without `single_fault_safe` a fault too small to be seen is not charged: what it may add is the ghost `unseen`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from safeloc.language.expr import (
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    NumVar,
    Var,
    abs_,
    all_of,
    any_of,
    as_num,
    between,
    exact_to,
    ite,
    maximum,
    with_unit,
)
from safeloc.language.machine import ANY, Initial, Machine
from safeloc.language.terms import variables
from safeloc.language.units import NM
from safeloc.models.odometry.cycle import Judged
from safeloc.models.odometry.distance_device import Cycle, Device, Unit
from safeloc.models.odometry.variables import Parts, unseen_at_reading_nm, unseen_in_a_cycle_nm


@dataclass(frozen=True, eq=False)
class Environment:
    """Ghosts with first values and moves, what the environment chooses in a cycle, and what it keeps."""

    first: dict[Var, Initial]
    moves: dict[Var, Expr]
    choices: list[Var]
    assumption: Bool


def environment(own: Parts, cycle: Judged) -> Environment:
    """The true position, the units' errors and, where the parts have one, the fault."""
    first: dict[Var, Initial] = {own.truth: ANY}
    moves: dict[Var, Expr] = {own.truth: own.truth + own.true_step}
    for (wander, chosen), (_, admitted) in zip(own.wanders, _admitted(cycle), strict=True):
        first[wander] = ANY
        moves[wander] = ite(admitted, chosen, wander)
    for device, unseen in zip(own.devices, own.unseen, strict=False):
        first[unseen] = unseen_at_reading_nm(device)
        moves[unseen] = _unseen_after(cycle, cycle.moved(device), unseen)
    if own.faulty is not None:
        first[own.faulty] = ANY
        moves[own.faulty] = own.faulty
    return Environment(first, moves, [own.true_step, *(chosen for _, chosen in own.wanders)], _assumption(own, cycle))


def _admitted(cycle: Judged) -> list[tuple[Unit, Bool]]:
    return [(unit, ok) for moved in cycle.cycles for unit, ok in zip(moved.device.units, moved.admitted, strict=True)]


def _assumption(own: Parts, cycle: Judged) -> Bool:
    """Error laws of admitted distances, the truth of accepted readings, and the vehicle staying on the line."""
    after = own.truth + own.true_step
    laws = []
    for (unit, admitted), (wander, chosen), device in zip(_admitted(cycle), own.wanders, _owners(own), strict=True):
        error = own.true_step - exact_to(unit.step.value, NM) - (chosen - wander)
        most = unit.law.growth_nm(abs_(unit.step.value), device.age + unit.limits.period_ms, unit.limits.period_ms)
        laws.append((admitted & own.lawful(unit)).implies(between(-most, error, most)))
    readings = [reading.accepted.implies(reading.fix.holds(after)) for reading in cycle.readings]
    return all_of([*laws, *readings, *_checked(own, cycle), between(own.truth.low, after, own.truth.high)])


def _checked(own: Parts, cycle: Judged) -> list[Bool]:
    """Where a lone distance is used: that of a faulty unit never comes alone."""
    if own.faulty is None or own.config.single_fault_safe:
        return []
    first = [moved.admitted[0].implies(moved.admitted[1] | own.lawful(moved.device.units[0])) for moved in cycle.cycles]
    second = [
        moved.admitted[1].implies(moved.admitted[0] | own.lawful(moved.device.units[1])) for moved in cycle.cycles
    ]
    return [*first, *second]


def _owners(own: Parts) -> list[Device]:
    return [device for device in own.devices for _ in device.units]


def on_board(machine: Machine) -> Machine:
    """The machine without its ghosts and assumption: where something else is the environment."""
    ghosts = {*machine.ghosts, *machine.ghost_inputs}
    kept = {name: term for name, term in machine.lemmas.items() if ghosts.isdisjoint(variables([term]))}
    return replace(machine, ghosts={}, ghost_inputs=(), ghost_moves={}, assumption=TRUE, lemmas=kept)


# ------------------------------------------------------------------ faults too small to be seen


def _unseen_after(cycle: Judged, moved: Cycle, unseen: NumVar) -> Num:
    """Each cycle in which both units measure may hide twice the greater law; a reading starts afresh."""
    device, both = moved.device, moved.admitted[0] & moved.admitted[1]
    period, start = device.limits.period_ms, as_num(unseen_at_reading_nm(device), NM)
    most = maximum(*(unit.law.growth_nm(moved.reach, moved.age, period) for unit in device.units))
    taken = any_of(reading.accepted | reading.is_candidate for reading in cycle.setting(device))
    fresh = taken | ~device.values.alive
    return ite(fresh, start, ite(both, unseen + most * 2, unseen))


# ------------------------------------------------------------------ what helps to prove


def lemmas(own: Parts, current: Num, mode: tuple[Lit, ...]) -> dict[str, Bool]:
    """Every living unit holds the truth; the mode names a living device with the smaller margin."""
    found: dict[str, Bool] = {}
    lost, located = mode[0], mode[2:]
    for unit in own.units:
        found[f"{unit.name} holds the truth"] = (unit.alive & current.one_of(*located)).implies(_holds(own, unit))
        found[f"{unit.name} is dead while delocalized"] = current.eq(lost).implies(~unit.alive)
    for device, target in zip(own.devices, located, strict=True):
        found[f"{device.name} device is alive when it leads"] = current.eq(target).implies(device.values.alive)
    if len(own.devices) == 2:
        front, rear = (device.values for device in own.devices)
        found["front device leads with the smaller margin"] = current.eq(located[0]).implies(~rear.better_than(front))
        found["rear device leads with the smaller margin"] = current.eq(located[1]).implies(~front.better_than(rear))
    for device, unseen in zip(own.devices, own.unseen, strict=False):
        found[f"{device.name} hides no more than its age allows"] = _hidden_with_age(device, unseen)
    return found


def _hidden_with_age(device: Device, unseen: NumVar) -> Bool:
    start, most, period = unseen_at_reading_nm(device), unseen_in_a_cycle_nm(device), device.limits.period_ms
    within_age = (unseen - start) * period <= with_unit(device.age * most, NM)
    return (unseen >= start) & device.values.alive.implies(within_age)


def _holds(own: Parts, unit: Unit) -> Bool:
    """The interval holds the truth: by the own wander, or, of a faulty unit, by that of the unit that checks it."""
    lawful = _inside(own, unit, unit, as_num(0, NM))
    if own.faulty is None:
        return lawful
    device, checker = own.partner(unit)
    unseen = own.unseen[own.devices.index(device)] if own.unseen else as_num(0, NM)
    return ite(own.lawful(unit), lawful, _inside(own, unit, checker, unseen))


def _inside(own: Parts, unit: Unit, checker: Unit, more: Num) -> Bool:
    wander, _ = own.wanders[own.units.index(checker)]
    half = checker.law.wander_nm
    off = own.truth - exact_to(unit.position, NM) - wander
    return between(half - unit.under - more, off, unit.over - half + more)
