"""Claims of one group: their requirements and the law that they rest on are stated once."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool
from safeloc.language.spec import Property, always


@dataclass(frozen=True)
class Claims:
    """A group of claims that hold in every step.

    requirements  ids of the requirements that all of them verify
    law           the assumption, in words, of those that rest on the world's laws
    """

    requirements: tuple[str, ...]
    law: str = ""

    def for_all_inputs(self, name: str, term: Bool, statement: str) -> Property:
        """Return a property for all inputs in range."""
        return always(name, term, statement=statement, requirements=self.requirements, unconditional=True)

    def lawful(self, name: str, term: Bool, statement: str) -> Property:
        """Return a property that rests on the world's laws."""
        return always(name, term, statement=statement, requirements=self.requirements, assumption=self.law)
