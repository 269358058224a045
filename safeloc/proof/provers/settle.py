"""Decision of one query by both solvers: z3 decides, and yices or cvc5 confirms from the text what z3 has proved."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Generic

from safeloc.codegen.smtlib import Key, Query
from safeloc.proof.provers.implication import Failure, Undecided, unproved
from safeloc.proof.provers.limits import Deadline
from safeloc.proof.provers.recheck import UNCONFIRMED, certify


@dataclass(frozen=True)
class Settled(Generic[Key]):
    """The goals that do not follow, with reasons; and if all follow, the certificate's text by its file name."""

    failed: Mapping[Key, Failure]
    texts: Mapping[str, str]


def settled_but(query: Query[Key], ends: Deadline, relies_on: Sequence[str] = ()) -> tuple[Settled[Key], list[Key]]:
    """Decide the query, and if some goals fail decide the others again without them.

    Return the result and the keys of the goals that follow.
    """
    first = settled(query, ends, relies_on)
    rest = {key: goal for key, goal in query.goals.items() if key not in first.failed}
    if not first.failed or not rest:
        return first, list(rest)
    again = settled(replace(query, goals=rest), ends, relies_on)
    return Settled({**first.failed, **again.failed}, again.texts), [key for key in rest if key not in again.failed]


def settled(
    query: Query[Key], ends: Deadline, relies_on: Sequence[str] = (), *, confirming: float = math.inf
) -> Settled[Key]:
    """Decide by both solvers whether every goal follows. EngineError if the second contradicts z3.

    confirming  seconds of effort for the second solver at most, for each goal; what it does not confirm then is undecided
    """
    failed = unproved(query, ends.left)
    if failed or not query.goals:
        return Settled(failed, {})
    certificate = certify(query, seconds=min(confirming, ends.left), relies_on=relies_on)
    late: dict[Key, Failure] = {key: Undecided(UNCONFIRMED) for key in certificate.undecided}
    return Settled(late, {} if late else {certificate.file: certificate.text})
