"""A rule for declarations: its name, the harm that it prevents, and its check."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, Literal, TypeVar

_Subject = TypeVar("_Subject")
Harm = Literal["a wrong verdict", "a crash", "a slip"]


@dataclass(frozen=True)
class Rule(Generic[_Subject]):
    """One rule about a subject.

    keeps_out   the harm without the rule: a wrong verdict, a crash (a failure without a message for the user), or a slip
                (a declaration that does not mean what its author intended)
    complaints  one sentence for each error: what, where (file and line), what to do
    """

    name: str
    keeps_out: Harm
    complaints: Callable[[_Subject], Iterator[str]]


def complaints(rules: Sequence[Rule[_Subject]], subject: _Subject) -> list[str]:
    """Return all complaints of the first rule that has any: later rules may rely on the parts that earlier ones accepted."""
    for rule in rules:
        found = list(rule.complaints(subject))
        if found:
            return found
    return []


def every_complaint(rules: Sequence[Rule[_Subject]], subject: _Subject) -> list[str]:
    """Return the complaints of all rules, so that the user sees every error at once."""
    return [complaint for rule in rules for complaint in rule.complaints(subject)]
