"""Checks of the arguments that a host passes to a controller: a wrong value is refused with a remedy."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from safeloc.errors import InputError
from safeloc.runtime.embedding.cycle_length import configured_period_ms
from safeloc.runtime.embedding.program import Program
from safeloc.target import Target

_Value = TypeVar("_Value")


class NotCopiedError(InputError, TypeError):
    """An attempt to copy a controller: two controllers with the same history would both be wrong."""


def as_program(given: Program | Target) -> Program:
    """Return the program, or make one of the target; InputError for anything else."""
    if isinstance(given, Program):
        return given
    if isinstance(given, Target):
        return Program(given)
    raise InputError(f"expected a Program or a Target, got {type(given).__name__}; load_target(name) gives one.")


def as_expected(given: Mapping[str, int] | None) -> dict[str, int]:
    """Return the expected records, channel -> number per cycle; InputError for a count that is no whole number from 0."""
    expected = a_mapping("expected", given)
    for channel, count in expected.items():
        if type(channel) is not str or type(count) is not int or count < 0:
            raise InputError(
                f"expected has {channel!r}: {count!r}; give a channel and its number of records per cycle."
            )
    return expected


def a_mapping(what: str, given: Mapping[str, _Value] | None) -> dict[str, _Value]:
    """Return a copy of a mapping; an empty one for None, except for `inputs`. InputError for anything else."""
    if given is None and what != "inputs":
        return {}
    if not isinstance(given, Mapping):
        raise InputError(f"{what} is {given!r}; give a mapping of names to values.")
    return dict(given)


def in_words(what: str, given: str) -> str:
    """Return the text; InputError for anything else."""
    if type(given) is not str:
        raise InputError(f"{what} is {given!r}; say it in words.")
    return given


def period_of(program: Program, given: int | None) -> int:
    """Return the cycle length: that of the configuration, else `given`. InputError if there is none, or if they differ."""
    configured = configured_period_ms(program.name, program.target.config)
    period_ms = given if configured is None else configured
    if period_ms is None:
        raise InputError(
            f"the configuration of {program.name} has no cycle length; give period_ms, on the command line --period-ms."
        )
    if type(period_ms) is not int or type(given) not in (int, type(None)):
        raise InputError(f"period_ms is {given!r}; give whole ms.")
    if given not in (None, period_ms):
        raise InputError(
            f"{program.name} is configured for cycles of {period_ms} ms, not {given} ms; change one of them."
        )
    return period_ms
