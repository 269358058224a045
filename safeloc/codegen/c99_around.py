"""C code around the step: the checked step, the loops over many steps, snapshots, and texts of statuses.

These texts are the same for every machine except for its name, fields and statuses.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.codegen.c99_layout import Field, Layout, literal
from safeloc.codegen.c99_statements import returned
from safeloc.codegen.c99_statuses import statuses
from safeloc.codegen.c99_terms import constant


def _required(layout: Layout, *pointers: str) -> str:
    """Return the statement that refuses a call without one of these pointers."""
    return returned(" || ".join(f"{name} == NULL" for name in pointers), f"{layout.names.upper}_NO_POINTER")


def _sound(layout: Layout) -> str:
    """Return the statements that refuse a state which was not set, or is out of its ranges."""
    return f"    const int32_t status = sound(state);\n{returned(f'status != {layout.names.upper}_OK', 'status')}"


def stepping(layout: Layout) -> str:
    """Return the functions for one checked step, and for the outputs of a state."""
    p, upper = layout.names.prefix, layout.names.upper
    idle = "".join(f"    outputs->{field.name} = 0;\n" for field in layout.fired)
    return f"""int32_t {p}_step({p}_state *state, const {p}_inputs *inputs, {p}_outputs *outputs)
{{
{_required(layout, "state", "inputs", "outputs")}    int32_t status = sound(state);
    if (status == {upper}_OK) {{
        status = judged(inputs);
    }}
{returned(f"status != {upper}_OK", "status")}    advance(state, inputs, outputs);
    show(state, outputs);
    return {upper}_OK;
}}

int32_t {p}_show(const {p}_state *state, {p}_outputs *outputs)
{{
{_required(layout, "state", "outputs")}{_sound(layout)}    show(state, outputs);
{idle}    return {upper}_OK;
}}
"""


def running(layout: Layout) -> str:
    """Return the functions for many steps over rows or over columns; they check each row before its step."""
    p = layout.names.prefix
    gathered = (
        "".join(_gathered(field) for field in layout.inputs)
        or "    (void)inputs;\n    (void)columns;\n    (void)number;\n"
    )
    scattered = "".join(
        f"    if (told->{field.name} != NULL) {{\n        told->{field.name}[number] = outputs->{field.name};\n    }}\n"
        for field in layout.output_fields
    )
    scattered = scattered or "    (void)outputs;\n    (void)told;\n    (void)number;\n"
    return f"""static inline void gather({p}_inputs *inputs, const {p}_input_columns *columns, size_t number)
{{
{gathered}}}

static void scatter(const {p}_outputs *outputs, const {p}_output_columns *told, size_t number)
{{
{scattered}}}

{_loop(layout, "run", f"const {p}_inputs *rows", f"{p}_outputs *told", _ROWS)}
{_loop(layout, "run_columns", f"const {p}_input_columns *columns", f"const {p}_output_columns *told", _COLUMNS)}"""


@dataclass(frozen=True)
class _Source:
    """The source of a loop's inputs and the destination of its outputs."""

    missing: str
    begin: str
    taken: str
    inputs: str
    kept: str


_ROWS = _Source("rows == NULL", "", "", "&rows[number]", "told[number] = outputs;")
_COLUMNS = _Source(
    "columns == NULL{columns}",
    "    const {p}_input_columns read = *columns;\n    {p}_inputs inputs = {{0}};\n",
    "            gather(&inputs, &read, number);\n",
    "&inputs",
    "scatter(&outputs, told, number);",
)


def _loop(layout: Layout, name: str, given: str, results: str, source: _Source) -> str:
    """Return a function with two loops: one without outputs, which does not compute them, and one with outputs."""
    p, upper = layout.names.prefix, layout.names.upper
    columns = "".join(f" || columns->{field.name} == NULL" for field in layout.inputs)
    judging = f"""{source.taken}            status = judged({source.inputs});
            if (status != {upper}_OK) {{
                break;
            }}
            advance(&now, {source.inputs}, &outputs);
"""
    missing = f"state == NULL || done == NULL || {source.missing.format(columns=columns)}"
    return f"""int32_t {p}_{name}({p}_state *state, {given}, {results}, size_t count, size_t *done)
{{
{returned(missing, f"{upper}_NO_POINTER")}    int32_t status = sound(state);
    if (status != {upper}_OK) {{
        *done = 0;
        return status;
    }}
{source.begin.format(p=p)}    {p}_state now = *state;
    {p}_outputs outputs = {{0}};
    size_t number = 0;
    if (told == NULL) {{
        for (; number < count; number++) {{
{judging}        }}
    }} else {{
        for (; number < count; number++) {{
{judging}            show(&now, &outputs);
            {source.kept}
        }}
    }}
    *state = now;
    *done = number;
    return status;
}}
"""


def _gathered(field: Field) -> str:
    """Return the statement that reads one input from its column; it does not read the value of an absent input."""
    value = f"columns->{field.name}[number]"
    if field.present:
        value = f"inputs->{field.present} != 0 ? {value} : {constant(field.absent)}"
    return f"    inputs->{field.name} = {value};\n"


def snapshots(layout: Layout) -> str:
    """Return the functions that save and restore a snapshot, with a checksum over values, not over padding."""
    p, upper = layout.names.prefix, layout.names.upper
    damaged = returned("snapshot->checksum != checksum(&snapshot->state)", f"{upper}_SNAPSHOT_DAMAGED")
    return f"""{_checksum(layout)}
int32_t {p}_save(const {p}_state *state, {p}_snapshot *snapshot)
{{
{_required(layout, "state", "snapshot")}{_sound(layout)}    snapshot->declaration = {upper}_DECLARATION;
    snapshot->checksum = checksum(state);
    snapshot->state = *state;
    return {upper}_OK;
}}

int32_t {p}_restore({p}_state *state, const {p}_snapshot *snapshot)
{{
{_required(layout, "state", "snapshot")}{returned(f"snapshot->declaration != {upper}_DECLARATION", f"{upper}_SNAPSHOT_FOREIGN")}{damaged}    const int32_t status = {p}_check_state(&snapshot->state);
    if (status == {upper}_OK) {{
        *state = snapshot->state;
    }}
    return status;
}}
"""


def _checksum(layout: Layout) -> str:
    """Return the function that adds up the values of a state."""
    p = layout.names.prefix
    mixed = "".join(f"    sum = mixed(sum, (uint64_t)state->{field.name});\n" for field in layout.state)
    return f"""/* FNV-1a over the bytes of a number, the least significant one first. */
static uint64_t mixed(uint64_t sum, uint64_t value)
{{
    for (int shift = 0; shift < 64; shift += 8) {{
        sum = (sum ^ ((value >> shift) & 0xFFU)) * UINT64_C(1099511628211);
    }}
    return sum;
}}

static uint64_t checksum(const {p}_state *state)
{{
    uint64_t sum = mixed(UINT64_C(14695981039346656037), state->declaration);
{mixed}    return sum;
}}
"""


def status_texts(layout: Layout) -> str:
    """Return the function that gives the text of a status."""
    p = layout.names.prefix
    cases = "".join(f"    case {name}:\n        return {literal(text)};\n" for name, _, text in statuses(layout))
    return (
        f"const char *{p}_status_text(int32_t status)\n{{\n    switch (status) {{\n{cases}"
        f'    default:\n        return "no status of {p}";\n    }}\n}}\n'
    )
