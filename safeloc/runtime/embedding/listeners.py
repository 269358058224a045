"""Listeners of a controller: functions that get each report, and host objects that follow a machine's modes."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from safeloc.errors import InputError
from safeloc.runtime.embedding.follower import Follower
from safeloc.runtime.embedding.program import Program
from safeloc.runtime.embedding.report import Report


class Listeners:
    """All listeners of one controller, called in the order in which they were added."""

    def __init__(self, program: Program) -> None:
        self._machines = {part.name: part.machine for part in program.parts}
        self._listeners: list[Callable[[Report], object]] = []
        self._followers: list[tuple[str, Follower]] = []

    def add(self, listener: Callable[[Report], object]) -> None:
        """Add a function that gets each report."""
        self._listeners.append(listener)

    def follow(self, model: object, machine: str | None, modes: Mapping[str, str]) -> Follower:
        """Make an object of the host follow this machine, starting in its present mode."""
        names = list(self._machines)
        if machine is None and len(names) > 1:
            raise InputError(f"name the machine to follow: one of {', '.join(names)}.")
        name = names[0] if machine is None else machine
        if name not in self._machines:
            raise InputError(f"no machine {name!r} to follow; there are {', '.join(names)}.")
        follower = Follower(self._machines[name], model)
        follower.place(modes[name])
        self._followers.append((name, follower))
        self._listeners.append(lambda report: follower.enter(report.modes[name], report=report))
        return follower

    def place(self, modes: Mapping[str, str]) -> None:
        """Set the followers to the mode of a restored machine, without callbacks."""
        for name, follower in self._followers:
            follower.place(modes[name])

    def tell(self, report: Report) -> None:
        """Call all listeners, even if some of them fail; raise all failures together in an ExceptionGroup."""
        failed: list[Exception] = []
        for listener in self._listeners:
            try:
                listener(report)
            except Exception as error:  # an error of the host, raised below
                failed.append(error)
        if failed:
            raise ExceptionGroup(f"listeners failed after cycle {report.cycle}; the step itself is done", failed)
