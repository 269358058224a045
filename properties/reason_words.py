"""Reasons of a machine in the words of the vehicle."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.language.expr import Bool, Lit, Num, all_of


def in_words(reason: Num, own: Num, words: Mapping[Lit, Lit]) -> Bool:
    """Return whether `reason` says in the vehicle's words what `own` says in those of a machine."""
    return all_of(own.eq(theirs).implies(reason.eq(ours)) for theirs, ours in words.items())
