"""The localizer as a host's object: the controller of the target with all methods of locating (RFL-13, RFL-14)."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.errors import InputError
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer.target import LOCALIZER
from safeloc.runtime.embedding.controller import Controller
from safeloc.runtime.embedding.program import Program


def localizer_program(config: LocalizerConfig | None = None) -> Program:
    """Return the compiled localizer. This takes seconds, so make one program for all vehicles of the same configuration."""
    return Program(LOCALIZER.make(config or LocalizerConfig()))


class Localizer(Controller):
    """One vehicle's localizer, cycle by cycle; see Controller.

    vehicle   its configuration, or a program made by `localizer_program`

    A device without records in a cycle gives no input; the configuration can leave out entire sources.
    """

    def __init__(
        self,
        vehicle: LocalizerConfig | Program | None = None,
        *,
        start_ms: int = 0,
        expected: Mapping[str, int] | None = None,
    ) -> None:
        if not (vehicle is None or isinstance(vehicle, LocalizerConfig | Program)):
            raise InputError(f"expected a LocalizerConfig or a Program, got {type(vehicle).__name__}.")
        program = vehicle if isinstance(vehicle, Program) else localizer_program(vehicle)
        super().__init__(program, start_ms=start_ms, expected=expected)
