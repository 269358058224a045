"""Conversion of cvc5's proofs to our own data. It need not be trusted: an error here cannot make a wrong proof right."""

# pyright: reportAttributeAccessIssue=false
# (cvc5's names come out of a compiled module, which pyright cannot read)

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import cvc5
from cvc5 import Kind, ProofRule, SkolemId

from safeloc.checker.proofs.steps import Step
from safeloc.checker.proofs.terms import FALSE, TRUE, Sort, Term, exact, make, number, variable
from safeloc.checker.proofs.texts import Goal
from safeloc.errors import EngineError

_OPTIONS = {"produce-proofs": "true", "proof-granularity": "dsl-rewrite"}
_NAMES = {
    Kind.NOT: "not",
    Kind.AND: "and",
    Kind.OR: "or",
    Kind.IMPLIES: "=>",
    Kind.XOR: "xor",
    Kind.EQUAL: "=",
    Kind.DISTINCT: "distinct",
    Kind.ITE: "ite",
    Kind.ADD: "+",
    Kind.SUB: "-",
    Kind.MULT: "*",
    Kind.NEG: "neg",
    Kind.ABS: "abs",
    Kind.LT: "<",
    Kind.LEQ: "<=",
    Kind.GEQ: ">=",
    Kind.GT: ">",
    Kind.INTS_DIVISION: "div",
    Kind.INTS_DIVISION_TOTAL: "div_total",
    Kind.INTS_MODULUS: "mod",
    Kind.INTS_MODULUS_TOTAL: "mod_total",
    Kind.DIVISION: "/",
    Kind.TO_REAL: "to_real",
    Kind.TO_INTEGER: "to_int",
    Kind.SEXPR: "list",
}
_KINDS = {name: kind for kind, name in _NAMES.items()}
_NAMED = (ProofRule.DSL_REWRITE, ProofRule.THEORY_REWRITE)


def written(goal: Goal, *, seconds: float, options: Mapping[str, str]) -> list[Step] | str:
    """Return cvc5's proof that the goal's assertions contradict each other, or its answer in words if it finds none.

    seconds  limit for the answer; writing the proof takes further time

    EngineError if cvc5 refuses the goal or writes a term that is unknown here.
    """
    manager = cvc5.TermManager()
    solver, to_cvc5 = cvc5.Solver(manager), _ToCvc5(manager)
    solver.setLogic(goal.logic)
    for option, value in {**_OPTIONS, "tlimit-per": str(max(1, int(seconds * 1000))), **options}.items():
        solver.setOption(option, value)
    try:
        for assertion in goal.assertions:
            solver.assertFormula(to_cvc5.term(assertion))
        answer = solver.checkSat()
        return _FromCvc5().steps(solver.getProof()) if answer.isUnsat() else str(answer)
    except (RuntimeError, TypeError) as error:
        raise EngineError(f"cvc5 writes no proof of a certificate: {error}") from error


class _ToCvc5:
    """Converts our terms to cvc5's, each once."""

    def __init__(self, manager: cvc5.TermManager) -> None:
        self.manager = manager
        self.known: dict[Term, cvc5.Term] = {}

    def term(self, root: Term) -> cvc5.Term:
        """Return cvc5's term."""
        waiting = [root]
        while waiting:
            term = waiting[-1]
            missing = [part for part in term.args if part not in self.known]
            if missing:
                waiting += missing
                continue
            waiting.pop()
            if term not in self.known:
                self.known[term] = self._made(term)
        return self.known[root]

    def _made(self, term: Term) -> cvc5.Term:
        manager = self.manager
        match term.op:
            case "true" | "false":
                return manager.mkBoolean(term is TRUE)
            case "number":
                return manager.mkInteger(str(exact(term)))
            case "variable":
                return manager.mkConst(self._sort(term.sort), str(term.value))
            case _:
                return manager.mkTerm(_KINDS[term.op], *(self.known[part] for part in term.args))

    def _sort(self, sort: Sort) -> cvc5.Sort:
        return self.manager.getBooleanSort() if sort == "Bool" else self.manager.getIntegerSort()


class _FromCvc5:
    """Converts cvc5's proof to steps in order; each proof node and each term once."""

    def __init__(self) -> None:
        self.terms: dict[cvc5.Term, Term] = {}
        self.numbers: dict[cvc5.Proof, int] = {}
        self.written: list[Step] = []

    def steps(self, roots: list[cvc5.Proof]) -> list[Step]:
        """Return the steps up to the one that claims false, without the outer steps that discharge the text's assertions."""
        [root] = roots
        while root.getRule() == ProofRule.SCOPE:
            [root] = root.getChildren()
        waiting = [(root, root.getChildren())]
        while waiting:
            node, children = waiting[-1]
            missing = [child for child in children if child not in self.numbers]
            if missing:
                waiting += [(child, child.getChildren()) for child in missing]
                continue
            waiting.pop()
            if node not in self.numbers:
                self.numbers[node] = len(self.written)
                self.written.append(self._step(node, children))
        return self.written

    def _step(self, node: cvc5.Proof, children: list[cvc5.Proof]) -> Step:
        rule = node.getRule()
        name = rule.name if rule not in _NAMED else f"{rule.name}:{node.getRewriteRule().name}"
        args = tuple(self._term(arg) for arg in node.getArguments())
        return Step(name, tuple(self.numbers[child] for child in children), args, self._term(node.getResult()))

    def _term(self, root: cvc5.Term) -> Term:
        waiting = [root]
        while waiting:
            term = waiting[-1]
            missing = [part for part in _parts(term) if part not in self.terms]
            if missing:
                waiting += missing
                continue
            waiting.pop()
            if term not in self.terms:
                self.terms[term] = self._made(term)
        return self.terms[root]

    def _made(self, term: cvc5.Term) -> Term:
        kind = term.getKind()
        if kind in _NAMES:
            return make(_NAMES[kind], *(self.terms[part] for part in _parts(term)))
        match kind:
            case Kind.CONST_BOOLEAN:
                return TRUE if term.getBooleanValue() else FALSE
            case Kind.CONST_INTEGER:
                return number(term.getIntegerValue())
            case Kind.CONST_RATIONAL:
                return number(Fraction(term.getRealValue()), "Real")
            case Kind.CONSTANT:
                return variable(term.getSymbol(), _sort(term))
            case Kind.SKOLEM if term.getSkolemId() == SkolemId.PURIFY:
                return make("purify", self.terms[term.getSkolemIndices()[0]])
            case _:
                raise EngineError(f"cvc5 writes a term that is unknown here: {kind}, {str(term)[:200]}")


def _parts(term: cvc5.Term) -> list[cvc5.Term]:
    if term.getKind() == Kind.SKOLEM:
        return list(term.getSkolemIndices())
    return list(term)


def _sort(term: cvc5.Term) -> Sort:
    sort = term.getSort()
    if sort.isBoolean():
        return "Bool"
    if sort.isInteger():
        return "Int"
    raise EngineError(f"cvc5 writes a variable of the sort {sort}, which no certificate has.")
