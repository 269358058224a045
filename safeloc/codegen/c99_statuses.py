"""The statuses that the functions of the generated C return, and the numbers that stand in for absent outputs."""

from __future__ import annotations

from safeloc.codegen.c99_layout import Field, Layout, unit_of

FIRST_INPUT_STATUS = 16
"""The number of the first input's status; the statuses below it have the same numbers in every machine and version."""


def statuses(layout: Layout) -> list[tuple[str, int, str]]:
    """Return every status: the name of its constant, its number, its text."""
    p, upper = layout.names.prefix, layout.names.upper
    fixed = [
        (f"{upper}_OK", "done"),
        (f"{upper}_NO_POINTER", "a pointer is NULL; nothing was done"),
        (f"{upper}_STATE_OUT_OF_RANGE", "a state variable is out of its range; nothing was done"),
        (f"{upper}_FIRST_REFUSED", "the chosen first values are out of range or exclude each other; nothing was done"),
        (f"{upper}_SNAPSHOT_FOREIGN", "the snapshot is of another declaration; nothing was restored"),
        (f"{upper}_SNAPSHOT_DAMAGED", "the snapshot's checksum is wrong; nothing was restored"),
        (
            f"{upper}_STATE_UNSOUND",
            "every state variable is in its range, but no step leads to such a state; nothing was done",
        ),
        (f"{upper}_STATE_NOT_SET", f"the state was not set by {p}_init or {p}_restore; nothing was done"),
    ]
    found = [
        (name, number, text)
        for number, (name, text) in enumerate(fixed)
        if layout.kept or name != f"{upper}_STATE_UNSOUND"
    ]
    for number, field in enumerate(layout.inputs, FIRST_INPUT_STATUS):
        found.append((input_status(layout, field), number, f"input {field.source} is not {_allowed(layout, field)}"))
    return found


def input_status(layout: Layout, field: Field) -> str:
    """Return the name of the status for this input out of range."""
    return f"{layout.names.upper}_REFUSED_{field.name.upper()}"


def _allowed(layout: Layout, field: Field) -> str:
    if field.kind == "uint8_t":
        return "0 or 1"
    unit = unit_of(layout, field)
    if unit is not None:
        return f"a member of {unit.name}"
    return f"in {field.low} .. {field.high} {field.unit}".rstrip()


def stand_in_name(layout: Layout, field: Field) -> str:
    """Return the name of the constant that stands in for this output while it is absent."""
    return f"{layout.names.upper}_ABSENT_{field.name.upper()}"
