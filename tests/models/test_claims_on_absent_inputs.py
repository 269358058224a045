"""No claim of a machine that ships depends on the stored number of an absent input."""

from __future__ import annotations

import pytest

from safeloc.catalogue import ENTRIES, load_target
from safeloc.language.expr import optional
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.proof.provers.absent_in_claims import read_while_absent

FEW = ("stop_point", "unlinked_group")
"""The ordinary ones; of the others a claim takes up to seconds."""
ONE, TWO = modes("ONE", "TWO")


@pytest.mark.parametrize(
    "name", [one if one in FEW else pytest.param(one, marks=pytest.mark.thorough) for one in ENTRIES]
)
def test_no_claim_reads_an_absent_input(name: str) -> None:
    """It would say of a silent sensor that it measures 0, and be proved of a machine that takes silence for a measurement."""
    target = load_target(name)
    assert [] == [
        (claim.name, option.value.name) for claim, option in read_while_absent(target.system, target.properties)
    ]


def test_a_claim_that_does_is_found() -> None:
    """Where another condition implies that the input is present, the value may stand alone; where nothing does, it may not."""
    seen = optional("seen", COUNT, 0, 9)
    rows = [Transition("see", ONE, TWO, seen.present & (seen.value > 3)), Transition("miss", TWO, ONE, ~seen.present)]
    machine = Machine("reader", (ONE, TWO), [seen], {}, {}, rows)
    far = always("seen far", machine.fired("see").implies(seen.value > 3))
    near = always("near", machine.mode.eq(ONE).implies(seen.value <= 3))
    assert [(near, seen)] == list(read_while_absent(lower(machine), [far, near]))
