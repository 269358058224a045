"""A claim that depends on the number stored for an absent input is violated, with a run that shows it."""

from __future__ import annotations

import pytest

from safeloc.language.composition import compose
from safeloc.language.expr import before, boolean, number, optional
from safeloc.language.machine import Machine, Transition, World, modes
from safeloc.language.spec import Property, always, never, once, previous, reachable, within
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Proved, Violated, word
from safeloc.proof.provers.absent_in_claims import absence_in_claims
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.results import Finding
from safeloc.target import Target
from tests.checker.small_proofs import kept

ONE, TWO = modes("ONE", "TWO")
LIMITS = Limits(depth=6, seconds=5)
SEEN = optional("seen", COUNT, 0, 9)
LIT = boolean("lit")
READER = Machine(
    "reader",
    (ONE, TWO),
    [SEEN, LIT],
    {},
    {},
    [
        Transition("see", ONE, TWO, SEEN.present & (SEEN.value > 3)),
        Transition("miss", TWO, ONE, ~SEEN.present),
    ],
    world=World(clauses={"light only with a reading": LIT.implies(SEEN.present)}),
)
SYSTEM = lower(READER)
FAR = SEEN.value > 3


def one(claim: Property, system: TransitionSystem = SYSTEM) -> Obligation:
    """The obligation of one claim."""
    [found] = absence_in_claims([claim], system, LIMITS)
    return found


@pytest.mark.parametrize(
    "claim",
    [
        always("the presence is asked", SEEN.present.implies(SEEN.value <= 9)),
        always("the row implies it", READER.fired("see").implies(FAR)),
        always("a law implies it", LIT.implies(FAR)),
        always("earlier, with its presence", previous(SEEN.present & FAR).implies(before(READER.mode).eq(TWO))),
        always("the stored number decides nothing", FAR | (SEEN.value <= 3)),
        within("answered", 2, SEEN.present & FAR, READER.mode.eq(TWO)),
        always("assumed with its presence", LIT.implies(FAR), further_assumption=SEEN.present.implies(FAR)),
    ],
    ids=lambda claim: claim.name,
)
def test_claims_about_what_was_measured(claim: Property) -> None:
    """Their truth is the same whatever is stored."""
    assert "proved" == word(one(claim).verdict)


@pytest.mark.parametrize(
    "claim",
    [
        always("near", READER.mode.eq(ONE).implies(SEEN.value <= 3)),
        always("a law for all inputs", LIT.implies(FAR), unconditional=True),
        always("the presence of another step", ~(previous(FAR) & SEEN.present & READER.mode.eq(ONE))),
        always("ever", ~once(FAR)),
        within("answered", 1, FAR, READER.mode.eq(TWO)),
        reachable("some day", FAR & READER.mode.eq(ONE)),
        always("assumed of silence", READER.mode.eq(ONE), further_assumption=SEEN.value <= 3),
    ],
    ids=lambda claim: claim.name,
)
def test_claims_about_what_nobody_measured(claim: Property) -> None:
    """A run shows it: with the stored number and with another one the claim is not the same."""
    verdict = one(claim).verdict
    assert isinstance(verdict, Violated) and verdict.trace is not None
    assert any(not step.inputs["seen.present"] for step in verdict.trace.steps)
    assert all(step.inputs["seen"] == 0 for step in verdict.trace.steps if not step.inputs["seen.present"])
    assert f"{claim.name!r}" in verdict.reason and "reads seen while it is absent" in verdict.reason


def test_the_run_says_which_reading_breaks_the_claim() -> None:
    """With the number that is stored it is kept here, so the claim itself is proved; with another it is not."""
    near = always("near", READER.mode.eq(ONE).implies(SEEN.value <= 3))
    reason = getattr(one(near).verdict, "reason", "")
    assert "after a run of 1 steps it is kept with the stored 0, and broken with " in reason


def test_a_state_that_no_run_reaches_breaks_nothing() -> None:
    """One step does not show it, but no run tells the readings apart."""
    count = number("count", COUNT, 0, 9)
    rows = [Transition("go", ONE, TWO, set={count: count})]
    system = lower(Machine("still", (ONE, TWO), [SEEN], {count: 0}, {}, rows))
    claim = always("never counted", (before(count) > 5).implies(SEEN.value > 3))
    assert "proved" == word(one(claim, system).verdict)


def test_an_inherited_claim_is_asked_on_its_machine() -> None:
    """There its input may be absent, whatever the wire carries."""
    teller = Machine("teller", (ONE, TWO), [], {}, {}, [Transition("tell", ONE, TWO)])
    whole = compose("whole", [teller, READER], {})
    near = always("near", READER.mode.eq(ONE).implies(SEEN.value <= 3))
    verdict = one(whole.inherited(READER, near), whole.system).verdict
    assert isinstance(verdict, Violated) and "'near'" in verdict.reason


def test_without_readings_nothing_is_asked() -> None:
    """A machine whose claims read no optional input has no such obligation."""
    assert [] == list(absence_in_claims([never("none", READER.mode.eq(TWO))], SYSTEM, LIMITS))


def found(*claims: Property) -> tuple[Target, list[Finding]]:
    """The obligations of the machine with these claims."""
    return Target("reader", (READER,), SYSTEM, claims), obligations(SYSTEM, LIMITS, properties=claims)


def test_it_is_an_obligation_like_others() -> None:
    """Beside the others, with its run; so the exit code is that of a violation."""
    _, findings = found(always("near", READER.mode.eq(ONE).implies(SEEN.value <= 3)))
    [claims] = [one for one in findings if one.id == "reader/obligation/absence in claims"]
    assert isinstance(claims.result, Violated) and claims.result.trace is not None
    assert SYSTEM is claims.result.trace.system or claims.result.trace.system.name == "reader"


def test_the_checker_confirms_it_from_the_certificates() -> None:
    """From those of both rules; without either one, or with more hypotheses, it confirms nothing."""
    target, findings = found(
        always("the row implies it", READER.fired("see").implies(FAR)), always("a law implies it", LIT.implies(FAR))
    )
    mine = [one for one in findings if one.id.endswith("/absence in claims")]
    assert isinstance(mine[0].result, Proved)
    evidence = kept(target, mine)
    assert ["confirmed"] == [row.answer for row in evidence.judged().rows]
    files = [file for file, text in evidence.texts.items() if "absence" in file]
    assert 2 == len(files)
    for file in files:
        assert ["confirmed"] != [row.answer for row in evidence.judged({file: None}).rows], file
