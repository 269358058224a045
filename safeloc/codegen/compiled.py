"""Generated Python, loaded: one step, a step that stores its state, a loop over a stream, and the outputs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import CodeType
from typing import Any

from safeloc.codegen.python_code import rows_to_python, terms_to_python, to_python
from safeloc.language.interpret import fired_names, read_inputs, start
from safeloc.language.nodes import Expr, Value, Var
from safeloc.language.system import TransitionSystem

__all__ = ["Compiled", "Row", "Tick", "compile_rows", "compile_system", "compile_terms", "to_python"]

Row = tuple[Value, ...]
Tick = Callable[[Row], tuple[int, ...]]


@dataclass(frozen=True)
class Compiled:
    """A system as Python functions. State and inputs are tuples in the order of `state_names` and `input_names`.

    step     (state, inputs) -> (state after, fired transition numbers)
    begin    state -> (tick, now): the same step, which stores its state; `tick(inputs)` -> fired transition numbers,
             `now()` -> state; the fastest way to run step by step
    run      (rows of inputs, state) -> last state: all steps in one loop
    history  (rows of inputs, state) -> states after every step
    outputs  state -> outputs, in the order of `output_names`

    These functions do not check inputs; pass raw data through `read`, which refuses the same inputs as the interpreter.
    """

    system: TransitionSystem
    source: str
    state_names: tuple[str, ...]
    input_names: tuple[str, ...]
    output_names: tuple[str, ...]
    step: Callable[[Row, Row], tuple[Row, tuple[int, ...]]]
    begin: Callable[[Row], tuple[Tick, Callable[[], Row]]]
    run: Callable[[Iterable[Row], Row], Row]
    history: Callable[[Iterable[Row], Row], list[Row]]
    outputs: Callable[[Row], Row]

    def first(self, chosen: Mapping[str, Value] | None = None) -> Row:
        """Return the first state; InputError as in `interpret.start`."""
        return tuple(start(self.system, chosen).values())

    def read(self, record: Mapping[str, object]) -> Row:
        """Return the inputs of one step from a record by name; InputError as in `interpret.read_inputs`."""
        values = read_inputs(self.system, record)
        return tuple(values[var] for var in self.system.inputs)

    def named_outputs(self, state: Row) -> dict[str, Value]:
        """Return the outputs by name."""
        return dict(zip(self.output_names, self.outputs(state), strict=True))

    def fired(self, numbers: Sequence[int]) -> dict[str, str]:
        """Return names of the transitions that fired, by fired variable."""
        return fired_names(dict(zip(self.system.fired, numbers, strict=True)))


def compile_system(system: TransitionSystem) -> Compiled:
    """Generate and load the functions. For the on-board system, pass `without_ghosts(system)`."""
    source = to_python(system)
    space = _functions(source, system.name)
    return Compiled(
        system,
        source,
        tuple(var.name for var in system.state),
        tuple(var.name for var in system.inputs),
        tuple(system.outputs),
        space["step"],
        space["begin"],
        space["run"],
        space["history"],
        space["outputs"],
    )


def compile_terms(reads: Sequence[Var], terms: Sequence[Expr]) -> Callable[[Sequence[Value]], Row]:
    """Return the terms as a function of one row of values, in the order of `reads`."""
    space = _functions(terms_to_python(reads, terms), "terms")
    function: Callable[[Sequence[Value]], Row] = space["terms"]
    return function


def compile_rows(rows: Mapping[str, Sequence[Var]], terms: Sequence[Expr]) -> Callable[..., Row]:
    """Return the terms as a function of several rows of values, in order; it unpacks only the values that the terms read."""
    space = _functions(rows_to_python(rows, terms), "terms")
    function: Callable[..., Row] = space["terms"]
    return function


def _functions(source: str, name: str) -> dict[str, Any]:
    """Return what a generated text defines."""
    space: dict[str, Any] = {}
    exec(_code(source, name), space)  # our own text, made from checked terms
    return space


def _code(source: str, name: str) -> CodeType:
    return compile(source, f"<safeloc {name}>", "exec")
