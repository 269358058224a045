"""Renamed keywords, variables and outputs. An old name is refused, and the message gives the new one."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import wraps
from typing import Any, TypeVar, cast

from safeloc.errors import SafelocError, declared_at

Declaring = TypeVar("Declaring", bound=Callable[..., Any])

SIDES = {"over": "margin_above", "under": "margin_below"}
"""The sides of an interval: `over` was ETCS's under-reading amount, and `under` its over-reading amount."""
FIELDS = {"mute_limit_cycles": "mute_ms", "integrity_limit_cycles": "integrity_wait_ms"}
"""Fields of configurations; their figure was a number of cycles, and is a time."""
PARTED = {
    "fix_protection_mm": ("fix_dilution_permille", "fix_further_mm"),
    "fix_speed_protection_um_s": ("fix_speed_dilution_permille", "fix_speed_further_um_s"),
}
"""Inputs that are told in two parts now, since the machine charges the rest itself. The old figure says neither part."""
_SIDE = re.compile(rf"(?<![A-Za-z])({'|'.join(SIDES)})(?=_(?:mm|nm)$)")


def name_now(name: str) -> str:
    """Return what a variable or an output of that name is called now: `fibre_margin_above_mm` for `fibre_over_mm`."""
    return _SIDE.sub(lambda found: SIDES[found[1]], name)


def renamed(names: Iterable[str], known: Collection[str]) -> str:
    """Return `; 'over_mm' is now 'margin_above_mm'` for each former name of one of `known`, to be appended; else ""."""
    former = [name for name in sorted(names) if name not in known]
    pairs = ((name, name_now(name)) for name in former)
    told = "".join(f"; {name!r} is now {new!r}" for name, new in pairs if new in known)
    apart = ((name, parts) for name in former if (parts := parted(name)) and parts[0] in known)
    return told + "".join(f"; {name!r} is told as {' and '.join(map(repr, parts))} now" for name, parts in apart)


def parted(name: str) -> tuple[str, ...]:
    """Return the inputs that have taken the place of a former one; none where none have."""
    machine, dot, bare = name.rpartition(".")
    return tuple(machine + dot + part for part in PARTED.get(bare, ()))


def hint(name: str, known: Collection[str]) -> str:
    """Return a sentence that suggests the nearest known name, to be appended; "" where nothing is near."""
    told = renamed([name], known)
    if told:
        return f" {told.removeprefix('; ')}."
    close = difflib.get_close_matches(name, known, n=1)
    return f" Did you mean {close[0]!r}?" if close else ""


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


def _remedy(old: str, new: str) -> str:
    """Return the text to write instead: another keyword, or a complete argument."""
    if "=" in new:
        return f"there is no keyword {old!r} any more; write {new}."
    return f"the keyword {old!r} is now {new!r}; write {new}=."


def _guarded(call: Any, name: str, error: type[SafelocError], renamed: Mapping[str, str]) -> Any:
    @wraps(call)
    def guarded(*values: Any, **named: Any) -> Any:
        for old, new in renamed.items():
            if old in named:
                raise error(f"{declared_at()}: {name}: {_remedy(old, new)}")
        return call(*values, **named)

    return guarded
