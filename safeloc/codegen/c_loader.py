"""Generated C, loaded into Python by ctypes: the same machine, as fast as C runs it.

machine = load_c(without_ghosts(system))
outputs = machine.step({"movement": 100})            by name, checked as the interpreter checks
rows = machine.rows(records)                         many steps, packed once
machine.run(rows)                                    and run in one call
"""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from safeloc.codegen.c99 import library_texts
from safeloc.codegen.c99_build import build
from safeloc.codegen.c99_layout import Field, Layout, layout_of
from safeloc.errors import InputError
from safeloc.language.expr import Bool, BoolVar, Var
from safeloc.language.interpret import fired_names, read_inputs, start
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem

_CTYPES: Mapping[str, Any] = {"int64_t": ctypes.c_int64, "int32_t": ctypes.c_int32, "uint8_t": ctypes.c_uint8}


def load_c(
    system: TransitionSystem,
    *,
    folder: Path | None = None,
    cc: str | None = None,
    first: Mapping[str, Value] | None = None,
    kept: Mapping[str, Bool] | None = None,
) -> CMachine:
    """Load the system, without ghosts, as compiled C in its first state.

    folder  stores libraries for later use; the default is a temporary folder
    cc      the C compiler; the default is $CC, cc, gcc or clang
    first   values of state variables declared ANY
    kept    invariants, proved by `safeloc.proof.provers.lasting`, that `put` and `restore` check besides the ranges

    EngineError if there is no compiler; InputError if the system cannot run in C, or `first` is not admissible.
    """
    layout = layout_of(system, kept)
    if folder is not None:
        return CMachine(layout, build(library_texts(layout), folder, layout.names.prefix, cc=cc), first)
    with tempfile.TemporaryDirectory() as place:  # a loaded library does not need its file any more
        return CMachine(layout, build(library_texts(layout), Path(place), layout.names.prefix, cc=cc), first)


@dataclass(frozen=True)
class Columns:
    """The inputs of `count` steps: an array for each input, stored beside the pointers so that it stays alive."""

    count: int
    arrays: tuple[ctypes.Array[Any], ...]
    pointers: ctypes.Structure


class CMachine:
    """One machine with its state, in C. Only one thread may use it at a time; two machines of one library share nothing."""

    def __init__(self, layout: Layout, library: Path, first: Mapping[str, Value] | None = None) -> None:
        self.layout, self.system = layout, layout.system
        self._library = ctypes.CDLL(str(library))
        self._state = _state(layout)()
        self._inputs, self._outputs = (_structure(fields)() for fields in (layout.inputs, layout.output_fields))
        self._input_columns = _pointers(layout.inputs)
        self._snapshot = _snapshot(type(self._state))
        self._function("status_text").restype = ctypes.c_char_p
        self.reset(first)

    def reset(self, first: Mapping[str, Value] | None = None) -> None:
        """Return to the first state; InputError as in `interpret.start`."""
        values = start(self.system, first)
        given = [ctypes.byref(self._state)]
        if self.layout.first:
            chosen = _structure(self.layout.first)()
            _fill(chosen, self.layout.first, [values[self.system.variable(f.source)] for f in self.layout.first])
            given.append(ctypes.byref(chosen))
        self._call("init", *given)

    def step(self, record: Mapping[str, object]) -> dict[str, Value]:
        """Run one step from inputs by name; return its outputs. After an InputError (see `interpret.read_inputs`) the state is unchanged."""
        _fill(self._inputs, self.layout.inputs, self._ordered(record))
        self._call("step", *map(ctypes.byref, (self._state, self._inputs, self._outputs)))
        return self._named(self._outputs)

    @property
    def fired(self) -> dict[str, str]:
        """Names of the transitions that fired in the last step, by fired variable."""
        numbers = [int(getattr(self._outputs, field.name)) for field in self.layout.fired]
        return fired_names(dict(zip(self.system.fired, numbers, strict=True)))

    @property
    def state(self) -> dict[str, Value]:
        """The state by name."""
        return dict(zip((var.name for var in self.system.state), self._values(), strict=True))

    def put(self, state: Mapping[str, Value]) -> None:
        """Set the state, given completely by name; InputError, and no change, if `check_state` refuses it."""
        fields = self.layout.state
        if state.keys() != {field.source for field in fields}:
            raise InputError(
                f"{self.system.name}: the state has other names than the machine; give a value for each of its variables, and "
                "no others."
            )
        wanted = type(self._state)(declaration=self._state.declaration)
        _fill(wanted, fields, [state[field.source] for field in fields])
        self._call("check_state", ctypes.byref(wanted))
        self._state = wanted

    def rows(self, records: Sequence[Mapping[str, object]]) -> ctypes.Array[Any]:
        """Return the inputs of many steps as an array of C structures; InputError as for `step`."""
        rows: ctypes.Array[Any] = (type(self._inputs) * len(records))()
        for row, record in zip(rows, records, strict=True):
            _fill(row, self.layout.inputs, self._ordered(record))
        return rows

    def run(self, rows: ctypes.Array[Any]) -> None:
        """Run all steps in one call, without outputs. InputError, with the row, if C refuses inputs."""
        self._ran("run", rows, None, len(rows))

    def history(self, rows: ctypes.Array[Any]) -> list[dict[str, Value]]:
        """Run all steps in one call; return the outputs of every step. InputError as for `run`."""
        outputs = (type(self._outputs) * len(rows))()
        self._ran("run", rows, outputs, len(rows))
        return [self._named(row) for row in outputs]

    def columns(self, arrays: Sequence[ctypes.Array[Any]]) -> Columns:
        """Return the columns for `run_columns`, from an array for each field of `layout.inputs`, of its type; InputError if
        types or lengths differ. Ranges are checked by `run_columns`."""
        lengths = {len(array) for array in arrays}
        kinds = [array._type_ for array in arrays]
        if kinds != [_CTYPES[field.kind] for field in self.layout.inputs] or len(lengths) > 1:
            wanted = ", ".join(f"{field.name}: {field.kind}" for field in self.layout.inputs)
            raise InputError(f"{self.system.name}: give columns as arrays of equal length, {wanted}.")
        return Columns(max(lengths, default=0), tuple(arrays), _filled(self._input_columns, arrays))

    def run_columns(self, columns: Columns) -> None:
        """Run all steps as `run` does, from columns: faster for a machine with few inputs."""
        self._ran("run_columns", ctypes.byref(columns.pointers), None, columns.count)

    def save(self) -> bytes:
        """Return a snapshot of the state, with the declaration's digest and a checksum."""
        snapshot = self._snapshot()
        self._call("save", ctypes.byref(self._state), ctypes.byref(snapshot))
        return bytes(snapshot)

    def restore(self, saved: bytes) -> None:
        """Restore the state of a snapshot; InputError, and no change, if it is damaged or of another declaration."""
        snapshot = self._snapshot()
        if len(saved) != ctypes.sizeof(snapshot):
            raise InputError(
                f"{self.system.name}: the snapshot has {len(saved)} bytes, expected {ctypes.sizeof(snapshot)}; it is damaged "
                "or of another machine."
            )
        ctypes.memmove(ctypes.byref(snapshot), saved, len(saved))
        self._call("restore", ctypes.byref(self._state), ctypes.byref(snapshot))

    def _ran(self, name: str, inputs: Any, outputs: Any, count: int) -> None:
        done = ctypes.c_size_t()
        state = ctypes.byref(self._state)
        status = self._function(name)(state, inputs, outputs, ctypes.c_size_t(count), ctypes.byref(done))
        if status:
            raise InputError(f"{self.system.name}: row {done.value}: {self._text(status)}.")

    def _ordered(self, record: Mapping[str, object]) -> list[Value]:
        values = read_inputs(self.system, record)
        return [values[var] for var in self.system.inputs]

    def _values(self) -> list[Value]:
        return [_as_declared(var, getattr(self._state, field.name)) for var, field in self._states()]

    def _states(self) -> zip[tuple[Var, Field]]:
        return zip(self.system.state, self.layout.state, strict=True)

    def _named(self, structure: Any) -> dict[str, Value]:
        values = {field.source: getattr(structure, field.name) for field in self.layout.outputs}
        truths = {field.source for field in self.layout.outputs if field.kind == "uint8_t"}
        return {name: bool(value) if name in truths else int(value) for name, value in values.items()}

    def _call(self, name: str, *arguments: Any) -> None:
        status = self._function(name)(*arguments)
        if status:
            raise InputError(f"{self.system.name}: {self._text(status)}.")

    def _text(self, status: int) -> str:
        text: bytes = self._function("status_text")(status)
        return text.decode("utf-8")

    def _function(self, name: str) -> Any:
        return getattr(self._library, f"{self.layout.names.prefix}_{name}")


def _structure(fields: Sequence[Field]) -> type[ctypes.Structure]:
    """Return the structure type that the header declares."""
    declared = [(field.name, _CTYPES[field.kind]) for field in fields] or [("nothing", ctypes.c_uint8)]
    return type("Structure", (ctypes.Structure,), {"_fields_": declared})


def _state(layout: Layout) -> type[ctypes.Structure]:
    """Return the type of the state that the header declares: the mark that it was set, then the variables."""
    fields = [("declaration", ctypes.c_uint64), *_structure(layout.state)._fields_]
    return type("State", (ctypes.Structure,), {"_fields_": fields})


def _pointers(fields: Sequence[Field]) -> type[ctypes.Structure]:
    """Return the type of the structure of columns that the header declares."""
    declared = [(field.name, ctypes.POINTER(_CTYPES[field.kind])) for field in fields] or [("nothing", ctypes.c_uint8)]
    return type("Columns", (ctypes.Structure,), {"_fields_": declared})


def _filled(kind: type[ctypes.Structure], arrays: Sequence[ctypes.Array[Any]]) -> ctypes.Structure:
    """Return the structure of columns with pointers to the arrays."""
    return kind(
        *(ctypes.cast(array, cast("type[Any]", field[1])) for array, field in zip(arrays, kind._fields_, strict=False))
    )


def _snapshot(state: type[ctypes.Structure]) -> type[ctypes.Structure]:
    fields = [("declaration", ctypes.c_uint64), ("checksum", ctypes.c_uint64), ("state", state)]
    return type("Snapshot", (ctypes.Structure,), {"_fields_": fields})


def _fill(structure: ctypes.Structure, fields: Sequence[Field], values: Sequence[Value]) -> None:
    for field, value in zip(fields, values, strict=True):
        setattr(structure, field.name, int(value))


def _as_declared(var: Var, value: int) -> Value:
    return bool(value) if isinstance(var, BoolVar) else int(value)
