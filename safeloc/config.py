"""Configuration fields that carry unit, range, default and source."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field


class Config(BaseModel):
    """Base of every configuration: frozen, strict about types, and refusing unknown fields."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


def quantity(default: int, unit: str, low: int, high: int, source: str) -> Any:
    """A whole-number field: `default` in `unit`, low <= value <= high, and where the figure comes from.

    Sources: [S] read in the document named, [D] derived, [M] from memory and therefore only a default.
    """
    return Field(default=default, ge=low, le=high, json_schema_extra={"unit": unit, "source": source})
