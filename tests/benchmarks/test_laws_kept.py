"""The campaign with the laws kept: every fault that breaks no law, alone and with every other one, on each journey."""

from __future__ import annotations

from benchmarks.laws_kept import FAULTS, declaration
from safeloc.campaign.declaration import parse_campaign
from safeloc.campaign.scenes import check_strata
from safeloc.models.localizer.simulation.journey import UNLAWFUL


def test_the_declaration_has_each_single_and_each_double_fault() -> None:
    """On three journeys; no two faults of a situation are of one group, and weights sum to one, or the file would be refused."""
    campaign = parse_campaign("".join(declaration(7)), "laws-kept.toml")
    check_strata(campaign)
    kinds = [tuple(sorted(fault.kind for fault in one.faults)) for one in campaign.declared.situations]
    number = len(FAULTS)
    assert number >= 12 and not {one.kind for one in FAULTS} & set(UNLAWFUL)
    assert 1 + number + number * (number - 1) // 2 == len(set(kinds)) == len(kinds)
    assert 3 * len(kinds) == len(campaign.strata)
    groups = [[fault.where for fault in one.faults if fault.where != ""] for one in campaign.declared.situations]
    assert all(len(set(some)) == len(some) for some in groups) and any(len(some) == 2 for some in groups)
