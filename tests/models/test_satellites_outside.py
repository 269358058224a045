"""Satellites outside of the list of usable ones: whatever their signals say, the solution is the same to the last digit (SAT-5).

The receiver's clock is not known before the list is: the criterion takes it from all that is visible. The solution must not.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from safeloc.models.satellite import chain as chains
from safeloc.models.satellite.chain import EpochChain, Outcome
from safeloc.sensing.satellite.almanac import Almanac
from safeloc.sensing.satellite.epochs import Epoch, Measured
from safeloc.sensing.satellite.figures import LIGHT_M_PER_S
from safeloc.sensing.satellite.solution import Look, Solution, Weighting, solve
from safeloc.simulation.satellite.almanacs import broadcast_almanac
from tests.models.test_satellite_chain import CONFIG, TRACK, chain, driven, driven_run, outcomes, start
from tests.simulation.satellite.sky import sky

FIRST, CYCLES = 20, 8
EXCLUDED_M = 80.0
"""A detour that no list lets pass."""
Moves = Sequence[tuple[float, float] | None]
"""In each cycle what is added to a satellite's pseudorange (m) and range rate (m/s); None: it is not measured."""
PLAIN: Moves = [(EXCLUDED_M, 0.0)] * CYCLES


def epochs(moves: Mapping[str, Moves]) -> list[Epoch]:
    """The healthy drive with these signals moved."""
    made = []
    for number, epoch in enumerate(driven_run().epochs[FIRST : FIRST + CYCLES]):
        changes = {name: _moved(epoch.satellites[name], one[number]) for name, one in moves.items()}
        made.append(replace(epoch, satellites={**epoch.satellites, **changes}))
    return made


def _moved(one: Measured, by: tuple[float, float] | None) -> Measured:
    return Measured(None, None) if by is None else Measured(one.code() + by[0], one.rate() + by[1])


def names() -> list[str]:
    """The satellites that the healthy drive uses throughout."""
    return sorted(frozenset.intersection(*(one.usable for one in outcomes()[FIRST : FIRST + CYCLES])))


def most() -> list[str]:
    """Those of the constellation with the most of them, whose clock gives the time of a measurement."""
    count = Counter(name[0] for name in names())
    return [name for name in names() if name[0] == max(sorted(count), key=count.__getitem__)]


@cache
def without_most() -> Almanac:
    """An almanac that does not list that constellation."""
    every = broadcast_almanac(sky().ephemerides).orbits
    return Almanac(tuple(one for one in every if one.satellite[0] != most()[0][0]))


def driven_along(one: EpochChain, given_epochs: Sequence[Epoch]) -> list[Outcome]:
    """A balise in the first cycle, and these epochs."""
    return driven(one, given_epochs, start(driven_run(), FIRST))


def lists(told: Sequence[Outcome]) -> list[frozenset[str]]:
    """The usable satellites of each cycle."""
    return [one.usable for one in told]


def solved(told: Sequence[Outcome]) -> list[object]:
    """What each cycle makes of the sky: the solution, the position machine's inputs and outputs: place, time, levels, reasons."""

    def of_position(values: Mapping[str, object]) -> dict[str, object]:
        return {name: value for name, value in values.items() if name.startswith("position.")}

    return [(one.solution, one.unconfirmed, of_position(one.inputs), of_position(one.outputs)) for one in told]


@cache
def struck(name: str) -> tuple[Outcome, ...]:
    """The drive with one satellite that comes by a detour."""
    return tuple(driven_along(chain(), epochs({name: PLAIN})))


def late(by_s: float) -> list[Outcome]:
    """The drive with all satellites of the largest constellation unlisted, and their time off by so much."""
    moves: Moves = [(by_s * LIGHT_M_PER_S, 0.0)] * CYCLES
    one = EpochChain(CONFIG, sky(), lambda low_m, high_m: (TRACK,), without_most())
    return driven_along(one, epochs(dict.fromkeys(most(), moves)))


@cache
def in_time() -> tuple[Outcome, ...]:
    """The same drive with their time right."""
    return tuple(late(0.0))


FAR = st.floats(60.0, 1e9).flatmap(lambda far: st.sampled_from([far, -far]))
MOVES = st.lists(
    st.one_of(st.none(), st.tuples(FAR, st.floats(-1e6, 1e6))), min_size=CYCLES, max_size=CYCLES
)  # fmt: skip


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 100), MOVES)
def test_a_satellite_outside_of_the_list_changes_nothing(which: int, moves: Moves) -> None:
    """Its signal moved by anything, another amount in every cycle, or away: where the list is the same, all that is solved is."""
    name = names()[which % len(names())]
    told = driven_along(chain(), epochs({name: moves}))
    assert not any(name in one.usable for one in told)
    same = [one == other for one, other in zip(lists(told), lists(struck(name)), strict=True)]
    assume(all(same))
    assert solved(told) == solved(struck(name))


@settings(max_examples=10, deadline=None)
@given(st.floats(-1e-3, 1e-3))
def test_a_constellation_outside_of_the_list_gives_no_time(by_s: float) -> None:
    """It is the largest, so the criterion's clock is its own: up to a millisecond off, nothing that is solved moves."""
    told = late(by_s)
    assert not any(one.usable & set(most()) for one in told)
    assume(lists(told) == lists(in_time()))
    assert solved(told) == solved(in_time())


def test_the_lists_are_the_same() -> None:
    """The cases above are there: solved in every cycle but the first two, with the satellites that are left."""
    one = names()[0]
    far: Moves = [(-1e6, 0.0)] * CYCLES
    pairs = [(driven_along(chain(), epochs({one: far})), struck(one)), (late(1e-3), in_time())]
    for told, other in pairs:
        assert lists(told) == lists(other)
        assert [False, *[True] * (CYCLES - 2)] == [each.solution is not None for each in told[1:]]
    assert lists(struck(one))[-1] == frozenset(names()) - {one}
    assert lists(in_time())[-1] == frozenset(names()) - set(most())


# ------------------------------------------------------------------ wrong chains


def _sees_all(*looked: object) -> object:
    """The solution is made from the criterion's look at all that is visible."""
    _, _, _, seen, *_ = looked
    return seen


def _of_all(looks: Sequence[Look], used: frozenset[str], *, free: bool, weighting: Weighting) -> Solution:
    """Solves with every satellite that was measured, and names the usable ones."""
    every = used | frozenset(looks[0].off_mm)
    return replace(solve(looks, every, free=free, weighting=weighting), used=used)


def _common_clock(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(EpochChain, "_of_usable", _sees_all)


def _all_solved(patch: pytest.MonkeyPatch) -> None:
    """Nothing confirms the solution either."""
    patch.setattr(EpochChain, "_of_usable", _sees_all)
    patch.setattr(chains, "refuted", lambda *_args, **_more: "")
    patch.setattr(EpochChain.__init__, "__defaults__", (None, _of_all))


def _due_by_all(patch: pytest.MonkeyPatch) -> None:
    """The cycles stay due by the clock of all that is visible."""
    right = EpochChain.__init__

    def begun(self: EpochChain, *args: object, **more: object) -> None:
        right(self, *args, **more)  # type: ignore[arg-type]
        self._timed = True

    patch.setattr(EpochChain, "__init__", begun)


WRONG: dict[str, tuple[Callable[[pytest.MonkeyPatch], None], float | None]] = {
    "differences by the clock of all": (_common_clock, -EXCLUDED_M),
    "every satellite in the solution": (_all_solved, EXCLUDED_M + 1),
    "the time of all": (_common_clock, None),
    "cycles due by the clock of all": (_due_by_all, None),
}
"""What is wrong, and the other detour of one satellite that shows it (m); None: the constellation shows it."""


@pytest.mark.parametrize("wrong", WRONG)
def test_a_chain_that_lets_others_have_a_part_is_noticed(monkeypatch: pytest.MonkeyPatch, wrong: str) -> None:
    """What is solved is no longer the same, although the lists are."""
    edit, by_m = WRONG[wrong]
    one, _ = names()[0], without_most()
    edit(monkeypatch)
    if by_m is None:
        told, other = late(0.0), late(1e-3)
    else:
        moved: Moves = [(by_m, 0.0)] * CYCLES
        told, other = (driven_along(chain(), epochs({one: moves})) for moves in (PLAIN, moved))
    assert lists(told) == lists(other)
    assert solved(told) != solved(other)
