"""The structures of the generated C: fields in order, each with its type, unit and range.

Header, source, self-check and loaders all read them from here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from safeloc.codegen.c99_names import Names, names_of
from safeloc.codegen.simplify_under_facts import Known
from safeloc.errors import InputError
from safeloc.language.absence import stand_in_of, value_while_present
from safeloc.language.digest import declaration_digest
from safeloc.language.expr import Bool, Expr, Num, NumVar, Var
from safeloc.language.machine import Any_
from safeloc.language.nodes import Past
from safeloc.language.ranges import beyond_int64, bounds
from safeloc.language.system import TransitionSystem, canonical
from safeloc.language.terms import in_order
from safeloc.language.units import Enumeration

CType = Literal["int64_t", "int32_t", "uint8_t"]


@dataclass(frozen=True)
class Field:
    """A field of a structure: numbers are int64_t, members of enumerations int32_t, truth values uint8_t (0 or 1).

    source   what the declaration calls it
    present  of an optional input, the field that tells whether it is there; `absent` is what then stands for it
    stand_in of an output that may be absent, the number that stands in for it; `low` to `high` is where it is there
    """

    name: str
    source: str
    kind: CType
    low: int
    high: int
    unit: str
    present: str = ""
    absent: int = 0
    stand_in: int | None = None


@dataclass(frozen=True)
class Layout:
    """The structures of one system, and what its functions are made of.

    first   state variables whose first value is open
    kept    what is proved to last, beside the ranges: name -> term over state; None: nothing is known to
    """

    system: TransitionSystem
    names: Names
    state: tuple[Field, ...]
    inputs: tuple[Field, ...]
    outputs: tuple[Field, ...]
    fired: tuple[Field, ...]
    first: tuple[Field, ...]
    shown: Mapping[str, Expr]
    digest: str
    kept: Mapping[str, Bool] | None = None

    @property
    def told(self) -> tuple[Field, ...]:
        """Every field of the outputs."""
        return (*self.outputs, *self.fired)


def layout_of(system: TransitionSystem, kept: Mapping[str, Bool] | None = None) -> Layout:
    """Return the structures of a system without ghosts. InputError where C cannot run it soundly: past operators, 64 bits.

    kept   as `safeloc.proof.provers.lasting` proves it
    """
    terms = [*system.next.values(), *system.fired.values(), *system.outputs.values(), system.init]
    terms += (kept or {}).values()
    if any(isinstance(node, Past) for node in in_order(terms)):
        raise InputError(f"{system.name}: past operators cannot run; observe the property first.")
    if wide := beyond_int64(terms):
        raise InputError(f"{system.name}: {wide[0]!r} may leave 64 bits; narrow the ranges of what it is made of.")
    names, folded = names_of(system), Known({})
    shown = {name: folded(term) for name, term in system.outputs.items()}
    of = _Fields(names, bounds([*terms, *system.fired]))
    present: dict[Var, str] = {option.value: names.variables[option.present] for option in system.optionals}
    return Layout(
        system,
        names,
        tuple(of.variable(var) for var in system.state),
        tuple(of.variable(var, present.get(var, "")) for var in system.inputs),
        tuple(of.term(names.outputs[name], name, term) for name, term in system.outputs.items()),
        tuple(of.term(names.fired[var], var.name, var) for var in system.fired),
        tuple(of.variable(var) for var in system.state if isinstance(system.initial[var], Any_)),
        shown,
        declaration_digest(system),
        kept,
    )


@dataclass(frozen=True)
class _Fields:
    names: Names
    bounds: Mapping[Num, tuple[int, int]]

    def variable(self, var: Var, present: str = "") -> Field:
        absent = canonical(var) if isinstance(var, NumVar) else 0
        name = self.names.variables[var]
        if isinstance(var, NumVar):
            return Field(name, var.name, _kind(var), var.low, var.high, unit_text(var), present, absent)
        return Field(name, var.name, "uint8_t", 0, 1, "")

    def term(self, name: str, source: str, term: Expr) -> Field:
        if isinstance(term, Num):
            low, high = self.bounds[value_while_present(term)]
            return Field(name, source, _kind(term), low, high, unit_text(term), stand_in=stand_in_of(term))
        return Field(name, source, "uint8_t", 0, 1, "")


def _kind(term: Num) -> CType:
    return "int32_t" if isinstance(term.unit, Enumeration) else "int64_t"


def unit_text(term: Num) -> str:
    """Return the unit as it is shown: nothing for an enumeration or a bare number."""
    return "" if isinstance(term.unit, Enumeration) or term.unit.name == "1" else term.unit.name


def unit_of(layout: Layout, field: Field) -> Enumeration | None:
    """Return the enumeration whose members a field holds."""
    system = layout.system
    known: dict[str, Expr] = {var.name: var for var in (*system.state, *system.inputs, *system.fired)}
    term = system.outputs.get(field.source) if field in layout.outputs else known[field.source]
    return term.unit if isinstance(term, Num) and isinstance(term.unit, Enumeration) else None


def literal(text: str) -> str:
    """Return a C string of the text, in plain letters whatever it holds."""
    letters = [chr(byte) if 32 <= byte < 127 and chr(byte) not in '"\\?' else f"\\{byte:03o}" for byte in text.encode()]
    return '"' + "".join(letters) + '"'


def remark(text: str) -> str:
    """Return the text as part of a C comment, which it must neither end nor begin."""
    for wrong, right in (("*/", "* /"), ("/*", "/ *"), ("??", "? ?"), ("\n", " ")):
        text = text.replace(wrong, right)
    return text
