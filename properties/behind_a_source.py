"""Claims on the restrictive state behind a source, said of their composition: it passes on that source's interval, and gives its reason.

Another interval that holds the truth would keep every claim on containment, and another reason every claim on the reason.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.composition import Composition
from safeloc.language.expr import Num, ite
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.models.vocabulary.reasons import LOCATED, NO_REFERENCE, TOLERANCE
from safeloc.properties.hearing import INTERVAL, hears_interval

for_all_inputs = partial(always, unconditional=True)


def behind_a_source(whole: Composition, restrictive: Machine, source: Machine, words: str) -> Iterator[Property]:
    """Yield the claims; `words` name the source in a sentence, such as "odometry"."""
    host, given = whole.of(restrictive), whole.of(source)
    passed, valid = ~host.bool(restrictive.flag("restrictive")), given.bool(source.flag("valid"))
    same = hears_interval(host, [restrictive.output(name) for name in INTERVAL], given, source)
    yield for_all_inputs(
        "the host gets its source's interval",
        passed.implies(valid & same),
        statement=f"the position that the host gets, and both margins, are those that {words} reports in this cycle",
        requirements=("MRK-D1",),
    )
    reason, cause = host.num(restrictive.output("reason")), given.num(source.output("reason"))
    told: Num = ite(valid, TOLERANCE, ite(cause.eq(LOCATED), NO_REFERENCE, cause))
    yield for_all_inputs(
        "the host is told its source's reason",
        (earlier_bool(passed) & ~passed).implies(reason.eq(told)),
        statement=f"in the cycle in which the position is lost the host is told why {words} reports none; that it is too wide, if one is "
        "reported all the same",
        requirements=("MRK-D1", "MRK-D2"),
    )
