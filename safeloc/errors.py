"""Errors of safeloc. Each message says what is wrong, where (file and line), and what to do.

SafelocError
├── ModelError             a declaration is wrong
│   ├── UnitError          ... its units do not fit (also a TypeError)
│   ├── TruthValueError    ... a symbolic term was used as a Python value (also a TypeError)
│   └── UnknownNameError   ... it names what the machine does not have (also a KeyError)
├── InputError             a value given to a machine is wrong (also a ValueError)
│   ├── StreamError        ... in a stream, with its file and line
│   ├── SnapshotError      ... in a snapshot that is damaged, or of another machine, configuration or version
│   └── UnforeseenError    ... and makes safeloc itself fail: it is refused; report it as a defect of safeloc
├── PropertyError          a property cannot be checked on this machine or trace
├── EngineError            a solver or back end gave an impossible answer, or is missing
└── NotProvedError         a verdict that was required to be Proved is not
"""

from __future__ import annotations

import sys
from types import FrameType

_USER_PACKAGES = ("safeloc.models", "safeloc.properties")


class SafelocError(Exception):
    """Root of every error that safeloc raises on purpose."""


class ModelError(SafelocError):
    """A machine, transition, property or composition is declared wrongly."""


class UnitError(ModelError, TypeError):
    """Terms of different units or kinds are combined."""


class TruthValueError(ModelError, TypeError):
    """A symbolic term is used where Python needs a value."""


class UnknownNameError(ModelError, KeyError):
    """A transition, output or variable is named that the machine does not have."""

    __str__ = Exception.__str__  # that of KeyError shows the message in quotes


class InputError(SafelocError, ValueError):
    """A value handed to a machine is missing, unknown, of the wrong type or out of range."""


class StreamError(InputError):
    """A recorded stream cannot be read; the message names file and line."""


class SnapshotError(InputError):
    """A snapshot cannot be used: it is damaged, newer, or of another machine or configuration."""


class UnforeseenError(InputError):
    """An input makes safeloc itself fail, and is refused; the message names the input and the line of safeloc."""


class PropertyError(SafelocError):
    """A property is declared wrongly, or cannot be checked on this machine or trace."""


class EngineError(SafelocError, RuntimeError):
    """A prover, solver or back end failed, or contradicted another one."""


class NotProvedError(SafelocError, AssertionError):
    """`require_proved` got a verdict other than Proved."""


def declared_at() -> str:
    """Return `file:line` of the nearest caller outside of the engine: the place that the user has to correct."""
    frame = _outside(sys._getframe(1))
    return f"{frame.f_code.co_filename}:{frame.f_lineno}"


def named_at() -> str:
    """Return `file:line` on which the name of a declaration is written, called while the declaration is made.

    A function that only passes the name on, as `claim(name, term)` that calls `always(name, term, ...)`, is not that place: its caller is.
    """
    made = sys._getframe(1)
    name = made.f_locals.get("name")
    frame = _outside(made)
    while frame.f_back is not None and _is_handed(name, frame) and not _in_engine(frame.f_back):
        frame = frame.f_back
    return f"{frame.f_code.co_filename}:{frame.f_lineno}"


def _outside(frame: FrameType) -> FrameType:
    """Return the nearest frame outside of the engine."""
    while frame.f_back is not None and _in_engine(frame):
        frame = frame.f_back
    return frame


def _in_engine(frame: FrameType) -> bool:
    return is_engine(frame.f_globals.get("__name__", ""))


def _is_handed(name: object, frame: FrameType) -> bool:
    """Return whether a function got the name as an argument."""
    code = frame.f_code
    given = (frame.f_locals.get(one) for one in code.co_varnames[: code.co_argcount + code.co_kwonlyargcount])
    return any(isinstance(one, str) and one == name for one in given)


def is_engine(module: str) -> bool:
    """Return whether a module belongs to the engine: neither a shipped machine nor a property, nor a user's code."""
    inside = module == "safeloc" or module.startswith("safeloc.")
    return (inside and not module.startswith(_USER_PACKAGES)) or module == "dataclasses"
