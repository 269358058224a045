"""Check of a certificate by proofs: for every `check-sat` of its text, a proof by cvc5, checked step by step."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from safeloc.checker.proofs import arithmetic, clauses, logic, rewrites
from safeloc.checker.proofs.solver import written
from safeloc.checker.proofs.steps import Checked, Failed, Rule, Step, check
from safeloc.checker.proofs.texts import Goal, read_goals
from safeloc.errors import EngineError

RULES: Mapping[str, Rule] = {**logic.RULES, **clauses.RULES, **arithmetic.RULES, **rewrites.RULES}


ATTEMPTS: Sequence[tuple[Mapping[str, str], float]] = (
    ({}, 0.4),
    ({"simplification": "none"}, 0.3),  # decides some goals that the first does not
    ({"ext-rew-prep": "use"}, 0.3),  # the fastest on hard goals, but with steps that name no rule
)  # options of cvc5 with their share of the time, tried in order until one leads to a proof


@dataclass(frozen=True)
class GoalProof:
    """The result for one `check-sat`, with the processor time in seconds to make the proof and to check it."""

    goal: str
    result: Checked | Failed
    seconds_made: float
    seconds_checked: float

    @property
    def nothing_trusted(self) -> bool:
        """True if every step of the proof was checked."""
        return isinstance(self.result, Checked) and not self.result.trusted


def check_unsat_proofs(text: str, *, seconds: float) -> list[GoalProof]:
    """Return, for each `check-sat` of a certificate in order, the check of cvc5's proof that it is unsat.

    seconds  limit for each answer of cvc5; writing and checking the proof take about as long again

    InputError for a text that is no certificate.
    """
    return [_proved(goal, seconds) for goal in read_goals(text)]


def _proved(goal: Goal, seconds: float) -> GoalProof:
    began = time.process_time()
    try:
        steps = _written(goal, seconds)
    except EngineError as error:
        return GoalProof(goal.name, Failed(str(error)), time.process_time() - began, 0.0)
    made = time.process_time()
    if isinstance(steps, str):
        return GoalProof(goal.name, Failed(f"no proof: cvc5 answers {steps}"), made - began, 0.0)
    result = check(steps, frozenset(goal.assertions), RULES, families=rewrites.FAMILIES)
    return GoalProof(goal.name, result, made - began, time.process_time() - made)


def _written(goal: Goal, seconds: float) -> list[Step] | str:
    """Return the proof by the first options that lead to one, else the last answer; `sat` ends the search."""
    found: list[Step] | str = "nothing"
    for options, share in ATTEMPTS:
        found = written(goal, seconds=seconds * share, options=options)
        if not isinstance(found, str) or found == "sat":
            return found
    return found
