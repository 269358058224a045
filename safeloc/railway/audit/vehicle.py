"""The vehicle's figures for the audit: table `[localization]` of a vehicle file, or a file with nothing else."""

from __future__ import annotations

import tomllib
from pathlib import Path

from pydantic import ValidationError

from safeloc.errors import InputError
from safeloc.models.layout_rules import LayoutConfig
from safeloc.runtime.toml_place import line_of, refusal

SHIPPED = Path(__file__).resolve().parents[2] / "models" / "vehicles"
_TABLE = "localization"


def find_layout(name: str) -> LayoutConfig:
    """Return the figures of a shipped vehicle by name, or of a file. InputError with line and key for anything wrong in it."""
    shipped = {path.stem: path for path in sorted(SHIPPED.glob("*.toml"))}
    if name not in shipped and not Path(name).is_file():
        raise InputError(f"{name}: no such file, and no shipped vehicle; shipped are {', '.join(shipped)}.")
    path = shipped.get(name, Path(name))
    try:
        text = path.read_text(encoding="utf-8")
        data = tomllib.loads(text)
    except RecursionError as error:
        raise InputError(f"{path}: nested too deeply to be a vehicle.") from error
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"{path}: cannot be read: {error}.") from error
    return _layout(path, text, data)


def _layout(path: Path, text: str, data: dict[str, object]) -> LayoutConfig:
    if _TABLE not in data:
        raise InputError(f"{path}: has no table [{_TABLE}] with the figures for the audit (docs/line.md lists them).")
    try:
        return LayoutConfig.model_validate(data[_TABLE])
    except ValidationError as error:
        raise InputError(refusal(error, lambda place: f"{path}:{line_of(text, place)}", (_TABLE,))) from error
