"""No claim of a machine that ships depends on the stored number of an absent input."""

from __future__ import annotations

import pytest

from safeloc.catalogue import ENTRIES, load_target
from safeloc.language.verdict import word
from safeloc.proof.provers.absent_in_claims import absence_in_claims
from safeloc.proof.provers.limits import Limits

FEW = ("stop_point", "unlinked_group")
"""The ordinary ones; of the others the lemmas take up to seconds."""


@pytest.mark.parametrize(
    "name", [one if one in FEW else pytest.param(one, marks=pytest.mark.thorough) for one in ENTRIES]
)
def test_no_claim_reads_an_absent_input(name: str) -> None:
    """It would say of a silent sensor that it measures 0, and be proved of a machine that takes silence for a measurement."""
    target = load_target(name)
    found = list(absence_in_claims(target.properties, target.system, Limits()))
    assert {"proved"} >= {word(one.verdict) for one in found}
