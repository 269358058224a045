"""The delocalized machine: entered in the same step, with its reason kept, and left only through a checked reference."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import pytest

from safeloc.language.expr import FALSE, TRUE, BoolVar
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition
from safeloc.language.monitor import check_all
from safeloc.language.nodes import Value
from safeloc.language.spec import observe
from safeloc.language.system import lower, without_ghosts
from safeloc.language.verdict import Held, Proved, Violated
from safeloc.models.delocalized import DelocalizedConfig, machine
from safeloc.models.vocabulary.absent import NO_MARGIN_MM, NO_POSITION_MM
from safeloc.models.vocabulary.reasons import REASON
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.properties.delocalized import properties

REASONS = [one.label for one in REASON]
CONFIG = DelocalizedConfig(tolerance_mm=1_000)
LIMITS = Limits(seconds=20, induction=1)
Outputs = list[Mapping[str, Value]]


def seen(valid: bool = True, reference: bool = False, reason: str = "NONE", **more: int) -> dict[str, object]:
    """One step of the source."""
    source = {"source_position_mm": 5_000, "source_margin_above_mm": 300, "source_margin_below_mm": 200}
    return {"source_valid": valid, "reference_accepted": reference, "source_reason": reason, **source, **more}


def lost(reason: str = "SENSOR_FAILURE", *, reference: bool = False) -> dict[str, object]:
    """A step in which the source reports nothing."""
    none = {"source_position_mm": 0, "source_margin_above_mm": 0, "source_margin_below_mm": 0}
    return seen(False, reference, reason, **none)


FOUND = seen(reference=True)


def drive(*steps: Mapping[str, object]) -> Outputs:
    """Outputs after each step."""
    return [one.outputs for one in run(without_ghosts(lower(machine(CONFIG))), steps).steps]


def reasons(outputs: Outputs) -> list[str]:
    """The reason in each step, by name."""
    return [REASONS[one["reason"]] for one in outputs]


def restrictive(outputs: Outputs) -> list[bool]:
    """The flag in each step."""
    return [bool(one["restrictive"]) for one in outputs]


# ------------------------------------------------------------------ runs


def test_starts_restrictive() -> None:
    """Before any reference the vehicle is restrictive and no position is passed on, however good the source is."""
    (out,) = drive(seen())
    assert out == {
        "restrictive": True,
        "position_mm": NO_POSITION_MM,
        "margin_above_mm": NO_MARGIN_MM,
        "margin_below_mm": NO_MARGIN_MM,
        "reason": REASONS.index("NO_REFERENCE"),
    }


def test_a_located_source_is_passed_on() -> None:
    """While localized, position and margins are those of the source, in the same step."""
    first, second = drive(FOUND, seen(source_position_mm=6_000, source_margin_above_mm=400))
    assert (first["position_mm"], first["margin_above_mm"], first["margin_below_mm"], first["restrictive"]) == (
        5_000,
        300,
        200,
        False,
    )
    assert (second["position_mm"], second["margin_above_mm"], second["margin_below_mm"]) == (6_000, 400, 200)
    assert reasons([first, second]) == ["NONE", "NONE"]


def test_same_step_entry() -> None:
    """The step in which the source loses its position is the one that is restrictive; nothing is passed on in it."""
    outputs = drive(FOUND, seen(), lost())
    assert restrictive(outputs) == [False, False, True]
    told = (outputs[2]["position_mm"], outputs[2]["margin_above_mm"], outputs[2]["margin_below_mm"])
    assert told == (NO_POSITION_MM, NO_MARGIN_MM, NO_MARGIN_MM)


@pytest.mark.parametrize("side", ["source_margin_above_mm", "source_margin_below_mm"])
def test_too_wide_a_source(side: str) -> None:
    """At the tolerance a position is passed on, one millimetre beyond it is lost, on either side."""
    outputs = drive(FOUND, seen(**{side: 1_000}), seen(**{side: 1_001}))
    assert restrictive(outputs) == [False, False, True]
    assert reasons(outputs) == ["NONE", "NONE", "TOLERANCE"]


@pytest.mark.parametrize("reason", [name for name in REASONS if name != "NONE"])
def test_the_first_reason_stays(reason: str) -> None:
    """The reason of the loss is the source's, and later ones do not replace it."""
    later = "CONTRADICTION" if reason != "CONTRADICTION" else "SENSOR_FAILURE"
    outputs = drive(FOUND, lost(reason), lost(later), seen(source_margin_above_mm=2_000), seen())
    assert reasons(outputs) == ["NONE", *[reason] * 4]
    assert restrictive(outputs) == [False, *[True] * 4]


def test_a_source_without_a_reason() -> None:
    """A source that reports nothing and calls itself located does not leave the vehicle without a reason."""
    assert reasons(drive(FOUND, lost("NONE"))) == ["NONE", "NO_REFERENCE"]


@pytest.mark.parametrize(
    ("step", "left"),
    [
        (FOUND, True),
        (seen(), False),
        (lost(reference=True), False),
        (seen(reference=True, source_margin_above_mm=1_001), False),
        (seen(reference=True, source_margin_below_mm=1_001), False),
        (seen(reference=True, source_margin_above_mm=1_000), True),
    ],
)
def test_left_only_by_a_checked_reference(step: Mapping[str, object], left: bool) -> None:
    """Source valid, within tolerance and reference accepted, all in one step: only that leaves the state."""
    outputs = drive(FOUND, lost(), step)
    assert restrictive(outputs) == [False, True, not left]
    assert reasons(outputs)[2] == ("NONE" if left else "SENSOR_FAILURE")


def test_a_reference_is_not_remembered() -> None:
    """A reference accepted while the source is invalid does not count once the source is valid again."""
    assert restrictive(drive(FOUND, lost(), lost(reference=True), seen(), seen())) == [False, *[True] * 4]


def test_a_second_loss_has_its_own_reason() -> None:
    """Found again, the next loss states its own reason."""
    outputs = drive(FOUND, lost("SENSOR_FAILURE"), FOUND, seen(source_margin_above_mm=1_001))
    assert reasons(outputs) == ["NONE", "SENSOR_FAILURE", "NONE", "TOLERANCE"]


# ------------------------------------------------------------------ proofs, and machines that are wrong


def proved(wrong: Machine, name: str) -> bool:
    """Whether a property is proved of a (possibly broken) machine."""
    prop = next(one for one in properties(wrong, CONFIG) if one.name == name)
    return isinstance(kinduction(observe(lower(wrong), prop), LIMITS), Proved)


def rebuilt(whole: Machine, transitions: list[Transition], **others: Any) -> Machine:
    """The machine with another table, or another field, and the same variables."""
    return replace(whole, transitions=transitions, **others)


def changed(name: str, **changes: object) -> Machine:
    """The machine with one transition changed."""
    whole = machine(CONFIG)
    assert name in [one.name for one in whole.transitions]
    return rebuilt(whole, [replace(t, **changes) if t.name == name else t for t in whole.transitions])


def source_valid(whole: Machine) -> BoolVar:
    """The input of that name."""
    return next(var for var in whole.inputs if isinstance(var, BoolVar) and var.name == "source_valid")


def without(name: str) -> Machine:
    """The machine without one transition."""
    whole = machine(CONFIG)
    return rebuilt(whole, [t for t in whole.transitions if t.name != name])


ALWAYS = [prop.name for prop in properties(machine(CONFIG), CONFIG) if prop.kind == "always"]


@pytest.mark.parametrize("name", ALWAYS)
def test_proved(name: str) -> None:
    """Each property is proved in one step of induction, also of the machine put together again from its table."""
    whole = machine(CONFIG)
    assert proved(whole, name)
    assert proved(rebuilt(whole, list(whole.transitions)), name)


def _no_loss() -> Machine:
    return without("position lost")


def _any_reference() -> Machine:
    return changed("reference accepted", when=TRUE)


def _no_reference_needed() -> Machine:
    whole = machine(CONFIG)
    valid = source_valid(whole)
    table = [replace(t, when=valid) if t.name == "reference accepted" else t for t in whole.transitions]
    return rebuilt(whole, table)


def _late_tolerance() -> Machine:
    whole = machine(CONFIG)
    valid = source_valid(whole)
    table = [replace(t, when=~valid) if t.name == "position lost" else t for t in whole.transitions]
    return rebuilt(whole, table)


def _reason_replaced() -> Machine:
    whole = machine(CONFIG)
    reason = next(var for var in whole.state if var.name == "latched_reason")
    cause = next(var for var in whole.inputs if getattr(var, "name", "") == "source_reason")
    table = [replace(t, set={**t.set, reason: cause}) if t.name == "stay restrictive" else t for t in whole.transitions]
    return rebuilt(whole, table)


def _position_kept() -> Machine:
    whole = machine(CONFIG)
    table = []
    for t in whole.transitions:
        kept = {var: term for var, term in t.set.items() if var.name == "latched_reason"}
        table.append(replace(t, set=kept) if t.name == "position lost" else t)
    return rebuilt(whole, table)


def _never_restrictive() -> Machine:
    whole = machine(CONFIG)
    return rebuilt(whole, list(whole.transitions), outputs={**whole.outputs, "restrictive": FALSE})


BROKEN = {
    "the host is not told": (_never_restrictive, "restrictive"),
    "the loss is forgotten": (_no_loss, "same step"),
    "any step is a reference": (_any_reference, "no resurrection"),
    "no reference is needed": (_no_reference_needed, "no resurrection"),
    "the reason is replaced": (_reason_replaced, "reason latched"),
    "no reason is given": (_reason_replaced, "reason stated"),
    "the position is kept": (_position_kept, "nothing reported"),
}


@pytest.mark.parametrize("what", list(BROKEN))
def test_a_broken_machine_is_noticed(what: str) -> None:
    """With a wrong guard or a wrong value the property that forbids it is not proved any more."""
    make, name = BROKEN[what]
    assert name in ALWAYS
    assert not proved(make(), name)


def test_a_margin_beyond_the_tolerance_is_noticed() -> None:
    """Without the tolerance in the guard a wide source leaves the declared range, and the proof does not go through."""
    assert not proved(_late_tolerance(), "tolerance")


def test_a_stale_position_misses_the_truth() -> None:
    """A machine that passes on the old position is caught: not proved, and a run shows the truth outside."""
    whole = machine(CONFIG)
    table = [replace(t, set={}) if t.name == "position passed on" else t for t in whole.transitions]
    wrong = rebuilt(whole, table)
    assert not proved(wrong, "containment")
    stream = [
        {**FOUND, "next_truth_nm": 5_000 * 10**6},
        seen(source_position_mm=9_000) | {"next_truth_nm": 9_000 * 10**6},
    ]
    for one, kind in ((whole, Held), (wrong, Violated)):
        prop = next(p for p in properties(one, CONFIG) if p.name == "containment")
        (result,) = check_all(run(lower(one), stream), [prop])
        assert isinstance(result, kind)
