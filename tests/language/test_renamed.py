"""Keywords that have another name now: the old one is refused, and the message says where it stands and the new one."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import replace

import pytest

from safeloc.errors import ModelError, PropertyError, SafelocError
from safeloc.language.composition import compose
from safeloc.language.expr import TRUE
from safeloc.language.machine import Transition, modes
from safeloc.language.spec import Property, always, never, reachable, within

ON, OFF = modes("ON", "OFF")
GO = Transition("go", ON, OFF, requirements=("R-1",))

OLD: dict[str, tuple[Callable[[], object], type[SafelocError], str]] = {
    "owes": (
        lambda: compose("both", [], {}, owes=[]),  # type: ignore[call-arg] # that is the slip
        ModelError,
        "compose: the keyword 'owes' is now 'discharge'; write discharge=.",
    ),
    "trace of a transition": (
        lambda: Transition("go", ON, ON, trace=("R-1",)),  # type: ignore[call-arg]
        ModelError,
        "Transition: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "trace of a transition that is changed": (
        lambda: replace(GO, trace=("R-1",)),  # type: ignore[call-arg]
        ModelError,
        "Transition: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "trace of a property": (
        lambda: Property("on", "always", TRUE, trace=("R-1",)),  # type: ignore[call-arg]
        PropertyError,
        "Property: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "trace of always": (
        lambda: always("on", TRUE, trace=("R-1",)),  # type: ignore[call-arg]
        PropertyError,
        "always: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "trace of never": (
        lambda: never("on", TRUE, trace=("R-1",)),  # type: ignore[call-arg]
        PropertyError,
        "never: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "trace of within": (
        lambda: within("on", 3, TRUE, TRUE, trace=("R-1",)),  # type: ignore[call-arg]
        PropertyError,
        "within: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "trace of reachable": (
        lambda: reachable("on", TRUE, trace=("R-1",)),  # type: ignore[call-arg]
        PropertyError,
        "reachable: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "given of Property": (
        lambda: Property("on", "always", TRUE, given=TRUE),  # type: ignore[call-arg]
        PropertyError,
        "Property: the keyword 'given' is now 'further_assumption'; write further_assumption=.",
    ),
    "given of always": (
        lambda: always("on", TRUE, given=TRUE),  # type: ignore[call-arg]
        PropertyError,
        "always: the keyword 'given' is now 'further_assumption'; write further_assumption=.",
    ),
    "given of never": (
        lambda: never("on", TRUE, given=TRUE),  # type: ignore[call-arg]
        PropertyError,
        "never: the keyword 'given' is now 'further_assumption'; write further_assumption=.",
    ),
    "given of within": (
        lambda: within("on", 3, TRUE, TRUE, given=TRUE),  # type: ignore[call-arg]
        PropertyError,
        "within: the keyword 'given' is now 'further_assumption'; write further_assumption=.",
    ),
    "given of reachable": (
        lambda: reachable("on", TRUE, given=TRUE),  # type: ignore[call-arg]
        PropertyError,
        "reachable: the keyword 'given' is now 'further_assumption'; write further_assumption=.",
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
