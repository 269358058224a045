"""Proofs of the reflector machine notice a wrong model: each guard, each margin and each rule is broken on purpose."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest

from safeloc.language.expr import Bool, Expr, Lit, Num, Var
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.system import lower
from safeloc.language.verdict import word
from safeloc.models.reflector import ReflectorMachine, build, echo
from safeloc.models.reflector.echo import AMBIGUOUS, NOT_SEARCHED, OTHER_MODEL, OUT_OF_WINDOW, TOO_COARSE, WEAK
from safeloc.models.reflector.variables import ReflectorConfig, parts
from safeloc.models.vocabulary.first_of import first_of
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.reflector import properties
from tests.models.inductive import changed, inductive, without

ONE_SLOT = ReflectorConfig(echo_slots=1)


def model(config: ReflectorConfig = ONE_SLOT) -> ReflectorMachine:
    """A machine with its terms."""
    return build(parts(config))


def named(made: ReflectorMachine, name: str, machine: Machine | None = None) -> Property:
    """One property, of the machine itself or of a broken one over the same variables."""
    whole = made if machine is None else replace(made, machine=machine)
    return next(prop for prop in properties(whole) if prop.name == name)


def updates(made: ReflectorMachine, name: str) -> Mapping[Var, Expr | int | bool]:
    """What a transition sets."""
    return next(t.set for t in made.machine.transitions if t.name == name)


def test_the_sound_machine_keeps_its_lemmas() -> None:
    """Nothing is broken in the machine as it is."""
    made = model()
    assert inductive(made.machine, named(made, "containment"))


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize(
    ("dropped", "broken"),
    [
        (WEAK, "minimum intensity"),
        (OTHER_MODEL, "the target is never mistaken"),
        (OUT_OF_WINDOW, "the target is never mistaken"),
        (AMBIGUOUS, "the target is never mistaken"),
        (AMBIGUOUS, "the next reflector is never mistaken"),
        (TOO_COARSE, "tolerance"),
        (NOT_SEARCHED, "no self-test passes before the prescribed search distance"),
    ],
    ids=lambda value: value.label if isinstance(value, Lit) else value,
)
def test_each_check_of_an_echo_is_needed(dropped: Lit, broken: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without one of the checks some reflector is taken for another, or a property is lost."""

    def lenient(*cases: tuple[Bool, Num], default: Num) -> Num:
        return first_of(*(case for case in cases if case[1] is not dropped), default=default)

    monkeypatch.setattr(echo, "first_of", lenient)
    made = model()
    if broken == "tolerance":
        assert not inductive(made.machine, named(made, broken), "range of own_margin_above_nm")
    else:
        assert not inductive(made.machine, named(made, broken), broken)


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize(
    "name", ["reflector tracked", "reflector found", "self-test passed", "next reflector takes over"]
)
@pytest.mark.parametrize("side", ["above", "below"])
def test_an_optimistic_measurement_is_noticed(name: str, side: str) -> None:
    """A measured interval that is one nanometre too narrow does not hold the truth, or, in the cycle of a self-test, where the
    balise is known better still, not where the radar has the truth."""
    made = model()
    var = getattr(made.own.track, side)
    narrower = updates(made, name)[var]
    assert isinstance(narrower, Num)
    broken = changed(made.machine, name, set={**updates(made, name), var: narrower - 1})
    lost = "holds where the radar has the truth" if name == "self-test passed" else "holds the truth"
    assert not inductive(broken, named(made, "containment"), f"a measured interval {lost}")


def test_a_forgotten_constant_is_noticed() -> None:
    """Running on from a measured reflector without charging the odometer's one-off constant loses the truth."""
    made = model()
    run_on = made.own.odometer.run_on(made.own.track.interval)
    broken = changed(
        made.machine, "echo missing", set={**updates(made, "echo missing"), **made.own.track.become(run_on)}
    )
    assert not inductive(broken, named(made, "containment"), "a dead-reckoned interval holds the truth")


def test_a_continuation_from_the_balise_is_noticed() -> None:
    """After the view zone odometry goes on from the last measured position, not from an older one."""
    made = model()
    older = made.own.track.become(made.judgement.anchored)
    broken = changed(made.machine, "reflector lost", set={**updates(made, "reflector lost"), **older})
    assert not inductive(broken, named(made, "goes on from the last position"), "goes on from the last position")


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize(
    ("transition", "fields", "prop"),
    [
        ("reflector not found", {"target": 3}, "a missing reflector ends the procedure"),
        ("reflector passed unseen", {"target": 3}, "nothing is skipped"),
        ("self-test failed", {"target": 3}, "a mismatch ends the procedure"),
        ("not ready", {"target": 3}, "no retry"),
        ("odometry zone", {"target": 5}, "clutter is no reflector"),
        ("search goes on", {"target": 5}, "errors of radar and survey make up the margins"),
        ("echo missing", {"target": 5}, "minimum intensity"),
        ("measurement pauses", {"target": 5}, "unfit echoes change nothing"),
        ("wait for a balise", {"target": 1}, "no resurrection"),
        ("route contradicted", {"target": 1}, "a contradicted route is not reported"),
    ],
)
def test_a_wrong_target_mode_is_noticed(transition: str, fields: dict[str, int], prop: str) -> None:
    """A transition that leads to the wrong mode is found by the property that it hurts."""
    made = model()
    broken = changed(made.machine, transition, target=made.machine.modes[fields["target"]])
    assert not inductive(broken, named(made, prop, broken), prop)


@pytest.mark.parametrize(
    ("transition", "prop"),
    [
        ("measuring error drifts", "error is constant"),
        ("route contradicted", "a contradicted route is not reported"),
    ],
)
def test_a_forgotten_transition_is_noticed(transition: str, prop: str) -> None:
    """Without the transition its property is lost."""
    made = model()
    assert inductive(made.machine, named(made, prop))
    broken = without(made.machine, transition)
    assert not inductive(broken, named(made, prop, broken), prop)


def test_a_retry_is_noticed() -> None:
    """A self-test that may be repeated over the same balise breaks `no retry`."""
    made = model()
    again = made.own.balise.read & made.own.ahead.known
    broken = changed(made.machine, "reference measurement begins", when=again)
    assert not inductive(broken, named(made, "no retry", broken), "no retry")


@pytest.mark.thorough
def test_readiness_without_a_test_is_noticed() -> None:
    """A way into readiness that leaves out the self-test is found: readiness no longer follows from a passed test."""
    made = model()
    shortcut = changed(made.machine, "balise without self-test", target=made.machine.modes[3])
    assert inductive(made.machine, _ready_by_test(made.machine))
    assert not inductive(shortcut, _ready_by_test(shortcut), "ready by test")


def _ready_by_test(machine: Machine) -> Property:
    ready = machine.flag("ready")
    passed = machine.fired("self-test passed", "self-test passed at the balise")
    return always("ready by test", (ready & ~earlier_bool(ready)).implies(passed))


VARIANTS = {
    "as shipped": ReflectorConfig(),
    "one echo, radar in the middle": ReflectorConfig(echo_slots=1, radar_offset_mm=20_000),
    "system variable, no latency": ReflectorConfig(
        echo_slots=1, reference_distance_mm=80_000, frame_latency_ms=0, balise_latency_ms=0
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", VARIANTS)
def test_variant_is_proved(name: str) -> None:
    """Every property is proved without bound and re-checked, for several configurations."""
    made = model(VARIANTS[name])
    findings = prove(lower(made.machine), properties(made), Limits(seconds=60), jobs=2)
    assert {finding.id: word(finding.result) for finding in findings if word(finding.result) != "proved"} == {}
