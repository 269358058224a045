"""z3 terms of a TransitionSystem, step by step.

Numbers become mathematical integers (`Int`); the overflow obligation makes this sound for machine words. Sub-terms that
several terms share stay shared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, assert_never

import z3

from safeloc.language.expr import Bool, BoolVar, Expr, Lit, NumVar, Var, all_of
from safeloc.language.nodes import (
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
from safeloc.language.system import TransitionSystem, environment, in_range
from safeloc.language.terms import in_order


class Terms:
    """Translates terms to z3, with a given z3 term for each variable; translates each term once."""

    def __init__(self, variables: Mapping[Var, z3.ExprRef]) -> None:
        self._done: dict[Expr, z3.ExprRef] = {var: term for var, term in variables.items()}

    def __call__(self, term: Expr) -> z3.ExprRef:
        """Return the z3 term; KeyError for a variable that was not given."""
        if term not in self._done:
            for node in in_order([term], self._done):
                self._done[node] = _translate(node, self._done)
        return self._done[term]

    def add(self, variables: Mapping[Var, z3.ExprRef]) -> None:
        """Add variables, with the z3 terms that stand for them."""
        self._done.update({var: term for var, term in variables.items()})

    def bool(self, term: Bool) -> z3.BoolRef:
        """Return the z3 term of a truth value."""
        result = self(term)
        assert isinstance(result, z3.BoolRef)
        return result


def _translate(node: Node, of: Mapping[Expr, Any]) -> Any:
    """Return the z3 term of a node whose parts have theirs in `of`; KeyError for a variable, TypeError for a past operator."""
    match node:
        case Lit(value, _):
            return z3.IntVal(value)
        case Truth(value):
            return z3.BoolVal(value)
        case NumVar() | BoolVar():
            raise KeyError(f"variable {node.name!r} has no z3 term here")
        case Add(a, b):
            return _number(z3.Z3_mk_add, of[a], of[b])
        case Sub(a, b):
            return _number(z3.Z3_mk_sub, of[a], of[b])
        case Mul(a, b):
            return _number(z3.Z3_mk_mul, of[a], of[b])
        case FloorDiv(a, k):  # z3's integer division rounds down for a positive divisor
            return z3.ArithRef(z3.Z3_mk_div(_context(), of[a].as_ast(), z3.IntVal(k).as_ast()))
        case Min(a, b):
            return _choice(_compared("<=", of[a], of[b]), of[a], of[b])
        case Max(a, b):
            return _choice(_compared(">=", of[a], of[b]), of[a], of[b])
        case Choose(c, a, b, _) | ChooseBool(c, a, b):
            return _choice(of[c], of[a], of[b])
        case Not(inner):
            return z3.BoolRef(z3.Z3_mk_not(_context(), of[inner].as_ast()))
        case And(parts):
            return _joined(z3.Z3_mk_and, [of[part] for part in parts])
        case Or(parts):
            return _joined(z3.Z3_mk_or, [of[part] for part in parts])
        case Compare("<", a, b):
            return _compared("<", of[a], of[b])
        case Compare("<=", a, b):
            return _compared("<=", of[a], of[b])
        case Compare("==", a, b):
            return _compared("==", of[a], of[b])
        case Compare() | Past():
            raise TypeError(f"{type(node).__name__} has no z3 term; observe the property first")
        case _:
            assert_never(node)


# z3's own functions in place of the operators of its Python classes, which look up and convert sorts for every term and
# take four times as long. Sorts were checked when the node was made (safeloc.language.nodes), and z3 checks them again.


def _context() -> Any:
    return z3.main_ctx().ref()


def _array(terms: Sequence[Any]) -> Any:
    return (z3.Ast * len(terms))(*(term.as_ast() for term in terms))


def _number(make: Callable[..., Any], a: Any, b: Any) -> z3.ArithRef:
    return z3.ArithRef(make(_context(), 2, _array((a, b))))


_COMPARISONS = {"<": z3.Z3_mk_lt, "<=": z3.Z3_mk_le, ">=": z3.Z3_mk_ge, ">": z3.Z3_mk_gt, "==": z3.Z3_mk_eq}
_SWAPPED = {"<": ">", "<=": ">=", ">=": "<=", "==": "=="}


def _compared(relation: str, a: Any, b: Any) -> z3.BoolRef:
    """Return the comparison; a constant comes first, as with z3's operators, so that z3 searches as it does with these."""
    if isinstance(b, z3.IntNumRef) and not isinstance(a, z3.IntNumRef):
        a, b, relation = b, a, _SWAPPED[relation]
    return z3.BoolRef(_COMPARISONS[relation](_context(), a.as_ast(), b.as_ast()))


def _joined(make: Callable[..., Any], parts: Sequence[Any]) -> z3.BoolRef:
    return z3.BoolRef(make(_context(), len(parts), _array(parts)))


def _choice(condition: Any, then: Any, other: Any) -> Any:
    """Return the one or the other, of the same class."""
    kind = z3.BoolRef if isinstance(then, z3.BoolRef) else z3.ArithRef
    return kind(z3.Z3_mk_ite(_context(), condition.as_ast(), then.as_ast(), other.as_ast()))


def implied(condition: z3.BoolRef, term: z3.BoolRef) -> z3.BoolRef:
    """Return `condition` => `term`."""
    return z3.BoolRef(z3.Z3_mk_implies(_context(), condition.as_ast(), term.as_ast()))


def require(solver: z3.Solver, term: z3.BoolRef) -> None:
    """Add a condition to a solver."""
    z3.Z3_solver_assert(_context(), solver.solver, term.as_ast())


def constant(var: Var, suffix: str = "") -> z3.ExprRef:
    """Return the z3 constant for a variable."""
    return z3.Int(var.name + suffix) if isinstance(var, NumVar) else z3.Bool(var.name + suffix)


class Unrolling:
    """The system unrolled over steps 0, 1, 2 ...: z3 constants and constraints of each step, made on demand."""

    def __init__(self, system: TransitionSystem, *, assume: bool = True) -> None:
        self.system = system
        self._states: list[Terms] = []
        self._environment = environment(system, assume=assume)
        self._range = in_range(system.state)

    def at(self, term: Expr, step: int) -> z3.ExprRef:
        """Return the z3 term for a term over the state after `step` steps, and the inputs of the next step."""
        return self._terms(step)(term)

    def initially(self) -> z3.BoolRef:
        """Return the condition that the first state is admissible."""
        return self._terms(0).bool(all_of([self.system.init, self._range]))

    def in_range(self, step: int) -> z3.BoolRef:
        """Return the condition that the state variables are in their ranges at this step."""
        return self._terms(step).bool(self._range)

    def transition(self, step: int) -> z3.BoolRef:
        """Return the condition that the step's inputs are admissible and lead to the state at `step` + 1."""
        now, after = self._terms(step), self._terms(step + 1)
        moves = [after(var) == now(term) for var, term in self.system.next.items()]
        step_: z3.BoolRef = z3.And(now.bool(self._environment), *moves)  # pyright: ignore[reportAssignmentType] # no Probe here
        return step_

    def values(self, model: z3.ModelRef, step: int, variables: Iterable[Var]) -> dict[str, Value]:
        """Return the values of variables at a step in the model."""
        found: dict[str, Value] = {}
        for var in variables:
            found[var.name] = value_of(model, self.at(var, step))
        return found

    def _terms(self, step: int) -> Terms:
        while len(self._states) <= step:
            number = len(self._states)
            named = {var: constant(var, f"@{number}") for var in (*self.system.state, *self.system.inputs)}
            self._states.append(Terms(named))
        return self._states[step]


def value_of(model: z3.ModelRef, term: z3.ExprRef) -> Value:
    """Return the value of a term in a model; one that the model leaves open gets some value."""
    value = model.eval(term, model_completion=True)
    return int(value.as_long()) if isinstance(value, z3.IntNumRef) else z3.is_true(value)
