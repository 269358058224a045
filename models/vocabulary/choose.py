"""A choice between two groups of terms."""

from __future__ import annotations

from dataclasses import Field, fields, replace
from typing import Any, ClassVar, Protocol, TypeVar

from safeloc.errors import ModelError
from safeloc.language.expr import Bool, Expr, Num, ite


class Group(Protocol):
    """A dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]


Terms = TypeVar("Terms", bound=Group)


def choose(condition: Bool, then: Terms, other: Terms) -> Terms:
    """Return `then` where the condition holds, else `other`, field by field; ModelError for a field that is no term."""
    chosen: dict[str, Expr] = {}
    for one in fields(then):
        match getattr(then, one.name), getattr(other, one.name):
            case (Num() as first, Num() as second):
                chosen[one.name] = ite(condition, first, second)
            case (Bool() as first, Bool() as second):
                chosen[one.name] = ite(condition, first, second)
            case _:
                raise ModelError(
                    f"choose() takes dataclasses of terms, and field {one.name} of {type(then).__name__} is none; leave the "
                    "field out, or write the choice by hand."
                )
    return replace(then, **chosen)
