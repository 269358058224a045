"""Self-check vectors: runs of the interpreter as plain numbers, which a small C program replays.

    begin  FIRST ...                    a run begins with these first values of variables declared ANY
    step   INPUTS ... STATUS OUTPUTS ... STATE ...    one step: its inputs, and status, outputs and state after it

At intervals a step has one input out of its range: it is refused, and outputs and state stay as they were.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from safeloc.codegen.c99_layout import Field, Layout
from safeloc.codegen.c99_statuses import FIRST_INPUT_STATUS
from safeloc.errors import InputError
from safeloc.language.interpret import Values, outputs, read_inputs, start, step
from safeloc.language.nodes import INT64_MAX, INT64_MIN, Value

_REFUSED_EVERY = 7
_INT32_MIN, _INT32_MAX, _UINT8_MAX = -(2**31), 2**31 - 1, 255


@dataclass(frozen=True)
class Run:
    """A run for the self-check: inputs by name, step by step; `first` chooses values of variables declared ANY."""

    name: str
    steps: Sequence[Mapping[str, object]]
    first: Mapping[str, Value] | None = None


def vectors(layout: Layout, runs: Sequence[Run]) -> str:
    """Return the text of the vector file. InputError if the interpreter refuses a run, or if no run has a step."""
    if not any(run.steps for run in runs):
        raise InputError(
            f"{layout.system.name}: there are no steps for the self-check; give at least one run with a step."
        )
    lines = [f"# {layout.system.name}: runs as the reference interpreter takes them; written by safeloc."]
    for run in runs:
        lines += _run(layout, run)
    return "\n".join(lines) + "\n"


def _run(layout: Layout, run: Run) -> Iterator[str]:
    system = layout.system
    state = start(system, run.first)
    yield f"# {' '.join(run.name.split())}"
    yield _line("begin", (state[system.variable(field.source)] for field in layout.first))
    shown: Sequence[int] = [0] * len(layout.output_fields)
    for number, record in enumerate(run.steps):
        admitted = read_inputs(system, record)
        inputs = [int(admitted[var]) for var in system.inputs]
        refused = _spoilt(layout, inputs, number // _REFUSED_EVERY) if number % _REFUSED_EVERY == 0 else None
        if refused is not None:
            yield _line("step", [*refused.inputs, refused.status, *shown, *state.values()])
        state, shown = _stepped(layout, state, admitted)
        yield _line("step", [*inputs, 0, *shown, *state.values()])


def _stepped(layout: Layout, state: Values, inputs: Values) -> tuple[Values, list[int]]:
    after, fired = step(layout.system, state, inputs)
    return after, [*map(int, outputs(layout.system, after).values()), *fired.values()]


def _line(word: str, values: Iterable[Value]) -> str:
    return " ".join([word, *(str(int(value)) for value in values)])


@dataclass(frozen=True)
class Refused:
    """Inputs of which one is out of its range, and the status with which they are refused."""

    inputs: tuple[int, ...]
    status: int


def _spoilt(layout: Layout, inputs: Sequence[int], turn: int) -> Refused | None:
    """Return the inputs with one of them just out of range, a different one in each turn; None if no type allows that."""
    able = [place for place, field in enumerate(layout.inputs) if _beyond(field)]
    if not able:
        return None
    place = able[turn % len(able)]
    field, values = layout.inputs[place], dict(zip(layout.inputs, inputs, strict=True))
    wrong = _beyond(field)
    values[field] = wrong[turn // len(able) % len(wrong)]
    for other in layout.inputs:
        if other.name == field.present:
            values[other] = 1
    return Refused(tuple(values.values()), FIRST_INPUT_STATUS + place)


def _beyond(field: Field) -> list[int]:
    """Return the values just outside of the range that the field's type can hold."""
    lowest, highest = {
        "int64_t": (INT64_MIN, INT64_MAX),
        "int32_t": (_INT32_MIN, _INT32_MAX),
        "uint8_t": (0, _UINT8_MAX),
    }[field.kind]
    return [value for value in (field.low - 1, field.high + 1) if lowest <= value <= highest]
