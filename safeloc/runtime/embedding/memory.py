"""The memory of a controller between cycles: writing it to a snapshot, and reading it back."""

from __future__ import annotations

import json
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

Whole = Annotated[int, Field(ge=0)]
Delivered = Mapping[str, tuple[int, int | None]]


@dataclass(frozen=True)
class Setting:
    """The arguments of a controller besides its program; a snapshot fits only a controller with equal ones."""

    period_ms: int
    expected: Mapping[str, int]
    first: Mapping[str, Value]


@dataclass(frozen=True)
class Kept:
    """The changing part of a controller's memory; `observed` is what its watch over the assumptions has worked out."""

    start_ms: int
    done: int
    deliveries: Delivered
    state: Row
    halted: str
    observed: Mapping[str, Value] | None = None


def snapshot(program: Program, setting: Setting, kept: Kept) -> bytes:
    """As bytes."""
    return sealed(
        {
            "machine": program.name,
            "config": program.config,
            "program": program.fingerprint,
            "setting": _told(setting),
            "start_ms": kept.start_ms,
            "done": kept.done,
            "deliveries": {channel: list(last) for channel, last in kept.deliveries.items()},
            "state": dict(zip(program.code.state_names, kept.state, strict=True)),
            "halted": kept.halted,
            **({"observed": dict(kept.observed)} if kept.observed else {}),
        }
    )


class Body(BaseModel):
    """The required fields of a snapshot: a correct checksum does not guarantee them."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    kind: str
    version: int
    machine: str
    config: dict[str, Any]
    program: str
    setting: dict[str, Any]
    start_ms: Whole
    done: Whole
    deliveries: dict[str, tuple[Whole, int | None]]
    state: dict[str, bool | int]
    halted: str
    observed: dict[str, bool | int] | None = None


def restored(program: Program, setting: Setting, data: bytes) -> Kept:
    """Read a snapshot; SnapshotError if it does not fit this program and setting."""
    body = _body(opened(data))
    require_same("machine", program.name, body.machine)
    require_same("configuration", program.config, body.config)
    require_same("build of the machine", program.fingerprint, body.program)
    require_same("setting", _told(setting), body.setting)
    observed = None if body.observed is None else _observed(program, body.observed)
    return Kept(body.start_ms, body.done, body.deliveries, _state(program, body.state), body.halted, observed)


def _body(content: Mapping[str, Any]) -> Body:
    try:
        return Body.model_validate_json(json.dumps(content))
    except ValidationError as error:
        found = error.errors(include_url=False, include_input=False, include_context=False)[0]
        where = ".".join(map(str, found["loc"]))
        raise SnapshotError(
            f"a field of the snapshot is wrong ({where}: {found['msg']}); begin anew without it."
        ) from error


def _told(setting: Setting) -> dict[str, Any]:
    return {"period_ms": setting.period_ms, "expected": dict(setting.expected), "first": dict(setting.first)}


def _state(program: Program, values: Mapping[str, object]) -> Row:
    """Each state variable in its range."""
    return tuple(_admitted(program.system.state, values).values())


def _observed(program: Program, values: Mapping[str, object]) -> dict[str, Value]:
    """The same of what a watch over the assumptions remembers."""
    return _admitted(tuple(program.laws.seen.memory), values)


def _admitted(variables: Sequence[Var], values: Mapping[str, object]) -> dict[str, Value]:
    """The values in the order of the variables. A checksum that fits values that do not was not made by this program."""
    if list(values) != sorted(var.name for var in variables):
        raise SnapshotError("the snapshot's state has other variables than the machine; begin anew without it.")
    try:
        return {var.name: admitted(var, values[var.name]) for var in variables}
    except InputError as error:
        raise SnapshotError(
            f"the snapshot's state does not fit this machine ({error}); begin anew without it."
        ) from error
