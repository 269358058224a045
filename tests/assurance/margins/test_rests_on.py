"""What a claim rests on: a world that moves only elsewhere keeps the claim, and a world that moves there is asked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest

from safeloc.assurance.margins.moved_world import in_world_of
from safeloc.assurance.margins.rests_on import RestsOn, from_data, rests_on, to_data
from safeloc.language.expr import maximum, minimum, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import Property, always, observe
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import MM
from safeloc.language.verdict import Proved, Violated
from safeloc.language.world import Law, World
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove_one

LIMITS = Limits(seconds=10)
FIGURES = {"error": 3, "wander": 5, "drift": 1, "most": 50}
(ON,) = modes("ON")


def made(given: Mapping[str, int]) -> Machine:
    """A machine that reports what it measures; the truth beside it is off by an error that wanders, and something else drifts."""
    measured, shown = number("measured_mm", MM, 0, 1_000), number("shown_mm", MM, 0, 1_000)
    truth, drifted = number("truth_mm", MM, -10, given["most"] + 1_000), number("drifted_mm", MM, 0, 1_000)
    wander, noise = number("wander_mm", MM, 0, 100), number("noise_mm", MM, 0, 100)
    return Machine(
        name="shown",
        modes=(ON,),
        inputs=[measured],
        state={shown: 0},
        outputs={"shown_mm": shown},
        transitions=[Transition("show", ON, ON, set={shown: measured})],
        world=World(
            ghosts={truth: 0, drifted: 0},
            choices=[wander, noise],
            moves={
                truth: measured + minimum(wander, given["wander"]),
                drifted: minimum(maximum(drifted, noise) + given["drift"], 1_000),
            },
            clauses={"error": Law(wander <= given["error"], "It errs so far."), "noise": Law(noise <= 7, "So loud.")},
        ),
    )


def claims(system: TransitionSystem) -> dict[str, Property]:
    by_name = {var.name: var for var in system.state}
    shown, truth, drifted = (by_name[name] for name in ("shown_mm", "truth_mm", "drifted_mm"))
    assert shown.unit == truth.unit == drifted.unit == MM  # type: ignore[union-attr] # they are numbers
    near = truth - shown <= 3  # type: ignore[operator]
    return {one.name: one for one in (always("near", near), always("on board", shown >= 0))}  # type: ignore[operator]


@pytest.fixture(name="base", scope="module")
def _base() -> TransitionSystem:
    return lower(made(FIGURES))


@pytest.fixture(name="near", scope="module")
def _near(base: TransitionSystem) -> RestsOn:
    found = rests_on(base, claims(base)["near"], LIMITS)
    assert found is not None
    return found


def is_moved(base: TransitionSystem, found: RestsOn, **figures: int) -> bool:
    return found.is_moved_by(in_world_of(base, lower(made({**FIGURES, **figures}))))


def test_a_claim_rests_on_the_law_and_the_move_that_its_proof_uses(near: RestsOn) -> None:
    assert {one.name for one in near.clauses} == {"error"}
    assert near.moves == {"truth_mm"}
    assert "drifted_mm" not in near.reads


def test_a_claim_over_board_alone_rests_on_nothing_of_the_world(base: TransitionSystem) -> None:
    found = rests_on(base, claims(base)["on board"], LIMITS)
    assert found is not None
    assert (frozenset(), frozenset()) == (found.clauses, found.moves)
    assert not is_moved(base, found, error=4, wander=9, drift=2, most=60)


@pytest.mark.parametrize(
    ("figure", "value", "moved"), [("drift", 2, False), ("error", 4, True), ("wander", 2, True), ("most", 60, True)]
)
def test_what_moves_it(base: TransitionSystem, near: RestsOn, figure: str, value: int, moved: bool) -> None:
    """A clause and a move that it uses, and the range of a variable that it reads; not a ghost beside it."""
    assert is_moved(base, near, **{figure: value}) is moved


def test_a_claim_that_is_not_moved_is_proved_there_and_one_that_is_can_be_broken(base: TransitionSystem) -> None:
    verdicts = {}
    for name, figures in {"beside": {"drift": 9}, "in it": {"error": 4}}.items():
        world = in_world_of(base, lower(made({**FIGURES, **figures})))
        verdicts[name] = prove_one(observe(world.system, world.claim(claims(base)["near"])), LIMITS)
    assert isinstance(verdicts["beside"], Proved)
    assert isinstance(verdicts["in it"], Violated)


def test_of_a_claim_that_no_induction_proves_nothing_is_known(base: TransitionSystem) -> None:
    broken = always("nearer", claims(base)["near"].term & (base.variable("shown_mm") <= 5))  # type: ignore[operator]
    assert rests_on(base, broken, replace(LIMITS, induction=1)) is None


def test_data_come_back(near: RestsOn) -> None:
    assert from_data(to_data(near)) == near
    assert from_data(to_data(None)) is None
