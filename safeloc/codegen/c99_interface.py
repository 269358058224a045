"""The interface of the generated C as text, one line for each thing that a host may rely on, and its digest.

Figures of the configuration that change no range, type or number do not show here, nor does the state: two exports with the
same digest can be exchanged without a change of the host's source.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator

from safeloc.codegen.c99_layout import Field, Layout, unit_of
from safeloc.codegen.c99_statuses import stand_in_name, statuses

FILE = "interface.txt"


def interface(layout: Layout) -> str:
    """Return the text: inputs, outputs, first values, members of enumerations, stand-ins and statuses, sorted in each kind."""
    return "\n".join([f"machine {layout.names.prefix}", *_lines(layout)]) + "\n"


def interface_digest(layout: Layout) -> str:
    """Return the SHA-256 of the interface's text."""
    return hashlib.sha256(interface(layout).encode("utf-8")).hexdigest()


def _lines(layout: Layout) -> Iterator[str]:
    structures = (("input", layout.inputs), ("output", layout.output_fields), ("first", layout.first))
    for kind, fields in structures:
        yield from sorted(f"{kind} {_described(layout, field)}" for field in fields)
    every = [field for _, fields in structures for field in fields]
    for unit in dict.fromkeys(unit for field in every if (unit := unit_of(layout, field)) is not None):
        title, names = layout.names.titles[unit], layout.names.members[unit]
        yield from (f"member {title} {name} = {number}" for number, name in enumerate(names))
    absent = [field for field in layout.outputs if field.stand_in is not None]
    yield from sorted(f"absent {stand_in_name(layout, field)} = {field.stand_in}" for field in absent)
    yield from (f"status {name} = {number}" for name, number, _ in statuses(layout))


def _described(layout: Layout, field: Field) -> str:
    """Return name, type, range and unit of a field, and the field that says whether it is there."""
    unit = unit_of(layout, field)
    if field.kind == "uint8_t":
        return f"{field.name} {field.kind} 0 .. 1"
    name = layout.names.titles[unit] if unit is not None else field.unit or "number"
    optional = f", read where {field.present} is 1" if field.present else ""
    return f"{field.name} {field.kind} {field.low} .. {field.high} {name}{optional}"
