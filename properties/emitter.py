"""What must hold of the function check by a test emitter (FVA-8)."""

from __future__ import annotations

from safeloc.language.expr import before
from safeloc.language.spec import Property, always, reachable, within
from safeloc.models.emitter import ELSEWHERE, FOREIGN, NO_PLACE, NOT_DUE, PASSED, Emitter

TRACE = ("FVA-8", "FVA-17")
LAW = "nothing else makes this pattern at this place when it is due"


def properties(model: Emitter) -> list[Property]:
    """Only the own pattern counts; a dead chain is told within the due time and one cycle."""
    machine, own, config = model.machine, model.own, model.own.config
    untested, tested, failed = machine.modes
    mode, works = machine.mode, machine.flag("chain_tested")
    passed = own.judged.eq(PASSED)
    own_pattern = own.pattern.present & own.pattern.value.eq(config.pattern)
    off = own.place.value - config.place_mm
    near = own.place.present & (off <= config.place_tolerance_mm) & (off >= -config.place_tolerance_mm)
    return [
        within(
            "dead chain is told",
            config.due_cycles,
            ~own.works,
            own.works | ~works,
            statement="a chain that works no longer is not said to be tested when its due time and one cycle are over, "
            "counted from the last pattern",
            requirements=TRACE,
            assumption=LAW,
            helper=lambda waited: works.implies(waited <= own.since),
        ),
        within(
            "silence is told",
            config.due_cycles,
            ~own.pattern.present,
            own.pattern.present | ~works,
            statement="when nothing is heard at all, the chain is not said to be tested beyond its due time and one cycle",
            requirements=TRACE,
            unconditional=True,
            helper=lambda waited: works.implies(waited <= own.since),
        ),
        within(
            "request is answered",
            config.answer_cycles,
            own.requested & mode.eq(tested),
            ~works | passed,
            statement="an unanswered request ends the tested state within its time and one cycle",
            requirements=TRACE,
            unconditional=True,
            helper=lambda waited: works.implies(waited <= own.asked),
        ),
        always(
            "only the own pattern passes",
            passed.implies(own_pattern & near),
            statement="a pattern passes only if every bit is that of this emitter and it comes from where the emitter stands",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "tested rests on a pattern",
            (works & before(mode).ne(tested)).implies(passed),
            statement="the chain is said to be tested again only in a cycle in which a pattern passed",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "foreign patterns do not pass",
            own.judged.one_of(FOREIGN, NOT_DUE, NO_PLACE).implies(
                ~machine.fired("pattern passes", "first pattern passes", "enough patterns pass")
            ),
            statement="another emitter's pattern, and the own one when it is not due or without its place, renew nothing",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "own pattern from elsewhere fails",
            own.judged.eq(ELSEWHERE).implies(mode.eq(failed)),
            statement="the own pattern from another place ends the tested state in the same cycle",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "failure is not forgotten",
            (before(mode).eq(failed) & works).implies(machine.fired("enough patterns pass")),
            statement="after a failure the chain is tested only when enough patterns passed one after the other",
            requirements=TRACE,
            unconditional=True,
        ),
        reachable(
            "chain fails",
            mode.eq(failed),
            statement="a chain that was tested can be found to fail",
            requirements=TRACE,
        ),
        reachable("chain is tested", mode.eq(tested), statement="a chain can be tested", requirements=TRACE),
        always(
            "untested is the start only",
            mode.eq(untested).implies(before(mode).eq(untested)),
            statement="a chain that was tested or failed is never untested again",
            requirements=TRACE,
            unconditional=True,
        ),
    ]
