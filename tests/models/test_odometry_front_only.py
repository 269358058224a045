"""With both readers never worse than with the front reader alone: proved as a product of two machines."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.language.machine import Machine
from safeloc.language.spec import observe, reachable
from safeloc.language.verdict import Proved, word
from safeloc.models.odometry.marker_reading import Fix
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.proof.provers.assumption import assumption_kept
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from tests.theorems.odometry.front_only import compose_comparison
from tests.theorems.odometry.front_only_claims import line_properties, properties
from tests.theorems.odometry.line_ahead import compose_line


@pytest.mark.parametrize("trusted", [False, True])
def test_the_comparison_is_made(trusted: bool) -> None:
    """Its facts on a candidate are of machines that have one; the proofs below are slow, so that an error here would be noticed late."""
    whole = compose_comparison(OdometryConfig(trust_first_marker=trusted))
    facts = {str(name) for name in whole.composition.system.lemmas}
    assert any("lost together" in name for name in facts)
    assert trusted != any("a candidate together" in name for name in facts)
    assert len(properties(whole)) == 2


@pytest.mark.slow
@pytest.mark.parametrize("trusted", [False, True])
def test_never_worse_than_the_front_reader_alone(trusted: bool) -> None:
    """MRK-1, MRK-D3: on every stream of the assumption, valid where the other is, and with no greater margin."""
    whole = compose_comparison(OdometryConfig(trust_first_marker=trusted))
    findings = prove(whole.composition.system, properties(whole), Limits(seconds=400), jobs=2)
    assert {finding.id: word(finding.result) for finding in findings if word(finding.result) != "proved"} == {}


@pytest.mark.slow
@pytest.mark.parametrize("devices", [1, 2])
def test_no_true_reading_is_refused(devices: int) -> None:
    """What the comparison asks of a stream holds on every line whose markers come in order and are read truly."""
    whole = compose_line(OdometryConfig(devices=devices))  # type: ignore[arg-type]
    findings = prove(whole.composition.system, line_properties(whole), Limits(seconds=200), jobs=2)
    assert {finding.id: word(finding.result) for finding in findings if word(finding.result) != "proved"} == {}


@pytest.mark.slow
def test_a_window_without_the_one_off_part_of_the_error_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The other device's error has a one-off part of its own, so a window by distances alone refuses true readings."""
    monkeypatch.setattr(Fix, "fits", lambda fix, reference: fix.meets(reference))
    whole = compose_line(OdometryConfig(devices=2))
    [claim] = line_properties(whole)
    assert not isinstance(kinduction(observe(whole.composition.system, claim), Limits(seconds=60, induction=1)), Proved)


@pytest.mark.slow
def test_the_comparison_is_not_empty() -> None:
    """Some run keeps its assumption, and comes where the front reader alone reports and the other one is better."""
    whole = compose_comparison(OdometryConfig(trust_first_marker=True))
    found, lasts, _ = assumption_kept(whole.composition.system, Limits(seconds=120))
    assert isinstance(found.verdict, Proved)
    assert isinstance(lasts.verdict, Proved)
    other = whole.of_alone.bool(whole.alone.machine.flag("valid"))
    better = whole.of_both.num(whole.both.lead.margin) < whole.of_alone.num(whole.alone.lead.margin)
    goal = reachable("better", other & better, requirements=())
    [finding] = [one for one in prove(whole.composition.system, [goal], Limits(seconds=60)) if one.kind == "property"]
    assert isinstance(finding.result, Proved)


@pytest.mark.slow
def test_a_forgotten_hand_over_to_the_front_is_noticed() -> None:
    """Without the hand-over to the smaller margin the machine with both readers is not proved as good."""

    def without(machine: Machine) -> Machine:
        kept = [
            t for t in machine.transitions if t.name not in ("hand over to front device", "leading reading at front")
        ]
        return replace(machine, transitions=kept)

    whole = compose_comparison(OdometryConfig(trust_first_marker=True), change=without)
    goal = observe(whole.composition.system, properties(whole)[1])
    assert not isinstance(kinduction(goal, Limits(seconds=60, induction=1)), Proved)
