"""The memory of a controller between cycles: writing it to a snapshot, and reading it back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from safeloc.codegen.compiled import Row
from safeloc.errors import InputError, SnapshotError
from safeloc.language.expr import Var
from safeloc.language.interpret import admitted
from safeloc.language.nodes import Value
from safeloc.runtime.embedding.program import Program
from safeloc.runtime.embedding.snapshot import opened, require_same, sealed

_Count = Annotated[int, Field(ge=0)]
_Delivered = Mapping[str, tuple[int, int | None]]


@dataclass(frozen=True)
class Setting:
    """The arguments of a controller besides its program; a snapshot fits only a controller with equal ones."""

    period_ms: int
    expected: Mapping[str, int]
    first: Mapping[str, Value]


@dataclass(frozen=True)
class Content:
    """The changing part of a controller's memory; `observed` is the memory of its watch over the assumptions."""

    start_ms: int
    done: int
    deliveries: _Delivered
    state: Row
    halted: str
    observed: Mapping[str, Value] | None = None


def snapshot(program: Program, setting: Setting, content: Content) -> bytes:
    """Return a snapshot with this content, as bytes."""
    return sealed(
        {
            "setting": _setting_data(setting),
            "start_ms": content.start_ms,
            "done": content.done,
            "deliveries": {channel: list(last) for channel, last in content.deliveries.items()},
            "state": dict(zip(program.code.state_names, content.state, strict=True)),
            "halted": content.halted,
            **({"observed": dict(content.observed)} if content.observed else {}),
        },
        ready=program.identity,
    )


class _Body(BaseModel):
    """The required fields of a snapshot with their types: a correct checksum does not guarantee them."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    kind: str
    version: int
    checksum: str
    machine: str
    config: dict[str, Any]
    program: str
    setting: dict[str, Any]
    start_ms: _Count
    done: _Count
    deliveries: dict[str, tuple[_Count, int | None]]
    state: dict[str, bool | int]
    halted: str
    observed: dict[str, bool | int] | None = None


def restored(program: Program, setting: Setting, data: bytes) -> Content:
    """Read a snapshot; SnapshotError if it does not fit this program and setting."""
    opened(data)
    body = _body(data)
    require_same("machine", program.name, body.machine)
    require_same("configuration", program.config, body.config)
    require_same("build of the machine", program.fingerprint, body.program)
    require_same("setting", _setting_data(setting), body.setting)
    observed = None if body.observed is None else _observed(program, body.observed)
    return Content(body.start_ms, body.done, body.deliveries, _state(program, body.state), body.halted, observed)


def _body(data: bytes) -> _Body:
    try:
        return _Body.model_validate_json(data)
    except ValidationError as error:
        found = error.errors(include_url=False, include_input=False, include_context=False)[0]
        where = ".".join(map(str, found["loc"]))
        raise SnapshotError(
            f"a field of the snapshot is wrong ({where}: {found['msg']}); start without the snapshot."
        ) from error


def _setting_data(setting: Setting) -> dict[str, Any]:
    return {"period_ms": setting.period_ms, "expected": dict(setting.expected), "first": dict(setting.first)}


def _state(program: Program, values: Mapping[str, object]) -> Row:
    """Return the state; SnapshotError for a value out of range."""
    return tuple(_admitted(program.system.state, values).values())


def _observed(program: Program, values: Mapping[str, object]) -> dict[str, Value]:
    """Return the memory of the watch over the assumptions; SnapshotError for a value out of range."""
    return _admitted(tuple(program.laws.seen.memory), values)


def _admitted(variables: Sequence[Var], values: Mapping[str, object]) -> dict[str, Value]:
    """Return the values in the order of the variables. SnapshotError for other names, and for a value out of range."""
    if list(values) != sorted(var.name for var in variables):
        raise SnapshotError("the snapshot's state has other variables than the machine; start without the snapshot.")
    try:
        return {var.name: admitted(var, values[var.name]) for var in variables}
    except InputError as error:
        raise SnapshotError(
            f"the snapshot's state does not fit this machine ({error}); start without the snapshot."
        ) from error
