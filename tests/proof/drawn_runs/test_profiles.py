"""Stretches of inputs: they are in range and repeatable from their seed, and each kind does what its name says."""

from __future__ import annotations

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.language.expr import NumVar, boolean, choice, enumeration, members, number, optional
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, canonical, lower
from safeloc.language.units import COUNT, MM
from safeloc.proof.drawn_runs.profiles import FAULTY, PLAUSIBLE, Profile

KINDS = tuple(dict.fromkeys(PLAUSIBLE + FAULTY))
(ON,) = modes("ON")
LAMPS = members("lamp", "OFF", "DIM", "FULL")
WHEEL, RADAR = number("wheel_mm", MM, -500, 500), number("radar_mm", MM, -500, 500)
MARKER, PLACE = optional("marker", COUNT, 0, 1_000), optional("place_mm", MM, -(10**6), 10**6)
LAMP, DOOR = choice("lamp", enumeration(LAMPS)), boolean("door")
WAITING, POSITION = number("waiting", COUNT, 0, 1_000), number("position_mm", MM, -(10**6), 10**6)


def _system() -> TransitionSystem:
    idle = Transition("idle", ON, ON)
    state = {WAITING: 741, POSITION: 123_456}
    return lower(Machine("train", (ON,), [WHEEL, RADAR, MARKER, PLACE, LAMP, DOOR], state, {}, [idle]))


SYSTEM = _system()
STATE: dict[object, Value] = {SYSTEM.state[0]: 0, WAITING: 741, POSITION: 123_456}


def _drawn(kind: str, seed: int, steps: int = 40) -> list[dict[str, Value]]:
    profile = Profile(SYSTEM, kind, random.Random(seed))
    rows = [profile.inputs(STATE) for _ in range(steps)]  # type: ignore[arg-type]
    return [{var.name: value for var, value in row.items()} for row in rows]


@pytest.mark.parametrize("kind", KINDS)
@given(st.integers(0, 2**16))
def test_the_machine_takes_every_stretch(kind: str, seed: int) -> None:
    """Values are in range, absent ones canonical, and one seed gives one stretch."""
    rows = _drawn(kind, seed, 15)
    assert rows == _drawn(kind, seed, 15)
    assert 15 == len(run(SYSTEM, rows).steps)
    for option in SYSTEM.optionals:
        absent = [row for row in rows if not row[option.present.name]]
        assert {row[option.value.name] for row in absent} <= {canonical(option.value)}


def _share(kind: str, ok: object) -> float:
    stretches = [_drawn(kind, seed) for seed in range(200)]
    return sum(bool(ok(rows)) for rows in stretches) / len(stretches)  # type: ignore[operator]


def test_sensors_of_one_train_move_together() -> None:
    """In a steady stretch both distances are mostly the same and stay so."""
    assert 0.6 < _share("steady", lambda rows: len({(row["wheel_mm"], row["radar_mm"]) for row in rows}) == 1)
    assert 0.6 < _share("steady", lambda rows: all(row["wheel_mm"] == row["radar_mm"] for row in rows))


def test_one_sensor_at_fault() -> None:
    """In a faulty stretch one distance departs from the other."""
    for kind in ("zero", "scaled", "stuck"):
        assert 0.1 < _share(kind, lambda rows: any(row["wheel_mm"] != row["radar_mm"] for row in rows))
    assert 0.9 < _share("silent", lambda rows: True)


def test_every_member_occurs() -> None:
    """Enumerated and truth-valued inputs take every value."""
    rows = [row for seed in range(60) for row in _drawn("steady", seed)]
    assert {0, 1, 2} == {row["lamp"] for row in rows}
    assert {False, True} == {row["door"] for row in rows}


def test_what_the_machine_knows_is_repeated() -> None:
    """Many readings meet an expected identity and the present position exactly, which uniform draws never do."""
    rows = [row for seed in range(60) for row in _drawn("random", seed)]
    assert 20 < sum(row["marker"] == 741 for row in rows)
    assert 20 < sum(row["place_mm"] == 123_456 for row in rows)


def test_the_environment_leans_to_one_side() -> None:
    """With a lean, each value picked in the stretch is at the same end of the allowed interval."""
    for seed in range(20):
        profile = Profile(SYSTEM, "steady", random.Random(seed), random.Random(seed))
        picked = {profile.pick(WHEEL, low, low + 10) - low for low in range(0, 100, 10)}
        assert 1 == len(picked)
    free = Profile(SYSTEM, "steady", random.Random(0))
    assert 2 < len({free.pick(WHEEL, 0, 10) for _ in range(50)})


def test_ends_are_ends() -> None:
    """`ends` gives the ends of the range and rest, except for inputs that repeat the state."""
    rows = [row["wheel_mm"] for seed in range(40) for row in _drawn("ends", seed)]
    assert 0.8 < sum(value in (-500, 0, 500) for value in rows) / len(rows)
    assert isinstance(WHEEL, NumVar)
