"""A composition for mutation: its machines, each with its own claims, and its wires.

Mutants of its machines are made like those of a single machine. Only those that the machine's own claims do not detect are put
into the composition.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from safeloc.assurance.mutation.declared import Declared
from safeloc.assurance.mutation.mutants import Mutant, mutants
from safeloc.assurance.mutation.places import Places
from safeloc.catalogue import load_target
from safeloc.errors import InputError
from safeloc.language.checks.composition import Plan
from safeloc.language.composition import Clause, compose
from safeloc.language.expr import BoolVar, Expr, NumVar, Optional, Var, before_step
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.system import Part, TransitionSystem, lower
from safeloc.language.terms import Sharing, Substitution, variables
from safeloc.proof.verification.other_figures import with_fitting_recordings
from safeloc.target import Target


@dataclass(frozen=True, eq=False)
class Composed:
    """A composition: the arguments of `compose`, and each machine with its own claims.

    claims  properties of the composition that are not inherited from one machine, without `reachable` ones
    again   makes the target once more; None if that is not possible
    """

    target: Target
    plan: Plan
    members: Mapping[str, Declared]
    claims: tuple[Property, ...]
    again: Callable[[], Target] | None = None

    def alone(self, name: str) -> Target:
        """Return a machine as a target of its own, without the recordings of the composition."""
        machine = self.members[name].machine
        return Target(f"{self.target.name}: {name}", (machine,), lower(machine), self.members[name].properties)


def composed(target: Target, places: Places, again: Callable[[], Target] | None = None) -> Composed:
    """Return the composition of a target, which `again`, or its name, makes once more.

    InputError if no call of `compose` with its machines was recorded.
    """
    plan = next((one for one in places.plans if tuple(one.machines) == target.system.machines), None)
    if plan is None:
        raise InputError(f"{target.name}: how its machines are wired is not known; make them with `compose`.")
    claims = asked_of_the_whole(target.properties)
    members = {one.name: Declared(one, _own_claims(target, one), claims) for one in target.system.machines}
    return Composed(target, plan, members, claims, again or _by_name(target))


def asked_of_the_whole(properties: Sequence[Property]) -> tuple[Property, ...]:
    """Return the properties that are not inherited from one machine, without `reachable` ones."""
    return tuple(prop for prop in properties if prop.kept_by is None and prop.kind != "reachable")


def _by_name(target: Target) -> Callable[[], Target] | None:
    """Return what makes the target once more by its requested name, if it has one and its figures are not those of a named configuration."""
    if not target.spec or target.configuration:
        return None
    return lambda: with_fitting_recordings(load_target(target.spec, target.config_file))


def _own_claims(target: Target, machine: Machine) -> tuple[Property, ...]:
    """Return the properties of the machine by itself: those that the composition inherits, and those that the target gives."""
    kept = [prop.kept_by[1] for prop in target.properties if prop.kept_by is not None and prop.kept_by[0] is machine]
    by_name = {prop.name: prop for prop in (*kept, *target.members.get(machine.name, ()))}
    return tuple(by_name.values())


def member_mutants(composed: Composed, places: Places) -> list[Mutant]:
    """Return all mutants of its machines, machine by machine."""
    return [one for declared in composed.members.values() for one in mutants(declared, places)]


def joined(composed: Composed, machine: Machine) -> TransitionSystem:
    """Return the composition with this machine in place of the one of its name, in the original variables.

    ModelError if the result is not a valid composition.
    """
    was = composed.members[machine.name].machine
    rewired = _rewired(composed.plan.wires, was, machine)
    machines = [machine if one is was else one for one in composed.plan.machines]
    made = compose(
        composed.plan.name,
        machines,
        rewired,
        shared=composed.plan.shared,
        discharge=_discharged(composed.plan.discharge, was, machine),
    )
    return in_variables_of(made.system, composed.target.system)[0]


def _discharged(discharge: Sequence[Machine | Clause], was: Machine, now: Machine) -> list[Machine | Clause]:
    found: list[Machine | Clause] = []
    for one in discharge:
        if isinstance(one, Clause):
            found.append(replace(one, machine=now) if one.machine is was else one)
        else:
            found.append(now if one is was else one)
    return found


def _rewired(wires: Mapping[Var, Expr], was: Machine, now: Machine) -> dict[Var, Expr]:
    """Return the wires with the outputs of the machine as it was replaced by those that it has now."""
    pairs = [(was.outputs[name], term) for name, term in now.outputs.items() if term is not was.outputs[name]]
    change = Substitution({}, pairs)
    return {var: _late(change(term), pairs) for var, term in wires.items()}


def _late(wire: Expr, outputs: Sequence[tuple[Expr, Expr]]) -> Expr:
    """Return the wire with outputs replaced where it reads them before the step: there it has a copy of the term."""
    late = [var for var in variables([wire]) if var.before is not None]
    if not late or not outputs:
        return wire
    twins: dict[Var, Expr] = {}
    for var in variables([wire, *(term for pair in outputs for term in pair)]):
        state = var if var.before is None else var.before
        twins.setdefault(state, var if var.before is not None else before_step(var))
    share, before = Sharing(), Substitution(twins)
    one = share(Substitution({var: twins[var.before] for var in late if var.before is not None})(wire))
    return Substitution({}, [(share(before(was)), before(now)) for was, now in outputs])(one)


def in_variables_of(system: TransitionSystem, like: TransitionSystem) -> tuple[TransitionSystem, Substitution]:
    """Return the system in the variables of `like`, which has the same names, and what rewrites its terms so.

    Parts take over `into`; contracts are rewritten. Variables and parts that `like` does not have stay as they are.
    """
    known = {(var.name, type(var)): var for var in (*like.state, *like.inputs, *like.fired)}
    mine = (*system.state, *system.inputs, *system.fired)
    twin = {var: known.get((var.name, type(var)), var) for var in mine}
    change, alike = Substitution(dict(twin)), {part.name: part for part in like.parts}
    renamed = replace(
        system,
        state=tuple(twin[var] for var in system.state),
        inputs=tuple(twin[var] for var in system.inputs),
        init=change.bool(system.init),
        next={twin[var]: change(term) for var, term in system.next.items()},
        assume=change.bool(system.assume),
        outputs={name: change(term) for name, term in system.outputs.items()},
        fired={_number(twin[var]): change.num(term) for var, term in system.fired.items()},
        lemmas={name: change.bool(term) for name, term in system.lemmas.items()},
        ghosts=frozenset(twin[var] for var in system.ghosts),
        initial={twin[var]: value for var, value in system.initial.items()},
        optionals=tuple(Optional(_number(twin[one.value]), _flag(twin[one.present])) for one in system.optionals),
        parts=tuple(_part(part, alike.get(part.name, part), change) for part in system.parts),
        stages=(),
    )
    return renamed, change


def _number(var: Var) -> NumVar:
    assert isinstance(var, NumVar)
    return var


def _flag(var: Var) -> BoolVar:
    assert isinstance(var, BoolVar)
    return var


def _part(part: Part, like: Part, change: Substitution) -> Part:
    return replace(
        part, into=like.into, inputs_in_range=change.bool(part.inputs_in_range), contract=change.bool(part.contract)
    )
