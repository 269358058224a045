"""Keywords that have another name now: the old one is refused, and the message says where it stands and the new one."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable

import pytest

from safeloc.errors import ModelError, SafelocError
from safeloc.language.composition import compose

OLD: dict[str, tuple[Callable[[], object], type[SafelocError], str]] = {
    "owes": (
        lambda: compose("both", [], {}, owes=[]),  # type: ignore[call-arg] # that is the slip
        ModelError,
        "compose: the keyword 'owes' is now 'discharge'; write discharge=.",
    ),
}


@pytest.mark.parametrize("old", OLD)
def test_an_old_keyword_is_refused_with_the_new_one(old: str) -> None:
    """The message names file, line, and the new keyword."""
    declare, error, message = OLD[old]
    with pytest.raises(error, match=rf"^\S*test_renamed\.py:\d+: {re.escape(message)}$"):
        declare()


def test_what_is_declared_keeps_its_name_and_its_parameters() -> None:
    """What is guarded looks as it was written, to a reader and to a tool."""
    assert "compose" == compose.__name__
    assert "Several machines as one TransitionSystem." == (compose.__doc__ or "").splitlines()[0]
    assert "discharge" in inspect.signature(compose).parameters
