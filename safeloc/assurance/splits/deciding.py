"""Search for the configured figure that makes a folded split live: each figure is changed alone, and the machine built.

A figure that cannot be changed alone, because others contradict it, is skipped.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from safeloc.assurance.splits.live_splits import Splits, splits_of
from safeloc.assurance.splits.observed import Split
from safeloc.errors import SafelocError
from safeloc.target import Entry


@dataclass(frozen=True)
class Change:
    """One figure of a configuration with another value."""

    figure: str
    value: object

    def __str__(self) -> str:
        return f"{self.figure} = {self.value}"


def changes(config: BaseModel, prefix: str = "") -> Iterator[Change]:
    """Yield other values of every figure: the other flag or name; of a number, neighbours, double, half, and the limits."""
    for name, field in type(config).model_fields.items():
        value = getattr(config, name)
        if isinstance(value, BaseModel):
            yield from changes(value, f"{prefix}{name}.")
        else:
            yield from (Change(prefix + name, other) for other in _others(value, field))


def _others(value: object, field: FieldInfo) -> Iterator[object]:
    if isinstance(value, bool):
        yield not value
    elif isinstance(value, str):
        yield from (other for other in get_args(field.annotation) if other != value)
    elif isinstance(value, int):
        limits = [getattr(rule, end) for rule in field.metadata for end in ("ge", "le") if hasattr(rule, end)]
        likely = [value + 1, value * 2, value // 2, *limits]
        yield from dict.fromkeys(one for one in likely if one != value and _inside(one, limits))


def _inside(value: int, limits: list[int]) -> bool:
    return len(limits) != 2 or limits[0] <= value <= limits[1]


def changed(config: BaseModel, change: Change) -> BaseModel:
    """Return the configuration with the change; ValidationError if other figures contradict it."""
    plain = config.model_dump()
    at = plain
    *groups, name = change.figure.split(".")
    for group in groups:
        at = at[group]
    at[name] = change.value
    return type(config).model_validate(plain)


def deciding(
    entry: Entry[Any], config: BaseModel, dead: Splits, on_change: Callable[[Change], None] = lambda _: None
) -> dict[Split, Change]:
    """Return, for each split that is dead in this configuration, the first change of one figure that makes it live."""
    found: dict[Split, Change] = {}
    for change in changes(config):
        on_change(change)
        live = _live(entry, config, change)
        for split in dead.dead:
            if split in live:
                found.setdefault(split, change)
    return found


def _live(entry: Entry[Any], config: BaseModel, change: Change) -> frozenset[Split]:
    """Return the live splits with the change; none if the machine cannot be built."""
    try:
        other = changed(config, change)
        return splits_of(lambda: entry.make(other)).live
    except (ValidationError, SafelocError):
        return frozenset()
