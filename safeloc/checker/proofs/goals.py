"""Certificates: for every `check-sat` of a text, a proof of it, checked."""

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
    ({"simplification": "none"}, 0.3),  # decides some that the first does not
    ({"ext-rew-prep": "use"}, 0.3),  # the quickest on what is hard, but with steps that name no rule
)  # options of cvc5, and the share of the time, until one answers


@dataclass(frozen=True)
class GoalProof:
    """One `check-sat`: what its proof came to, and the seconds of the processor that making and checking it took."""

    goal: str
    result: Checked | Failed
    seconds_made: float
    seconds_checked: float

    @property
    def nothing_trusted(self) -> bool:
        """True if every step of the proof was checked."""
        return isinstance(self.result, Checked) and not self.result.trusted


def check_unsat_proofs(text: str, *, seconds: float) -> list[GoalProof]:
    """For each `check-sat` of a certificate, in order: cvc5's proof that it is unsat, checked.

    `seconds`: for cvc5's answer to each; writing the proof and checking it come on top, about as long again.
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
    """The proof by the first options that lead to one, else the last answer; `sat` ends the search."""
    said: list[Step] | str = "nothing"
    for options, share in ATTEMPTS:
        said = written(goal, seconds=seconds * share, options=options)
        if not isinstance(said, str) or said == "sat":
            return said
    return said
