"""The cycle length in a configuration: its own field, or the fields of its machines."""

from __future__ import annotations

from pydantic import BaseModel

from safeloc.errors import InputError


def configured_period_ms(name: str, config: BaseModel | None) -> int | None:
    """Return the cycle length of a configuration in ms; None if it has none. InputError if its machines differ."""
    found = periods(config)
    if len(found) > 1:
        raise InputError(f"{name} is configured for cycles of {found} ms at once; make them one.")
    return found[0] if found else None


def periods(config: BaseModel | None) -> list[int]:
    """Return the different cycle lengths: that of the configuration itself, else those of its machines."""
    if config is None:
        return []
    period_ms: int | None = getattr(config, "period_ms", None)
    if period_ms is not None:
        return [period_ms]
    parts = (getattr(config, name) for name in type(config).model_fields)
    return sorted({one for part in parts if isinstance(part, BaseModel) for one in periods(part)})
