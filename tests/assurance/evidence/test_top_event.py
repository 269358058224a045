"""The hazards that shipped machines declare name properties of theirs, in every configuration."""

from __future__ import annotations

import pytest

from safeloc.assurance.evidence.top_event import hazard_claims, top_event
from safeloc.catalogue import ENTRIES


@pytest.mark.thorough
def test_every_hazard_names_claims_in_every_configuration() -> None:
    """A pattern that matches nothing is refused."""
    hazardous = 0
    for entry in ENTRIES.values():
        for config in (entry.config(), *entry.configurations.named.values()):
            made = entry.make(config)
            assert top_event(made)
            assert (made.hazard is None) is (hazard_claims(made) == ())
            hazardous += made.hazard is not None
    assert hazardous
