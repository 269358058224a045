"""The cache of solver answers: the fact that every goal of a query is proved, by which programs that was confirmed, the
hypotheses that a proof needs, and the goals of a query that z3 did not prove.

The key is the text of the query (hypotheses and goals), the solver, and the engine; after an edit of a machine only the
affected queries are solved again.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Literal

from safeloc.proof.cache.engine import engine_digest, undisturbed
from safeloc.proof.cache.store import Store, utc_now
from safeloc.proof.cache.turns import Turn, turn

Solver = Literal["z3", "second"]
"""z3, which proves, or the second solver, which confirms: yices or cvc5."""
_KIND, _PROVED, NEEDED, UNPROVED = "answers", b"proved", "needed", "unproved"
_BEGINS = "(set-logic "


@dataclass(frozen=True)
class _Place:
    """The store of answers, and the earliest valid date (UTC)."""

    store: Store
    since: str


_PLACES: list[_Place] = []


@contextmanager
def kept_in(store: Store | None, *, fresh: bool = False) -> Iterator[None]:
    """Look up and cache answers in this store within the `with` block, and in processes that are forked in it.

    No answers are cached without a store, or if a file of the package was written after the process started.

    fresh  use only answers that are cached from now on: a query that occurs twice in a run is solved once
    """
    if store is None or not undisturbed():
        yield
        return
    engine_digest()  # here, so that processes that start later do not read files that were written meanwhile
    _PLACES.append(_Place(store, utc_now() if fresh else ""))
    try:
        yield
    finally:
        _PLACES.pop()


def keeping() -> bool:
    """Return whether answers are cached at all."""
    return bool(_PLACES)


def proved_before(text: str) -> bool:
    """Return whether z3 has proved every goal of this text before."""
    return _answer("z3", text) == _PROVED


def keep_proved(text: str) -> None:
    """Cache the fact that z3 has proved every goal of this text."""
    if _PLACES:
        _PLACES[-1].store.put(_KIND, _key("z3", text), _PROVED)


def confirmed_before(text: str) -> tuple[str, ...]:
    """Return the programs that have confirmed every goal of this text before, with their versions; nothing if that is not known.

    An entry that names no program, as safeloc wrote it before it named them, counts as none: the text is asked again.
    """
    said, *by = _answer("second", text).split(b"\n")
    return tuple(name.decode() for name in by) if said == _PROVED else ()


def keep_confirmed(text: str, by: Sequence[str]) -> None:
    """Cache the names of the programs that have confirmed every goal of this text."""
    if _PLACES and by:
        _PLACES[-1].store.put(_KIND, _key("second", text), b"\n".join([_PROVED, *(name.encode() for name in by)]))


def _answer(solver: Solver, text: str) -> bytes:
    """Return what is cached of this solver's answer; nothing if there is none, or none that is new enough."""
    if not _PLACES:
        return b""
    place = _PLACES[-1]
    entry = place.store.get(_KIND, _key(solver, text))
    return entry.data if entry is not None and entry.since >= place.since else b""


def needed_before(text: str, hypotheses: int) -> list[int] | None:
    """Return the cached numbers of the hypotheses of this text that z3 used for its proof; None if there are none.

    hypotheses  the number of all hypotheses of the text

    The numbers are a proposal: the caller has to prove the goals from these hypotheses.
    """
    numbers = _numbers(NEEDED, text)
    return numbers if numbers is not None and all(number < hypotheses for number in numbers) else None


def keep_needed(text: str, numbers: Sequence[int]) -> None:
    """Cache the numbers of the hypotheses of this text that z3 used for its proof."""
    _keep_numbers(NEEDED, text, numbers)


def unproved_before(text: str, goals: int, seconds: float) -> list[int] | None:
    """Return the cached numbers of the goals of this text that z3 did not prove; None if that is not known, or not for so much effort.

    goals  the number of all goals of the text

    That the others follow has to be known from elsewhere (`proved_before`), so a wrong number proves nothing.
    """
    found = _numbers(UNPROVED, text)
    if not found or found[0] < _milliseconds(seconds) or any(number >= goals for number in found[1:]):
        return None
    return found[1:]


def keep_unproved(text: str, seconds: float, numbers: Sequence[int]) -> None:
    """Cache the numbers of the goals of this text that z3 did not prove with so much effort."""
    _keep_numbers(UNPROVED, text, [_milliseconds(seconds), *numbers])


def _milliseconds(seconds: float) -> int:
    return int(seconds * 1000)


def _numbers(kind: str, text: str) -> list[int] | None:
    if not _PLACES:
        return None
    place = _PLACES[-1]
    entry = place.store.get(kind, _key("z3", text))
    if entry is None or entry.since < place.since:
        return None
    return [int(number) for number in entry.data.split() if number.isdigit()]


def _keep_numbers(kind: str, text: str, numbers: Sequence[int]) -> None:
    if _PLACES:
        _PLACES[-1].store.put(kind, _key("z3", text), b" ".join(b"%d" % number for number in numbers))


@contextmanager
def turn_of(solver: Solver, text: str) -> Iterator[Turn | None]:
    """Provide the lock of this query, by which one process solves it while others wait; None if nothing is cached."""
    if not _PLACES:
        yield None
        return
    with turn(_PLACES[-1].store.folder, _key(solver, text)) as mine:
        yield mine


def _key(solver: Solver, text: str) -> str:
    """Return the key of a query: a digest of engine, solver and text, without the text's header, which solvers ignore."""
    body = text[text.index(_BEGINS) :]
    return hashlib.sha256("\0".join([engine_digest(), solver, body]).encode()).hexdigest()
