"""A question about all streams around a stream of a target."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem
from safeloc.proof.around.claims import Asked
from safeloc.proof.around.deviations import Deviations
from safeloc.proof.around.tube import Given
from safeloc.proof.around.windows import Observe
from safeloc.proof.provers.limits import Limits

General = Callable[[Sequence[Property]], Mapping[Property, Mapping[str, str]]]
"""Declared properties -> the certificates of the proofs for all lawful streams, of those that are proved."""


@dataclass(frozen=True, eq=False)
class Question:
    """A question about all streams around a stream of a target.

    system   the machine with its world, without the laws that are left out
    name     of the stream
    general  looks for general proofs of declared properties
    watched  is called with every course of a window, such as to draw the tube
    seconds_in_all  limit of effort for the whole question, besides those of `limits` for each of its parts
    """

    target: str
    system: TransitionSystem
    name: str
    given: Given
    deviations: Deviations
    asked: Sequence[Asked]
    limits: Limits
    without: tuple[str, ...] = ()
    general: General | None = None
    watched: Observe | None = None
    say: Callable[[str], None] = field(default=lambda _: None)
    seconds_in_all: float = math.inf
