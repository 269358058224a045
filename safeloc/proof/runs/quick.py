"""Runs and checks of recorded streams on generated code, which the interpreter checks on a sampled share of the steps.

    Quick(terms)      computes what `interpret.Program` does, by generated code; every SAMPLED-th time by both
    quick_run(...)    returns what `interpret.run` does

EngineError if the two differ: then the generator is wrong, and its results must not be used.
"""

from __future__ import annotations

import weakref
from collections.abc import Iterable, Mapping, Sequence

from safeloc.errors import EngineError
from safeloc.language.expr import Expr, Var
from safeloc.language.interpret import Program, fired_names, read_inputs, start
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import variables
from safeloc.language.trace import Step, Trace
from safeloc.proof.runs.allowed import compiled_terms

SAMPLED = 50


class Quick:
    """Terms that generated code evaluates; the interpreter checks the first and every SAMPLED-th evaluation."""

    def __init__(self, terms: Sequence[Expr]) -> None:
        self._reads = tuple(variables(terms))
        self._code = compiled_terms(self._reads, list(terms))
        self._oracle = Program(terms)
        self._calls = 0

    def __call__(self, values: Mapping[Var, Value]) -> Sequence[Value]:
        """Return the value of each term; KeyError for a variable without a value."""
        found = self._code([values[var] for var in self._reads])
        if self._calls % SAMPLED == 0:
            self._compare(values, found)
        self._calls += 1
        return found

    def _compare(self, values: Mapping[Var, Value], found: Sequence[Value]) -> None:
        for number, (quick, right) in enumerate(zip(found, self._oracle(values), strict=True)):
            if quick != right or type(quick) is not type(right):
                raise EngineError(f"generated code gives {quick!r} for term {number}, the interpreter {right!r}.")


_STEPS: weakref.WeakKeyDictionary[TransitionSystem, tuple[Quick, Quick]] = weakref.WeakKeyDictionary()


def quick_run(
    system: TransitionSystem, stream: Iterable[Mapping[str, object]], *, first: Mapping[str, Value] | None = None
) -> Trace:
    """Run a whole stream; the arguments, the Trace and the errors are those of `interpret.run`."""
    if system not in _STEPS:
        _STEPS[system] = Quick([*system.next.values(), *system.fired.values()]), Quick([*system.outputs.values()])
    move, output = _STEPS[system]
    state = start(system, first)
    initial, steps = _named(state), list[Step]()
    for record in stream:
        inputs = read_inputs(system, record)
        moved = move({**state, **inputs})
        state = dict(zip(system.next, moved, strict=False))
        fired = dict(zip(system.fired, map(int, moved[len(state) :]), strict=True))
        outputs = dict(zip(system.outputs, output(state), strict=True))
        steps.append(Step(_named(inputs), fired_names(fired), _named(state), outputs))
    return Trace(system, initial, tuple(steps))


def _named(values: Mapping[Var, Value]) -> dict[str, Value]:
    return {var.name: value for var, value in values.items()}
