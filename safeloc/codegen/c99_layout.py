"""The structures of the generated C: fields in order, each with its type, unit and range.

The generators of header, source, self-check and FMI unit, and the loader, all read this layout.
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

    source    the name in the declaration
    low, high the range of a present value
    present   of an optional input, the field with its presence
    absent    of an optional input, its value while it is absent
    stand_in  of an output that may be absent, the number that stands in for it
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
    """The structures of one system, and the terms for its functions.

    first   state variables declared ANY
    shown   the terms of the outputs, simplified
    kept    proved invariants besides the ranges: name -> term over state; None: nothing is proved
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
    def output_fields(self) -> tuple[Field, ...]:
        """The fields of the structure of outputs: outputs, then the transitions that fired."""
        return (*self.outputs, *self.fired)


def layout_of(system: TransitionSystem, kept: Mapping[str, Bool] | None = None) -> Layout:
    """Return the structures of a system without ghosts. InputError for past operators, and for terms that may exceed 64 bits.

    kept   invariants, proved by `safeloc.proof.provers.lasting`
    """
    terms = [*system.next.values(), *system.fired.values(), *system.outputs.values(), system.init]
    terms += (kept or {}).values()
    if any(isinstance(node, Past) for node in in_order(terms)):
        raise InputError(f"{system.name}: past operators cannot run; `observe` the property first.")
    if wide := beyond_int64(terms):
        raise InputError(f"{system.name}: {wide[0]!r} may exceed 64 bits; narrow the ranges of its variables.")
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
            return Field(name, var.name, _kind(var), var.low, var.high, _unit_text(var), present, absent)
        return Field(name, var.name, "uint8_t", 0, 1, "")

    def term(self, name: str, source: str, term: Expr) -> Field:
        if isinstance(term, Num):
            low, high = self.bounds[value_while_present(term)]
            return Field(name, source, _kind(term), low, high, _unit_text(term), stand_in=stand_in_of(term))
        return Field(name, source, "uint8_t", 0, 1, "")


def _kind(term: Num) -> CType:
    return "int32_t" if isinstance(term.unit, Enumeration) else "int64_t"


def _unit_text(term: Num) -> str:
    """Return the name of the unit for a reader; "" for an enumeration or a number without unit."""
    return "" if isinstance(term.unit, Enumeration) or term.unit.name == "1" else term.unit.name


def unit_of(layout: Layout, field: Field) -> Enumeration | None:
    """Return the enumeration whose members a field holds; None for any other field."""
    system = layout.system
    known: dict[str, Expr] = {var.name: var for var in (*system.state, *system.inputs, *system.fired)}
    term = system.outputs.get(field.source) if field in layout.outputs else known[field.source]
    return term.unit if isinstance(term, Num) and isinstance(term.unit, Enumeration) else None


def literal(text: str) -> str:
    """Return the text as a C string literal in printable ASCII characters."""
    letters = [chr(byte) if 32 <= byte < 127 and chr(byte) not in '"\\?' else f"\\{byte:03o}" for byte in text.encode()]
    return '"' + "".join(letters) + '"'


def remark(text: str) -> str:
    """Return the text as part of a C comment, changed so that it neither ends the comment nor begins another."""
    for wrong, right in (("*/", "* /"), ("/*", "/ *"), ("??", "? ?"), ("\n", " ")):
        text = text.replace(wrong, right)
    return text
