"""First values of variables: a value in range, or ANY."""

from __future__ import annotations

from typing import Final

from safeloc.language.nodes import Lit, Value


class Any_:
    """The type of ANY, which marks an initial value that may be anything in range."""

    def __repr__(self) -> str:
        return "ANY"

    def __reduce__(self) -> str:
        return "ANY"


ANY: Final = Any_()
Initial = Value | Lit | Any_
