"""Keywords that have another name now: the old one is refused, and the message says the new one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import wraps
from typing import Any, TypeVar, cast

from safeloc.errors import SafelocError, declared_at

Declaring = TypeVar("Declaring", bound=Callable[..., Any])


def refuse_old_keywords(error: type[SafelocError], renamed: Mapping[str, str]) -> Callable[[Declaring], Declaring]:
    """Let a function or a class raise `error`, with file and line, where it is called with an old name of `renamed`."""

    def refusing(declaring: Declaring) -> Declaring:
        made: Any = declaring
        name = made.__name__
        if isinstance(declaring, type):
            made.__init__ = _guarded(made.__init__, name, error, renamed)
        else:
            made = _guarded(made, name, error, renamed)
        return cast("Declaring", made)

    return refusing


def _guarded(call: Any, name: str, error: type[SafelocError], renamed: Mapping[str, str]) -> Any:
    @wraps(call)
    def guarded(*values: Any, **named: Any) -> Any:
        for old, new in renamed.items():
            if old in named:
                raise error(f"{declared_at()}: {name}: the keyword {old!r} is now {new!r}; write {new}=.")
        return call(*values, **named)

    return guarded
