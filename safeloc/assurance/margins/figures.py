"""The figures of a configuration that can be moved, and the same target made with one of them at another value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel, ValidationError

from safeloc.catalogue import ENTRIES, Target
from safeloc.errors import InputError, ModelError, SafelocError, UnforeseenError
from safeloc.language.renamed import hint
from safeloc.own_module import own_target

_FARTHEST = 10
"""A figure without a declared range is moved from 0 to this multiple of its value (from its negative, if it is negative)."""


@dataclass(frozen=True)
class Figure:
    """A whole-number figure of a configuration.

    name  its path, such as "motion.odometer.rate_ppm"
    unit  as declared; "" if nothing is
    low, high  the values that it may have, both included
    """

    name: str
    value: int
    unit: str
    low: int
    high: int


def figures(target: Target) -> dict[str, Figure]:
    """Return the figures of a target by name; InputError for a target without any.

    Of a shipped machine: the whole-number fields of its configuration. Of a user's own: the whole numbers of its
    configuration file.
    """
    if target.spec in ENTRIES and target.config is not None:
        found = list(configured_figures(target.config))
    else:
        found = list(_of_data(target.given or {}))
    if not found:
        raise InputError(
            f"{target.name} has no figure to move: figures are the whole numbers of its configuration; give a machine of your "
            "own with --config FILE."
        )
    return {one.name: one for one in found}


def chosen_figures(target: Target, names: list[str] | None) -> list[Figure]:
    """Return the figures of these names, or all; InputError for a name that the target does not have, with the nearest."""
    known = figures(target)
    unknown = [name for name in names or () if name not in known]
    if unknown:
        raise InputError(
            f"{target.name} has no figure {unknown[0]!r}; it has {', '.join(known)}.{hint(unknown[0], [*known])}"
        )
    return [known[name] for name in known if names is None or name in names]


class Refused(InputError):
    """The configuration, or the machine, does not take a value."""


def moved(target: Target, values: Mapping[str, int]) -> Target:
    """Return the target made with these figures at these values.

    Refused, with the reason, if its configuration or its declaration does not take them. Any other error of the maker is a defect
    of the maker, and no reason why a figure may not move.
    """
    try:
        if target.spec in ENTRIES and target.config is not None:
            entry = ENTRIES[target.spec]
            config = type(target.config).model_validate(_with(target.config.model_dump(), values))
            return entry.make(config)
        return own_target(target.spec, target.config_file, _with(target.given or {}, values))
    except ValidationError as error:
        raise Refused(str(error.errors()[0]["msg"]).removeprefix("Value error, ")) from None
    except (InputError, ModelError) as error:
        if isinstance(error, UnforeseenError) or not isinstance(error.__cause__, SafelocError | ValidationError | None):
            raise
        raise Refused(str(error).splitlines()[-1].strip(" -")) from None


def configured_figures(config: BaseModel, prefix: str = "") -> Iterator[Figure]:
    """Yield the whole-number fields of a configuration, also those of its parts."""
    for name, field in type(config).model_fields.items():
        value = getattr(config, name)
        if isinstance(value, BaseModel):
            yield from configured_figures(value, f"{prefix}{name}.")
        elif isinstance(value, int) and not isinstance(value, bool):
            extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
            limits = {kind: getattr(one, kind) for one in field.metadata for kind in ("ge", "le") if hasattr(one, kind)}
            low, high = _reach(value)
            yield Figure(
                prefix + name, value, str(extra.get("unit", "")), limits.get("ge", low), limits.get("le", high)
            )


def _of_data(data: Mapping[str, Any], prefix: str = "") -> Iterator[Figure]:
    for name, value in data.items():
        if isinstance(value, Mapping):
            yield from _of_data(value, f"{prefix}{name}.")
        elif isinstance(value, int) and not isinstance(value, bool):
            yield Figure(prefix + name, value, "", *_reach(value))


def _reach(value: int) -> tuple[int, int]:
    """Return the values to which a figure without a declared range is moved."""
    return min(0, _FARTHEST * value), max(0, _FARTHEST * value)


def _with(data: Mapping[str, Any], values: Mapping[str, int]) -> dict[str, Any]:
    """Return a copy of nested data with the values at these paths."""
    copy = dict(data)
    for path, value in values.items():
        first, _, rest = path.partition(".")
        copy[first] = _with(copy[first], {rest: value}) if rest else value
    return copy
