"""Certificates from end to end: proofs of real ones are checked, and altered proofs are found out."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import floor
from random import Random

import pytest

from safeloc.checker.proofs import goals as module
from safeloc.checker.proofs.goals import RULES, GoalProof, check_unsat_proofs
from safeloc.checker.proofs.rewrites import FAMILIES
from safeloc.checker.proofs.solver import written
from safeloc.checker.proofs.steps import Checked, Failed, Step, check
from safeloc.checker.proofs.terms import Term, exact, make, no, number
from safeloc.checker.proofs.texts import Goal, read_goals
from safeloc.errors import EngineError
from tests.checker.proofs.formulas import DECLARED

CHOICES = f"""(set-logic QF_LIA){DECLARED}
(define-fun t1 () Int (ite a (+ x y) (ite (< z 3) (- x y) (* 2 z))))
(define-fun t2 () Int (ite b t1 (- t1)))
(define-fun t3 () Bool (=> (and (<= 0 x) (<= 0 y) (<= y x) (<= 0 z)) (or b (<= t2 0))))
(assert (or c d))
(push 1)
; holds in every case
(assert (not t3))
(check-sat)
(pop 1)
(push 1)
; quotients
(assert (and (<= 0 x) (<= x 1000) (not (<= (div (* x 7) 10) 700))))
(check-sat)
(pop 1)
(push 1)
; parity
(assert (= (+ (* 2 x) 1) (* 2 y)))
(check-sat)
(pop 1)
"""
PRODUCT = f"(set-logic QF_NIA){DECLARED}(assert (and (< x 0) (> y 0) (>= (* x y) 0)))(check-sat)"
SATISFIABLE = f"(set-logic QF_LIA){DECLARED}(assert (< x y))(check-sat)"


class Meaning:
    """A world: a value of each variable, and what terms are worth there. Shares nothing with the checker."""

    def __init__(self, random: Random) -> None:
        self.random = random
        self.values: dict[Term, Fraction | bool] = {}

    def of(self, term: Term) -> Fraction | bool:
        """The value of a term."""
        if term not in self.values:
            self.values[term] = self._of(term)
        return self.values[term]

    def _of(self, term: Term) -> Fraction | bool:
        if term.op == "variable":
            return Fraction(self.random.randint(-4, 4)) if term.sort == "Int" else self.random.random() < 0.5
        if term.op == "number":
            return Fraction(str(term.value))
        return self._operation(term.op, [self.of(arg) for arg in term.args])

    def _operation(self, op: str, args: list[Fraction | bool]) -> Fraction | bool:
        match op, args:
            case "true" | "false", _:
                return op == "true"
            case "not", [a]:
                return not a
            case "and", _:
                return all(args)
            case "or", _:
                return any(args)
            case "=>", [a, b]:
                return not a or bool(b)
            case "ite", [c, a, b]:
                return a if c else b
            case "purify" | "to_real", [a]:
                return a
            case "neg", [a]:
                return -Fraction(a)
            case "to_int", [a]:
                return Fraction(floor(Fraction(a)))
            case "+", _:
                return sum(map(Fraction, args), Fraction(0))
            case _, [a, b]:
                return self._of_two(op, Fraction(a), Fraction(b))
        raise AssertionError(op)

    def _of_two(self, op: str, a: Fraction, b: Fraction) -> Fraction | bool:
        match op:
            case "-":
                return a - b
            case "*":
                return a * b
            case "/":
                return a / b
            case "div" | "div_total":
                return Fraction(floor(a / b)) if b > 0 else -Fraction(floor(a / -b))
            case "<":
                return a < b
            case "<=":
                return a <= b
            case ">":
                return a > b
            case ">=":
                return a >= b
            case "=":
                return a == b
        raise AssertionError(op)


def one_of(text: str, at: int = 0) -> tuple[Goal, list[Step]]:
    """A goal and cvc5's proof of it."""
    goal = read_goals(text)[at]
    steps = written(goal, seconds=20.0, options={})
    assert isinstance(steps, list)
    return goal, steps


def judged(goal: Goal, steps: list[Step]) -> Checked | Failed:
    """The proof, checked against the goal."""
    return check(steps, frozenset(goal.assertions), RULES, families=FAMILIES)


def test_nothing_is_left_to_trust() -> None:
    """Choices, quotients and parity: every step of cvc5's proofs is checked."""
    found = check_unsat_proofs(CHOICES, seconds=20.0)
    assert ["holds in every case", "quotients", "parity"] == [one.goal for one in found]
    assert [] == [one for one in found if not one.nothing_trusted]


def test_products_of_variables() -> None:
    """The sign of a product is checked as well."""
    [found] = check_unsat_proofs(PRODUCT, seconds=20.0)
    assert found.nothing_trusted
    assert isinstance(found.result, Checked)
    assert found.result.steps > 5


def test_what_is_satisfiable_has_no_proof() -> None:
    """A goal that does not follow fails, and cvc5's answer is told."""
    [found] = check_unsat_proofs(SATISFIABLE, seconds=20.0)
    assert Failed("no proof: cvc5 answers sat") == found.result
    assert not found.nothing_trusted


def test_a_proof_of_another_text_fails() -> None:
    """A proof is of the text it is checked against: one assertion weaker, and it assumes too much."""
    goal, steps = one_of(CHOICES)
    assert isinstance(judged(goal, steps), Checked)
    other = read_goals(CHOICES.replace("(<= y x)", "(<= y (+ x 1))"))[0]
    assert "does not assert" in str(judged(other, steps))


def altered(steps: list[Step], random: Random) -> tuple[list[Step], int]:
    """The proof with one step changed, and which: another claim, premise, argument, or the rule of another step."""
    at = random.randrange(len(steps))
    step, other = steps[at], random.choice(steps)
    change = random.choice(("claim", "negated", "premise", "args", "figure", "rule"))
    if change == "claim":
        step = step._replace(claim=other.claim)
    elif change == "negated" and step.claim.sort == "Bool":
        step = step._replace(claim=no(step.claim))
    elif change == "premise" and step.premises:
        premises = list(step.premises)
        premises[random.randrange(len(premises))] = random.randrange(at)
        step = step._replace(premises=tuple(premises))
    elif change == "args":
        step = step._replace(args=other.args)
    elif change == "figure":
        step = step._replace(claim=shifted(step.claim))
    else:
        step = step._replace(rule=other.rule)
    return [*steps[:at], step, *steps[at + 1 :]], at


def shifted(term: Term) -> Term:
    """The term with one figure in it one higher."""
    if term.op == "number":
        return number(exact(term) + 1, term.sort)
    for at, part in enumerate(term.args):
        if (other := shifted(part)) is not part:
            return make(term.op, *term.args[:at], other, *term.args[at + 1 :])
    return term


def holds(step: Step, premises: list[Term], meaning: Meaning) -> bool:
    """Whether the claim is true where the premises are, in one world."""
    return not all(meaning.of(premise) for premise in premises) or bool(meaning.of(step.claim))


def sound(steps: list[Step], at: int, worlds: list[Meaning]) -> bool:
    """Whether a step is, in all these worlds. Assumptions and their discharge are not a matter of one world."""
    step = steps[at]
    premises = [steps[premise].claim for premise in step.premises]
    return step.rule in ("ASSUME", "SCOPE") or all(holds(step, premises, world) for world in worlds)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("at", [0, 1, 2])
def test_altered_proofs_are_found_out(at: int) -> None:
    """Of 300 changes those that make a step untrue are all found out, which most of them do."""
    goal, steps = one_of(CHOICES, at)
    random, worlds = Random(at), [Meaning(Random(seed)) for seed in range(40)]
    assert all(sound(steps, one, worlds) for one in range(len(steps)))
    untrue, refused = 0, 0
    for _ in range(300):
        other, changed = altered(steps, random)
        result = judged(goal, other)
        refused += isinstance(result, Failed)
        if not sound(other, changed, worlds):
            untrue += 1
            assert not isinstance(result, Checked) or result.trusted.get(other[changed].rule), other[changed]
    assert untrue > 50
    assert refused > untrue


def test_every_attempt_is_made_until_one_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Options are tried in turn; an answer of `sat` ends the search, and so does a proof."""
    asked: list[float] = []

    def unsure(_: Goal, *, seconds: float, options: object) -> str:
        asked.append(seconds)
        return f"unknown with {options}"

    monkeypatch.setattr(module, "written", unsure)
    [found] = check_unsat_proofs(SATISFIABLE, seconds=10.0)
    assert len(module.ATTEMPTS) == len(asked)
    assert 10.0 == pytest.approx(sum(asked))
    assert "unknown" in str(found.result)


def test_a_solver_that_breaks_down_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """An error of the solver is a failed goal with its words; the next goal is asked all the same."""

    def broken(goal: Goal, *, seconds: float, options: object) -> str:
        raise EngineError(f"no {goal.name} in {seconds} s with {options}")

    monkeypatch.setattr(module, "written", broken)
    found = check_unsat_proofs(CHOICES, seconds=10.0)
    assert 3 == len(found)
    assert all("no " in str(one.result) for one in found)


def test_trust_shows_in_the_result() -> None:
    """A proof with a step that was not checked is not one with nothing to trust."""
    checked = GoalProof("g", Checked(3, {"ODD": 1, "ASSUME": 2}, {"ODD": 1}), 0.1, 0.1)
    assert not checked.nothing_trusted
    assert replace(checked, result=Checked(3, {"ASSUME": 3})).nothing_trusted
