"""Properties of the function check by a test emitter (FVA-8).

The times at which the emitter is to send are facts of the world: its ghosts `silent` and `may_answer` count them, not the machine.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, as_num, before, ite
from safeloc.language.spec import Property, always, earlier_num, reachable, within
from safeloc.language.units import COUNT
from safeloc.models.emitter import Emitter
from safeloc.models.emitter.variables import ELSEWHERE, FOREIGN, NO_PLACE, NOT_DUE, NOTHING, PASSED, Parts

REQUIREMENTS = ("FVA-8", "FVA-17")
LAW = "nothing else makes this pattern at this place while the emitter is to send"
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(model: Emitter) -> list[Property]:
    """Return the properties: only the own pattern counts, at its time; a dead chain is reported within the due time and one cycle."""
    return [
        *_chain(model),
        *_request(model),
        *_tested(model),
        *_modes(model),
        *_patterns(model),
        *_times(model),
        *_failures(model),
        *_in_time(model),
        *_recovery(model),
    ]


def _chain(model: Emitter) -> Iterator[Property]:
    """Claim that a dead or silent chain is soon no longer tested."""
    own, config, works = model.own, model.own.config, model.machine.flag("chain_tested")
    yield within(
        "a dead chain is reported",
        config.due_cycles,
        ~own.works,
        own.works | ~works,
        statement="a chain that no longer works is not reported as tested once its due time and one cycle are over, counted from the last pattern",
        requirements=REQUIREMENTS,
        assumption=LAW,
        helper=lambda waited: works.implies(waited <= own.since_passed),
    )
    yield within(
        "silence is reported",
        config.due_cycles,
        ~own.pattern.present,
        own.pattern.present | ~works,
        statement="if no pattern comes at all, the chain is not reported as tested beyond its due time and one cycle",
        requirements=REQUIREMENTS,
        unconditional=True,
        helper=lambda waited: works.implies(waited <= own.since_passed),
    )


def _request(model: Emitter) -> Iterator[Property]:
    own, config, works = model.own, model.own.config, model.machine.flag("chain_tested")
    yield within(
        "request is answered",
        config.answer_cycles,
        own.requested & works,
        ~works | own.last_verdict.eq(PASSED),
        statement="an unanswered request ends the tested state within its time and one cycle",
        requirements=REQUIREMENTS,
        unconditional=True,
        helper=lambda waited: works.implies(waited <= own.since_request),
    )


def _tested(model: Emitter) -> Iterator[Property]:
    """Claim that only the own pattern makes a chain tested."""
    machine, own = model.machine, model.own
    _, tested, _ = machine.modes
    mode, works, passed = machine.mode, machine.flag("chain_tested"), own.last_verdict.eq(PASSED)
    yield for_all_inputs(
        "only the own pattern passes",
        passed.implies(_ours(own) & own.place.present & ~_off_place(own)),
        statement="a pattern passes only if every bit is that of this emitter and it comes from the emitter's place",
    )
    yield for_all_inputs(
        "tested rests on a pattern",
        (works & before(mode).ne(tested)).implies(passed),
        statement="the chain is reported as tested again only in a cycle in which a pattern passed",
    )
    yield for_all_inputs(
        "foreign patterns do not pass",
        own.last_verdict.one_of(FOREIGN, NOT_DUE, NO_PLACE).implies(
            ~machine.fired("pattern passes", "first pattern passes", "enough patterns pass")
        ),
        statement="another emitter's pattern, and the own one when it is not due or without its place, renew nothing",
    )


def _modes(model: Emitter) -> Iterator[Property]:
    """Claim that the first mode never comes back, and that the others are reachable."""
    untested, tested, failed = model.machine.modes
    mode = model.machine.mode
    yield for_all_inputs(
        "untested is the start only",
        mode.eq(untested).implies(before(mode).eq(untested)),
        statement="a chain that was tested or failed is never untested again",
    )
    yield reachable("chain is tested", mode.eq(tested), statement="a chain can be tested", requirements=REQUIREMENTS)
    yield reachable(
        "chain fails",
        mode.eq(failed),
        statement="a chain that was tested can fail",
        requirements=REQUIREMENTS,
    )


def _ours(own: Parts) -> Bool:
    """Return the condition that every received bit is that of this emitter."""
    return own.pattern.present & own.pattern.value.eq(own.config.pattern)


def _off_place(own: Parts) -> Bool:
    """Return the condition that the pattern comes from farther from the emitter than the front end's error."""
    off = own.place.value - own.config.place_mm
    return (off > own.config.place_tolerance_mm) | (off < -own.config.place_tolerance_mm)


def _to_send(own: Parts) -> Bool:
    """Return the condition, in the world, that the emitter's silence was over before this cycle, or a request was open."""
    return before(own.silent).eq(0) | before(own.may_answer).ne(0)


def _patterns(model: Emitter) -> Iterator[Property]:
    """Claim the verdict on a pattern, from its content and its time."""
    own, config, outcome = model.own, model.own.config, model.own.last_verdict
    ours, off_place = _ours(own), _off_place(own)
    here = ours & own.place.present & ~off_place
    yield under_assumption(
        "a pattern that passes came through the chain",
        outcome.eq(PASSED).implies(own.works),
        statement="in the cycle in which a pattern passes the whole chain works",
    )
    yield under_assumption(
        "a pattern passes when the emitter is to send, and only then",
        outcome.eq(PASSED).iff(here & _to_send(own)) & outcome.eq(NOT_DUE).iff(here & ~_to_send(own)),
        statement="the own pattern from its own place passes at the emitter's regular time or while a request is open; at "
        "any other time the verdict is that it is not due",
    )
    meanings = {NOTHING: ~own.pattern.present, FOREIGN: own.pattern.present & own.pattern.value.ne(config.pattern)}
    meanings |= {NO_PLACE: ours & ~own.place.present, ELSEWHERE: ours & own.place.present & off_place}
    yield for_all_inputs(
        "the verdict names why a pattern does not pass",
        all_of(outcome.eq(verdict).iff(meaning) for verdict, meaning in meanings.items()),
        statement="the verdict distinguishes no pattern, another emitter's pattern, the own one without a place, and the own one from elsewhere",
    )
    yield for_all_inputs(
        "a foreign pattern is reported",
        model.machine.flag("foreign_pattern").iff(meanings[FOREIGN]),
        statement="another emitter's pattern is reported in the cycle in which it comes, and in no other",
    )


def _times(model: Emitter) -> Iterator[Property]:
    """Claim the time at which the next pattern is awaited."""
    machine, own, config = model.machine, model.own, model.own.config
    left, awaited = machine.output("next_due_in_cycles"), _awaited(model)
    one_less = ite(awaited > 0, awaited - 1, as_num(0, COUNT))
    yield for_all_inputs(
        "the time to the next pattern counts down",
        ite(own.last_verdict.eq(PASSED), left.eq(config.due_cycles), left.eq(one_less)),
        statement="the next pattern is awaited for the due time after one that passed, and one cycle less in each other cycle",
    )


def _failures(model: Emitter) -> Iterator[Property]:
    """Claim the failure of a chain as reported."""
    machine, own = model.machine, model.own
    *_, failed = machine.modes
    mode, elsewhere = machine.mode, own.last_verdict.eq(ELSEWHERE)
    yield for_all_inputs(
        "a failed chain is reported",
        machine.flag("failed").iff(mode.eq(failed)),
        statement="the chain is reported as failed from the failure until it is tested again",
    )
    yield for_all_inputs(
        "own pattern from elsewhere fails",
        elsewhere.implies(mode.eq(failed)),
        statement="the own pattern from another place ends the tested state in the same cycle",
    )


def _in_time(model: Emitter) -> Iterator[Property]:
    """Claim the reasons for a failure, and the patterns that show a tested chain."""
    machine, own = model.machine, model.own
    _, tested, failed = machine.modes
    mode, passed, elsewhere = machine.mode, own.last_verdict.eq(PASSED), own.last_verdict.eq(ELSEWHERE)
    in_time = _awaited(model).ne(0) & before(own.may_answer).ne(1)
    yield under_assumption(
        "a chain fails for a reason",
        ite(before(mode).eq(failed), (~passed).implies(mode.eq(failed)), mode.eq(failed).iff(~in_time | elsewhere)),
        statement="a chain fails when a pattern or an answer is overdue or comes from elsewhere, and for no other reason; "
        "without a pattern that passes it does not recover",
    )
    yield under_assumption(
        "a pattern in time shows a tested chain",
        (passed & in_time & before(mode).ne(failed)).implies(mode.eq(tested)),
        statement="the first pattern, and every further one that comes in time, shows that the chain works",
    )


def _recovery(model: Emitter) -> Iterator[Property]:
    """Claim the conditions under which a failed chain is tested again."""
    machine, own, config = model.machine, model.own, model.own.config
    _, tested, failed = machine.modes
    mode, passed, elsewhere = machine.mode, own.last_verdict.eq(PASSED), own.last_verdict.eq(ELSEWHERE)
    so_far = ite(before(mode).eq(failed) & (_awaited(model) > 0), before(own.passes), as_num(0, COUNT))
    nothing_counts = before(mode).ne(failed) | elsewhere
    yield for_all_inputs(
        "patterns count after a failure only",
        mode.ne(failed).implies(own.passes.eq(0)),
        statement="no pattern counts towards a recovery unless the chain has failed",
    )
    yield for_all_inputs(
        "failure is not forgotten",
        (before(mode).eq(failed) & machine.flag("chain_tested")).implies(machine.fired("enough patterns pass")),
        statement="after a failure the chain is tested only when enough patterns passed one after the other",
    )
    yield for_all_inputs(
        "patterns count one after the other",
        mode.eq(failed).implies(ite(nothing_counts, own.passes.eq(0), own.passes.eq(ite(passed, so_far + 1, so_far)))),
        statement="after a failure each pattern that passes counts, and none counts any longer when the next one is missed",
    )
    yield for_all_inputs(
        "as many patterns as required recover",
        (before(mode).eq(failed) & passed).implies(mode.eq(tested).iff(so_far + 1 >= config.passes_to_recover)),
        statement="a failed chain is tested again exactly with the last of the required patterns",
    )


def _awaited(model: Emitter) -> Num:
    """Return the number of cycles after which the next pattern was overdue, as reported before the step."""
    return earlier_num(model.machine.output("next_due_in_cycles"))
