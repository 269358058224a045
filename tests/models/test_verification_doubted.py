"""A fibre that may be wrong in everything: what is wrong is withheld, or within figures that are sharp."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import replace
from functools import cache

import pytest

from safeloc.language.expr import FALSE, TRUE, any_of
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, observe
from safeloc.language.system import lower
from safeloc.language.verdict import Violated
from safeloc.models.verification import Verification, VerificationConfig, build, build_doubted, parts
from safeloc.models.verification.judgement import Judgement
from safeloc.proof.provers.bmc import bmc
from safeloc.proof.provers.limits import Limits
from safeloc.properties.verification import properties
from tests.models.everything_proved import unproved_of
from tests.models.inductive import inductive

CONFIG = VerificationConfig()


def made(config: VerificationConfig = CONFIG) -> Verification:
    """The machine as it is built now, among nothing but doubt."""
    return build_doubted(parts(config))


@cache
def right() -> Verification:
    """The machine as it ships."""
    return made()


def named(model: Verification, claim: str) -> Property:
    """The claim of that name."""
    [found] = [one for one in properties(model) if one.name == claim]
    return found


def refuted(machine: Machine, claim: Property) -> bool:
    """Whether a run of a few steps breaks the claim, all laws of the world kept; the interpreter replays it."""
    return isinstance(bmc(observe(lower(machine), claim), Limits(depth=6, seconds=30)), Violated)


@pytest.mark.thorough
def test_everything_is_proved() -> None:
    """Every claim and lemma, without a bound, and what they are for is reached."""
    assert unproved_of(right().machine, properties(right())) == {}


def test_it_is_the_same_machine() -> None:
    """What is doubted and what is believed within its bounds differ in their world, lemmas and words only."""
    believed, doubted = build(parts(CONFIG)).machine, right().machine
    assert repr(doubted.outputs) == repr(believed.outputs)
    assert [repr(row) for row in map(_told, doubted.transitions)] == [
        repr(row) for row in map(_told, believed.transitions)
    ]


def _told(row: object) -> dict[str, object]:
    return {name: value for name, value in vars(row).items() if name != "src"}


def test_nothing_is_assumed_of_the_fibre() -> None:
    """No clause reads anything but the record, when it is due, and the train."""
    from safeloc.language.terms import variables

    own, model = right().own, right()
    heard = {
        own.associated, own.fibre_axles.value, own.fibre_axles.present, own.fibre_length.value, own.fibre_length.present,
        own.fibre_speed.value, own.fibre_speed.present, own.fibre_position.value, own.fibre_position.present, own.fibre_margin_above, own.fibre_margin_below,
        own.located, own.fibre_error, own.chain_tested, own.chain_failed, own.control_axles.value, own.control_length.value,
        own.control_brake.value, own.ends_low.value, own.ends_high.value,
    }  # fmt: skip
    assert not heard & set(variables(list(model.machine.world.terms.values())))


# ------------------------------------------------------------------ the figures are sharp

SHORT = VerificationConfig(currency_cycles=2, place_doubt_limit_mm=300_000)
"""Limits that a search comes to in a few steps."""
SHARP = [
    ("a place at the counter", "place_tolerance_mm"),
    ("a place later", "place_tolerance_mm"),
    ("a place at any time", "place_doubt_limit_mm"),
    ("a place from cycle to cycle", "jump_mm"),
    ("a wrong length withholds", "length_tolerance_mm"),
    ("a distance of the ends", "length_tolerance_mm"),
    ("wrong data by train control withhold", "length_tolerance_mm"),
    ("a speed at the counter", "speed_tolerance_mm_s"),
    ("a fibre without right count or length withholds", "currency_cycles"),
    ("a place whose record is old", "place_doubt_limit_mm"),
]


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize(("claim", "figure"), SHARP, ids=[claim for claim, _ in SHARP])
def test_one_less_is_refuted_by_a_run(claim: str, figure: str) -> None:
    """The figure of a claim is the least one: with one unit less a run breaks it, with the laws kept."""
    model = made(SHORT)
    less = SHORT.model_copy(update={figure: getattr(SHORT, figure) - 1})
    own = copy(model.own)
    own.config = less
    narrower = named(replace(model, own=own), claim)
    assert refuted(model.machine, narrower)


# ------------------------------------------------------------------ wrong edits


EDITS: dict[str, tuple[str, Callable[[Judgement], object], str]] = {
    "nothing is a mismatch": ("mismatch", lambda _: FALSE, "a place at any time"),
    "count ignored": (
        "count_matches",
        lambda j: j.own.associated & j.own.fibre_axles.present,
        "a wrong count withholds",
    ),
    "length ignored": (
        "length_matches",
        lambda j: j.own.associated & j.own.fibre_length.present,
        "a wrong length withholds",
    ),
    "ends ignored": ("ends_apart", lambda _: FALSE, "a distance of the ends"),
    "place at the counter ignored": ("place_fits", lambda _: TRUE, "a place at the counter"),
    "place later ignored": ("out_of_reach", lambda _: FALSE, "a place later"),
    "speed ignored": ("speed_fits", lambda _: TRUE, "a speed at the counter"),
    "jump ignored": ("jumped", lambda _: FALSE, "a place from cycle to cycle"),
    "identity ignored": (
        "missing",
        lambda j: any_of([~j.own.located, ~j.own.fibre_position.present, ~j.own.chain_tested, j.doubtful]),
        "a pattern of nobody",
    ),
    "age of the count ignored": ("current", lambda _: TRUE, "a fibre without right count or length withholds"),
    "age of the place ignored": ("doubtful", lambda _: FALSE, "a place whose record is old"),
    "a record is as new as it comes": (
        "possible",
        lambda j: (j.own.record_place_low, j.own.record_place_high),
        "a record that is handed over is true",
    ),
    "train control's count ignored": (
        "_control_count_differs",
        lambda _: FALSE,
        "wrong data by train control withhold",
    ),
}


@pytest.mark.thorough(ordinary=5)
@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_is_refuted_by_a_run(edit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A check that is left out lets the fibre be wrong beyond its figure: a run shows it, with all laws kept."""
    name, wrong, claim = EDITS[edit]
    monkeypatch.setattr(Judgement, name, property(wrong))
    model = made(SHORT)
    assert refuted(model.machine, named(model, claim))


def test_the_right_machine_keeps_it() -> None:
    """What wrong edits and sharper figures lose, the machine of these limits has."""
    model = made(SHORT)
    asked = {claim for *_, claim in EDITS.values()} | {claim for claim, _ in SHARP}
    assert [claim for claim in asked if not inductive(model.machine, named(model, claim))] == []
