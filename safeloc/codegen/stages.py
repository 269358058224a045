"""A composition's moves machine by machine: each reads what the machines before it have come to in the same step.

A machine of the whole hears terms over the state of earlier machines after the step. Written out in one piece, what an earlier
machine computes would stand in every later one. Here it is cut off: where a term gives an earlier machine's variable its
next value, a variable stands for that value.

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
    """Some of the state variables and how they move: over their state before the step, inputs, `after` and `before`.

    name    of the machine
    moved   state variable -> term
    fired   variable that names the machine -> term for the transition that fires
    after   what stands for a variable of an earlier stage after the step -> that variable
    before  what stands for a variable of an earlier stage before the step -> that variable
    """

    name: str
    moved: Mapping[Var, Expr]
    fired: Mapping[NumVar, Num]
    after: Mapping[Var, Var]
    before: Mapping[Var, Var]


def stages(system: TransitionSystem) -> list[Stage]:
    """Return the stages in the order of the step; together they move every state variable and tell every fired transition."""
    found: list[Stage] = []
    earlier, cut = list[Var](), dict[Expr, Var]()
    after: dict[Var, Var] = {}
    for name, group, fired in _groups(system):
        whole = Substitution({}, cut.items())
        moved = {var: whole(system.next[var]) for var in group}
        told = {var: whole.num(system.fired[var]) for var in fired}
        read = set(variables([*moved.values(), *told.values()])).intersection(earlier)
        before = {var: replace(var, name=f"{var.name} before") for var in earlier if var in read}
        past = Substitution(before)
        found.append(
            Stage(
                name,
                {var: past(term) for var, term in moved.items()},
                {var: past.num(term) for var, term in told.items()},
                dict(after),
                {kept: var for var, kept in before.items()},
            )
        )
        stands = {var: replace(var, name=f"{var.name} after") for var in group}
        cut |= {system.next[var]: stands[var] for var in reversed(group) if _is_cut(var, system.next[var])}
        after |= {later: var for var, later in stands.items()}
        earlier += group
    return found


def at_once(system: TransitionSystem) -> Stage:
    """Return the composition as one stage."""
    return Stage(system.name, system.next, system.fired, {}, {})


def _groups(system: TransitionSystem) -> list[tuple[str, list[Var], list[NumVar]]]:
    """Name, state variables and fired variables of each stage; what is of no machine comes last."""
    fired = list(system.fired)
    if not system.stages or len(system.stages) != len(fired) or len(fired) != len(system.machines):
        return [(system.name, list(system.state), fired)]
    groups = [
        (machine.name, [var for var in system.state if var in members], [told])
        for machine, members, told in zip(system.machines, system.stages, fired, strict=True)
    ]
    others = [var for var in system.state if not any(var in members for members in system.stages)]
    return [*groups, (system.name, others, [])] if others else groups


def _is_cut(var: Var, moved: Expr) -> bool:
    """Return whether the term belongs to this variable only: a constant or another variable does not."""
    return moved is var or (not isinstance(moved, Var) and bool(variables([moved])))
