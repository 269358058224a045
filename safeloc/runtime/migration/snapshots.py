"""Snapshots: those of this build are accepted unchanged, all others are refused.

A snapshot holds the state of one build of a machine, identified by its digest. Nothing shows that the same numbers have the
same meaning in another build, so a converted snapshot could make a false claim about the world.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from safeloc.errors import InputError, SnapshotError
from safeloc.runtime.embedding import snapshot as controllers
from safeloc.runtime.outside import quoted
from safeloc.runtime.service import saving as processes

Fingerprint = Callable[[str, Mapping[str, Any]], str | None]
"""Machine and configuration -> current digest of that machine; None for a machine that does not ship."""


def is_snapshot(content: object) -> bool:
    """Return whether the content calls itself a snapshot, of a controller or of a process."""
    return isinstance(content, dict) and content.get("kind") in (controllers.KIND, processes.KIND)


def require_current(path: Path, content: Mapping[str, Any], fingerprint: Fingerprint) -> None:
    """Raise SnapshotError if a snapshot is damaged, newer than this version, or of another build of its machine."""
    for of, body in _controllers(path, content):
        machine, program, config = body.get("machine"), body.get("program"), body.get("config")
        if not isinstance(machine, str) or not isinstance(config, dict):
            raise SnapshotError(f"{path}: {of}holds no machine and configuration; start without the snapshot.")
        current = _current_digest(path, machine, config, fingerprint)
        if current is None:
            raise SnapshotError(
                f"{path}: {of}the state of {quoted(machine)}, which is no shipped machine, so it cannot be checked here. Try to "
                "start the machine with it; if it is refused, start without it."
            )
        if current != program:
            raise SnapshotError(
                f"{path}: {of}the state of another build of {quoted(machine)} (digest {quoted(program)}, now "
                f"{quoted(current)}). Its numbers may mean something else here, so it cannot be converted: start without it, or "
                "end the run with the version that wrote it."
            )


def _current_digest(path: Path, machine: str, config: Mapping[str, Any], fingerprint: Fingerprint) -> str | None:
    try:
        return fingerprint(machine, config)
    except InputError as error:
        raise SnapshotError(
            f"{path}: its configuration is not valid now ({error}); start without the snapshot."
        ) from error


def _controllers(path: Path, content: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the snapshot of every controller in it, each with its name for messages."""
    kind = content["kind"]
    version = controllers.VERSION if kind == controllers.KIND else processes.VERSION
    saved = _opened(path, json.dumps(content).encode(), str(kind), version)
    if kind == controllers.KIND:
        yield "", saved
        return
    for name, vehicle in saved.get("vehicles", {}).items():
        if vehicle.get("controller") is not None:
            data = vehicle["controller"].encode()
            yield f"vehicle {quoted(name)}: ", _opened(path, data, controllers.KIND, controllers.VERSION)


def _opened(path: Path, data: bytes, kind: str, version: int) -> dict[str, Any]:
    try:
        return controllers.opened(data, kind, version)
    except SnapshotError as error:
        raise SnapshotError(f"{path}: {error}") from error
