"""Clear or occupied by axles counted in and out at both ends of a section, with its reset procedure (FVA-4, FVA-5).

    UNKNOWN    after power-up: occupied until reset and swept
    CLEAR      every axle that was counted in was counted out
    OCCUPIED   axles are counted in, or a wheel stands on a head
    DISTURBED  a count is impossible, or a counting head is at fault: occupied until reset and swept
    SWEEPING   reset: occupied until a train ran through on sight, was counted in and out, and found the section free

Only CLEAR is clear. A reset is refused while a head is damped or at fault, while axles are counted in, and for a while
after the last axle (Frauscher FAdC manual p. 33); a reset never leads to CLEAR directly.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import TRUE, Bool, BoolVar, Lit, Num, NumVar, any_of, as_num, between, ite
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT
from safeloc.models.axle_section.lemmas import lemmas
from safeloc.models.axle_section.variables import (
    ACCEPTED,
    AXLE_PASSED,
    AXLES_COUNTED,
    HEAD_DAMPED,
    HEAD_FAULT,
    NOT_ASKED,
    AxleSectionConfig,
    Parts,
    parts,
)
from safeloc.models.axle_section.world import world

__all__ = ["AxleSection", "AxleSectionConfig", "Parts", "build", "machine", "parts"]
REQUIREMENTS = ("FVA-4", "FVA-5")


AxleSection = Model[Parts]


def machine(config: AxleSectionConfig | None = None) -> Machine:
    """Return the machine of a section between axle counters (FVA-4, FVA-5)."""
    return build(parts(config or AxleSectionConfig())).machine


def build(own: Parts) -> AxleSection:
    """Return the machine over the given variables."""
    table = modes("UNKNOWN", "CLEAR", "OCCUPIED", "DISTURBED", "SWEEPING")
    current = current_mode(table)
    _, clear, occupied, _, _ = table
    counting = current.one_of(clear, occupied)
    made = own.declared.machine(
        name="axle_section",
        modes=table,
        outputs={
            "clear": current.eq(clear),
            "healthy": counting,
            "needs_reset": current.one_of(table[0], table[3]),
            "axles": own.counted_axles,
            "reset_answer": own.answer,
        },
        transitions=list(_table(own, current, table)),
        world=world(own),
        lemmas=lemmas(own, current, table),
        definitions={
            "count after the cycle": _counted(own),
            "sweep ran through": _through(own),
            "answer": _answer(own, current, table),
        },
        doc=(
            "Clear or occupied by counting axles at both ends. Assumed: heads without a fault count every axle "
            "once and in its direction; the driver who reports a sweep ran it on sight after the reset was "
            "requested, has left the section, and met nothing where he ran through. Not covered: a miscount that "
            "no head reports and that never makes the count negative."
        ),
    )
    return Model(made, own)


def _counted(own: Parts) -> Num:
    """Return the count after the cycle."""
    return own.counted_axles + own.into[0] + own.into[1] - own.out[0] - own.out[1]


def _moved(own: Parts) -> Bool:
    """Return the condition that an axle passed a head in this cycle."""
    return any_of(var > 0 for var in (*own.into, *own.out))


def _possible(own: Parts) -> Bool:
    """Return the condition that the count after the cycle is possible."""
    return between(0, _counted(own), own.config.axle_limit)


def _through(own: Parts) -> Bool:
    """Return the condition that since the reset a train came in at one end and went out at the other, and nothing else moved."""
    ways = [own.swept_from[a] & ~own.swept_to[a] & ~own.swept_from[b] & own.swept_to[b] for a, b in ((0, 1), (1, 0))]
    return any_of(ways)


def _answer(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> Num:
    """Return the answer to a request for reset. A count of axles refuses it only while the count is undisturbed, or swept."""
    counted = current.one_of(table[2], table[4]) & (own.counted_axles > 0)
    answer = ite(_moved(own) | (own.quiet < own.config.lead_cycles), AXLE_PASSED, ACCEPTED)
    answer = ite(counted, AXLES_COUNTED, answer)
    answer = ite(own.damped, HEAD_DAMPED, answer)
    answer = ite(own.fault, HEAD_FAULT, answer)
    return ite(own.reset_requested, answer, NOT_ASKED)


def _table(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> Iterator[Transition]:
    unknown, clear, occupied, disturbed, sweeping = table
    answer, counted = _answer(own, current, table), _counted(own)
    quiet = ite(own.quiet >= own.config.lead_cycles, own.quiet, own.quiet + 1)
    always: Updates = {own.quiet: ite(_moved(own), as_num(0, COUNT), quiet), own.answer: answer}
    fresh = together(always, {own.counted_axles: 0}, dict.fromkeys((*own.swept_from, *own.swept_to), False))
    counts = together(always, {own.counted_axles: counted})
    sweeps = together(counts, {passed: passed | (axles > 0) for passed, axles in _ways(own)})
    believed, all_out = (clear, occupied, sweeping), counted.eq(0) & ~own.damped
    wrong = own.fault | ~_possible(own)
    swept = _through(own) & _counted(own).eq(0) & ~_moved(own) & ~own.damped & own.reported_clear
    yield Transition("count cannot be believed", believed, disturbed, wrong, fresh, REQUIREMENTS, 0)
    yield Transition("reset accepted", table, sweeping, answer.eq(ACCEPTED), fresh, REQUIREMENTS, 1)
    yield Transition("swept", sweeping, clear, swept, counts, REQUIREMENTS, 2)
    yield Transition("sweep goes on", sweeping, sweeping, TRUE, sweeps, REQUIREMENTS, 3)
    yield Transition("all axles counted out", occupied, clear, all_out, counts, REQUIREMENTS, 2)
    yield Transition("axles counted in", clear, occupied, (counted > 0) | own.damped, counts, REQUIREMENTS, 2)
    yield Transition("stay clear", clear, clear, TRUE, counts, REQUIREMENTS, 3)
    yield Transition("stay occupied", occupied, occupied, TRUE, counts, REQUIREMENTS, 3)
    yield Transition("stay disturbed", disturbed, disturbed, TRUE, always, REQUIREMENTS, 3)
    yield Transition("stay unknown", unknown, unknown, TRUE, always, REQUIREMENTS, 3)


def _ways(own: Parts) -> list[tuple[BoolVar, NumVar]]:
    return [*zip(own.swept_from, own.into, strict=True), *zip(own.swept_to, own.out, strict=True)]
