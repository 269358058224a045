"""A certificate counts for what its rule says, and only if it presumes no more than that."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from safeloc.catalogue import load_target
from safeloc.checker.claims import Goals
from safeloc.checker.dag import Dag
from safeloc.checker.rules import RefusedError, Theory
from safeloc.checker.text import read
from safeloc.language.expr import BoolVar, boolean, number, was
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import Property, observe, within
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import ONE
from safeloc.language.verdict import Proved
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.target import Target
from tests.checker.small_proofs import LIMITS, NAMES, Evidence, kept, refused, removed, solved


@pytest.mark.parametrize("name", NAMES)
def test_what_was_proved_is_confirmed(proofs: dict[str, Evidence], name: str) -> None:
    """All certificates of a report are of use, and every result that has some is confirmed."""
    found = proofs[name].judged()
    assert ([], {}, {}) == (refused(found), found.wrong, found.undecided)
    assert 10 < len(found.rows) + len(proofs[name].texts)


def with_goals(evidence: Evidence) -> dict[str, str]:
    """The certificates that show something; witness functions are proposals."""
    return {file: text for file, text in evidence.texts.items() if "(push 1)" in text}


@pytest.mark.parametrize("name", NAMES)
def test_no_certificate_can_be_missing(proofs: dict[str, Evidence], name: str) -> None:
    """Without any one certificate some result is not confirmed."""
    for file in proofs[name].texts:
        assert refused(proofs[name].judged({file: None})), file


@pytest.mark.thorough
def test_readings_of_one_input_are_one_goal() -> None:
    """What several terms read of an absent input stands in one certificate, as one goal, and each is confirmed."""
    target = load_target("stop_point")
    owed = [one for one in obligations(target.system, LIMITS) if one.id.endswith("/absence")]
    found = kept(target, owed).judged()
    assert (["confirmed"], {}, {}) == ([row.answer for row in found.rows], found.wrong, found.undecided)


@pytest.mark.thorough
def test_a_goal_left_out(whole_proofs: dict[str, Evidence]) -> None:
    """A step that does not show what it presumes shows nothing: the last goal is dropped from each certificate in turn."""
    for name, evidence in whole_proofs.items():
        for file, text in with_goals(evidence).items():
            *others, goal = re.split(r"(?m)^(?=\(push 1\)$)", text)
            dag = Dag()
            sees_itself = read(file, text, dag).goals[-1] == dag.truth[True]
            harmless = sees_itself or "implies" in file  # the invariant may hold the property itself
            assert harmless or refused(evidence.judged({file: "".join(others)})), (name, file, goal)


def test_a_hypothesis_added(proofs: dict[str, Evidence]) -> None:
    """A hypothesis that no rule allows is refused, even if the solvers agree that the goals follow."""
    evidence = proofs["counting"]
    for file, text in with_goals(evidence).items():
        added = text.replace("(push 1)", "(declare-const |more| Bool)\n(assert |more|)\n(push 1)", 1)
        assert refused(evidence.judged({file: added})), file


@pytest.mark.thorough
def test_a_hypothesis_left_out_that_is_not_needed(whole_proofs: dict[str, Evidence]) -> None:
    """Presuming less is no harm, where both solvers still confirm the goals."""
    evidence = whole_proofs["counting"]
    file = evidence.file("overlap")
    changed = removed(evidence.texts[file], r"\(assert t\d+\)\n(?=\(push 1\))")
    assert [] == refused(evidence.judged({file: changed}))


def test_a_variable_renamed(proofs: dict[str, Evidence]) -> None:
    """The same text about another variable is no proof of this one."""
    evidence = proofs["counting"]
    for file in (evidence.file("never-above-eight-step"), evidence.file("facts-step")):
        renamed = evidence.texts[file].replace("|level|", "|lever|")
        assert {"unsat"} == set(solved(renamed).answers["z3"])
        assert refused(evidence.judged({file: renamed})), file


def test_a_goal_weakened(proofs: dict[str, Evidence]) -> None:
    """A weaker goal follows as well, and is not what has to be shown."""
    evidence = proofs["counting"]
    file = evidence.file("never-above-eight-step")
    weaker = (
        evidence.texts[file]
        .replace("(assert (not ", "(assert (not (or true ")
        .replace("))\n(check-sat)", ")))\n(check-sat)")
    )
    assert {"unsat"} == set(solved(weaker).answers["cvc5"])
    assert any("never above eight" in one for one in refused(evidence.judged({file: weaker})))


def test_certificates_swapped(proofs: dict[str, Evidence]) -> None:
    """The start of one property is none of another."""
    evidence = proofs["counting"]
    one, other = evidence.file("never-above-eight-start"), evidence.file("one-more-or-none-start")
    head = re.compile(r"(?m)^; property: .*$")
    swapped = head.sub("; property: one more or none", evidence.texts[one])
    assert any("one more" in each for each in refused(evidence.judged({other: swapped})))


def test_of_another_layer(proofs: dict[str, Evidence]) -> None:
    """A fact proved under the assumption does not count for all inputs."""
    evidence = proofs["counting"]
    files = [evidence.file("facts-start"), evidence.file("facts-step")]
    found = evidence.judged({file: evidence.texts[file].replace("layer: facts", "layer: always") for file in files})
    assert refused(found)


@pytest.mark.parametrize(("former", "now"), [("heard", "wires"), ("owed", "contract")])
def test_a_rule_of_an_old_certificate(proofs: dict[str, Evidence], former: str, now: str) -> None:
    """The answer gives the name that the rule has now."""
    evidence = proofs["whole"]
    changed = {
        file: text.replace(f"; rule: {now}", f"; rule: {former}")
        for file, text in evidence.texts.items()
        if f"; rule: {now}" in text
    }
    found = evidence.judged({**changed})
    assert changed
    assert {f"rule {former!r} is now {now!r}"} == {found.wrong[file] for file in changed}


def test_contracts_have_an_order(proofs: dict[str, Evidence]) -> None:
    """A contract that was shown from what the machine keeps only because of the contract establishes nothing."""
    evidence = proofs["whole"]
    file = evidence.file("contract-of-listener-holds")
    kept = "(declare-const |listener.kept| Int)\n(assert (<= 1 |listener.kept|))\n(push 1)"
    known = evidence.judged({file: evidence.texts[file].replace("(push 1)", kept, 1)})
    assert [] == refused(known)  # the whole keeps it also without the contract
    joint = {one: None for one in evidence.texts if re.match(r"whole-(always|facts)-", one)}
    found = evidence.judged({file: evidence.texts[file].replace("(push 1)", kept, 1), **joint})
    assert "1 of its hypotheses are not allowed by its rule" in found.wrong[file]
    assert any("listener: keeps what it hears" in one for one in refused(found))


def test_a_contract_has_to_be_shown(proofs: dict[str, Evidence]) -> None:
    """Without it the machine's own property is none of the whole."""
    evidence = proofs["whole"]
    found = evidence.judged({evidence.file("contract-of-listener-holds"): None})
    assert any("listener: keeps what it hears" in one for one in refused(found))
    assert not any("kept is small" in one and "source" in one for one in refused(found))


def test_every_start_of_an_induction_is_needed(proofs: dict[str, Evidence]) -> None:
    """The start over three states presumes two lawful steps: it says nothing of a run that ends before."""
    evidence = proofs["counting"]
    starts = [file for file in evidence.texts if "answered-start" in file]
    assert 3 == len(starts)
    for file in starts:
        assert any("answered" in one for one in refused(evidence.judged({file: None}))), file


ARMED, LEVEL = boolean("armed"), number("i", ONE, 0, 1)
(ONLY,) = modes("ONLY")


def armed() -> TransitionSystem:
    """What was proved of it once, and does not hold: the answer never comes while the input stays 0 (d01)."""
    row = Transition("arm", ONLY, ONLY, (LEVEL >= 1) & ~ARMED, {ARMED: True})
    return lower(Machine("m", (ONLY,), [LEVEL], {ARMED: False}, {}, [row]))


def answered(steps: int) -> Property:
    """Its helper reads an input, which is not the same in two steps."""
    helper = lambda waited: (waited > 0).implies(ARMED & (LEVEL >= 1))  # noqa: E731
    return within("answered", steps, (LEVEL >= 1) & ~was(ARMED), (LEVEL >= 1) & was(ARMED), helper=helper)


def test_an_input_that_is_rigid(monkeypatch: pytest.MonkeyPatch) -> None:
    """d01: where the language would let a helper read an input, z3 and cvc5 confirm every text, and the checker refuses."""
    monkeypatch.setattr("safeloc.language.spec.check_reading", lambda _: None)
    system, prop = armed(), answered(2000)
    verdict = kinduction(observe(system, prop), Limits())
    assert isinstance(verdict, Proved)
    assert all(solved(text).confirmed(0) for text in verdict.certificates.values())
    target = Target("m", system.machines, system, (prop,))
    goals = Goals(target)
    theory = Theory(system, goals)
    useless = theory.take([read(name, text, theory.dag) for name, text in verdict.certificates.items()])
    assert {} == theory.proved
    assert any("not allowed by its rule" in why for why in useless.values())


def test_a_variable_named_like_an_input_of_a_later_step() -> None:
    """Where the language would let a variable have such a name, the checker tells it from that input, by refusing."""
    tick, level = boolean("tick"), number("level", ONE, 0, 3)
    row = Transition("up", ONLY, ONLY, tick & (level < 3), {level: level + 1})
    system = lower(Machine("m", (ONLY,), [tick], {level: 0}, {}, [row]))
    clash = BoolVar("tick@1")
    state = replace(
        system,
        state=(*system.state, clash),
        next={**system.next, clash: clash},
        initial={**system.initial, clash: False},
    )
    theory = Theory(state, lambda _, __: ())
    with pytest.raises(RefusedError, match=r"^a variable has the name of an input of a later step$"):
        theory.together.facts_frame(lawful=False).unrolled(theory.write, 2)
