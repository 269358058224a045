"""The worst run between two resets: proved for every length and spacing, attained, and noticed when the machine is wrong."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.language.machine import Machine
from safeloc.language.spec import observe
from safeloc.language.verdict import Proved, Violated, word
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.proof.provers.assumption import assumption_kept
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.provers.proved_base import base
from tests.proof.provers.small import told
from tests.theorems.odometry.field import LONGER, QUEUED, SHORTER, WITHOUT_LENGTH, Arrangement
from tests.theorems.odometry.marker_field import ONE_LAW, MarkerField, compose_field
from tests.theorems.odometry.marker_field_claims import properties

ONE_WAITS = ONE_LAW.model_copy(update={"pending_markers": 1})
CASES: dict[str, tuple[Arrangement, OdometryConfig]] = {
    "0 < L <= D": (SHORTER, ONE_LAW),
    "D < L <= 2 D, several identities wait": (QUEUED, ONE_LAW),
    "L > D, one identity waits": (LONGER, ONE_WAITS),
    "L = 0": (WITHOUT_LENGTH, ONE_LAW),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_run_between_resets_is_proved(case: str) -> None:
    """MRK-D5: the worst run is max(L, D - L) for every 0 < L < D, and attained; no gain at L = 0, L = D and, with one
    identity that waits, beyond."""
    whole = compose_field(*CASES[case])
    findings = prove(whole.composition.system, properties(whole), Limits(seconds=200), jobs=2)
    assert {finding.id: word(finding.result) for finding in findings if word(finding.result) != "proved"} == {}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_every_field_can_be_run_over(case: str) -> None:
    """The assumption of each case is kept by some run that moves; only the end of the line ends it."""
    found, *_ = assumption_kept(compose_field(*CASES[case]).composition.system, Limits(seconds=120))
    assert isinstance(found.verdict, Proved)
    assert found.verdict.witness is not None


def without_hand_over(machine: Machine) -> Machine:
    """The machine in which a trailing reading never sets the rear device, neither by itself nor with a hand-over."""
    gone = ("trailing reading at rear", "hand over to rear device")
    kept = [row for row in machine.transitions if row.name not in gone]
    assert len(kept) == len(machine.transitions) - len(gone)
    return replace(machine, transitions=kept)


@pytest.mark.slow
def test_worst_run_needs_the_trailing_reading() -> None:
    """Without the transition for the trailing reading, the worst run is neither proved nor kept."""
    whole = compose_field(change=without_hand_over)
    worst = next(prop for prop in properties(whole) if prop.name == "worst run")
    goal = observe(whole.composition.system, worst)
    assert not isinstance(kinduction(goal, Limits(seconds=30, induction=1)), Proved)


@pytest.mark.slow
def test_a_wrong_worst_run_is_violated() -> None:
    """A bound that is one millimetre too small is broken by a run: the bound is tight."""
    whole: MarkerField = compose_field()
    worst = next(prop for prop in properties(whole) if prop.name == "worst run attained on M1")
    [finding] = [
        one
        for one in prove(
            whole.composition.system, [replace(worst, kind="always", term=~worst.term)], Limits(seconds=60)
        )
        if one.kind == "property"
    ]
    assert isinstance(finding.result, Violated)


@pytest.mark.slow
def test_nothing_of_the_field_is_taken_on_trust() -> None:
    """Every lemma of the field is proved; what is dropped are ranges that only the line's end keeps, on wires too."""
    known = base(compose_field(WITHOUT_LENGTH).composition.system, seconds=60)
    only_by_the_end = ("range of ", "wired inputs of odometry are in range")
    assert [name for name in told(known.refuted) if not name.startswith(only_by_the_end)] == []
