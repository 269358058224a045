"""A machine as a script for a browser, or for node: it runs step by step, and explains each step.

    javascript(system)  ->  '(()=>{"use strict"; ... safelocMachine("odometry", machineOf(...))})()'

The script is classic (no module, no import) and needs one function, `safelocMachine(name, machine)`, which whoever loads it has
defined before. It stands in a page as it is, and is ASCII. docs/export.md tells what the machine does.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from safeloc.codegen.javascript_code import moving, shown, state_names, values_of
from safeloc.codegen.javascript_parts import Parts
from safeloc.codegen.javascript_tables import tables
from safeloc.errors import InputError
from safeloc.language.first_values import Any_
from safeloc.language.interpret import start
from safeloc.language.nodes import Past, Value
from safeloc.language.ranges import beyond_int64
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.language.terms import in_order

_HERE = Path(__file__).parent
_COMMON = "{machineOf,down,fits}"
STREAM_SCHEMA = "safeloc-stream/1"
"""The form of the streams that the machine writes; `safeloc.runtime.streams.steps` reads it."""


def javascript(
    system: TransitionSystem,
    *,
    first: Mapping[str, Value] | None = None,
    test: Sequence[str] = (),
    properties: Sequence[Property] = (),
    with_common: bool = True,
) -> str:
    """Return the text of the script, with ghosts and laws of the world if the system has them.

    first  values for variables whose first value is open, which its `first()` takes where its caller chooses none; without
           them those nearest to zero, which `initially` may exclude
    test   the text of a test file in four pieces, between which first values, steps and fired transitions come
           (`safeloc.explain.pytest_file.run_file_pieces`); without it the machine writes no tests

    properties  what the machine monitors; those about runs as a whole (`reachable`) and those that read what the system does not
                have are left out

    with_common
                with the text that all machines have in common; without it whoever loads the script has defined `safelocCommon`
                (`common`)

    A system whose terms might exceed 64 bits is not refused: its step throws an Error where one does.
    InputError for past operators, for a composition without its parts, and for a first value that is refused.
    """
    chosen = {} if first is None else _open_values(system, first)
    terms = [*system.next.values(), *system.fired.values(), *system.outputs.values(), system.init]
    if any(isinstance(node, Past) for node in in_order(terms)):
        raise InputError(f"{system.name}: past operators cannot run; `observe` the property first.")
    if len(system.machines) > 1 and not system.parts:
        raise InputError(f"{system.name}: a composition without its parts cannot be explained; use on_board(system).")
    checked, parts = bool(beyond_int64(terms)), Parts(system)
    every = {**tables(parts, chosen, properties), "test": list(test), "schema": STREAM_SCHEMA}
    data = json.dumps(every, separators=(",", ":")).replace("<", "\\u003c")
    functions = (
        moving(system, checked=checked),
        shown(system, checked=checked),
        f"s=>{values_of([system.init], state_names(system))}",
    )
    name = json.dumps(system.name).replace("<", "\\u003c")
    made = f"machineOf({data},{','.join(functions)})"
    every_machine = _common() if with_common else f"const {_COMMON}=safelocCommon;"
    return f'(()=>{{"use strict";\n{every_machine}safelocMachine({name},{made})}})();\n'


def common() -> str:
    """Return the text that all machines have in common, as an expression whose value is `safelocCommon`."""
    return f"(() => {{\n{_common()}return {_COMMON};\n}})()"


def on_board(system: TransitionSystem) -> TransitionSystem:
    """Return the system that runs on board, with its parts: guards and named terms read no ghosts."""
    return replace(without_ghosts(system), parts=system.parts)


def _open_values(system: TransitionSystem, first: Mapping[str, Value]) -> dict[str, Value]:
    """Return the first values of those variables whose first value is open."""
    values = start(system, first)
    return {var.name: value for var, value in values.items() if isinstance(system.initial[var], Any_)}


def _common() -> str:
    """Return what every machine needs, without remarks and indentation."""
    both = "".join((_HERE / f"{name}.js").read_text(encoding="utf-8") for name in ("machine_terms", "machine"))
    lines = (line.strip() for line in both.splitlines())
    return "".join(f"{line}\n" for line in lines if line and not line.startswith("//"))
