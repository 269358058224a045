"""The mutation analysis of one target: what is chosen, who is told, and what is refused."""

from __future__ import annotations

import pytest

from safeloc.assurance.mutation.analysis import Analysis
from safeloc.assurance.mutation.declared import declared
from safeloc.assurance.mutation.places import noted
from safeloc.assurance.mutation.reasons import Reasons
from safeloc.assurance.mutation.results import Judged
from safeloc.assurance.mutation.work import Plan
from safeloc.errors import InputError
from safeloc.proof.provers.limits import Limits
from tests.assurance.mutation import door

PLAN = Plan(Limits(seconds=2), 0, 2)


def test_of_a_machine() -> None:
    """The number to judge is told before the first result; results come with the number of all mutants."""
    told: list[int | Judged] = []
    with noted() as places:
        target, _ = declared("tests.assurance.mutation.gate:machine")
    found = Analysis(target, places, PLAN, Reasons(), told.append, told.append, most=3).of(["machine"])
    assert (3, 3, {}) == (told[0], len(found.judged), found.reasons)
    assert {one.id for one in found.judged} == {one.id for one in told[1:] if isinstance(one, Judged)}
    assert found.of > 3
    (one,) = (
        Analysis(target, places, PLAN, Reasons(), told.append, told.append, only=[found.judged[0].id])
        .of(["machine"])
        .judged
    )
    assert one.id == found.judged[0].id


def test_of_a_composition() -> None:
    """Its machines and wires are judged; worlds and claims are those of one machine."""
    told: list[int | Judged] = []
    with noted() as places:
        target = door.target()
    analysis = Analysis(target, places, PLAN, Reasons(), told.append, told.append, most=2)
    assert 2 == len(analysis.of(["machine"]).judged)
    with pytest.raises(
        InputError, match=r"^watched_door is a composition: .* give one of its machines: watch, door\.$"
    ):
        analysis.of(["world"])
