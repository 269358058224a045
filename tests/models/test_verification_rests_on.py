"""What a followed train's trust is told to rest on, and what is stored and forgotten: an update that is skipped loses its claim."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

from safeloc.models.verification import Verification, VerificationConfig, build, parts
from safeloc.properties.verification.rests_on import properties
from tests.models.inductive import changed, inductive


@cache
def made() -> Verification:
    """The machine with its variables."""
    return build(parts(VerificationConfig()))


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize(
    ("row", "kept", "claim"),
    [
        ("reference accepted", "by_count", "verified_count is of the last verification"),
        ("not verified now", "by_length", "verified_length is of the last verification"),
        ("reference accepted", "by_speed_at_entry", "verified_speed_at_entry is reported if it was compared"),
        ("reference accepted", "by_place_at_entry", "verified_place_at_entry is reported if it was compared"),
        ("verified", "by_control_data", "train control is reported if it agreed"),
        ("still verified", "by_emitter", "the emitter is reported if it was tested"),
        ("verified", "why", "a trusted train is verified"),
        ("not verified now", "why", "a withheld train has the first reason"),
        ("reference accepted", "front_margin_above_mm", "the last reading of each kind is stored"),
        ("mismatch", "last_length_mm", "nothing is kept of a train that is gone or untrusted"),
        ("train has left", "given_out", "without a train there is no record and nothing to revoke"),
    ],
)
def test_a_skipped_update_is_noticed(row: str, kept: str, claim: str) -> None:
    """The claim is inductive for the machine, and no longer where one row keeps the old value."""
    right = made()
    [transition] = [one for one in right.machine.transitions if one.name == row]
    updates = {var: value for var, value in transition.set.items() if var.name != kept}
    assert len(transition.set) - 1 == len(updates)
    wrong = replace(right, machine=changed(right.machine, row, set=updates))
    by_model = [next(one for one in properties(model) if one.name == claim) for model in (right, wrong)]
    assert inductive(right.machine, by_model[0])
    assert not inductive(wrong.machine, by_model[1], claim)
