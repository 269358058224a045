"""The configuration of a guard, from a vehicle file and the user's choices."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from safeloc.errors import InputError
from safeloc.models.guard.variables import GuardConfig
from safeloc.railway.audit.vehicle import SHIPPED
from safeloc.runtime.outside import quoted
from safeloc.simulation.motion import VehicleConfig
from safeloc.simulation.vehicles import load_vehicle

_STRONGEST_BRAKE_MM_S2 = GuardConfig.model_fields["brake_mm_s2"].default
"""Vehicle files give the service brake; a guard has to allow for the emergency brake."""


def find_vehicle(name: str) -> VehicleConfig:
    """Return a shipped vehicle by name, or one from a file. InputError with file and field for anything wrong in it."""
    shipped = SHIPPED / f"{name}.toml"
    if not shipped.is_file() and not Path(name).is_file():
        known = ", ".join(sorted(path.stem for path in SHIPPED.glob("*.toml")))
        raise InputError(f"{name}: no such file, and no shipped vehicle; shipped are {known}.")
    return load_vehicle(shipped if shipped.is_file() else Path(name))


def guard_config(vehicle: VehicleConfig | None, chosen: Mapping[str, Any] | None = None) -> GuardConfig:
    """Return the configuration for a vehicle; figures in `chosen` replace the vehicle's. InputError for a figure out of range.

    The brake is assumed to be at least 1.5 m/s2, since the vehicle file gives the service brake only.
    """
    figures = {} if vehicle is None else _of(vehicle)
    try:
        return GuardConfig.model_validate({**figures, **(chosen or {})})
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in first["loc"])
        reason = first["msg"].removeprefix("Value error, ")
        got = f" (got {quoted(first['input'])})" if field else ""
        raise InputError(f"guard, {field or 'figures'}: {reason.rstrip('.')}{got}.") from error


def _of(vehicle: VehicleConfig) -> dict[str, int]:
    return {
        "max_speed_mm_s": vehicle.max_speed_mm_s,
        "acceleration_mm_s2": vehicle.acceleration_mm_s2,
        "brake_mm_s2": max(vehicle.brake_mm_s2, _STRONGEST_BRAKE_MM_S2),
    }
