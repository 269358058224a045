"""A co-simulation unit, loaded as a simulator loads it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from safeloc.language.nodes import Value


class Unit:
    """A unit, loaded as a master loads it."""

    def __init__(self, path: Path, logged: list[str]) -> None:
        fmpy = pytest.importorskip("fmpy", reason="needs fmpy (extra fmi)")
        fmi3 = pytest.importorskip("fmpy.fmi3")
        self.described = fmpy.read_model_description(str(path))
        self.variables = {variable.name: variable for variable in self.described.modelVariables}
        folder = path.with_suffix("")
        if not folder.exists():  # a library that is loaded must not be written over
            fmpy.extract(str(path), str(folder))
        self.slave: Any = fmi3.FMU3Slave(
            guid=self.described.guid,
            unzipDirectory=str(folder),
            modelIdentifier=self.described.coSimulation.modelIdentifier,
            instanceName="one",
        )
        self.slave.instantiate(loggingOn=True, logMessage=lambda _e, _s, _c, message: logged.append(message.decode()))

    def begin(self, first: Mapping[str, Value]) -> None:
        """Through initialization."""
        for name, value in first.items():
            self.set(f"first.{name}", value)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def set(self, name: str, value: Value) -> None:
        """A variable by name."""
        variable = self.variables[name]
        setter = self.slave.setBoolean if variable.type == "Boolean" else self.slave.setInt64
        setter([variable.valueReference], [value])

    def get(self, names: Sequence[str]) -> list[Value]:
        """Variables by name."""
        found = []
        for name in names:
            variable = self.variables[name]
            getter = self.slave.getBoolean if variable.type == "Boolean" else self.slave.getInt64
            found.append(getter([variable.valueReference])[0])
        return found


@contextmanager
def loaded(path: Path, logged: list[str] | None = None) -> Iterator[Unit]:
    """A unit that is freed in the end."""
    unit = Unit(path, [] if logged is None else logged)
    try:
        yield unit
    finally:
        unit.slave.freeInstance()
