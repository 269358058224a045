"""Repaired inputs satisfy the assumption, even if several parts restrict one input; first states satisfy `initially`."""

from __future__ import annotations

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.catalogue import load_target
from safeloc.errors import InputError
from safeloc.language.expr import all_of, between, boolean, exact_to, number, optional
from safeloc.language.interpret import evaluate, start
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.system import TransitionSystem, environment, lower
from safeloc.language.units import MM, NM
from safeloc.language.world import World
from safeloc.models import odometry
from safeloc.proof.drawn_runs.lawful import Repair, first_state
from safeloc.proof.drawn_runs.profiles import PLAUSIBLE, Profile
from tests.examples import EXAMPLES, Example

(ON,) = modes("ON")
STEP = number("distance_mm", MM, -100, 100)
SEEN = optional("seen_mm", MM, -1_000, 1_000)
TRUTH, MOVED = number("truth_nm", NM, -(10**9), 10**9), number("moved_nm", NM, -(10**9), 10**9)


def _coupled() -> TransitionSystem:
    """A step within 1 mm of the truth's, and a reading within 1 mm of where the truth is: both bind `moved`."""
    after = TRUTH + MOVED
    law = between(-1_000_000, MOVED - exact_to(STEP, NM), 1_000_000)
    exact = SEEN.present.implies(between(-1_000_000, after - exact_to(SEEN.value, NM), 1_000_000))
    idle = Transition("idle", ON, ON)
    return lower(
        Machine(
            "coupled",
            (ON,),
            [STEP, SEEN],
            {},
            {},
            [idle],
            world=World(
                ghosts={TRUTH: ANY},
                choices=[MOVED],
                moves={TRUTH: after},
                clauses={"assumption": all_of([law, exact, between(-(10**9), after, 10**9)])},
                reads_machine="the test asks it",
            ),
            initially=between(-3, TRUTH, 3),
        )
    )


@given(st.integers(-(10**9), 10**9), st.integers(0, 2**16))
def test_coupled_parts_are_repaired_together(truth: int, seed: int) -> None:
    """A reading and a measured distance that both bind the true movement are made lawful, at the third draw at the latest."""
    system, draw = _coupled(), random.Random(seed)
    seen = SEEN.value.low + draw.randrange(2_001)
    drawn = {STEP: draw.randint(-100, 100), SEEN.present: True, SEEN.value: seen, MOVED: draw.randint(-(10**9), 10**9)}
    state = {system.state[0]: 0, TRUTH: truth}
    repair = Repair(system)
    mended = next(filter(None, (repair.mend(state, drawn, draw) for _ in range(3))), None)
    assert mended is not None
    assert evaluate([environment(system)], {**state, **mended})[0]


def test_most_readings_survive_repair() -> None:
    """A measurement is left out only as the last resort."""
    system, draw, kept = _coupled(), random.Random(1), 0
    repair = Repair(system)
    for _ in range(200):
        truth = draw.randint(-(9 * 10**8), 9 * 10**8)
        drawn = {STEP: 50, SEEN.present: True, SEEN.value: draw.randint(-1_000, 1_000), MOVED: 0}
        mended = repair.mend({system.state[0]: 0, TRUTH: truth}, drawn, draw)
        assert mended is not None
        kept += bool(mended[SEEN.present])
    assert kept > 100


def test_nothing_lawful_is_said_so() -> None:
    """If no inputs satisfy the assumption, the repair returns none."""
    flag = boolean("flag")
    machine = Machine(
        "never",
        (ON,),
        [flag, STEP],
        {},
        {},
        [Transition("idle", ON, ON)],
        world=World(clauses={"assumption": flag & ~flag}, reads_machine="the test asks it"),
    )
    drawn = {flag: True, STEP: 3}
    assert Repair(lower(machine)).mend({machine.mode: 0}, drawn, random.Random(0)) is None


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_drawn_stretches_become_lawful(example: Example) -> None:
    """Of the steps that the rules draw for the examples, every one can be repaired, and the repaired ones are lawful."""
    _all_lawful(example.system, steps=20)


def test_odometry_becomes_lawful() -> None:
    """The same is true of the odometry machine, whose assumption has many parts."""
    _all_lawful(lower(odometry.machine()), steps=30)


@pytest.mark.parametrize("name", ["sections", "selection"])
def test_laws_of_two_broken_figures_are_mended_part_by_part(name: str) -> None:
    """A train whose front and rear both leapt, and a signal whose range and rate are both wrong: no single value mends their law."""
    _all_lawful(load_target(name).system, steps=10)


def _all_lawful(system: TransitionSystem, steps: int) -> None:
    repair, law = Repair(system), environment(system)
    state = {var: value for var, value in zip(system.state, _first(system), strict=True)}
    for number_, kind in enumerate(PLAUSIBLE):
        profile = Profile(system, kind, random.Random(number_))
        for _ in range(steps):
            mended = repair.mend(state, profile.inputs(state), profile.draw, profile.pick)
            assert mended is not None
            assert evaluate([law], {**state, **mended})[0]
            moved = evaluate(system.next.values(), {**state, **mended})
            state = dict(zip(system.next, moved, strict=True))


def _first(system: TransitionSystem) -> list[int | bool]:
    return list(start(system, first_state(system, random.Random(0))).values())


@given(st.integers(0, 2**16))
def test_first_states_satisfy_initially(seed: int) -> None:
    """Open initial variables are chosen so that `initially` holds, even if they begin far from zero."""
    system = _coupled()
    chosen = first_state(system, random.Random(seed), adventurous=1.0)
    assert set(chosen) == {"truth_nm"}
    assert -3 <= chosen["truth_nm"] <= 3


def test_a_first_state_is_drawn_anew() -> None:
    """Repairs may go round between the ends of ranges; then another draw begins, and each time one succeeds."""
    low, high = number("low_mm", MM, -100, 100), number("high_mm", MM, -100, 100)
    machine = Machine(
        "ends",
        (ON,),
        [STEP],
        {},
        {},
        [Transition("idle", ON, ON)],
        world=World(ghosts={low: ANY, high: ANY}, moves={low: low, high: high}),
        initially=(low < high) & (low >= -90) & (high <= 90),
    )
    for seed in range(100):
        first = first_state(lower(machine), random.Random(seed), adventurous=1.0)
        assert -90 <= first["low_mm"] < first["high_mm"] <= 90


def test_no_first_state_is_wrong_input() -> None:
    """A machine without a possible first state is refused with that reason."""
    open_, other = number("open_mm", MM, 0, 5), number("other_mm", MM, 0, 5)
    machine = Machine(
        "stuck",
        (ON,),
        [STEP],
        {},
        {},
        [Transition("idle", ON, ON)],
        world=World(ghosts={open_: ANY, other: ANY}, moves={open_: open_, other: other}),
        initially=(open_ < other) & (other < open_),
    )
    with pytest.raises(
        InputError, match=r"^stuck: no first state found that satisfies `initially`; give one explicitly\.$"
    ):
        first_state(lower(machine), random.Random(0))
