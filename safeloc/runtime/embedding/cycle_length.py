"""The cycle length in a configuration: its own field, or those of its machines."""

from __future__ import annotations

from pydantic import BaseModel

from safeloc.errors import InputError


def configured_period_ms(name: str, config: BaseModel | None) -> int | None:
    """Return the cycle length in the configuration; None if it has none. InputError if its machines differ."""
    found = periods(config)
    if len(found) > 1:
        raise InputError(f"{name} is configured for cycles of {found} ms at once; make them one.")
    return found[0] if found else None


def periods(config: BaseModel | None) -> list[int]:
    """List the different cycle lengths: the configuration's own, or else those of its machines."""
    if config is None:
        return []
    own: int | None = getattr(config, "period_ms", None)
    if own is not None:
        return [own]
    parts = (getattr(config, name) for name in type(config).model_fields)
    return sorted({one for part in parts if isinstance(part, BaseModel) for one in periods(part)})
