"""Many runs at once in numpy: arrays of shape [step, run].

Generated straight-line code over int64 and bool arrays, worked through in blocks of runs that stay in the
processor's cache. int64 wraps in silence, so a system whose terms might leave 64 bits is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from safeloc.errors import InputError
from safeloc.expr import (
    Add,
    And,
    BoolVar,
    Choose,
    ChooseBool,
    Compare,
    Expr,
    FloorDiv,
    Lit,
    Max,
    Min,
    Mul,
    Node,
    Not,
    Num,
    NumVar,
    Or,
    Past,
    Sub,
    Substitution,
    Truth,
    Value,
    Var,
    children,
    in_order,
)
from safeloc.interpret import admitted, start
from safeloc.ranges import beyond_int64
from safeloc.system import TransitionSystem, canonical

Array = NDArray[Any]
BLOCK_RUNS = 16384


@dataclass(frozen=True)
class BatchTrace:
    """What a batch run kept: arrays [step, run] by name, and the last state of every run by name ([run])."""

    kept: Mapping[str, Array]
    last: Mapping[str, Array]


@dataclass(frozen=True)
class Batch:
    """A system as a numpy function: `step(state arrays, input arrays)` on one block of runs."""

    system: TransitionSystem
    source: str
    keep: tuple[str, ...]
    step: Callable[[list[Array], list[Array]], tuple[list[Array], list[Array]]]


def compile_batch(system: TransitionSystem, keep: Sequence[str] = ()) -> Batch:
    """Generate and load the function. `keep` names state variables, outputs or fired variables to be returned.

    Raises InputError for an unknown name and for a system whose terms may leave 64 bits.
    """
    wide = beyond_int64([*system.next.values(), *system.fired.values(), *system.outputs.values()])
    if wide:
        raise InputError(
            f"{system.name}: {len(wide)} terms may leave 64 bits, for example {wide[0]!r}; narrow the ranges."
        )
    source = to_numpy(system, keep)
    space: dict[str, Any] = {"np": np}
    exec(compile(source, f"<safeloc batch {system.name}>", "exec"), space)
    return Batch(system, source, tuple(keep), space["step"])


def simulate(
    system: TransitionSystem | Batch,
    inputs: Mapping[str, Array],
    *,
    start_state: Mapping[str, Array | Value] | None = None,
    keep: Sequence[str] = (),
    block_runs: int = BLOCK_RUNS,
) -> BatchTrace:
    """Run every column of the inputs.

    inputs       name -> array [step, run], integers or booleans; optional inputs may be left out (absent), or come
                 with `name.present`
    start_state  name -> value or array [run], for variables declared ANY
    Raises InputError naming array, step and run for a wrong dtype, shape, name or value out of range.
    """
    batch = system if isinstance(system, Batch) else compile_batch(system, keep)
    columns, steps, runs = _columns(batch.system, inputs)
    state = _first(batch.system, start_state or {}, runs)
    kept = [np.empty((steps, runs), dtype=_dtype_of(batch.system, name)) for name in batch.keep]
    for begin in range(0, runs, block_runs):
        block = slice(begin, min(begin + block_runs, runs))
        _run_block(batch, columns, state, kept, block, steps)
    last = {var.name: array for var, array in zip(batch.system.state, state, strict=True)}
    return BatchTrace(dict(zip(batch.keep, kept, strict=True)), last)


def _run_block(
    batch: Batch, columns: list[Array], state: list[Array], kept: list[Array], block: slice, steps: int
) -> None:
    now = [np.ascontiguousarray(array[block]) for array in state]
    for number in range(steps):
        now, shown = batch.step(now, [column[number, block] for column in columns])
        for target, values in zip(kept, shown, strict=True):
            target[number, block] = values
    for target, values in zip(state, now, strict=True):
        target[block] = values


def _columns(system: TransitionSystem, inputs: Mapping[str, Array]) -> tuple[list[Array], int, int]:
    left = dict(inputs)
    shapes = {array.shape for array in left.values() if isinstance(array, np.ndarray)}
    if len(shapes) != 1 or len(next(iter(shapes), ())) != 2:
        raise InputError(f"{system.name}: inputs must be arrays of one shape [step, run]; got {sorted(shapes)}.")
    steps, runs = next(iter(shapes))
    present = {option.present.name: option.value for option in system.optionals}
    values = {option.value.name: option for option in system.optionals}
    columns = []
    for var in system.inputs:
        array = left.pop(var.name, None)
        if array is None and var.name in present:
            array = np.full((steps, runs), present[var.name].name in inputs)
        elif array is None and var.name in values and isinstance(var, NumVar):
            array = np.full((steps, runs), canonical(var))
        elif array is None:
            raise InputError(f"{system.name}: input {var.name!r} is missing.")
        columns.append(_checked(system, var, array))
    if left:
        raise InputError(f"{system.name}: unknown inputs {sorted(left)}.")
    return columns, steps, runs


def _checked(system: TransitionSystem, var: Var, array: Array) -> Array:
    """The array as int64 or bool; floats (and so NaN) are refused, whatever their values."""
    if isinstance(var, BoolVar):
        if array.dtype != np.bool_:
            raise InputError(f"{system.name}: input {var.name!r} has dtype {array.dtype}; it takes booleans.")
        return array
    if array.dtype == np.bool_ or not np.issubdtype(array.dtype, np.integer):
        raise InputError(f"{system.name}: input {var.name!r} has dtype {array.dtype}; it takes whole numbers.")
    outside = np.logical_or(array < var.low, array > var.high)
    if outside.any():
        where = np.argwhere(outside)[0]
        raise InputError(
            f"{system.name}: input {var.name!r} at step {where[0]}, run {where[1]} is {array[tuple(where)]}, outside "
            f"{var.low}..{var.high} {var.unit.name}."
        )
    return array.astype(np.int64, copy=False)


def _first(system: TransitionSystem, chosen: Mapping[str, Array | Value], runs: int) -> list[Array]:
    plain = {name: value for name, value in chosen.items() if not isinstance(value, np.ndarray)}
    values = start(system, plain)
    result = []
    for var in system.state:
        given = chosen.get(var.name)
        if isinstance(given, np.ndarray):
            if given.shape != (runs,):
                raise InputError(f"{system.name}: start {var.name!r} has shape {given.shape}, expected ({runs},).")
            for value in np.unique(given):
                admitted(var, value.item())
            result.append(given.astype(np.bool_ if isinstance(var, BoolVar) else np.int64))
        else:
            result.append(np.full(runs, values[var], dtype=np.bool_ if isinstance(var, BoolVar) else np.int64))
    return result


def _dtype_of(system: TransitionSystem, name: str) -> type[np.generic]:
    return np.int64 if isinstance(_term(system, name), Num) else np.bool_


def _term(system: TransitionSystem, name: str) -> Expr:
    for var in system.state:
        if var.name == name:
            return system.next[var]
    for fired, term in system.fired.items():
        if fired.name == name:
            return term
    if name in system.outputs:
        return _after(system, system.outputs[name])
    known = [*(var.name for var in system.state), *(var.name for var in system.fired), *system.outputs]
    raise InputError(f"{system.name}: cannot keep {name!r}; it has {known}.")


def _after(system: TransitionSystem, term: Expr) -> Expr:
    return Substitution({var: moved for var, moved in system.next.items()})(term)


# ------------------------------------------------------------------ generating


def to_numpy(system: TransitionSystem, keep: Sequence[str] = ()) -> str:
    """The source of `step(state, inputs)` -> (state after, kept values): one numpy call a term."""
    names: dict[Expr, str] = {var: f"s{n}" for n, var in enumerate(system.state)}
    names |= {var: f"i{n}" for n, var in enumerate(system.inputs)}
    kept = [_term(system, name) for name in keep]
    moved = list(system.next.values())
    order = [node for node in in_order([*moved, *kept]) if not isinstance(node, (NumVar, BoolVar))]
    last = _last_uses(order, [*moved, *kept])
    lines: list[str] = []
    for number, node in enumerate(order):
        if isinstance(node, (Lit, Truth)):
            names[node] = repr(node.value)
            continue
        names[node] = f"x{number}"
        lines.append(f"x{number} = {_call(node, names)}")
        spent = [names[child] for child in dict.fromkeys(children(node)) if last.get(id(child)) == number]
        if spent:
            lines.append(f"del {', '.join(spent)}")
    take = [f"s{n} = state[{n}]" for n in range(len(system.state))]
    take += [f"i{n} = inputs[{n}]" for n in range(len(system.inputs))]
    states, shown = (", ".join(_array(term, names) for term in terms) for terms in (moved, kept))
    body = "".join(f"    {line}\n" for line in [*take, *lines])
    return f"def step(state, inputs):\n{body}    return [{states}], [{shown}]\n"


def _array(term: Expr, names: Mapping[Expr, str]) -> str:
    """A constant result still has to be an array."""
    return f"np.full(len(state[0]), {names[term]})" if isinstance(term, (Lit, Truth)) else names[term]


def _last_uses(order: Sequence[Node], results: Sequence[Expr]) -> dict[int, int]:
    """Position of the last use of every computed term that is not itself a result: its memory is given back there."""
    last: dict[int, int] = {}
    for number, node in enumerate(order):
        for child in children(node):
            if not isinstance(child, (Lit, Truth, NumVar, BoolVar)):
                last[id(child)] = number
    for term in results:
        last.pop(id(term), None)
    return last


def _call(node: Node, of: Mapping[Expr, str]) -> str:
    match node:
        case Add(a, b):
            return f"{of[a]} + {of[b]}"
        case Sub(a, b):
            return f"{of[a]} - {of[b]}"
        case Mul(a, b):
            return f"{of[a]} * {of[b]}"
        case FloorDiv(a, divisor, _):
            return f"{of[a]} // {divisor}"
        case Min(a, b):
            return f"np.minimum({of[a]}, {of[b]})"
        case Max(a, b):
            return f"np.maximum({of[a]}, {of[b]})"
        case Choose(c, a, b, _) | ChooseBool(c, a, b):
            return f"np.where({of[c]}, {of[a]}, {of[b]})"
        case Not(inner):
            return f"np.logical_not({of[inner]})"
        case And(parts):
            return _folded("np.logical_and", [of[part] for part in parts])
        case Or(parts):
            return _folded("np.logical_or", [of[part] for part in parts])
        case Compare(op, a, b):
            return f"{of[a]} {op} {of[b]}"
        case Past() | NumVar() | BoolVar() | Lit() | Truth():
            raise KeyError(f"{node!r} is no call")
        case _:
            assert_never(node)


def _folded(function: str, parts: list[str]) -> str:
    text = f"{function}({parts[0]}, {parts[1]})"
    for part in parts[2:]:
        text = f"{function}({text}, {part})"
    return text
