"""Configurations, whose fields have a unit, a range, a default and a source."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, model_validator


class Config(BaseModel):
    """Base of every configuration: it is frozen, checks types strictly, and refuses unknown fields."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class CompositionConfig(Config):
    """Base of the configuration of a composition: a table of a machine that is given in part keeps the figures that the composition has for it."""

    @model_validator(mode="before")
    @classmethod
    def _parts_keep_their_figures(cls, given: object, info: ValidationInfo) -> object:
        if not isinstance(given, Mapping):
            return given
        read = _tupled(given) if info.mode == "json" else given
        return {name: _filled(_default(cls, name), value) for name, value in read.items()}


def _tupled(given: Any) -> Any:
    """Return data of JSON with its lists as tuples: what a validator returns is checked as strictly as Python's own data."""
    if isinstance(given, Mapping):
        return {name: _tupled(value) for name, value in given.items()}
    return tuple(_tupled(value) for value in given) if isinstance(given, list) else given


def _default(kind: type[BaseModel], name: object) -> object:
    field = kind.model_fields.get(name) if isinstance(name, str) else None
    return None if field is None else field.default


def _filled(default: object, given: object) -> object:
    """Return a table with the figures of the default that it does not give; anything else as it is."""
    if not isinstance(default, BaseModel) or not isinstance(given, Mapping):
        return given
    usual = {name: getattr(default, name) for name in type(default).model_fields}
    return {**usual, **{name: _filled(usual.get(name), value) for name, value in given.items()}}


@dataclasses.dataclass(frozen=True)
class Configurations:
    """Further configurations in which a machine is proved, for the cases that its defaults fold away (safeloc.assurance.splits).

    named  name -> configuration
    never  splits that no configuration makes live, as "file: source text" -> the reason why none is needed
    """

    named: Mapping[str, BaseModel] = dataclasses.field(default_factory=dict)
    never: Mapping[str, str] = dataclasses.field(default_factory=dict)


def quantity(default: int, unit: str, low: int, high: int, source: str) -> Any:
    """Declare a whole-number field with default, unit, range (low <= value <= high) and the source of its figure.

    A source begins with [S] for a document that was read, [D] for a derivation, [M] for memory, thus only a default.
    """
    return Field(default=default, ge=low, le=high, json_schema_extra={"unit": unit, "source": source})


class Derived(property):
    """A figure computed from the fields of its configuration; reports list it after the fields."""

    unit: str
    source: str


def derived(unit: str, source: str) -> Callable[[Callable[[Any], int]], Derived]:
    """Return a decorator that turns a method of a configuration into a derived figure in `unit`; `source` explains it."""

    def made(compute: Callable[[Any], int]) -> Derived:
        figure = Derived(compute)
        figure.unit, figure.source = unit, source
        return figure

    return made


def derived_figures(config: BaseModel) -> Iterator[tuple[str, Derived]]:
    """Yield every derived figure of a configuration with its name."""
    for kind in reversed(type(config).__mro__):
        yield from ((name, value) for name, value in vars(kind).items() if isinstance(value, Derived))


def figures(config: BaseModel, prefix: str = "", usual: BaseModel | None = None) -> Iterator[dict[str, str]]:
    """Yield name, value, unit and source of every figure of a configuration: its fields, then its derived figures.

    usual  the configuration by default, of a part for which the whole has other defaults than the part's class
    """
    for name, field in type(config).model_fields.items():
        value = getattr(config, name)
        usually = field.get_default(call_default_factory=True, validated_data={})
        default = usually if usual is None else getattr(usual, name)
        if isinstance(value, BaseModel):
            yield from figures(value, f"{prefix}{name}.", default if isinstance(default, type(value)) else None)
            continue
        extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
        source = str(extra.get("source", field.description or ""))
        if field.is_required() and usual is None:
            pass
        elif value != default:
            source = f"set here; the default is {default} {source}"
        elif not field.is_required() and value != usually:
            source = f"the default here, elsewhere {usually} {source}"
        yield {"name": prefix + name, "value": str(value), "unit": str(extra.get("unit", "")), "source": source}
    for name, figure in derived_figures(config):
        value, source = getattr(config, name), f"follows from the figures above: {figure.source}"
        yield {"name": prefix + name, "value": str(value), "unit": figure.unit, "source": source}
