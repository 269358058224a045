"""The variables of a co-simulation unit: one for each input, output, parameter and state variable, numbered from 1.

Number 0 is the time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from safeloc.codegen.c99_layout import Field, Layout, unit_of
from safeloc.language.nodes import Value
from safeloc.language.units import Enumeration

Causality = Literal["input", "output", "parameter", "local"]
_PLACES: Mapping[Causality, str] = {"input": "inputs", "output": "outputs", "parameter": "first", "local": "state"}


@dataclass(frozen=True)
class Variable:
    """A variable of the unit; `place` is the C expression for its value within an instance."""

    reference: int
    name: str
    causality: Causality
    field: Field
    enumeration: Enumeration | None
    start: int | None

    @property
    def is_truth(self) -> bool:
        """True for a Boolean variable; all others are 64-bit numbers."""
        return self.field.kind == "uint8_t"

    @property
    def place(self) -> str:
        """The C expression for the value within an instance."""
        return f"unit->{_PLACES[self.causality]}.{self.field.name}"

    @property
    def description(self) -> str:
        """The unit, the condition under which the value is read, and its stand-in, in words."""
        parts = [f"in {self.field.unit}"] if self.field.unit else []
        parts += [f"read only where {self.field.source}.present is true"] if self.field.present else []
        parts += [] if self.field.stand_in is None else [f"{self.field.stand_in} while it is absent"]
        parts += ["state after the last step"] if self.causality == "local" else []
        return "; ".join(parts)


def variables_of(layout: Layout, first: Mapping[str, Value]) -> tuple[Variable, ...]:
    """Return the variables: inputs, outputs, open first values as parameters, the state as locals.

    first  start values of the parameters
    """
    made = [
        Variable(number, name, causality, field, unit_of(layout, field), start)
        for number, (name, causality, field, start) in enumerate(_listed(layout, first), 1)
    ]
    return tuple(made)


def _listed(layout: Layout, first: Mapping[str, Value]) -> Iterator[tuple[str, Causality, Field, int | None]]:
    for field in layout.inputs:
        yield field.source, "input", field, field.absent
    for field in layout.output_fields:
        yield field.source, "output", field, None
    for field in layout.first:
        yield f"first.{field.source}", "parameter", field, int(first.get(field.source, field.absent))
    for field in layout.state:
        yield f"state.{field.source}", "local", field, None
