"""A free obligation with its verdict, before it becomes a Finding."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.verdict import Verdict


@dataclass(frozen=True, eq=False)
class Obligation:
    """A free obligation: its name within the system, and the method that found the verdict, in words for the reader."""

    name: str
    statement: str
    verdict: Verdict
    method: str
