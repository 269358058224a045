"""Function check of the fibre chain by an acoustic emitter beside the track (FVA-8, FVA-17).

The emitter sends its own bit pattern from a known place, at regular times and on request. As long as the pattern comes back
through pulse, fibre, detector and evaluation when it is due, the chain works.

    UNTESTED  the own pattern has not come yet
    TESTED    the last pattern came when it was due, and the next one is not overdue
    FAILED    a pattern that was due did not come, or the own pattern came from another place

Only the own pattern counts, from its own place, when it is due. A foreign pattern is reported and changes nothing.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import TRUE, Lit, Num, any_of, as_num, ite
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT
from safeloc.models.emitter.judgement import due, late, overdue, verdict
from safeloc.models.emitter.variables import (
    ELSEWHERE,
    FOREIGN,
    HEARD,
    NO_PLACE,
    NOT_DUE,
    NOTHING,
    PASSED,
    EmitterConfig,
    Parts,
    parts,
)
from safeloc.models.emitter.world import lemmas, world

__all__ = [
    "ELSEWHERE",
    "FOREIGN",
    "HEARD",
    "NOTHING",
    "NOT_DUE",
    "NO_PLACE",
    "PASSED",
    "Emitter",
    "EmitterConfig",
    "Parts",
    "build",
    "machine",
    "parts",
]
REQUIREMENTS = ("FVA-8", "FVA-17")

Emitter = Model[Parts]


def machine(config: EmitterConfig | None = None) -> Machine:
    """Return the machine of one test emitter (FVA-8)."""
    return build(parts(config or EmitterConfig())).machine


def build(own: Parts) -> Emitter:
    """Return the machine over the given variables."""
    table = modes("UNTESTED", "TESTED", "FAILED")
    current = current_mode(table)
    tested = current.eq(table[1])
    made = own.declared.machine(
        name="emitter",
        modes=table,
        outputs={
            "chain_tested": tested,
            "failed": current.eq(table[2]),
            "verdict": own.last_verdict,
            "foreign_pattern": own.last_verdict.eq(FOREIGN),
            "next_due_in_cycles": own.config.due_cycles - own.since_passed,
        },
        transitions=list(_table(own, table)),
        world=world(own),
        lemmas=lemmas(own),
        definitions={"verdict on the pattern": verdict(own), "a pattern may come": due(own), "overdue": overdue(own)},
        doc=(
            "Function check of the fibre chain by an emitter with its own bit pattern. Assumed: nothing else "
            "makes this pattern at this place while the emitter is to send, so a pattern received then shows "
            "that the chain works."
        ),
    )
    return Model(made, own)


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    untested, tested, failed = table
    zero, heard = as_num(0, COUNT), verdict(own)
    counted = ite(late(own), zero, own.passes)
    waiting = _clocks(own)
    anew = together(waiting, {own.passes: 0})
    one_more = together(waiting, {own.passes: counted + 1})
    recovering = together(waiting, {own.passes: counted})
    enough = counted + 1 >= own.config.passes_to_recover
    hears, elsewhere = heard.eq(PASSED), heard.eq(ELSEWHERE)
    yield Transition("own pattern from elsewhere", table, failed, elsewhere, anew, REQUIREMENTS, 0)
    yield Transition("pattern passes", tested, tested, hears & ~overdue(own), anew, REQUIREMENTS, 1)
    yield Transition("pattern does not come", (untested, tested), failed, overdue(own), anew, REQUIREMENTS, 2)
    yield Transition("first pattern passes", untested, tested, hears, anew, REQUIREMENTS, 3)
    if own.config.passes_to_recover > 1:
        yield Transition("one more pattern passes", failed, failed, hears & ~enough, one_more, REQUIREMENTS, 3)
    yield Transition("enough patterns pass", failed, tested, hears & enough, anew, REQUIREMENTS, 4)
    yield Transition("wait for the first pattern", untested, untested, TRUE, waiting, REQUIREMENTS, 5)
    yield Transition("wait for the next pattern", tested, tested, TRUE, waiting, REQUIREMENTS, 5)
    yield Transition("wait for a pattern after the failure", failed, failed, TRUE, recovering, REQUIREMENTS, 5)


def _clocks(own: Parts) -> Updates:
    """Advance both clocks. A pattern that counts restarts them in any mode; no request is forgotten before its time."""
    zero, heard = as_num(0, COUNT), verdict(own)
    waited = ite(late(own), own.since_passed, own.since_passed + 1)
    open_request = any_of([own.since_request > 0, own.requested])
    fresh: Num = ite(own.requested, as_num(1, COUNT), zero)
    asked = ite(own.since_request >= own.config.answer_cycles, fresh, ite(open_request, own.since_request + 1, zero))
    passes = heard.eq(PASSED)
    return {
        own.since_passed: ite(passes, zero, waited),
        own.since_request: ite(passes, zero, asked),
        own.last_verdict: heard,
    }
