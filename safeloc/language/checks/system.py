"""Rules for every system, whether lowered, composed or built by hand; provers and back ends rely on them."""

from __future__ import annotations

import weakref
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from safeloc.errors import ModelError
from safeloc.language.checks.rule import Rule, complaints
from safeloc.language.checks.terms import malformed
from safeloc.language.expr import Bool, Expr, Num, NumVar, Var
from safeloc.language.nodes import Past
from safeloc.language.terms import in_order, variables

if TYPE_CHECKING:
    from safeloc.language.system import TransitionSystem

_FOUND_SOUND: weakref.WeakSet[TransitionSystem] = weakref.WeakSet()


def check_system(system: TransitionSystem) -> None:
    """Raise ModelError with all complaints of the first broken rule; a system that passed is not checked again."""
    if system in _FOUND_SOUND:
        return
    found = complaints(SYSTEM, system)
    if found:
        raise ModelError(f"system {system.name!r}:\n" + "\n".join(f"  - {c}" for c in found))
    _FOUND_SOUND.add(system)


def _where(var: Var) -> str:
    return f"{var.name!r} ({var.src})" if var.src else repr(var.name)


def _terms_are_well_formed(system: TransitionSystem) -> Iterator[str]:
    named = [*system.next.values(), *system.fired.values(), *system.outputs.values(), *system.lemmas.values()]
    yield from malformed([*named, system.init, system.assume, *system.state, *system.inputs])


def _names_are_distinct(system: TransitionSystem) -> Iterator[str]:
    """Variables have distinct names: solvers and records identify a variable by its name."""
    seen: dict[str, Var] = {}
    for var in dict.fromkeys((*system.state, *system.inputs, *system.fired)):
        other = seen.setdefault(var.name, var)
        if other is not var:
            yield f"two variables are called {var.name!r}: {_where(other)} and {_where(var)}; rename one."


def _one_role_each(system: TransitionSystem) -> Iterator[str]:
    inputs = set(system.inputs)
    for var in system.state:
        if var in inputs:
            yield (
                f"{_where(var)} is state of one machine and an input of another; a shared variable must have one role in all "
                "machines: input, ghost input or ghost."
            )
    for what, group in (("state", system.state), ("input", system.inputs)):
        counted = Counter(group)
        for var in [var for var, times in counted.items() if times > 1]:
            yield f"{what} variable {_where(var)} is listed twice; list it once."


def _everything_moves(system: TransitionSystem) -> Iterator[str]:
    for var in system.state:
        move = system.next.get(var)
        if move is None or var not in system.initial:
            yield f"{_where(var)} has no next value or no first value; give both."
        elif isinstance(var, NumVar) != isinstance(move, Num):
            kind = "number" if isinstance(var, NumVar) else "truth value"
            yield f"the next value of {_where(var)} is {move!r}, which is no {kind}; give a {kind}."
    for var in set(system.next) - set(system.state):
        yield f"{_where(var)} has a next value but is no state variable; list it in the state."


def _reads_are_known(system: TransitionSystem) -> Iterator[str]:
    state, every = set(system.state), {*system.state, *system.inputs}
    steps = {f"the next value of {var.name!r}": term for var, term in system.next.items()}
    steps |= {var.name: term for var, term in system.fired.items()} | {"the assumption": system.assume}
    yield from _only(steps, every, "state and inputs")
    ends: dict[str, Expr] = {f"output {name!r}": term for name, term in system.outputs.items()}
    ends |= {f"lemma {name!r}": term for name, term in system.lemmas.items()} | {"`initially`": system.init}
    yield from _only(ends, state, "state")


def _only(terms: Mapping[str, Expr], allowed: set[Var], text: str) -> Iterator[str]:
    """Check all terms at once, since they share most of their parts; check each term alone only to name the wrong one."""
    nodes = in_order(terms.values())
    if all(node in allowed for node in nodes if isinstance(node, Var)) and not _past(nodes):
        return
    for what, term in terms.items():
        strange = [_where(var) for var in variables([term]) if var not in allowed]
        if strange:
            yield f"{what} reads {', '.join(strange)}; it may read only {text}."
        if _past(in_order([term])):
            yield f"{what} uses a past operator; only properties may."


def _past(nodes: Iterable[Expr]) -> bool:
    return any(isinstance(node, Past) for node in nodes)


def _no_ghost_is_read_on_board(system: TransitionSystem) -> Iterator[str]:
    """On-board terms read no ghosts: a guard, a wire or a shared variable must not give the machine the ground
    truth."""
    board: dict[str, Expr] = {repr(var.name): term for var, term in system.next.items() if var not in system.ghosts}
    board |= {var.name: term for var, term in system.fired.items()} | dict(system.outputs)
    if system.ghosts.isdisjoint(variables(board.values())):
        return
    for what, term in board.items():
        read = [_where(var) for var in variables([term]) if var in system.ghosts]
        if read:
            yield f"{what}, which is computed on board, reads the ghost {', '.join(read)}; let it read inputs and state only."


def _ghosts_are_variables(system: TransitionSystem) -> Iterator[str]:
    for var in system.ghosts - {*system.state, *system.inputs}:
        yield f"the ghost {_where(var)} is neither state nor input; list it as one of them."


def _optionals_are_complete(system: TransitionSystem) -> Iterator[str]:
    """Value and presence of an optional input belong together; otherwise an input could be present and absent at once."""
    inputs, used = set(system.inputs), set[Var]()
    for option in system.optionals:
        for var in (option.value, option.present):
            if var not in inputs:
                yield f"{_where(var)} of an optional input is no input of the composition; share or wire value and presence together."
            elif var in used:
                yield f"{_where(var)} is part of two optional inputs; share value and presence together, or neither."
            used.add(var)


def _facts_are_truth_values(system: TransitionSystem) -> Iterator[str]:
    for what, term in {"initially": system.init, "assumption": system.assume, **system.lemmas}.items():
        if not isinstance(term, Bool):
            yield f"{what}: {term!r} is no truth-valued term; write TRUE or FALSE for a constant."


SYSTEM: tuple[Rule[TransitionSystem], ...] = (
    Rule("terms of the system are well formed", "a crash", _terms_are_well_formed),
    Rule("facts of the system are truth values", "a crash", _facts_are_truth_values),
    Rule("names of the system are distinct", "a crash", _names_are_distinct),
    Rule("every variable has one role", "a wrong verdict", _one_role_each),
    Rule("ghosts of the system are variables", "a slip", _ghosts_are_variables),
    Rule("every state variable moves", "a crash", _everything_moves),
    Rule("reads of the system are known", "a crash", _reads_are_known),
    Rule("no ghost is read on board", "a wrong verdict", _no_ghost_is_read_on_board),
    Rule("optional inputs are whole", "a crash", _optionals_are_complete),
)
