"""Second opinion: yices or cvc5 decides every proof again, from its SMT-LIB 2 text alone.

yices, if it is installed, is asked first: it takes a fraction of cvc5's time. cvc5 decides the goals that yices leaves open, and all
goals without yices. The text holds the hypotheses that z3's proof needs, or all of them if they cannot confirm the proof from
those.
"""

# pyright: reportAttributeAccessIssue=false
# (cvc5's names come out of a compiled module, which pyright cannot read)

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Generic

import cvc5

from safeloc import yices
from safeloc.codegen.smtlib import Key, Query, to_smtlib
from safeloc.errors import EngineError
from safeloc.proof.cache.answers import confirmed_before, keep_confirmed
from safeloc.proof.provers.limits import Deadline, clock_multiple, deadline, milliseconds, spend
from safeloc.proof.provers.needed import only_needed
from safeloc.proof.provers.once import alone_in_asking

_CVC5 = f"cvc5 {cvc5.__version__}"
UNCONFIRMED = "cvc5 could not confirm it in time"
"""The reason of every result that z3 has proved and that is not confirmed: cvc5 is the last one asked."""
YICES_SECONDS, YICES_FIRST_SECONDS, YICES_INDUCTION_SECONDS = 10.0, 2.0, 4.0
"""Most processor time of yices for the goals of a text together and for each alone; and, of an induction query of one goal, for the first
and for the second look. The shipped induction queries that it decides take it at most 2.5 s; two of the reflector that take it 2 s take
cvc5 28 s. Those that it does not decide in 10 s, of guard and stop point, take cvc5 less than 1 s: so cvc5 looks for a short time between.
"""
_CVC5_FIRST_SECONDS = 1.0
OPTIONS = {"incremental": "true", "ext-rew-prep": "use", "ite-simp": "true"}  # measured: four times faster on our terms
INDUCTION_OF_ONE_GOAL = {**OPTIONS, "simplification": "none"}
"""Options for an induction query of one goal. Measured against OPTIONS: the fibre areas take 2 to 7 s instead of 15 to 35 s, one
property of the guard 0.2 s instead of 60 s, other hard ones the same within a fifth. Several goals in one solver take a quarter
longer with them, equalities of two copies over 2 s instead of 0.2 s."""
ALONE = {
    "decision": "justification"
}  # for goals left over: equalities of two copies take 0.5 s with it, over 15 s together
FIRST_SECONDS = 10.0  # for each of several goals together, before it is tried alone: most take 1 s there, 15 s alone
_ROUNDS_S = (1.0, 4.0, 16.0, math.inf)
"""For a goal alone, with each set of options in turn. What a set suits, it decides soon: a query of the guard takes 0.3 s with
OPTIONS, 0.7 s with ALONE, and over 45 s with INDUCTION_OF_ONE_GOAL."""


_LONGEST_NAME = 150
UNITS_PER_SECOND = 300_000
"""Units of cvc5's resource count in one second of effort: our queries use 70 to 600 thousand a second on an idle processor."""
_USED = "resource::resourceUnitsUsed"


class ConfirmedText(str):
    """The text of a query of which all goals are confirmed, with the programs that confirmed them, in the order in which they were
    asked: two if yices left a goal open.

    It equals the same text that other programs confirmed: what it proves is the same.
    """

    by: tuple[str, ...]

    def __new__(cls, text: str, by: tuple[str, ...]) -> ConfirmedText:
        """Make the text."""
        made = super().__new__(cls, text)
        made.by = by
        return made

    def __getnewargs__(self) -> tuple[str, tuple[str, ...]]:  # type: ignore[override] # str's own has the text alone
        """Return what a copy in another process is made from."""
        return str(self), self.by


def confirmed_by(certificates: Mapping[str, str]) -> tuple[str, ...]:
    """Return the programs that confirmed these certificates, each at least one of them; yices, which is asked first, comes first."""
    found = {name for text in certificates.values() if isinstance(text, ConfirmedText) for name in text.by}
    return tuple(sorted(found, reverse=True))


def rechecked_in_words(how: str, by: Sequence[str]) -> str:
    """Return how something was proved, with the programs that confirmed it: the second one confirmed what the first one left open."""
    return f"{how}, re-checked by {' and, for what it left open, '.join(by)}" if by else how


@dataclass(frozen=True)
class Certificate(Generic[Key]):
    """The text of a query, and the goals that no second solver could decide in time; if there are none, the proof is confirmed.

    text  a ConfirmedText if the proof is confirmed
    """

    file: str
    text: str
    undecided: tuple[Key, ...]


def certify(
    query: Query[Key], *, seconds: float, relies_on: Sequence[str] = (), one_goal: Mapping[str, str] = OPTIONS
) -> Certificate[Key]:
    """Let yices and cvc5 decide each goal from the hypotheses that the query needs; return the certificate.

    If they do not confirm every goal within the given seconds of effort, they decide the query with all hypotheses, with the
    same limit again. EngineError if one of them contradicts a goal, or cvc5 cannot read the text. `relies_on` names the files of
    the proofs whose results are hypotheses here; `one_goal` holds cvc5's options if the query has a single goal.
    """
    options = one_goal if len(query.goals) == 1 else OPTIONS
    needed = _certify(only_needed(query), seconds, relies_on, options)
    return needed if not needed.undecided else _certify(query, seconds, relies_on, options)


def _certify(
    query: Query[Key], seconds: float, relies_on: Sequence[str], options: Mapping[str, str]
) -> Certificate[Key]:
    text = to_smtlib(query, relies_on)
    file = file_name(query.name, text)
    if by := confirmed_before(text):
        return Certificate(file, ConfirmedText(text, by), ())
    with alone_in_asking("second", text):
        if by := confirmed_before(text):
            return Certificate(file, ConfirmedText(text, by), ())
        open_, by = _asked(query, file, text, seconds, options)
        if open_:
            return Certificate(file, text, open_)
        keep_confirmed(text, by)
    return Certificate(file, ConfirmedText(text, by), ())


def _asked(
    query: Query[Key], file: str, text: str, seconds: float, options: Mapping[str, str]
) -> tuple[tuple[Key, ...], tuple[str, ...]]:
    """Return the goals that neither yices nor cvc5 confirms in time, and the programs that confirm the others."""
    if options is INDUCTION_OF_ONE_GOAL and yices.program() is not None:
        return _asked_in_turn(query, file, text, seconds)
    left = _left_by_yices(query, file, text, seconds, YICES_SECONDS)
    by_yices = (f"yices {yices.version()}",) if len(left) < len(query.goals) else ()
    if not left:
        return (), by_yices
    if by_yices:
        query = Query(query.name, query.hypotheses, {goal: query.goals[goal] for goal in left})
        text = to_smtlib(query)
    open_ = _left_by_cvc5(query, file, text, seconds, options)
    return open_, (*by_yices, *([_CVC5] if len(open_) < len(left) else []))


def _asked_in_turn(query: Query[Key], file: str, text: str, seconds: float) -> tuple[tuple[Key, ...], tuple[str, ...]]:
    """Ask yices, then cvc5, for a short time each, and both again for longer: of an induction query with one goal."""
    by_yices = (f"yices {yices.version()}",)
    if not _left_by_yices(query, file, text, seconds, YICES_FIRST_SECONDS):
        return (), by_yices
    if recheck(file, text, 1, seconds=min(_CVC5_FIRST_SECONDS, seconds), options=INDUCTION_OF_ONE_GOAL) == ["unsat"]:
        return (), (_CVC5,)
    if not _left_by_yices(query, file, text, seconds, YICES_INDUCTION_SECONDS):
        return (), by_yices
    open_ = _left_by_cvc5(query, file, text, seconds, INDUCTION_OF_ONE_GOAL)
    return open_, () if open_ else (_CVC5,)


def _left_by_yices(query: Query[Key], file: str, text: str, seconds: float, alone_s: float) -> tuple[Key, ...]:
    """Return the goals that yices does not confirm in time: all of them where it is not installed or cannot read the text."""
    if yices.program() is None or not seconds:
        return tuple(query.goals)
    began = _of_children_s()
    answers = yices.answers(text, min(seconds, YICES_SECONDS), min(seconds, alone_s))
    spend(_of_children_s() - began)
    if len(answers) != len(query.goals) or yices.SAT in answers:
        raise _contradicts("yices", file, answers, len(query.goals))
    return tuple(goal for goal, answer in zip(query.goals, answers, strict=True) if answer != yices.UNSAT)


def _of_children_s() -> float:
    """Return the processor time of all ended processes that this one has started."""
    return os.times().children_user


def _left_by_cvc5(
    query: Query[Key], file: str, text: str, seconds: float, options: Mapping[str, str]
) -> tuple[Key, ...]:
    """Return the goals that cvc5 does not confirm in time: several are asked together, and what is left of them each alone."""
    ends = deadline(seconds)
    if len(query.goals) == 1:
        sets = [options, ALONE] if options is OPTIONS else [options, ALONE, OPTIONS]
        return () if _confirmed_alone(file, text, sets, ends) else tuple(query.goals)
    first = min(seconds, FIRST_SECONDS)
    answers = recheck(file, text, len(query.goals), seconds=seconds, each=first, options=options)
    left = [goal for goal, answer in zip(query.goals, answers, strict=True) if answer != "unsat"]
    texts = {
        goal: to_smtlib(only_needed(Query(query.name, query.hypotheses, {goal: query.goals[goal]}))) for goal in left
    }
    return tuple(goal for goal in left if not _confirmed_alone(file, texts[goal], [ALONE, options], ends))


def _confirmed_alone(file: str, text: str, sets: Sequence[Mapping[str, str]], ends: Deadline) -> bool:
    """Return whether cvc5 confirms the one goal of a text in the remaining time, with one of these sets of options."""
    for most_s, options in product(_ROUNDS_S, sets):
        if ends.passed:
            return False
        [answer] = recheck(file, text, 1, seconds=min(most_s, ends.left), options=options)
        if answer == "unsat":
            return True
    return False


def file_name(name: str, text: str) -> str:
    """Return the file name of a certificate: a readable name, and a digest of the text.

    So files of one name have the same content.
    """
    plain = "".join(letter if letter.isascii() and (letter.isalnum() or letter in "_.") else "-" for letter in name)
    return f"{plain[:_LONGEST_NAME]}-{hashlib.sha256(text.encode()).hexdigest()[:16]}.smt2"


def recheck(
    file: str,
    text: str,
    expected: int,
    *,
    seconds: float = 60.0,
    each: float | None = None,
    options: Mapping[str, str] = OPTIONS,
) -> list[str]:
    """Return cvc5's answers to the text, each `unsat` or `unknown`.

    each  limit in seconds for one goal; None: that of all goals

    EngineError if the number of answers is not `expected`, or if an answer is anything else: then cvc5 contradicts the
    proof.
    """
    answers = decide(file, text, seconds=seconds, each=each, options=options)
    if len(answers) != expected or any(answer not in ("unsat", "unknown") for answer in answers):
        raise _contradicts("cvc5", file, answers, expected)
    return answers


def _contradicts(solver: str, file: str, answers: Sequence[str], expected: int) -> EngineError:
    return EngineError(
        f"{file}: {solver} does not confirm the proof: answers {list(answers)}, expected {expected} times unsat. Do not use "
        "this result; keep the text and report it."
    )


def decide(
    file: str, text: str, *, seconds: float, each: float | None = None, options: Mapping[str, str] = OPTIONS
) -> list[str]:
    """Return cvc5's answers to the text's `check-sat` commands, in order; `unknown` to all that come after `seconds`."""
    terms = cvc5.TermManager()
    solver, symbols = cvc5.Solver(terms), cvc5.SymbolManager(terms)
    for option, value in options.items():
        solver.setOption(option, value)
    most = seconds if each is None else each
    solver.setOption("rlimit-per", str(max(1, int(UNITS_PER_SECOND * most))))
    solver.setOption("tlimit-per", str(milliseconds(clock_multiple() * most)))
    parser = cvc5.InputParser(solver, symbols)
    parser.setStringInput(cvc5.InputLanguage.SMT_LIB_2_6, str(text), file)  # it takes no subclass of str
    try:
        return _answers(parser, solver, symbols, deadline(seconds))
    except RuntimeError as error:
        raise EngineError(f"{file}: cvc5 cannot read the text of the proof: {error}") from error


def _answers(parser: cvc5.InputParser, solver: cvc5.Solver, symbols: cvc5.SymbolManager, ends: Deadline) -> list[str]:
    answers, used = [], 0
    while not (command := parser.nextCommand()).isNull():
        if ends.passed and command.getCommandName() == "check-sat":
            answers.append("unknown")
            continue
        answer = str(command.invoke(solver, symbols)).strip()
        if command.getCommandName() == "check-sat":
            used, before = _used(solver), used
            spend((used - before) / UNITS_PER_SECOND)
        if answer and answer != "success":
            answers.append("unknown" if answer.startswith("unknown (") else answer)  # as in `unknown (TIMEOUT)`
    return answers


def _used(solver: cvc5.Solver) -> int:
    return int(solver.getStatistics().get(internal=True, defaulted=True)[_USED]["value"])
