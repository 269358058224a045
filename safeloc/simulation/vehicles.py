"""Vehicles as data: one TOML file each, read into a VehicleConfig."""

from __future__ import annotations

import tomllib
from pathlib import Path

from pydantic import ValidationError

from safeloc.errors import InputError
from safeloc.runtime.toml_place import line_of, refusal
from safeloc.simulation.motion import VehicleConfig


def load_vehicle(path: Path) -> VehicleConfig:
    """Read a vehicle. InputError with file, line and field for anything wrong in it.

    The table [localization] is for the audit of a line and is not read here.
    """
    text = ""
    try:
        text = path.read_text(encoding="utf-8")
        data = tomllib.loads(text)
        return VehicleConfig.model_validate({key: value for key, value in data.items() if key != "localization"})
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file.") from error
    except RecursionError as error:
        raise InputError(f"{path}: nested too deeply to be a vehicle.") from error
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not TOML ({error}).") from error
    except ValidationError as error:
        raise InputError(refusal(error, lambda place: f"{path}:{line_of(text, place)}")) from error
