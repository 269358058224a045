"""Runs and checks of recorded streams on generated code, which the interpreter checks on a sampled share of the steps.

    Quick(terms)      computes what `interpret.Program` does, by generated code; every SAMPLED-th time by both
    quick_run(...)    returns what `interpret.run` does
    run_again(...)    does so for a run that the interpreter has confirmed, and compiles only where that pays
    Again()           does so for many runs, of which some begin others

EngineError if the two differ: then the generator is wrong, and its results must not be used.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property, lru_cache

from safeloc.errors import EngineError
from safeloc.language.expr import Expr, Var
from safeloc.language.interpret import Program, fired_names, read_inputs, run, start
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import variables
from safeloc.language.trace import Step, Trace
from safeloc.proof.drawn_runs.allowed import compiled_terms, row_of

SAMPLED = 50
PAYS = 100
"""Steps of one system after which generated code is quicker: to compile the step takes as long as to interpret it 100 times."""


class Quick:
    """Terms that generated code evaluates; the interpreter checks the first and every SAMPLED-th evaluation."""

    def __init__(self, terms: Sequence[Expr]) -> None:
        reads = tuple(variables(terms))
        self._row, self._code = row_of(reads), compiled_terms(reads, list(terms))
        self._oracle = Program(terms)
        self._calls = 0

    def __call__(self, values: Mapping[Var, Value]) -> Sequence[Value]:
        """Return the value of each term; KeyError for a variable without a value."""
        found = self._code(self._row(values))
        if self._calls % SAMPLED == 0:
            self._compare(values, found)
        self._calls += 1
        return found

    def _compare(self, values: Mapping[Var, Value], found: Sequence[Value]) -> None:
        for number, (quick, right) in enumerate(zip(found, self._oracle(values), strict=True)):
            if quick != right or type(quick) is not type(right):
                raise EngineError(f"generated code gives {quick!r} for term {number}, the interpreter {right!r}.")


class _Steps:
    """The step of a system and its outputs: interpreted at first, compiled once that pays."""

    def __init__(self, moves: tuple[Expr, ...], outputs: tuple[Expr, ...]) -> None:
        self._moves, self._outputs = moves, outputs
        self.interpreted = 0

    @cached_property
    def code(self) -> tuple[Quick, Quick]:
        """The generated code of the step and of the outputs."""
        return Quick(self._moves), Quick(self._outputs)


@lru_cache(maxsize=32)
def _steps(moves: tuple[Expr, ...], outputs: tuple[Expr, ...]) -> _Steps:
    return _Steps(moves, outputs)


def _steps_of(system: TransitionSystem) -> _Steps:
    """Return the steps of a system; systems that differ only in assumption and first states share them."""
    return _steps((*system.next.values(), *system.fired.values()), tuple(system.outputs.values()))


def quick_run(
    system: TransitionSystem, stream: Iterable[Mapping[str, object]], *, first: Mapping[str, Value] | None = None
) -> Trace:
    """Run a whole stream; the arguments, the Trace and the errors are those of `interpret.run`."""
    move, output = _steps_of(system).code
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


def run_again(
    system: TransitionSystem, stream: Sequence[Mapping[str, object]], *, first: Mapping[str, Value] | None = None
) -> Trace:
    """Make a run once more that the interpreter has confirmed: the first PAYS steps of a system are interpreted, more are compiled.

    The arguments, the Trace and the errors are those of `interpret.run`.
    """
    steps = _steps_of(system)
    steps.interpreted += len(stream)
    return (run if steps.interpreted <= PAYS else quick_run)(system, stream, first=first)


class Again:
    """Makes runs once more, for as long as it lives: one whose inputs begin a run that it has made is a part of that run.

    So whoever wants many runs asks for the longest first.
    """

    def __init__(self) -> None:
        self._made: dict[tuple[object, ...], list[tuple[list[Mapping[str, object]], Trace]]] = {}

    def __call__(
        self, system: TransitionSystem, stream: Sequence[Mapping[str, object]], *, first: Mapping[str, Value]
    ) -> Trace:
        """Return the run; the arguments, the Trace and the errors are those of `run_again`."""
        rows, made = list(stream), self._made.setdefault((system, *sorted(first.items())), [])
        whole = next((run for before, run in made if before[: len(rows)] == rows), None)
        if whole is None:
            whole = run_again(system, rows, first=first)
            made.append((rows, whole))
        return Trace(system, whole.initial, whole.steps[: len(rows)])


def _named(values: Mapping[Var, Value]) -> dict[str, Value]:
    return {var.name: value for var, value in values.items()}
