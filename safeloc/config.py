"""Configuration fields that carry unit, range, default and source."""

from __future__ import annotations

from collections.abc import Callable, Iterator
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


class Derived(property):
    """A figure that follows from the fields of its configuration; reports show it beside them."""

    unit: str
    source: str


def derived(unit: str, source: str) -> Callable[[Callable[[Any], int]], Derived]:
    """Makes a method of a configuration a figure in `unit`, and says what it is."""

    def made(compute: Callable[[Any], int]) -> Derived:
        figure = Derived(compute)
        figure.unit, figure.source = unit, source
        return figure

    return made


def derived_figures(config: BaseModel) -> Iterator[tuple[str, Derived]]:
    """Name and figure of everything that follows from a configuration's fields."""
    for kind in reversed(type(config).__mro__):
        yield from ((name, value) for name, value in vars(kind).items() if isinstance(value, Derived))
