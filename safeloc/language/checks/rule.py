"""A rule for declarations: its name, the harm that it prevents, and its check."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, Literal, TypeVar

Subject = TypeVar("Subject")
Harm = Literal["a wrong verdict", "a crash", "a slip"]


@dataclass(frozen=True)
class Rule(Generic[Subject]):
    """One rule about a subject.

    keeps_out   the harm without the rule: a wrong verdict, a failure without a message for the user, or
                nothing but a declaration that does not say what its author meant
    complaints  one sentence for each offence: what, where (file and line), what to do
    """

    name: str
    keeps_out: Harm
    complaints: Callable[[Subject], Iterator[str]]


def complaints(rules: Sequence[Rule[Subject]], subject: Subject) -> list[str]:
    """Return all complaints of the first rule that has any: later rules may walk what earlier ones have found in order."""
    for rule in rules:
        found = list(rule.complaints(subject))
        if found:
            return found
    return []


def every_complaint(rules: Sequence[Rule[Subject]], subject: Subject) -> list[str]:
    """Return all complaints of all rules, so that one look shows every mistake."""
    return [complaint for rule in rules for complaint in rule.complaints(subject)]
