"""C identifiers for all names of a system: the letters of the name, with a number if the identifier is taken already."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from safeloc.language.nodes import Expr, Lit, NumVar, Var
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import in_order
from safeloc.language.units import Enumeration

_KEYWORDS = """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while _Bool _Complex
    _Imaginary bool true false NULL errno EOF offsetof asm typeof
"""
_OWN_WORDS = "state inputs outputs first count done floor_div ceil_div advance show judged sound declaration nothing"
_RESERVED = frozenset(f"{_KEYWORDS} {_OWN_WORDS}".split())
_TYPES = re.compile(r"u?int(_\w+)?\d*_t|u?int\w*_(min|max|c)|size_t|size_max|t\d+", re.IGNORECASE)


@dataclass(frozen=True)
class Names:
    """Identifiers of one system.

    prefix     the beginning of every external name
    variables  fields of the structures, and local names in functions: distinct among state and inputs
    outputs    fields of the outputs
    fired      fields of the transitions that fired
    members    enumeration -> the constants of its members, in order
    titles     enumeration -> its name
    """

    prefix: str
    variables: Mapping[Var, str]
    outputs: Mapping[str, str]
    fired: Mapping[NumVar, str]
    members: Mapping[Enumeration, tuple[str, ...]]
    titles: Mapping[Enumeration, str]

    @property
    def upper(self) -> str:
        """The prefix of constants."""
        return self.prefix.upper()


def names_of(system: TransitionSystem) -> Names:
    """Return the identifiers of a system; none is a keyword of C, a fixed-width type or a word of the generated text."""
    prefix = identifier(system.name)
    titles = _titles(system)
    constants = set[str]()
    members = {
        unit: tuple(distinct(identifier(f"{prefix}_{title}_{label}").upper(), constants) for label in unit.members)
        for unit, title in titles.items()
    }
    taken, shown = set(constants), set(constants)
    variables = {var: distinct(identifier(var.name), taken) for var in (*system.state, *system.inputs)}
    outputs = {name: distinct(identifier(name), shown) for name in system.outputs}
    fired = {var: distinct(identifier(var.name), shown) for var in system.fired}
    return Names(prefix, variables, outputs, fired, members, titles)


def identifier(name: str) -> str:
    """Return the name as a C identifier: letters, digits and underscores, with "n" before a leading digit."""
    plain = re.sub(r"[^A-Za-z0-9_]+", "_", name).strip("_") or "unnamed"
    return f"n{plain}" if plain[0].isdigit() else plain


def distinct(plain: str, taken: set[str]) -> str:
    """Return the name, with a number if it is taken or has another meaning in C, and add it to `taken`."""
    name, number = plain, 1
    while name in taken or name in _RESERVED or _TYPES.fullmatch(name):
        number += 1
        name = f"{plain}_{number}"
    taken.add(name)
    return name


def _titles(system: TransitionSystem) -> dict[Enumeration, str]:
    """Return the C name of every enumeration; in a composition, modes and fired transitions have their machine's prefix."""
    known: dict[Enumeration, str] = {}
    for machine in system.machines:
        owner = f"{identifier(machine.name)}_" if len(system.machines) > 1 else ""
        for var, word in ((machine.mode, "mode"), (machine.fired_name, "fired")):
            if isinstance(var.unit, Enumeration):
                known.setdefault(var.unit, owner + word)
    taken: set[str] = set()
    return {unit: distinct(known.get(unit, identifier(unit.name)), taken) for unit in _enumerations(system)}


def _enumerations(system: TransitionSystem) -> Iterable[Enumeration]:
    """Return every enumeration of a variable or constant, in order of first use."""
    terms: list[Expr] = [*system.state, *system.inputs, *system.fired]
    terms += in_order([*system.next.values(), *system.fired.values(), *system.outputs.values(), system.init])
    units = [term.unit for term in terms if isinstance(term, (Lit, NumVar))]
    return dict.fromkeys(unit for unit in units if isinstance(unit, Enumeration))
