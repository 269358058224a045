"""The reference interpreter: exact, slow, and the oracle for all other back ends.

It reads only TransitionSystem and computes with Python's unbounded integers; it clips no value and fills in no default.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any, assert_never

from safeloc.errors import InputError
from safeloc.language.expr import Bool, BoolVar, Expr, Lit, NumVar, Var
from safeloc.language.first_values import Any_
from safeloc.language.nodes import (
    TRUE,
    Add,
    And,
    Choose,
    ChooseBool,
    Compare,
    FloorDiv,
    Max,
    Min,
    Mul,
    Node,
    Not,
    Or,
    Past,
    Sub,
    Truth,
    Value,
)
from safeloc.language.renamed import hint, renamed
from safeloc.language.system import TransitionSystem, canonical
from safeloc.language.terms import in_order
from safeloc.language.trace import Step, Trace
from safeloc.language.units import Enumeration

Values = dict[Var, Value]


def evaluate(terms: Iterable[Expr], values: Mapping[Var, Value]) -> list[Value]:
    """Return the value of each term for these values of variables; KeyError for a variable without a value."""
    return _program(tuple(terms))(values)


class Program:
    """Terms prepared for repeated evaluation: the order of evaluation is determined once.

    Every node has a place in a list of values, and a small function that computes its value from those before it.
    """

    def __init__(self, terms: Iterable[Expr]) -> None:
        self.terms = list(terms)
        order = in_order(self.terms)
        place: dict[Expr, int] = {node: number for number, node in enumerate(order)}
        self._moves = [_move(node, place) for node in order]
        self._results = [place[term] for term in self.terms]

    def __call__(self, values: Mapping[Var, Value]) -> list[Value]:
        """Return the value of each term; KeyError for a variable without a value."""
        found: list[Any] = []
        keep = found.append
        for move in self._moves:
            keep(move(found, values))
        return [found[place] for place in self._results]


_Move = Callable[[list[Any], Mapping[Var, Value]], Value]
_STEPS: weakref.WeakKeyDictionary[TransitionSystem, Program] = weakref.WeakKeyDictionary()
_OUTPUTS: weakref.WeakKeyDictionary[TransitionSystem, Program] = weakref.WeakKeyDictionary()


def holds(term: Bool, values: Mapping[Var, Value]) -> bool:
    """Return the truth value of one term."""
    return bool(evaluate([term], values)[0])


@lru_cache(maxsize=64)
def _program(terms: tuple[Expr, ...]) -> Program:
    """Return the program of these terms; cached, because callers evaluate the same terms state after state."""
    return Program(terms)


def _move(node: Node, place: Mapping[Expr, int]) -> _Move:
    """Make the function that computes a node's value from the values of its parts; in it, `of` lists these by place."""
    match node:
        case NumVar() | BoolVar():
            return lambda _, values: values[node]
        case Lit(value, _) | Truth(value):
            return lambda _, __: value
        case FloorDiv(a, divisor):
            i = place[a]
            return lambda of, _: of[i] // divisor
        case Choose(c, a, b, _) | ChooseBool(c, a, b):
            k, i, j = place[c], place[a], place[b]
            return lambda of, _: of[i] if of[k] else of[j]
        case Not(inner):
            i = place[inner]
            return lambda of, _: not of[i]
        case And(parts):
            return _every([place[part] for part in parts])
        case Or(parts):
            return _some([place[part] for part in parts])
        case Add() | Sub() | Mul() | Min() | Max() | Compare():
            return _of_two(node, place[node.left], place[node.right])
        case Past():
            raise InputError(
                f"{type(node).__name__} reads earlier steps and cannot be evaluated; `observe` the property first."
            )
        case _:
            assert_never(node)


def _every(places: Sequence[int]) -> _Move:
    def move(of: list[Any], _: Mapping[Var, Value]) -> bool:
        for place in places:  # noqa: SIM110  # `all` of a generator takes twice as long
            if not of[place]:
                return False
        return True

    return move


def _some(places: Sequence[int]) -> _Move:
    def move(of: list[Any], _: Mapping[Var, Value]) -> bool:
        for place in places:  # noqa: SIM110
            if of[place]:
                return True
        return False

    return move


def _of_two(node: Add | Sub | Mul | Min | Max | Compare, i: int, j: int) -> _Move:
    match node:
        case Add():
            return lambda of, _: of[i] + of[j]
        case Sub():
            return lambda of, _: of[i] - of[j]
        case Mul():
            return lambda of, _: of[i] * of[j]
        case Min():
            return lambda of, _: min(of[i], of[j])
        case Max():
            return lambda of, _: max(of[i], of[j])
        case Compare("<"):
            return lambda of, _: of[i] < of[j]
        case Compare("<="):
            return lambda of, _: of[i] <= of[j]
        case Compare("=="):
            return lambda of, _: of[i] == of[j]
        case Compare():
            raise AssertionError(node)
        case _:
            assert_never(node)


def start(system: TransitionSystem, chosen: Mapping[str, Value] | None = None) -> Values:
    """Return the first state. `chosen` gives values to variables declared ANY; the default is their value nearest zero.

    Raises InputError for an unknown name, a value out of range, or a state that `initially` excludes.
    """
    given = dict(chosen or {})
    values: Values = {}
    for var in system.state:
        declared = system.initial[var]
        if isinstance(declared, Any_):
            fallback = canonical(var) if isinstance(var, NumVar) else False
            values[var] = admitted(var, given.pop(var.name, fallback))
        else:
            values[var] = declared.value if isinstance(declared, Lit) else declared
            if var.name in given and given.pop(var.name) != values[var]:
                raise InputError(
                    f"{system.name}: {var.name} starts at {values[var]} by declaration and cannot be chosen; leave it out."
                )
    if given:
        raise InputError(
            f"{system.name}: unknown state variables {sorted(given)}{renamed(given, _names(system.state))}."
        )
    if not holds(system.init, values):
        raise InputError(f"{system.name}: the chosen first state breaks `initially`; choose values that satisfy it.")
    return values


def admitted(var: Var, value: object) -> Value:
    """Return the value as the variable stores it (a label becomes its number); InputError if kind or range is wrong."""
    if isinstance(var, BoolVar):
        if not isinstance(value, bool):
            raise InputError(f"{var.name}: expected true or false, got {value!r}.")
        return value
    if isinstance(value, str) and isinstance(var.unit, Enumeration) and value in var.unit.members:
        return var.unit.index(value)
    if isinstance(value, bool) or not isinstance(value, int):
        raise InputError(f"{var.name}: expected a whole number of {var.unit.name}, got {value!r}.")
    if not var.low <= value <= var.high:
        raise InputError(f"{var.name}: {value} {var.unit.name} is outside {var.low}..{var.high}.")
    return value


def read_inputs(system: TransitionSystem, record: Mapping[str, object]) -> Values:
    """Return the inputs of one step from a record by name. It may omit optional inputs (or give None), but no others.

    Raises InputError for a missing or unknown name, and for a value that `admitted` refuses.
    """
    left = dict(record)
    values: Values = {}
    for option in system.optionals:
        raw = left.pop(option.value.name, None)
        values[option.present] = raw is not None
        values[option.value] = canonical(option.value) if raw is None else admitted(option.value, raw)
        flag = left.pop(option.present.name, None)
        if flag is not None and not isinstance(flag, bool):
            raise InputError(f"{option.present.name}: expected true or false, got {flag!r}.")
        if (
            flag is not None
            and flag != values[option.present]
            and not (flag is False and raw == canonical(option.value))
        ):
            raise InputError(f"{system.name}: {option.present.name} is {flag!r} but {option.value.name} is {raw!r}.")
        if flag is False:
            values[option.present] = False
    for var in system.inputs:
        if var not in values:
            if var.name not in left:
                raise InputError(
                    f"{system.name}: input {var.name!r} is missing; the step needs {_names(system.inputs)}"
                    f"{renamed(left, _names(system.inputs))}."
                )
            values[var] = admitted(var, left.pop(var.name))
    if left:
        known, strange = _names(system.inputs), sorted(left)
        new_names = renamed(left, known)
        raise InputError(
            f"{system.name}: unknown inputs {strange}{new_names}.{'' if new_names else hint(strange[0], known)}"
        )
    return values


def _names(of: Iterable[Var]) -> list[str]:
    return [var.name for var in of]


def step(
    system: TransitionSystem, state: Mapping[Var, Value], inputs: Mapping[Var, Value]
) -> tuple[Values, dict[NumVar, int]]:
    """Run one step; return the state after it and, for each machine, the number of the transition that fired (0: none)."""
    known = {**state, **inputs}
    if system not in _STEPS:
        _STEPS[system] = Program([*system.next.values(), *system.fired.values()])
    moved = _STEPS[system](known)
    after = dict(zip(system.next, moved, strict=False))
    return after, dict(zip(system.fired, map(int, moved[len(after) :]), strict=True))


def stepped(
    system: TransitionSystem, state: Values, stream: Iterable[Mapping[Var, Value]], *, while_: Bool = TRUE
) -> Iterator[tuple[Mapping[Var, Value], Values, dict[NumVar, int]]]:
    """Step on from a state; yield the inputs of each step, the state after it and the numbers of the transitions that fired.

    while_  a condition over the state before the step and inputs: the run ends before the first step that breaks it
    """
    for inputs in stream:
        if while_ is not TRUE and not holds(while_, {**state, **inputs}):
            return
        state, fired = step(system, state, inputs)
        yield inputs, state, fired


def taken(
    system: TransitionSystem,
    state: Values,
    stream: Iterable[Mapping[str, object]],
    *,
    while_: Bool = TRUE,
    hidden: Container[Var] = (),
) -> Iterator[tuple[Step, Values]]:
    """Run on from a state with inputs by name; yield each step together with the state after it.

    while_  as in `stepped`
    hidden  state variables that the yielded steps omit
    """
    rows = (read_inputs(system, record) for record in stream)
    for inputs, after, fired in stepped(system, state, rows, while_=while_):
        yield Step(named(inputs), fired_names(fired), named(after, hidden), outputs(system, after)), after


def run(
    system: TransitionSystem, stream: Iterable[Mapping[str, object]], *, first: Mapping[str, Value] | None = None
) -> Trace:
    """Run all steps of `stream` (one mapping of inputs each) and return the Trace; `first` chooses ANY values."""
    state = start(system, first)
    return Trace(system, named(state), tuple(one for one, _ in taken(system, state, stream)))


def outputs(system: TransitionSystem, state: Mapping[Var, Value]) -> dict[str, Value]:
    """Return the outputs in a state, by name."""
    if system not in _OUTPUTS:
        _OUTPUTS[system] = Program(system.outputs.values())
    return dict(zip(system.outputs, _OUTPUTS[system](state), strict=True))


def fired_names(fired: Mapping[NumVar, int]) -> dict[str, str]:
    """Return the name of the transition that fired, by the name of the machine's fired variable."""
    result = {}
    for var, index in fired.items():
        assert isinstance(var.unit, Enumeration)
        result[var.name] = var.unit.members[index]
    return result


def named(values: Mapping[Var, Value], hidden: Container[Var] = ()) -> dict[str, Value]:
    """Return the values by name, without those of hidden variables."""
    return {var.name: value for var, value in values.items() if var not in hidden}
