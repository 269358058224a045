"""What solvers say of a certificate's text, one answer for each goal: unsat, sat or unknown.

z3 and cvc5 read the very text. yices, where it is installed, is a further opinion, which is told and never needed.
"""

# pyright: reportAttributeAccessIssue=false
# (names of these packages come out of compiled modules, which pyright cannot read)

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cvc5
import z3

SOLVERS = ("z3", "cvc5", "yices")
NEEDED = SOLVERS[:2]
GROUP = "\n(push 1)\n"
TOGETHER = {"incremental": "true", "ext-rew-prep": "use"}  # measured: three times faster on our terms
ALONE = {"decision": "justification"}  # for what is left: equalities of two copies take 0.5 s so, over 15 s together
Answers = list[str]


@dataclass(frozen=True)
class Opinion:
    """What each solver says of each goal; no answers of one that is not installed."""

    answers: dict[str, Answers]

    @property
    def goals(self) -> int:
        """How many goals the solvers were asked for."""
        return len(self.answers[NEEDED[0]])

    def confirmed(self, goal: int) -> bool:
        """Whether both solvers that are needed say that the goal follows."""
        return all(self.answers[name][goal] == "unsat" for name in NEEDED)

    def contradicted(self) -> list[str]:
        """The solvers that say of some goal that it does not follow, or do not take the text."""
        return [name for name, said in self.answers.items() if any(one not in ("unsat", "unknown") for one in said)]


def opinion(text: str, seconds: float) -> Opinion:
    """All solvers' answers; each goal may take so many seconds."""
    found = {"z3": _asked(_z3, text, seconds), "cvc5": _asked(_cvc5, text, seconds)}
    if yices() is not None:
        found["yices"] = _asked(_yices, text, seconds)
    return Opinion(found)


def _asked(solver: Callable[[str, float, bool], Sequence[str]], text: str, seconds: float) -> Answers:
    """All goals in one go; then each that is left by itself, from the same text without the other goals."""
    start, *groups = text.split(GROUP)
    answers = _fitting(solver(text, seconds, True), len(groups))
    for goal, answer in enumerate(answers):
        if answer == "unknown":
            [answers[goal]] = _fitting(solver(f"{start}{GROUP}{groups[goal]}", seconds, False), 1)
    return answers


def _fitting(answers: Sequence[str], goals: int) -> Answers:
    """One answer a goal; a solver that says anything else does not take the text."""
    return list(answers) if len(answers) == goals else [f"{len(answers)} answers to {goals} goals"] * goals


def _z3(text: str, seconds: float, _: bool) -> Sequence[str]:
    context, limit = z3.Context(), f"(set-option :timeout {max(1, int(seconds * 1000))})\n"
    try:
        said = z3.Z3_eval_smtlib2_string(context.ref(), limit + text)
    except z3.Z3Exception as error:
        return [f"error: {error}"]
    return [line.strip() for line in said.splitlines() if line.strip()]


def _cvc5(text: str, seconds: float, together: bool) -> Sequence[str]:
    terms = cvc5.TermManager()
    solver, symbols = cvc5.Solver(terms), cvc5.SymbolManager(terms)
    for name, value in (TOGETHER if together else ALONE).items():
        solver.setOption(name, value)
    solver.setOption("tlimit-per", str(max(1, int(seconds * 1000))))
    parser = cvc5.InputParser(solver, symbols)
    parser.setStringInput(cvc5.InputLanguage.SMT_LIB_2_6, text if together else _without_groups(text), "certificate")
    answers = []
    try:
        while not (command := parser.nextCommand()).isNull():
            said = str(command.invoke(solver, symbols)).strip()
            if said and said != "success":
                answers.append("unknown" if said.startswith("unknown") else said)
    except RuntimeError as error:
        return [*answers, f"error: {error}"]
    return answers


def _without_groups(text: str) -> str:
    """One goal without push and pop, so that a solver need not keep anything for later."""
    return text.replace(GROUP, "\n").replace("\n(pop 1)\n", "\n")


def yices() -> str | None:
    """The path of yices' program for this language, where there is one: beside Python, or on the path."""
    return shutil.which(
        "yices-smt2", path=os.pathsep.join([os.path.dirname(sys.executable), os.environ.get("PATH", "")])
    )


def _yices(text: str, seconds: float, together: bool) -> Sequence[str]:
    program = yices()
    assert program is not None
    limit = max(1, int(seconds))
    asked = [program, f"--timeout={limit}", *(["--incremental"] if together else [])]
    done = subprocess.run(asked, input=text if together else _without_groups(text), capture_output=True, text=True)
    return [line for line in re.split(r"\s*\n", done.stdout) if line]
