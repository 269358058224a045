"""The junction on the freight train's journey: linking is replaced before it, and no group of another branch counts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import pytest

from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_MM
from safeloc.models.balise import variables as v
from safeloc.models.localizer.simulation.journeys import ASIDE, FREIGHT, OFF_THE_FIBRE, SET_MM, SWITCH_MM, THROUGH
from safeloc.models.localizer.simulation.simulate import Journey, Steps, motion_of, simulate
from safeloc.simulation.faults import Fault
from tests.models.localizer_runs import CONFIG, Told, run

OTHER = "other branch taken"
STALE = "linking not replaced"
BRANCHES = [{group.identity for group in branch} for branch in (THROUGH, ASIDE)]


def gone_wrong(*kinds: str) -> Journey:
    """The freight journey with what goes wrong at its junction."""
    return replace(FREIGHT, troubles=[Fault(kind) for kind in kinds])


@cache
def told(*kinds: str) -> Told:
    """What is told on it."""
    return run(gone_wrong(*kinds))


def cycle_at(place_mm: int) -> int:
    """The first cycle at whose end the front end is there."""
    places = [int(place) for place in motion_of(CONFIG, FREIGHT).position_nm]
    return next(cycle for cycle, place in enumerate(places) if place >= place_mm * NM_PER_MM)


def behind(one: Told, name: str) -> list[Value]:
    """An output in every cycle from the switch on."""
    return [out[name] for out in one.outputs[cycle_at(SWITCH_MM) :]]


def announced(steps: Steps, order: str) -> list[tuple[int, object]]:
    """Cycles and groups of announcements of one order."""
    return [
        (cycle, step.get("balise.linking_group"))
        for cycle, step in enumerate(steps)
        if step.get("balise.linking_order") == order
    ]


def test_both_branches_have_groups_equally_far_behind_the_switch() -> None:
    """Only identities tell them apart."""
    assert [group.place_mm for group in THROUGH] == [group.place_mm for group in ASIDE]
    assert not BRANCHES[0] & BRANCHES[1]
    assert min(group.place_mm for group in THROUGH) > SWITCH_MM > SET_MM


def test_linking_is_replaced_before_the_switch() -> None:
    """Groups of the other branch are announced until the route is set, and of its own branch alone from then on."""
    steps, set_at = simulate(CONFIG, FREIGHT, seed=3), cycle_at(SET_MM)
    assert announced(steps, "REPLACE") == [(set_at, THROUGH[0].identity)]
    added = announced(steps, "ADD")
    assert ASIDE[0].identity in {group for cycle, group in added if cycle < set_at}
    assert not BRANCHES[1] & {group for cycle, group in added if cycle > set_at}
    assert not BRANCHES[1] & {out["balise.expected"] for out in told().outputs[set_at:]}
    assert ASIDE[0].identity in {out["balise.expected"] for out in told().outputs[:set_at]}


def test_without_the_change_nothing_is_replaced() -> None:
    """Linking that is not replaced never comes to name a group of the route behind the switch."""
    steps = simulate(CONFIG, gone_wrong(STALE), seed=3)
    assert announced(steps, "REPLACE") == []
    assert not BRANCHES[0] & {group for _, group in announced(steps, "ADD")}


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("kind", [OTHER, STALE])
def test_no_group_that_is_not_announced_counts(kind: str) -> None:
    """Groups are read behind the switch and none is accepted: not announced, and later without a place on the route."""
    one = told(kind)
    judged = [verdict for verdict in behind(one, "balise.telegram") if verdict != v.NONE.value]
    located = judged.count(v.NOT_ANNOUNCED.value)  # how long balises locate depends on the odometer's errors
    assert judged == [v.NOT_ANNOUNCED.value] * located + [v.NO_PLACE.value] * (6 - located)
    assert 1 <= located <= 2
    assert not any(behind(one, "balise.reference_accepted"))
    assert one.fired["balise: expected group missed"] == located
    assert one.standings["WRONG"] == 0


@pytest.mark.parametrize(("kind", "last_mm"), [(OTHER, 1_200_000), (STALE, 2_030_000)])
def test_every_source_is_withdrawn_and_none_comes_back(kind: str, last_mm: int) -> None:
    """On the other branch 250 m behind the switch nothing is left; with stale linking the fibre lasts to its end."""
    outputs = told(kind).outputs[cycle_at(last_mm) :]
    assert len(outputs) > 200
    assert all(out["delocalized.restrictive"] for out in outputs)
    assert any(not one for one in behind(told(kind), "delocalized.restrictive"))


def test_the_fibre_ends_trust_at_the_switch_and_satellites_are_withheld() -> None:
    """On the other branch; on the route satellites count again behind the first group, and with stale linking the fibre goes on."""
    one, at = told(OTHER), cycle_at(SWITCH_MM)
    assert one.outputs[at - 1]["downlink.valid"]
    assert not any(behind(one, "verification.trusted"))
    assert not any(out["downlink.valid"] for out in one.outputs[at + 12 :])
    assert {kind: max(int(usable) for usable in behind(told(*kind), "selection.usable")) for kind in ((), (OTHER,), (STALE,))} == {
        (): 8, (OTHER,): 0, (STALE,): 0,
    }  # fmt: skip
    assert told(STALE).outputs[cycle_at(1_900_000)]["downlink.valid"]


def test_stale_linking_for_the_branch_that_is_taken_locates() -> None:
    """Both together: what is announced happens to be what lies ahead; groups count, and the distance is right."""
    one = told(OTHER, STALE)
    assert one.standings["WRONG"] == 0
    assert any(behind(one, "balise.reference_accepted"))
    assert one.fired["balise: expected group missed"] == 0


def test_a_telegram_with_a_place_of_its_own_is_refused_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """While balises locate, a group that is not announced does not count, were it placed as far as the one expected."""
    place = {group.identity: group.place_mm for group in ASIDE}

    def placed(*args: object, **named: object) -> Steps:
        steps = simulate(*args, **named)  # type: ignore[arg-type]
        return [step | _place(step.get("balise.telegram_group"), place) for step in steps]

    monkeypatch.setattr("tests.models.localizer_runs.simulate", placed)
    one = run(gone_wrong(OTHER))
    assert one.standings["WRONG"] == 0
    assert (
        behind(one, "balise.telegram")[cycle_at(ASIDE[0].place_mm) - cycle_at(SWITCH_MM) :][:10].count(v.ACCEPTED.value)
        == 0
    )
    assert 1 <= one.fired["balise: expected group missed"] <= 2


def _place(group: object, place: dict[int, int]) -> dict[str, int | str]:
    if not isinstance(group, int) or group not in place:
        return {}
    return {"balise.telegram_position_mm": place[group], "balise.telegram_orientation": "NOMINAL"}


def test_a_train_announced_off_the_fibre_goes_on_with_the_others() -> None:
    """The fibre's position ends with the switch; satellites and balises locate on, and nothing is wrong."""
    one, at = run(OFF_THE_FIBRE), cycle_at(SWITCH_MM)
    assert one.standings["WRONG"] == 0
    assert not any(out["downlink.valid"] for out in one.outputs[at + 12 :])
    located: Sequence[bool] = [not out["delocalized.restrictive"] for out in one.outputs[at : cycle_at(2_200_000)]]
    assert all(located)
    assert behind(one, "balise.reference_accepted").count(True) >= 5
    assert one.fired["balise: expected group missed"] == 0
