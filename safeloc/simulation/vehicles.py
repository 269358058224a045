"""Vehicles as data: one TOML file each, read into a VehicleConfig."""

from __future__ import annotations

import tomllib
from pathlib import Path

from pydantic import ValidationError

from safeloc.errors import InputError
from safeloc.runtime.outside import quoted
from safeloc.simulation.motion import VehicleConfig


def load_vehicle(path: Path) -> VehicleConfig:
    """Read a vehicle. InputError with file and field for anything wrong in it.

    The table [localization] is for the audit of a line and is not read here.
    """
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        return VehicleConfig.model_validate({key: value for key, value in data.items() if key != "localization"})
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file.") from error
    except RecursionError as error:
        raise InputError(f"{path}: nested too deeply to be a vehicle.") from error
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not TOML ({error}).") from error
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(str(part) for part in first["loc"])
        reason = first["msg"].removeprefix("Value error, ").rstrip(".")
        told = f"field {field}: {reason} (got {quoted(first['input'])})" if field else reason
        raise InputError(f"{path}: {told}.") from error
