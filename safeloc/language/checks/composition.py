"""Rules for the machines, wires and shared variables of a composition."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from safeloc.errors import ModelError
from safeloc.language.checks.rule import Rule, complaints
from safeloc.language.checks.terms import malformed
from safeloc.language.composed_names import contract_text, lemma_name
from safeloc.language.expr import Expr, Num, NumVar, Var
from safeloc.language.machine import Machine
from safeloc.language.nodes import Past
from safeloc.language.terms import in_order, variables

if TYPE_CHECKING:
    from safeloc.language.composition import Clause
    from safeloc.language.system import TransitionSystem


@dataclass(frozen=True, eq=False)
class Plan:
    """The arguments of `compose`; `systems` are the lowered machines, `src` is the place of the call."""

    name: str
    machines: Sequence[Machine]
    systems: Sequence[TransitionSystem]
    wires: Mapping[Var, Expr]
    shared: Sequence[Var]
    discharge: Sequence[Machine | Clause]
    src: str


@dataclass(frozen=True, eq=False)
class SharedGhost:
    """A ghost of one machine; if an earlier machine shares it, whether both give it the same move and the same first value."""

    var: Var
    machine: Machine
    moves_alike: bool
    starts_alike: bool


def check_plan(plan: Plan) -> None:
    """Raise ModelError with all complaints of the first broken rule."""
    found = complaints(JOINING, plan)
    if found:
        raise ModelError(f"composition {plan.name!r} ({plan.src}): {' '.join(found)}")


def refuse_ghosts(plan: Plan, ghosts: Iterable[SharedGhost]) -> None:
    """Raise ModelError for a shared ghost that two machines move differently or start differently."""
    for ghost in ghosts:
        for alike, verb in ((ghost.moves_alike, "moves"), (ghost.starts_alike, "starts")):
            if not alike:
                raise ModelError(
                    f"composition {plan.name!r} ({plan.src}): the shared ghost {ghost.var.name!r} {verb} differently in "
                    f"{ghost.machine.name!r} and in an earlier machine; declare it alike in both, or do not share it."
                )


def _name_can_be_written(plan: Plan) -> Iterator[str]:
    name = plan.name
    if not isinstance(name, str) or not name.strip() or not name.isprintable() or set(name) & set("|\\/"):
        yield "its name must consist of printable characters, without /, | and \\."


def _machines_have_distinct_names(plan: Plan) -> Iterator[str]:
    names = [machine.name for machine in plan.machines]
    if not names:
        yield "it has no machines; give at least one."
    if len(set(names)) != len(names):
        yield f"the names of its machines {names} must be distinct; rename one."


def _joined_names_are_distinct(plan: Plan) -> Iterator[str]:
    """Names in a composition consist of two names: "a" with "b: c" and "a: b" with "c" would give the same lemma."""
    groups: dict[str, list[str]] = {
        "lemma": [lemma_name(machine.name, name) for machine in plan.machines for name in machine.lemmas],
        "output": [f"{machine.name}.{name}" for machine in plan.machines for name in machine.outputs],
        "variable": [f"{system.name}.{var.name}" for system in plan.systems for var in _renamed(plan, system)],
    }
    groups["lemma"] += [contract_text(machine.name) for machine in plan.machines]
    groups["variable"] += [var.name for var in plan.shared]
    for what, names in groups.items():
        for name in sorted({name for name in names if names.count(name) > 1}):
            yield f"the {what} {name!r} comes from two machines; rename one of the machines, or the {what} in one of them."


def _renamed(plan: Plan, system: TransitionSystem) -> list[Var]:
    """Return the variables of a machine whose names get the machine's name in front: neither shared nor wired."""
    unchanged = {*plan.shared, *plan.wires}
    return [var for var in (*system.state, *system.inputs, *system.fired) if var not in unchanged]


def _shared_is_no_state(plan: Plan) -> Iterator[str]:
    for var in plan.shared:
        owner = next((system.name for system in plan.systems if var in set(system.state) - system.ghosts), None)
        if owner is not None:
            yield f"{var.name!r} is state of {owner!r}; only inputs and ghosts can be shared."


def _shared_variables_have_one_role(plan: Plan) -> Iterator[str]:
    for var in plan.shared:
        roles = {_role(var, system): system.name for system in plan.systems if var in {*system.state, *system.inputs}}
        if len(roles) > 1:
            listed = " and ".join(f"{role} of {name!r}" for role, name in roles.items())
            yield (
                f"{var.name!r} ({var.src}) is {listed}; a shared variable must have one role in all machines: input, ghost "
                "input or ghost."
            )


def _role(var: Var, system: TransitionSystem) -> str:
    ghost = var in system.ghosts
    if var in set(system.inputs):
        return "a ghost input" if ghost else "an input"
    return "a ghost" if ghost else "state"


def _wires_read_no_ghosts(plan: Plan) -> Iterator[str]:
    """A wire to an on-board input reads on-board variables only."""
    ghosts: set[Var] = set()
    later = {var for system in plan.systems for var in system.ghosts}
    for system in plan.systems:
        for var in system.inputs:
            on_wire = variables([plan.wires[var]]) if var in plan.wires else []
            read = [one.name for one in on_wire if one in ghosts or one.before in later]
            if read and var not in system.ghosts:
                yield (
                    f"the wire to {var.name!r}, an on-board input, reads the ghost {', '.join(map(repr, read))}; let it read "
                    "on-board variables only."
                )
        ghosts |= system.ghosts


def _wires_lead_to_inputs(plan: Plan) -> Iterator[str]:
    inputs = {var for system in plan.systems for var in system.inputs}
    unknown = [var.name for var in plan.wires if var not in inputs]
    if unknown:
        yield (
            f"wires lead to {unknown}, which are no inputs of {[machine.name for machine in plan.machines]}; wire inputs of "
            "these machines only."
        )


def _wires_are_terms(plan: Plan) -> Iterator[str]:
    for var, term in plan.wires.items():
        yield from (f"the wire to {var.name!r}: {complaint}" for complaint in malformed([term]))


def _wires_fit(plan: Plan) -> Iterator[str]:
    for var, term in plan.wires.items():
        if isinstance(var, NumVar) != isinstance(term, Num):
            wanted, found = ("a number", "a truth value") if isinstance(var, NumVar) else ("a truth value", "a number")
            yield f"the wire to {var.name!r}, which is {wanted}, carries {found}; give a term of the same kind."
        elif isinstance(var, NumVar) and isinstance(term, Num) and not term.unit.same(var.unit):
            yield f"the wire to {var.name!r} carries {term.unit.name}, not {var.unit.name}; convert the term."
        if any(isinstance(node, Past) for node in in_order([term])):
            yield f"the wire to {var.name!r} uses a past operator; only properties may."


def _wires_read_earlier_machines(plan: Plan) -> Iterator[str]:
    earlier, twice = set[Var](), set[Var]()
    for system in plan.systems:
        declared = {*system.state, *system.inputs}
        for var in system.inputs:
            if var in plan.wires:
                yield from _wire_reads(var, plan.wires[var], earlier, twice)
        twice |= (earlier & declared) - set(plan.shared)
        earlier |= declared


def _wire_reads(var: Var, term: Expr, earlier: set[Var], twice: set[Var]) -> Iterator[str]:
    now = [read for read in variables([term]) if read.before is None]
    late = [read.name for read in now if read not in earlier]
    if late:
        yield (
            f"the wire to {var.name!r} reads {late}, which no earlier machine has; a wire reads machines listed before, or the state "
            "of any machine before the step, by was() and before()."
        )
    unclear = [read.name for read in now if read in twice]
    if unclear:
        yield (
            f"the wire to {var.name!r} reads {unclear}, which several earlier machines have; give each machine a variable "
            "of its own."
        )


def _values_before_are_state(plan: Plan) -> Iterator[str]:
    """A value before the step is that of a state variable of one machine."""
    states = [var for system in plan.systems for var in system.state]
    once = {var for var, number in Counter(states).items() if number == 1 or var in set(plan.shared)}
    for var, term in plan.wires.items():
        unknown = [one.name for one in variables([term]) if one.before is not None and one.before not in once]
        if unknown:
            yield (
                f"the wire to {var.name!r} reads {unknown}; before() and was() are for state variables that exactly one of "
                f"{[machine.name for machine in plan.machines]} has."
            )


def _discharged_is_assumed(plan: Plan) -> Iterator[str]:
    for one in plan.discharge:
        machine = one if isinstance(one, Machine) else one.machine
        if machine not in plan.machines:
            yield f"`discharge` names {machine.name!r}, which is no machine of it; it has {[m.name for m in plan.machines]}."
        elif not isinstance(one, Machine) and one.name not in machine.world.clauses:
            yield (
                f"`discharge` names the clause {one.name!r}, which {machine.name!r} does not have; it has "
                f"{list(machine.world.clauses)}."
            )


JOINING: tuple[Rule[Plan], ...] = (
    Rule("the composition's name can be written", "a slip", _name_can_be_written),
    Rule("machines have distinct names", "a crash", _machines_have_distinct_names),
    Rule("wires are well formed", "a crash", _wires_are_terms),
    Rule("shared variables are no state", "a slip", _shared_is_no_state),
    Rule("shared variables have one role", "a wrong verdict", _shared_variables_have_one_role),
    Rule("wires fit", "a crash", _wires_fit),
    Rule("wires read no ghosts", "a wrong verdict", _wires_read_no_ghosts),
    Rule("wires read earlier machines", "a crash", _wires_read_earlier_machines),
    Rule("values before the step are state", "a crash", _values_before_are_state),
    Rule("wires lead to inputs", "a slip", _wires_lead_to_inputs),
    Rule("joined names are distinct", "a wrong verdict", _joined_names_are_distinct),
    Rule("discharged clauses exist", "a slip", _discharged_is_assumed),
)
