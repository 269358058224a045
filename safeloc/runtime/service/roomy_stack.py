"""A piece of the interpreter's stack that stays: the step of a large machine needs a frame of 15 KB.

CPython (3.11 and later) keeps the frames of a thread in pieces of at least 16 KB. A frame that does not fit gets a new piece, and
the piece goes back to the system when the frame ends: with every step of the localizer the system had to hand out, clear and
take back four pages. A frame that claims a large stack of values for itself has a large piece, in which all calls inside of it
find room. Memory that it claims and does not write to is never handed out.
"""

from __future__ import annotations

from collections.abc import Callable
from types import FunctionType

_VALUES = 1 << 16
"""Values, of 8 bytes, that the frame claims. The piece is the next power of two: as much is left for the frames inside."""


def _called(work: Callable[[], object]) -> None:
    work()


_ROOMY = FunctionType(_called.__code__.replace(co_stacksize=_VALUES), globals(), "_called")


def in_roomy_stack(work: Callable[[], object]) -> None:
    """Call with a large piece of stack, for what lasts long and steps machines."""
    _ROOMY(work)
