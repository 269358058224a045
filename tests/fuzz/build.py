"""From our own data to safeloc's declarations, and back from safeloc's terms to ours."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from safeloc.language import nodes
from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import (
    BoolVar,
    Expr,
    Lit,
    NumVar,
    Optional,
    abs_,
    all_of,
    any_of,
    before,
    boolean,
    ceil_div,
    choice,
    enumeration,
    floor_div,
    ite,
    maximum,
    members,
    minimum,
    number,
    optional,
    product,
    was,
)
from safeloc.language.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.language.spec import Property, once, previous, since
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import ONE
from safeloc.language.world import World as MachineWorld
from tests.fuzz.judge import WAITING, Claim
from tests.fuzz.terms import Term
from tests.fuzz.world import COLOURS, Game, Var, Whole, World

MEMBERS = members("colour", *COLOURS)
Names = Mapping[str, Any]

WRITTEN: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": product,
    "min": minimum,
    "max": maximum,
    "abs": abs_,
    "not": lambda a: ~a,
    "and": lambda *all_: all_of(all_),
    "or": lambda *all_: any_of(all_),
    "implies": lambda a, b: a.implies(b),
    "iff": lambda a, b: a.iff(b),
    "ite": ite,
    "lt": lambda a, b: a < b,
    "le": lambda a, b: a <= b,
    "gt": lambda a, b: a > b,
    "ge": lambda a, b: a >= b,
    "eq": lambda a, b: a.eq(b),
    "ne": lambda a, b: a.ne(b),
    "previous": previous,
    "once": once,
    "since": since,
}


def term(own: Term, names: Names) -> Any:
    """Our term as safeloc's, over what `names` says."""
    match own:
        case ("lit", value):
            return Lit(value, ONE)
        case ("member", value):
            return MEMBERS[value]
        case ("true" | "false",):
            return nodes.TRUE if own[0] == "true" else nodes.FALSE
        case ("var", name):
            return names[name]
        case ("was", name):
            var = names[name]
            return before(var) if isinstance(var, NumVar) else was(var)
        case ("floor" | "ceil", inner, divisor):
            return (floor_div if own[0] == "floor" else ceil_div)(term(inner, names), divisor)
        case ("among", inner, *numbers):
            of = term(inner, names)
            return of.one_of(*(Lit(value, of.unit) for value in numbers))
        case (operator, *inner):
            return WRITTEN[operator](*(term(one, names) for one in inner))
    raise ValueError(own)


@dataclass(frozen=True)
class Built:
    """A machine or composition as safeloc has it; `names` gives its variables by our names."""

    system: TransitionSystem
    names: Names
    machines: Mapping[str, Machine] = field(default_factory=dict)
    composition: Composition | None = None
    own_names: Mapping[str, Names] = field(default_factory=dict)

    def prop(self, claim: Claim) -> Property:
        """The claim as a property."""
        if claim.of and self.composition is not None:
            own = Property(claim.name, "always", term(claim.own, self.own_names[claim.of]))
            own = Property(own.name, "always", own.term, unconditional=claim.unconditional)
            return self.composition.inherited(self.machines[claim.of], own)
        helper = claim.helper
        return Property(
            claim.name,
            claim.kind,
            term(claim.term, self.names),
            term(claim.response, self.names),
            claim.steps,
            term(claim.further_assumption, self.names),
            unconditional=claim.unconditional,
            helper=None if helper is None else lambda waiting: term(helper, {**self.names, WAITING: waiting > 0}),
        )


def build(game: Game) -> Built:
    """The machine or composition; ModelError where safeloc refuses it."""
    if isinstance(game, Whole):
        return _whole(game)
    made, names = machine(game)
    return Built(lower(made), names, {game.name: made}, None, {game.name: names})


def variable(var: Var) -> Any:
    """A declared variable, or an optional input."""
    if var.optional:
        return optional(var.name, ONE, var.low, var.high)
    if var.kind == "number":
        return number(var.name, ONE, var.low, var.high)
    return boolean(var.name) if var.kind == "truth" else choice(var.name, enumeration(MEMBERS))


def machine(world: World, shared: Mapping[str, Any] | None = None) -> tuple[Machine, dict[str, Any]]:
    """The declaration, and its variables by name; `shared` are those that exist already."""
    labels = modes(*(f"M{mode}" for mode in range(world.modes)))
    same = shared or {}
    declared = {name: same[name] if name in same else variable(var) for name, var in world.variables.items()}
    names: dict[str, Any] = {"mode": current_mode(labels)}
    for name, var in declared.items():
        names |= {name: var.value, f"{name}.present": var.present} if isinstance(var, Optional) else {name: var}
    rows = [
        Transition(
            row.name,
            tuple(labels[mode] for mode in row.sources),
            labels[row.target],
            term(row.guard, names),
            {names[name]: term(value, names) for name, value in row.sets.items()},
            rank=row.rank,
        )
        for row in world.rows
    ]
    made = Machine(
        name=world.name,
        modes=labels,
        inputs=[declared[var.name] for var in world.inputs],
        state={names[var.name]: _first(value, var) for var, value in world.state.items()},
        outputs={name: term(told, names) for name, told in world.outputs.items()},
        transitions=rows,
        world=MachineWorld(
            ghosts={names[var.name]: _first(value, var) for var, value in world.ghosts.items()},
            choices=[declared[var.name] for var in world.ghost_inputs],
            moves={names[name]: term(move, names) for name, move in world.ghost_moves.items()},
            clauses={
                "assumption": term(world.assumption, names),
                **{name: term(clause, names) for name, clause in world.clauses.items()},
            },
            reads_machine="the test asks it",
        ),
        initially=all_of(term(one, names) for one in world.initially),
        lemmas={name: term(lemma, names) for name, lemma in world.lemmas.items()},
    )
    return made, {**names, "fired": made.fired_name}


def _first(value: int | None, var: Var) -> Any:
    if value is None:
        return ANY
    return MEMBERS[value] if var.kind == "colour" else bool(value) if var.kind == "truth" else value


def _whole(whole: Whole) -> Built:
    shared = {
        name: variable(world.variables[name])
        for name in whole.shared
        for world in whole.worlds
        if name in world.variables
    }
    machines, own, qualified = {}, {}, dict[str, Any]()
    for world in whole.worlds:
        machines[world.name], own[world.name] = machine(world, shared)
        qualified |= {whole.called(world, name): var for name, var in own[world.name].items()}
    alike = [
        one for var in shared.values() for one in ((var.value, var.present) if isinstance(var, Optional) else (var,))
    ]
    discharge = [machines[one] if isinstance(one, str) else Clause(machines[one[0]], one[1]) for one in whole.discharge]
    wires = {qualified[name]: term(told, qualified) for name, told in whole.wires.items()}
    made = compose(whole.name, list(machines.values()), wires, shared=alike, discharge=discharge)
    of: dict[str, Any] = {}
    for world in whole.worlds:
        into = made.of(machines[world.name])
        of |= {whole.called(world, name): into(var) for name, var in own[world.name].items()}
    return Built(made.system, of, machines, made, own)


# ------------------------------------------------------------------ back


def read(node: Expr) -> Term:
    """A term of safeloc's as ours; for what provers found. ValueError for one that has no value in a state."""
    match node:
        case nodes.Lit(value, _):
            return ("lit", value)
        case nodes.Truth(value):
            return ("true",) if value else ("false",)
        case NumVar(name=name) | BoolVar(name=name):
            return ("var", name)
        case nodes.Add(a, b):
            return ("add", read(a), read(b))
        case nodes.Sub(a, b):
            return ("sub", read(a), read(b))
        case nodes.Mul(a, b):
            return ("mul", read(a), read(b))
        case nodes.FloorDiv(a, divisor):
            return ("floor", read(a), divisor)
        case nodes.Min(a, b):
            return ("min", read(a), read(b))
        case nodes.Max(a, b):
            return ("max", read(a), read(b))
        case nodes.Choose(c, a, b) | nodes.ChooseBool(c, a, b):
            return ("ite", read(c), read(a), read(b))
        case nodes.Not(a):
            return ("not", read(a))
        case nodes.And(inner):
            return ("and", *(read(one) for one in inner))
        case nodes.Or(inner):
            return ("or", *(read(one) for one in inner))
        case nodes.Compare(operator, a, b):
            return ({"<": "lt", "<=": "le", "==": "eq"}[operator], read(a), read(b))
    raise ValueError(node)
