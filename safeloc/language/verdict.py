"""Verdicts: the result of a prover, a test or a replay for one property, with its evidence.

A verdict has no truth value: read it by `match`, or call `require_proved`. The order from worst to best is
Violated < Unknown < Vacuous < NotAsked < Held < Proved; the headline of a report is the worst.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import NoReturn, TypeAlias, assert_never

from safeloc.errors import NotProvedError, TruthValueError
from safeloc.language.expr import Bool
from safeloc.language.html_views import verdict_html
from safeloc.language.trace import Trace


class _NoTruth:
    __slots__ = ()

    def __bool__(self) -> NoReturn:
        raise TruthValueError(
            "a verdict has no truth value: match on Proved, Held, Unknown, Violated or call require_proved."
        )

    def _repr_html_(self) -> str:
        return _as_html(self)  # type: ignore[arg-type] # every verdict is a Result


SEVERAL_RUNS = "recordings and bounded search"
"""The engine of a statement that several things occur, of which every one is shown by a run."""


@dataclass(frozen=True, eq=False)
class Proved(_NoTruth):
    """The property holds on every stream that obeys the assumption, of whatever length.

    invariant        the inductive invariant; None for `reachable`
    rechecked        the programs that confirmed the result (yices or cvc5, interpreter)
    certificates     file name -> SMT-LIB 2 text
    witness          for `reachable`, a run that reaches the state
    by_construction  the part that needed no solver, and why, such as divisors that are positive constants
    """

    invariant: Bool | None
    engine: str
    depth: int = 0
    rechecked: tuple[str, ...] = ()
    certificates: Mapping[str, str] = field(default_factory=dict)
    witness: Trace | None = None
    by_construction: str = ""

    @property
    def is_shown_by_runs(self) -> bool:
        """Return whether runs are the whole evidence: one that is kept here, or several, each kept with what it shows."""
        return self.witness is not None or self.engine == SEVERAL_RUNS


@dataclass(frozen=True, eq=False)
class Violated(_NoTruth):
    """A run violates the property; its trace was replayed in the interpreter.

    `trace` is None only if the evidence is no run: a `reachable` state was proved unreachable, as `reason` states.
    """

    trace: Trace | None
    engine: str
    reason: str = ""


@dataclass(frozen=True, eq=False)
class Unknown(_NoTruth):
    """The property is undecided within the limits; no violation exists up to `depth` steps (-1: no depth was completed).

    escape  a counterexample to induction: a run from a state that keeps all that is proved, whose last step breaks the property; no
            run of the machine need come to that state
    """

    reason: str
    depth: int = -1
    escape: Trace | None = None

    @property
    def searched(self) -> str:
        """The length up to which runs were searched, in words."""
        return "no runs searched" if self.depth < 0 else f"all runs of up to {self.depth} steps searched"


@dataclass(frozen=True, eq=False)
class Vacuous(_NoTruth):
    """The property is vacuously true: one of its cases never happens, or runs under its assumption reach a dead end.

    `trace` is a run into the dead end, if that is the reason.
    """

    reason: str
    trace: Trace | None = None


@dataclass(frozen=True, eq=False)
class NotAsked(_NoTruth):
    """Nothing to prove was declared, for example in a module without properties; this never counts as proved."""

    reason: str


@dataclass(frozen=True, eq=False)
class Held(_NoTruth):
    """The property was not violated in the runs that were made: this is evidence and no proof."""

    engine: str
    runs: int
    steps: int
    notes: Mapping[str, str] = field(default_factory=dict)


Verdict: TypeAlias = Proved | Violated | Unknown | Vacuous
Result: TypeAlias = Verdict | Held | NotAsked


def word(result: Result) -> str:
    """Return the verdict as one of the words of WORST_FIRST."""
    match result:
        case Proved():
            return "proved"
        case Vacuous():
            return "vacuous"
        case NotAsked():
            return "not asked"
        case Held():
            return "held"
        case Unknown():
            return "unknown"
        case Violated():
            return "violated"
        case _:
            assert_never(result)


SHOWN = "shown by a run"
"""What a reader is told of a verdict `proved` whose evidence is runs: that something can happen, not that something always holds."""


def told(result: Result) -> str:
    """Return the verdict as a reader is told it: `word`, but `shown by a run` where runs are the whole evidence."""
    return SHOWN if isinstance(result, Proved) and result.is_shown_by_runs else word(result)


def _as_html(result: Result) -> str:
    """Return a verdict as HTML: its word, how it was found or why it is open, and its run."""
    match result:
        case Proved(engine=engine, witness=witness):
            return verdict_html(told(result), f"by {engine}", witness)
        case Violated(trace, engine, reason):
            return verdict_html("violated", f"found by {engine}. {reason}".rstrip(), trace)
        case Vacuous(reason, trace):
            return verdict_html("vacuous", reason, trace)
        case Unknown(reason) | NotAsked(reason):
            return verdict_html(word(result), reason, None)
        case Held(engine, runs, steps):
            return verdict_html("held", f"{engine}, {runs} runs, {steps} steps", None)
        case _:
            assert_never(result)


WORST_FIRST = ("violated", "unknown", "vacuous", "not asked", "held", "proved")


def worst(words: Iterable[str]) -> str:
    """Return the worst of several verdict words; `not asked` if there are none."""
    return min(words, key=WORST_FIRST.index, default="not asked")


def require_proved(verdict: Verdict) -> Proved:
    """Return the verdict if it is Proved; otherwise raise NotProvedError with the evidence."""
    match verdict:
        case Proved():
            return verdict
        case Violated(trace, engine, reason):
            run = "" if trace is None else f" after {len(trace.steps)} steps\n{trace.table()}"
            raise NotProvedError(f"violated (found by {engine}) {reason}{run}")
        case Unknown(reason, depth):
            raise NotProvedError(f"undecided: {reason} (no violation up to depth {depth})")
        case Vacuous(reason):
            raise NotProvedError(f"vacuous: {reason}")
        case _:
            assert_never(verdict)
