"""The almanac and the solver in the chain: what an almanac refuses, an expired one, and solvers that are wrong (SAT-5, SAT-6)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction

import pytest

from safeloc.models.satellite.chain import ChainConfig, Cycle, EpochChain, Outcome, Solver
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.sensing.satellite.almanac import Almanac, AlmanacOrbit
from safeloc.sensing.satellite.solution import Look, Solution, Solved, Weighting, solve
from safeloc.sensing.satellite.track_fit import TrackFit
from safeloc.simulation.satellite.almanacs import broadcast_almanac
from tests.models.test_satellite_chain import (
    AT_REST,
    CONFIG,
    SELECTION,
    TRACK,
    changed,
    driven,
    driven_run,
    missing,
    outcomes,
    recorded,
    start,
)
from tests.simulation.satellite.sky import sky

CYCLES = 12
DAY_S = 86_400


def almanac(change: Callable[[AlmanacOrbit], AlmanacOrbit] = lambda one: one) -> Almanac:
    """The almanac of the simulated sky, each orbit changed."""
    return Almanac(tuple(map(change, broadcast_almanac(sky().ephemerides).orbits)))


def driven_by(
    known: Almanac | None, selection: SelectionConfig = SELECTION, solver: Solver = solve, config: ChainConfig = CONFIG
) -> list[Outcome]:
    """The first cycles of the healthy drive, with this almanac and this solver."""
    satellite = config.satellite.model_copy(update={"selection": selection})
    chosen = config.model_copy(update={"satellite": satellite})
    one = EpochChain(chosen, sky(), lambda low_m, high_m: (TRACK,), known, solver)
    return driven(one, driven_run().epochs[:CYCLES], start(driven_run()))


# ------------------------------------------------------------------ the almanac


def test_a_current_almanac_lists_what_is_received() -> None:
    """The healthy sky, once located: the same outputs as without one, but that it is reported as current."""
    told, plain = driven_by(almanac())[1:], outcomes()[1:CYCLES]
    assert [one.standings for one in plain] == [one.standings for one in told]
    for with_one, without in zip(told, plain, strict=True):
        assert with_one.outputs["selection.almanac_current"] and not without.outputs["selection.almanac_current"]
        rest = {"selection.almanac_current": True}
        assert {**without.outputs, **rest} == dict(with_one.outputs)


WRONG = {
    "below the horizon": lambda one: replace(one, m0=one.m0 + math.pi),
    "unhealthy": lambda one: replace(one, healthy=False),
    "not in it": lambda one: replace(one, satellite="J09"),
}


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("why", WRONG)
def test_what_the_almanac_does_not_list_is_not_used(why: str) -> None:
    """One received satellite that a current almanac has elsewhere, as unhealthy, or not: out, and the others locate."""
    struck = sorted(outcomes()[CYCLES - 1].usable)[0]
    known = almanac(lambda one: WRONG[why](one) if one.satellite == struck else one)
    last = driven_by(known)[-1]
    assert "UNLISTED" == last.standings[struck]
    assert last.solution is not None and struck not in last.solution.used
    assert last.usable == last.solution.used == outcomes()[CYCLES - 1].usable - {struck}


@pytest.mark.parametrize(("days", "refused"), [(5.9, True), (6.1, False), (-6.1, False)])
def test_an_expired_almanac_is_not_used(days: float, refused: bool) -> None:
    """An almanac that refuses a satellite does so until it expires; then it decides nothing, and is reported as not current."""
    struck = sorted(outcomes()[CYCLES - 1].usable)[0]
    known = almanac(lambda one: replace(one, time_s=one.time_s - days * DAY_S, healthy=one.satellite != struck))
    last = driven_by(known)[-1]
    assert refused is last.outputs["selection.almanac_current"]
    assert refused is (last.standings[struck] == "UNLISTED")


@pytest.mark.parametrize("known", [None, almanac(lambda one: replace(one, time_s=one.time_s - 7 * DAY_S)), Almanac(())])
def test_where_an_almanac_is_required_nothing_is_usable_without_a_current_one(known: Almanac | None) -> None:
    """None, an expired one, an empty one: no satellite is usable, and the position coasts and ends."""
    required = SelectionConfig(channels=6, almanac="required")
    told = driven_by(known, required)
    assert {"UNLISTED"} == {standing for one in told for standing in one.standings.values()}
    assert {"NONE_LEFT"} == {missing(one) for one in told[1:]}
    assert (True, False) == (told[5].outputs["position.valid"], told[-1].outputs["position.valid"])
    assert 6 == len(driven_by(almanac(), required)[-1].usable)


@pytest.mark.thorough
def test_a_recorded_sky_is_listed() -> None:
    """An almanac made of the recorded ephemerides has all that the recorded receiver could use; three others are unhealthy in it."""
    plain, told = (recorded(AT_REST, with_almanac=known)[0] for known in (False, True))
    assert [one.usable for one in plain] == [one.usable for one in told]
    assert {"J02", "J03", "J07"} == {name for name, one in told[-1].standings.items() if one == "UNLISTED"}
    assert {""} == {one.unconfirmed for one in told}
    assert min(len(one.usable) for one in told[4:]) > 8


# ------------------------------------------------------------------ wrong solvers


def _from_memory(*, named: bool) -> Solver:
    """Uses the satellites of the cycle before as well, as they were then; no others are given to it. Names them, or does not."""
    kept: list[Sequence[Look]] = []

    def wrong(looks: Sequence[Look], used: frozenset[str], *, free: bool, weighting: Weighting) -> Solution:
        kept.append(looks)
        more = [_with(then, now) for then, now in zip(kept[-2 if len(kept) > 1 else -1], looks, strict=True)]
        found = solve(more, used | more[0].measured, free=free, weighting=weighting)
        return found if named else replace(found, used=used)

    return wrong


def _with(then: Look, now: Look) -> Look:
    off, speed_off = {**then.off_mm, **now.off_mm}, {**then.speed_off_mm_s, **now.speed_off_mm_s}
    return Look(now.place, now.bounds, off, speed_off, {**then.predictions, **now.predictions})


def _names_more(looks: Sequence[Look], used: frozenset[str], *, free: bool, weighting: Weighting) -> Solution:
    """Uses all but one, and names all."""
    return replace(solve(looks, frozenset(sorted(used)[1:]), free=free, weighting=weighting), used=used)


def _names_fewer(looks: Sequence[Look], used: frozenset[str], *, free: bool, weighting: Weighting) -> Solution:
    """Uses all, and does not name one."""
    return replace(solve(looks, used, free=free, weighting=weighting), used=frozenset(sorted(used)[1:]))


def _of_each(change: Callable[[Solved], Solved]) -> Solver:
    def wrong(looks: Sequence[Look], used: frozenset[str], *, free: bool, weighting: Weighting) -> Solution:
        right = solve(looks, used, free=free, weighting=weighting)
        return replace(right, solved=tuple(map(change, right.solved)))

    return wrong


def _place(change: Callable[[TrackFit], TrackFit]) -> Solver:
    return _of_each(lambda one: replace(one, place=None if one.place is None else change(one.place)))


def _speed(change: Callable[[TrackFit], TrackFit]) -> Solver:
    return _of_each(lambda one: replace(one, speed=None if one.speed is None else change(one.speed)))


def _halved(fit: TrackFit) -> TrackFit:
    return replace(fit, shares={name: share / 2 for name, share in fit.shares.items()})


def _late() -> Solver:
    """Tells the solution of the cycle before."""
    kept: list[Solution] = []

    def wrong(looks: Sequence[Look], used: frozenset[str], *, free: bool, weighting: Weighting) -> Solution:
        kept.append(solve(looks, used, free=free, weighting=weighting))
        return replace(kept[-2 if len(kept) > 1 else -1], used=used)

    return wrong


def _tight(one: Solved) -> Solved:
    most = one.bounds.range_mm
    return replace(one, bounds=replace(one.bounds, range_mm=None if most is None else most // 2))


WRONG_SOLVERS: dict[str, tuple[Callable[[], Solver], str]] = {
    "names satellites that are not usable": (lambda: _from_memory(named=True), "not usable in this cycle"),
    "uses a foreign satellite unnamed": (lambda: _from_memory(named=False), "its place"),
    "leaves out a satellite that it names": (lambda: _names_more, "its place"),
    "uses a usable satellite unnamed": (lambda: _names_fewer, "its place"),
    "a place 5 mm off": (lambda: _place(lambda fit: replace(fit, along=fit.along + 5)), "its place is"),
    "a place of the wrong sign": (lambda: _place(lambda fit: replace(fit, along=-fit.along - 10)), "its place is"),
    "a speed 5 mm/s off": (lambda: _speed(lambda fit: replace(fit, along=fit.along + 5)), "its speed is"),
    "half the dilution": (lambda: _place(_halved), "its place has the dilution"),
    "half the dilution of the speed": (lambda: _speed(_halved), "its speed has the dilution"),
    "one unknown fewer": (
        lambda: _place(lambda fit: replace(fit, degrees_of_freedom=fit.degrees_of_freedom + 1)),
        "unknowns",
    ),
    "no place": (lambda: _of_each(lambda one: replace(one, place=None)), "has a place where none"),
    "half the further error": (lambda: _of_each(_tight), "other bounds"),
    "the solution of the cycle before": (_late, "its "),
    "a portion of track left out": (
        lambda: lambda *args, **kwargs: replace(solve(*args, **kwargs), solved=()),
        "has 0 portions",
    ),
}


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("kind", WRONG_SOLVERS)
def test_a_wrong_solver_is_refused_in_the_cycle(kind: str) -> None:
    """One signal comes by a detour, so that it is not usable. What the solver makes wrong is told, and the position coasts."""
    solver, why = WRONG_SOLVERS[kind]
    sim, wrong = driven_run(), solver()
    struck = sorted(outcomes()[CYCLES - 1].usable)[0]
    calls: list[int] = []

    def sometimes(looks: Sequence[Look], used: frozenset[str], *, free: bool, weighting: Weighting) -> Solution:
        calls.append(len(used))
        chosen = wrong if len(calls) >= CYCLES - 5 or kind.startswith("the solution of") else solve
        return chosen(looks, used, free=free, weighting=weighting)

    one = EpochChain(CONFIG, sky(), lambda low_m, high_m: (TRACK,), almanac(), sometimes)
    driven(one, sim.epochs[: CYCLES - 1], start(sim))
    last = one.step(Cycle(changed(sim.epochs[CYCLES - 1], **{struck: 80.0})))
    assert "EXCLUDED" == last.standings[struck]
    assert (None, "UNCONFIRMED") == (last.solution, missing(last))
    assert why in last.unconfirmed
    assert last.outputs["position.valid"] and last.outputs["position.coasting"]
    assert "position.fix_mm" not in last.inputs and not any(last.inputs[f"position.used_{n}"] for n in range(1, 29))


@pytest.mark.parametrize(
    "changes", [{}, {"weighting": "elevation"}, {"solution": "free"}, {"solution": "free", "weighting": "elevation"}]
)
def test_the_right_solver_is_confirmed_in_every_cycle(changes: dict[str, str]) -> None:
    """Both methods agree, whatever is solved and however it is weighed."""
    told = driven_by(almanac(), config=CONFIG.model_copy(update=changes))
    assert {""} == {one.unconfirmed for one in told}
    assert all(one.solution is not None for one in told[4:])


def test_a_place_within_the_bound_is_confirmed() -> None:
    """Half a millimetre is what slopes in whole millionths and floats may differ by."""
    near = _place(lambda fit: replace(fit, along=fit.along + Fraction(1, 2)))
    assert {""} == {one.unconfirmed for one in driven_by(almanac(), solver=near)}
