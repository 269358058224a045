"""The length of a cycle, as a configuration says it: itself, or the machines it is made of."""

from __future__ import annotations

from pydantic import BaseModel

from safeloc.errors import InputError


def configured_period_ms(name: str, config: BaseModel | None) -> int | None:
    """What the configuration of this machine says; None if nothing. InputError where its parts differ."""
    found = periods(config)
    if len(found) > 1:
        raise InputError(f"{name} is configured for cycles of {found} ms at once; make them one.")
    return found[0] if found else None


def periods(config: BaseModel | None) -> list[int]:
    """What a configuration says of the cycle: itself, or else the configurations of its machines; each figure once."""
    if config is None:
        return []
    own: int | None = getattr(config, "period_ms", None)
    if own is not None:
        return [own]
    parts = (getattr(config, name) for name in type(config).model_fields)
    return sorted({one for part in parts if isinstance(part, BaseModel) for one in periods(part)})
