"""Errors of safeloc. Each message says what is wrong, where (file and line), and what to do.

SafelocError
├── ModelError             a declaration is wrong
│   ├── UnitError          ... its units do not fit (also a TypeError)
│   └── TruthValueError    ... a symbolic term was used as a Python value (also a TypeError)
├── InputError             a value given to a machine is wrong (also a ValueError)
│   ├── StreamError        ... in a stream, with its file and line
│   ├── SnapshotError      ... a snapshot that is damaged, or of something else
│   └── UnforeseenError    ... in a way that safeloc was not ready for: refused, and a defect of safeloc to be reported
├── PropertyError          a property cannot be checked on this machine or trace
├── EngineError            a solver or back end gave an impossible answer, or is missing
└── NotProvedError         a verdict that was required to be Proved is not
"""

from __future__ import annotations

import sys

_USER_PACKAGES = ("safeloc.models", "safeloc.properties")


class SafelocError(Exception):
    """Root of every error that safeloc raises on purpose."""


class ModelError(SafelocError):
    """A machine, transition, property or composition is declared wrongly."""


class UnitError(ModelError, TypeError):
    """Terms of different units or kinds were combined."""


class TruthValueError(ModelError, TypeError):
    """A symbolic term was used where Python needs a value."""


class InputError(SafelocError, ValueError):
    """A value handed to a machine is missing, unknown, of the wrong type or out of range."""


class StreamError(InputError):
    """A recorded stream cannot be read; the message names file and line."""


class SnapshotError(InputError):
    """A snapshot does not fit: it is damaged, newer, or of another machine or configuration."""


class UnforeseenError(InputError):
    """An input that made safeloc itself fail. It is refused; the message names the input and the line of safeloc."""


class PropertyError(SafelocError):
    """A property cannot be evaluated on what it was given."""


class EngineError(SafelocError, RuntimeError):
    """A prover, solver or back end failed, or contradicted another one."""


class NotProvedError(SafelocError, AssertionError):
    """`require_proved` met a verdict other than Proved."""


def declared_at() -> str:
    """`file:line` of the nearest caller that is not the engine itself: the place to mend."""
    frame = sys._getframe(1)
    while frame.f_back is not None and is_engine(frame.f_globals.get("__name__", "")):
        frame = frame.f_back
    return f"{frame.f_code.co_filename}:{frame.f_lineno}"


def is_engine(module: str) -> bool:
    """Whether a module is the engine's own: neither a machine nor a property, and no user's code."""
    inside = module == "safeloc" or module.startswith("safeloc.")
    return (inside and not module.startswith(_USER_PACKAGES)) or module == "dataclasses"
