"""A composition's moves machine by machine: each machine reads the new values of the machines before it in the same step.

The wires of a machine carry terms over the state of earlier machines after the step. In one piece, the code of every machine
would repeat the computations of all earlier ones. Therefore these are cut off: if a term is the next value of an earlier
machine's variable, a variable takes its place.

    stages(system)  ->  [Stage("motion", moved={distance: ...}, ...), Stage("odometry", ...), ...]

A system that is no composition is one stage.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from safeloc.language.nodes import Expr, Num, NumVar, Var
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import Substitution, variables


@dataclass(frozen=True, eq=False)
class Stage:
    """The moves of one machine, over its state before the step, the inputs, and the variables of `after` and `before`.

    name    the machine's name
    moved   state variable -> term for its next value
    fired   the machine's fired variable -> term for the transition that fires
    after   variable that represents a variable of an earlier stage after the step -> that variable
    before  variable that represents a variable of an earlier stage before the step -> that variable
    """

    name: str
    moved: Mapping[Var, Expr]
    fired: Mapping[NumVar, Num]
    after: Mapping[Var, Var]
    before: Mapping[Var, Var]


def stages(system: TransitionSystem) -> list[Stage]:
    """Return the stages in the order of the step; together they compute every state variable and every fired transition."""
    found: list[Stage] = []
    earlier, cut = list[Var](), dict[Expr, Var]()
    after: dict[Var, Var] = {}
    for name, group, fired in _groups(system):
        replaced = Substitution({}, cut.items())
        moved = {var: replaced(system.next[var]) for var in group}
        numbers = {var: replaced.num(system.fired[var]) for var in fired}
        read = set(variables([*moved.values(), *numbers.values()])).intersection(earlier)
        before = {var: replace(var, name=f"{var.name} before") for var in earlier if var in read}
        past = Substitution(before)
        found.append(
            Stage(
                name,
                {var: past(term) for var, term in moved.items()},
                {var: past.num(term) for var, term in numbers.items()},
                dict(after),
                {kept: var for var, kept in before.items()},
            )
        )
        stands = {var: replace(var, name=f"{var.name} after") for var in group}
        cut |= {system.next[var]: stands[var] for var in reversed(group) if is_cut(var, system.next[var])}
        after |= {later: var for var, later in stands.items()}
        earlier += group
    return found


def at_once(system: TransitionSystem) -> Stage:
    """Return the composition as one stage."""
    return Stage(system.name, system.next, system.fired, {}, {})


def _groups(system: TransitionSystem) -> list[tuple[str, list[Var], list[NumVar]]]:
    """Return name, state variables and fired variables of each stage; state variables of no machine (observers) come last."""
    fired = list(system.fired)
    if not system.stages or len(system.stages) != len(fired) or len(fired) != len(system.machines):
        return [(system.name, list(system.state), fired)]
    groups = [
        (machine.name, [var for var in system.state if var in members], [number])
        for machine, members, number in zip(system.machines, system.stages, fired, strict=True)
    ]
    others = [var for var in system.state if not any(var in members for members in system.stages)]
    return [*groups, (system.name, others, [])] if others else groups


def is_cut(var: Var, moved: Expr) -> bool:
    """Return whether the next value identifies the variable: a constant or another variable does not."""
    return moved is var or (not isinstance(moved, Var) and bool(variables([moved])))
