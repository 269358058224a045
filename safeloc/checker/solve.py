"""Answers of solvers about a certificate: for each goal unsat (it follows from the hypotheses), sat or unknown.

z3 and cvc5 get exactly the nodes that the rest of the checker uses, each through its own translation, so that no text can
have one meaning for a solver and another for the rules. Terms that certificates of a machine share are translated once.
yices, if installed, gets the text; its answer is reported, but not required.
"""

# pyright: reportAttributeAccessIssue=false
# (names of these packages come out of compiled modules, which pyright cannot read)

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import cvc5
import z3

from safeloc import yices
from safeloc.checker.dag import INT, Dag
from safeloc.checker.text import Certificate

SOLVERS = ("z3", "cvc5", "yices")
NEEDED = SOLVERS[:2]
_YICES_SECONDS = 5.0
"""Most processor time of yices for the goals of a text together and for each alone, as its answer is not required."""
_FIRST_SECONDS = {
    "z3": 5.0,
    "cvc5": 10.0,
}  # limit for a goal among others: a goal that takes longer is often quick alone
_TOGETHER = {"incremental": "true", "ext-rew-prep": "use"}  # measured: three times faster on our terms
_ALONE = {
    "decision": "justification"
}  # for goals alone: equalities of two copies take 0.5 s with it, over 15 s among others
Answers = list[str]


@dataclass(frozen=True)
class Opinion:
    """The answers of each solver for each goal; a solver that is not installed has none."""

    answers: dict[str, Answers]

    @property
    def goals(self) -> int:
        """The number of goals that the solvers were asked."""
        return len(self.answers[NEEDED[0]])

    def confirmed(self, goal: int) -> bool:
        """Return whether both required solvers confirm the goal."""
        return all(self.answers[name][goal] == "unsat" for name in NEEDED)

    def contradicted(self) -> list[str]:
        """Return the solvers that answer for some goal that it does not follow, or that refuse the text."""
        return [name for name, found in self.answers.items() if any(one not in ("unsat", "unknown") for one in found)]


NONE = Opinion({name: [] for name in NEEDED})
"""The opinion on a text that cannot be read."""


class _Solver(Protocol):
    """A solver that answers goals from the same hypotheses: several together, or a single goal alone."""

    def ask(self, one: Certificate, seconds: float, *, together: bool) -> Answers: ...


class Opinions:
    """The solvers' opinions on certificates in one Dag."""

    def __init__(self, dag: Dag, seconds: float) -> None:
        self._seconds = seconds
        self._solvers: Mapping[str, _Solver] = {"z3": _Z3(dag), "cvc5": _Cvc5(dag)}
        self._asked: dict[tuple[frozenset[int], tuple[int, ...]], dict[str, Answers]] = {}

    def __call__(self, one: Certificate, text: str | None) -> Opinion:
        """Return the answers of all solvers; certificates with equal hypotheses and goals are asked once.

        text  what yices reads; without one it is not asked
        """
        key = (one.hypotheses, one.goals)
        if key not in self._asked:
            self._asked[key] = {name: self._answers_or_why(name, one) for name in self._solvers}
        most_s = min(self._seconds, _YICES_SECONDS)
        more = {} if text is None or yices.program() is None else {"yices": yices.answers(text, most_s, most_s)}
        return Opinion({**self._asked[key], **more})

    def _answers_or_why(self, name: str, one: Certificate) -> Answers:
        """Return a solver's answers; if it refuses the terms (for example a number as a truth value), its error for each goal."""
        try:
            return self._answers(name, one)
        except (z3.Z3Exception, RuntimeError, TypeError, ValueError, AttributeError) as error:
            return [f"error: {error}"] * len(one.goals)

    def _answers(self, name: str, one: Certificate) -> Answers:
        """Ask for all goals together with a short limit each; then for each undecided goal alone, by both sets of options."""
        solver, first = self._solvers[name], min(self._seconds, _FIRST_SECONDS[name])
        answers = solver.ask(one, first, together=True)
        for together in (False, True):
            for goal in [number for number, answer in enumerate(answers) if answer == "unknown"]:
                alone = replace(one, goals=one.goals[goal : goal + 1])
                [answers[goal]] = solver.ask(alone, self._seconds, together=together)
        return answers


class _Translation:
    """Translates nodes to a solver's terms; each node once."""

    def __init__(self, dag: Dag) -> None:
        self.dag = dag
        self._done: dict[int, Any] = {}

    def __call__(self, term: int) -> Any:
        for number in self.dag.below(term, self._done):
            operator, *rest = self.dag.nodes[number]
            parts = [self._done[part] for part in self.dag.parts(number)]
            self._done[number] = self.made(str(operator), rest, parts)
        return self._done[term]

    def all(self, terms: Iterable[int]) -> list[Any]:
        """Return the solver's terms, in the order in which the nodes were made."""
        return [self(term) for term in sorted(terms)]

    def made(self, operator: str, rest: Sequence[str | int], parts: Sequence[Any]) -> Any:
        raise NotImplementedError


class _Z3(_Translation):
    def __init__(self, dag: Dag) -> None:
        super().__init__(dag)
        self._in = z3.Context()

    def made(self, operator: str, rest: Sequence[str | int], parts: Sequence[Any]) -> Any:
        match operator:
            case "var":
                return z3.Int(str(rest[0]), self._in) if rest[1] == INT else z3.Bool(str(rest[0]), self._in)
            case "lit":
                return z3.IntVal(rest[0], self._in)
            case "truth":
                return z3.BoolVal(bool(rest[0]), self._in)
            case "and":
                return z3.And(*parts)
            case "or":
                return z3.Or(*parts)
            case "not":
                return z3.Not(parts[0])
            case "ite":
                return z3.If(*parts)
            case _:
                return _Z3_OPERATORS[operator](*parts)

    def ask(self, one: Certificate, seconds: float, *, together: bool) -> Answers:
        """Return the answers. A goal alone is asked without push: z3 then preprocesses all terms, in 0.1 s or much longer."""
        logic = "QF_LIA" if _linear(self.dag, one) else "QF_NIA"
        solver = z3.SimpleSolver(self._in) if together else z3.SolverFor(logic, self._in)
        solver.set("timeout", max(1, int(seconds * 1000)))
        solver.add(*self.all(one.hypotheses))
        answers = []
        for goal in one.goals:
            if together:
                solver.push()
            solver.add(z3.Not(self(goal)))
            answers.append(str(solver.check()))
            if together:
                solver.pop()
        return answers


_Z3_OPERATORS = {
    "+": lambda one, other: one + other,
    "-": lambda one, other: one - other,
    "*": lambda one, other: one * other,
    "div": lambda one, other: one / other,  # of whole numbers z3 rounds down for a positive divisor, as SMT-LIB says
    "<": lambda one, other: one < other,
    "<=": lambda one, other: one <= other,
    ">=": lambda one, other: one >= other,
    "=": lambda one, other: one == other,
}


class _Cvc5(_Translation):
    def __init__(self, dag: Dag) -> None:
        super().__init__(dag)
        self._terms = cvc5.TermManager()

    def made(self, operator: str, rest: Sequence[str | int], parts: Sequence[Any]) -> Any:
        terms = self._terms
        match operator:
            case "var":
                return terms.mkConst(terms.getIntegerSort() if rest[1] == INT else terms.getBooleanSort(), rest[0])
            case "lit":
                return terms.mkInteger(str(rest[0]))
            case "truth":
                return terms.mkBoolean(bool(rest[0]))
            case _:
                return terms.mkTerm(_CVC5_OPERATORS[operator], *parts)

    def ask(self, one: Certificate, seconds: float, *, together: bool) -> Answers:
        solver = cvc5.Solver(self._terms)
        solver.setLogic("QF_LIA" if _linear(self.dag, one) else "QF_NIA")
        for name, value in (_TOGETHER if together else _ALONE).items():
            solver.setOption(name, value)
        solver.setOption("tlimit-per", str(max(1, int(seconds * 1000))))
        for term in self.all(one.hypotheses):
            solver.assertFormula(term)
        answers = []
        for goal in one.goals:
            if together:
                solver.push()
            solver.assertFormula(self._terms.mkTerm(cvc5.Kind.NOT, self(goal)))
            answer = str(solver.checkSat())
            answers.append("unknown" if answer.startswith("unknown") else answer)
            if together:
                solver.pop()
        return answers


_CVC5_OPERATORS = {
    "+": cvc5.Kind.ADD,
    "-": cvc5.Kind.SUB,
    "*": cvc5.Kind.MULT,
    "div": cvc5.Kind.INTS_DIVISION,
    "<": cvc5.Kind.LT,
    "<=": cvc5.Kind.LEQ,
    ">=": cvc5.Kind.GEQ,
    "=": cvc5.Kind.EQUAL,
    "and": cvc5.Kind.AND,
    "or": cvc5.Kind.OR,
    "not": cvc5.Kind.NOT,
    "ite": cvc5.Kind.ITE,
}


def _linear(dag: Dag, one: Certificate) -> bool:
    """Return whether every product has a constant factor; quotients by constants count as linear."""
    done = dict[int, None]()
    for term in (*one.hypotheses, *one.goals):
        for number in dag.below(term, done):
            done[number] = None
            node = dag.nodes[number]
            if node[0] == "*" and all(dag.nodes[part][0] != "lit" for part in dag.parts(number)):
                return False
    return True
