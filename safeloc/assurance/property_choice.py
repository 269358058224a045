"""Choice of properties by machine, requirement and text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.catalogue import ENTRIES, load_target
from safeloc.errors import InputError
from safeloc.language.spec import Property


@dataclass(frozen=True)
class PropertyChoice:
    """A filter for properties.

    machines     names or addresses of machines; all that ship if none is named
    requirement  id of a requirement that they verify; None: any
    text         text in their name or statement; None: any
    """

    machines: Sequence[str]
    requirement: str | None
    text: str | None

    @property
    def by_text(self) -> bool:
        """True if properties are chosen by requirement or text."""
        return self.requirement is not None or self.text is not None

    def found(self) -> list[tuple[str, Property]]:
        """Return the chosen properties, each with the name of its machine. InputError if there is none."""
        found = [
            (target.name, prop)
            for target in map(load_target, dict.fromkeys(self.machines or ENTRIES))
            for prop in target.properties
            if self.accepts(prop)
        ]
        if not found:
            raise InputError(f"no property{self._in_words()}; `safeloc list properties` lists all.")
        return found

    def accepts(self, prop: Property) -> bool:
        """Return whether the filter accepts a property of a chosen machine; case is ignored."""
        requirements = {one.casefold() for one in prop.requirements}
        words = f"{prop.name}\n{prop.statement}".casefold()
        return (self.requirement is None or self.requirement.casefold() in requirements) and (
            self.text or ""
        ).casefold() in words

    def _in_words(self) -> str:
        machines = f" of {', '.join(self.machines)}" if self.machines else ""
        requirement = f" verifies requirement {self.requirement!r}" if self.requirement is not None else ""
        text = f" has {self.text!r} in its name or statement" if self.text is not None else ""
        return f"{machines}{' and'.join(part for part in (requirement, text) if part) or ' is declared'}"
