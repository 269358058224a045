"""Claims about runs, twice: as defined on a finished run, and step by step with a memory. Nothing here is safeloc's.

A claim is over the state after the step, `was` for the state before it, the step's inputs, and what fired.

    always     its term holds in every step; one that reads state only, also in the first state
    within     after each term, the response holds in the same step or at most `steps` later
    reachable  some run comes to its term; one that reads state only may hold in the first state
    previous   held in the step before, false in the first step
    once       holds now, or held in some earlier step
    since      (p, q): q held in some step up to now, and p in every step after it up to now
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from tests.fuzz.terms import PAST, TRUE, Term, below, fast, parts, reads, rewritten, value

Env = Mapping[str, int]
WAITING = "waiting > 0"  # what a helper may read besides the state


@dataclass(frozen=True)
class Claim:
    """A property of our own.

    of      of a composition: the machine that it is inherited from; `own` is its term over that machine's names
    helper  over the state and WAITING
    """

    name: str
    kind: Literal["always", "within", "reachable"]
    term: Term
    response: Term = TRUE
    steps: int = 0
    further_assumption: Term = TRUE
    unconditional: bool = False
    helper: Term | None = None
    of: str = ""
    own: Term = TRUE


def has_past(term: Term) -> bool:
    """Whether a past operator is in it."""
    return any(one[0] in PAST for one in below(term))


def requires_first(claim: Claim, state_names: Sequence[str]) -> bool:
    """Whether it speaks of the first state as well: a term that reads state only, and nothing of the past."""
    return claim.kind != "within" and not has_past(claim.term) and reads(claim.term) <= set(state_names)


# ------------------------------------------------------------------ on a finished run


def holds_at(term: Term, run: Sequence[Env], step: int) -> bool:
    """Whether the term holds in a step of the run; the definition of the past operators."""
    match term:
        case ("previous", inner):
            return step > 0 and holds_at(inner, run, step - 1)
        case ("once", inner):
            return any(holds_at(inner, run, earlier) for earlier in range(step + 1))
        case ("since", kept, begin):
            return any(
                holds_at(begin, run, start) and all(holds_at(kept, run, later) for later in range(start + 1, step + 1))
                for start in range(step + 1)
            )
    now = rewritten(term, lambda leaf: leaf) if not has_past(term) else _judged(term, run, step)
    return bool(value(now, run[step]))


def _judged(term: Term, run: Sequence[Env], step: int) -> Term:
    """The term with what it says of the past replaced by its truth."""
    if term[0] in PAST:
        return ("true",) if holds_at(term, run, step) else ("false",)
    inner = tuple(_judged(part, run, step) for part in parts(term))
    return (term[0], *inner, *term[1 + len(inner) :])


def hit_at(claim: Claim, first: Env, run: Sequence[Env], state_names: Sequence[str]) -> int | None:
    """The number of steps after which the claim is broken (for `reachable`: reached); None where it is not."""
    wanted = claim.kind == "reachable"
    if requires_first(claim, state_names) and bool(value(claim.term, first)) == wanted:
        return 0
    for step in range(len(run)):
        if claim.kind == "within":
            hit = _late(claim, run, step)
        else:
            hit = holds_at(claim.term, run, step) == wanted
        if hit:
            return step + 1
    return None


def _late(claim: Claim, run: Sequence[Env], step: int) -> bool:
    """Whether the last moment to answer something passes unanswered in this step."""
    asked = step - claim.steps
    return (
        asked >= 0
        and holds_at(claim.term, run, asked)
        and not any(holds_at(claim.response, run, one) for one in range(asked, step + 1))
    )


# ------------------------------------------------------------------ step by step


class Watch:
    """A claim with its memory: of each past operator one truth, and of `within` how long it has been waited."""

    def __init__(self, claim: Claim) -> None:
        self._claim = claim
        self._past: list[tuple[str, list[Callable[[Env], int]]]] = []
        self._names: dict[Term, str] = {}
        self._term, self._response = fast(self._lifted(claim.term)), fast(self._lifted(claim.response))
        self.memory: tuple[int, ...] = (*(0 for _ in self._past), -1)

    def _lifted(self, term: Term) -> Term:
        """The term with past operators replaced by variables of their own, inner ones first."""
        if term in self._names:
            return ("var", self._names[term])
        inner = tuple(self._lifted(part) for part in parts(term))
        if term[0] not in PAST:
            return (term[0], *inner, *term[1 + len(inner) :])
        self._names[term] = f"past {len(self._past)}"
        self._past.append((term[0], [fast(part) for part in inner]))
        return ("var", self._names[term])

    def hit(self, first: Env) -> bool:
        """Whether the first state breaks it, or reaches it."""
        return bool(self._term(first)) == (self._claim.kind == "reachable")

    def step(self, memory: tuple[int, ...], env: Env) -> tuple[tuple[int, ...], bool]:
        """Memory after a step, and whether the step breaks (or reaches) it."""
        values, after = dict(env) if self._past else env, list(memory)
        for number, (operator, inner) in enumerate(self._past):
            known = [bool(one(values)) for one in inner]
            now, later = _remembered(operator, known, bool(memory[number]))
            values[f"past {number}"], after[number] = now, later  # type: ignore[index] # a dict where there is a past
        now = bool(self._term(values))
        if self._claim.kind != "within":
            return tuple(after), now == (self._claim.kind == "reachable")
        age = -1 if self._response(values) else memory[-1] + 1 if memory[-1] >= 0 else 0 if now else -1
        after[-1] = min(age, self._claim.steps)
        return tuple(after), age >= self._claim.steps


def _remembered(operator: str, known: Sequence[bool], memory: bool) -> tuple[bool, bool]:
    """What a past operator says now, and what it keeps for the next step."""
    if operator == "previous":
        return memory, known[0]
    now = (known[0] or memory) if operator == "once" else (known[1] or (known[0] and memory))
    return now, now
