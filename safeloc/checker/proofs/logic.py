"""Rules of equality and of the connectives: each computes its conclusion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise

from safeloc.checker.proofs.steps import Inference, Rule, WrongStep
from safeloc.checker.proofs.terms import FALSE, TRUE, Term, clause, exact, make, no, same

Parts = tuple[Term, ...]


def require(holds: bool, what: str) -> None:
    """Raise WrongStep with the text `what` unless `holds`."""
    if not holds:
        raise WrongStep(what)


def of(term: Term, op: str) -> Parts:
    """Return the arguments of a term with this operator. WrongStep for any other."""
    require(term.op == op, f"{op!r} was expected, not {term.op!r}")
    return term.args


def only(parts: Parts) -> Term:
    """Return the only term. WrongStep if there are more terms, or none."""
    require(len(parts) == 1, f"one formula was expected, not {len(parts)}")
    return parts[0]


def two(parts: Parts) -> tuple[Term, Term]:
    """Return both terms. WrongStep if there are more or fewer than two."""
    require(len(parts) == 2, f"two formulas were expected, not {len(parts)}")
    return parts[0], parts[1]


def _index(term: Term, parts: Parts) -> Term:
    """Return the part with this number. WrongStep if there is none."""
    at = exact(term)
    require(at.denominator == 1 and 0 <= at < len(parts), f"there is no part {at}")
    return parts[int(at)]


# ------------------------------------------------------------------ equality


def _refl(step: Inference) -> Term:
    return same(only(step.args), step.args[0])


def _symm(step: Inference) -> Term:
    premise = only(step.premises)
    if premise.op == "not":
        left, right = of(premise.args[0], "=")
        return no(same(right, left))
    left, right = of(premise, "=")
    return same(right, left)


def _trans(step: Inference) -> Term:
    links = [of(premise, "=") for premise in step.premises]
    require(bool(links), "a chain of no equations")
    require(all(one[1] is other[0] for one, other in pairwise(links)), "an equation does not begin where one ends")
    return same(links[0][0], links[-1][1])


def _cong(step: Inference) -> Term:
    function = only(step.args)
    sides = [of(premise, "=") for premise in step.premises]
    require(bool(sides), "a congruence of nothing")
    require(function.args == tuple(left for left, _ in sides), "the arguments are not the left sides")
    require(function.op != "purify", "a name for a term is no function of it")
    return same(function, make(function.op, *(right for _, right in sides)))


def _eq_resolve(step: Inference) -> Term:
    formula, equation = two(step.premises)
    left, right = of(equation, "=")
    require(left is formula, "the equation is of another formula")
    return right


def _true_elim(step: Inference) -> Term:
    left, right = of(only(step.premises), "=")
    require(right is TRUE, "the equation is not with true")
    return left


def _false_elim(step: Inference) -> Term:
    left, right = of(only(step.premises), "=")
    require(right is FALSE, "the equation is not with false")
    return no(left)


def _skolem_intro(step: Inference) -> Term:
    return same(only(step.args), only(of(step.args[0], "purify")))


# ------------------------------------------------------------------ connectives


def _contra(step: Inference) -> Term:
    formula, negation = two(step.premises)
    require(negation is no(formula), "the second is not the negation of the first")
    return FALSE


def _modus_ponens(step: Inference) -> Term:
    formula, implication = two(step.premises)
    left, right = of(implication, "=>")
    require(left is formula, "the implication is from another formula")
    return right


def _and_intro(step: Inference) -> Term:
    return step.premises[0] if len(step.premises) == 1 else make("and", *step.premises)


def _and_elim(step: Inference) -> Term:
    return _index(only(step.args), of(only(step.premises), "and"))


def _not_or_elim(step: Inference) -> Term:
    return no(_index(only(step.args), of(only(of(only(step.premises), "not")), "or")))


def _not_and(step: Inference) -> Term:
    return clause(tuple(map(no, of(only(of(only(step.premises), "not")), "and"))))


def _split(step: Inference) -> Term:
    return make("or", only(step.args), no(step.args[0]))


def _cnf_and_pos(step: Inference) -> Term:
    compound, at = two(step.args)
    return make("or", no(compound), _index(at, of(compound, "and")))


def _cnf_and_neg(step: Inference) -> Term:
    compound = only(step.args)
    return make("or", compound, *map(no, of(compound, "and")))


def _cnf_or_pos(step: Inference) -> Term:
    compound = only(step.args)
    return make("or", no(compound), *of(compound, "or"))


def _cnf_or_neg(step: Inference) -> Term:
    compound, at = two(step.args)
    return make("or", compound, no(_index(at, of(compound, "or"))))


def _ite_eq(step: Inference) -> Term:
    compound = only(step.args)
    condition, yes, other = of(compound, "ite")
    return make("ite", condition, same(compound, yes), same(compound, other))


def _eliminated(op: str, shape: Callable[..., Parts]) -> Rule:
    """Return the rule that turns a premise with operator `op` into a clause of its parts."""
    return lambda step: clause(shape(*of(only(step.premises), op)))


def _eliminated_not(op: str, shape: Callable[..., Parts]) -> Rule:
    """Return the rule that turns a negated premise with operator `op` into a clause of its parts."""
    return lambda step: clause(shape(*of(only(of(only(step.premises), "not")), op)))


def _always(op: str, shape: Callable[..., Parts]) -> Rule:
    """Return the rule that gives a clause which holds for every formula with operator `op` and its parts."""
    return lambda step: clause(shape(only(step.args), *of(step.args[0], op)))


RULES: Mapping[str, Rule] = {
    "REFL": _refl,
    "SYMM": _symm,
    "TRANS": _trans,
    "CONG": _cong,
    "NARY_CONG": _cong,
    "EQ_RESOLVE": _eq_resolve,
    "TRUE_INTRO": lambda step: same(only(step.premises), TRUE),
    "TRUE_ELIM": _true_elim,
    "FALSE_INTRO": lambda step: same(only(of(only(step.premises), "not")), FALSE),
    "FALSE_ELIM": _false_elim,
    "SKOLEM_INTRO": _skolem_intro,
    "CONTRA": _contra,
    "MODUS_PONENS": _modus_ponens,
    "AND_INTRO": _and_intro,
    "AND_ELIM": _and_elim,
    "NOT_OR_ELIM": _not_or_elim,
    "NOT_AND": _not_and,
    "NOT_NOT_ELIM": lambda step: only(of(only(of(only(step.premises), "not")), "not")),
    "SPLIT": _split,
    "ITE_EQ": _ite_eq,
    "CNF_AND_POS": _cnf_and_pos,
    "CNF_AND_NEG": _cnf_and_neg,
    "CNF_OR_POS": _cnf_or_pos,
    "CNF_OR_NEG": _cnf_or_neg,
    "IMPLIES_ELIM": _eliminated("=>", lambda a, b: (no(a), b)),
    "NOT_IMPLIES_ELIM1": _eliminated_not("=>", lambda a, _: (a,)),
    "NOT_IMPLIES_ELIM2": _eliminated_not("=>", lambda _, b: (no(b),)),
    "EQUIV_ELIM1": _eliminated("=", lambda a, b: (no(a), b)),
    "EQUIV_ELIM2": _eliminated("=", lambda a, b: (a, no(b))),
    "NOT_EQUIV_ELIM1": _eliminated_not("=", lambda a, b: (a, b)),
    "NOT_EQUIV_ELIM2": _eliminated_not("=", lambda a, b: (no(a), no(b))),
    "XOR_ELIM1": _eliminated("xor", lambda a, b: (a, b)),
    "XOR_ELIM2": _eliminated("xor", lambda a, b: (no(a), no(b))),
    "NOT_XOR_ELIM1": _eliminated_not("xor", lambda a, b: (a, no(b))),
    "NOT_XOR_ELIM2": _eliminated_not("xor", lambda a, b: (no(a), b)),
    "ITE_ELIM1": _eliminated("ite", lambda c, a, _: (no(c), a)),
    "ITE_ELIM2": _eliminated("ite", lambda c, _, b: (c, b)),
    "NOT_ITE_ELIM1": _eliminated_not("ite", lambda c, a, _: (no(c), no(a))),
    "NOT_ITE_ELIM2": _eliminated_not("ite", lambda c, _, b: (c, no(b))),
    "CNF_IMPLIES_POS": _always("=>", lambda f, a, b: (no(f), no(a), b)),
    "CNF_IMPLIES_NEG1": _always("=>", lambda f, a, _: (f, a)),
    "CNF_IMPLIES_NEG2": _always("=>", lambda f, _, b: (f, no(b))),
    "CNF_EQUIV_POS1": _always("=", lambda f, a, b: (no(f), no(a), b)),
    "CNF_EQUIV_POS2": _always("=", lambda f, a, b: (no(f), a, no(b))),
    "CNF_EQUIV_NEG1": _always("=", lambda f, a, b: (f, a, b)),
    "CNF_EQUIV_NEG2": _always("=", lambda f, a, b: (f, no(a), no(b))),
    "CNF_XOR_POS1": _always("xor", lambda f, a, b: (no(f), a, b)),
    "CNF_XOR_POS2": _always("xor", lambda f, a, b: (no(f), no(a), no(b))),
    "CNF_XOR_NEG1": _always("xor", lambda f, a, b: (f, no(a), b)),
    "CNF_XOR_NEG2": _always("xor", lambda f, a, b: (f, a, no(b))),
    "CNF_ITE_POS1": _always("ite", lambda f, c, a, _: (no(f), no(c), a)),
    "CNF_ITE_POS2": _always("ite", lambda f, c, _, b: (no(f), c, b)),
    "CNF_ITE_POS3": _always("ite", lambda f, _, a, b: (no(f), a, b)),
    "CNF_ITE_NEG1": _always("ite", lambda f, c, a, _: (f, no(c), no(a))),
    "CNF_ITE_NEG2": _always("ite", lambda f, c, _, b: (f, c, no(b))),
    "CNF_ITE_NEG3": _always("ite", lambda f, _, a, b: (f, no(a), no(b))),
}
