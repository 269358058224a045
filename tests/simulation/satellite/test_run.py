"""Simulated runs: what the receiver gives against what is true."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.sensing.satellite.places import Place
from safeloc.sensing.satellite.residuals import Residuals, residuals
from safeloc.simulation.faults import Fault
from safeloc.simulation.satellite.receiver import ReceiverConfig
from safeloc.simulation.satellite.run import SimulatedRun, World, simulate
from safeloc.simulation.satellite.scenery import tunnel
from tests.simulation.satellite.sky import ride, sky, straight

QUIET = ReceiverConfig(
    code_noise_mm=0, slow_code_mm=0, rate_noise_mm_s=0, ionosphere_percent=0, troposphere_percent=0, orbit_mm=0
)


def _at_truth(run: SimulatedRun, number: int) -> Residuals:
    truth = run.truth[number]
    point, along = straight().at(truth.place_m)
    x, y, z = (truth.speed_m_per_s * share for share in along)
    return residuals(run.epochs[number], Place.of_earth_fixed(point), (x, y, z), run.navigation)


def test_without_errors_the_front_end_finds_nothing() -> None:
    """A quiet receiver with an offset and drifting clock on a moving train: differences below 2 mm and 2 mm/s."""
    run = simulate(World(sky(), straight(), receiver=QUIET), ride(), seed=3)
    for number in (0, 17, 39):
        found = _at_truth(run, number)
        assert len(found.pseudorange_m) > 15
        assert max(map(abs, found.pseudorange_m.values())) < 2e-3
        assert max(map(abs, found.rate_m_per_s.values())) < 2e-3


def test_differences_are_the_stated_errors() -> None:
    """With noise, what the front end finds is what the truth says, but for what a constellation has in common."""
    run = simulate(World(sky(), straight()), ride(), seed=3)
    found, truth = _at_truth(run, 20), run.truth[20]
    for system in "CEG":
        ours = {name: value for name, value in found.pseudorange_m.items() if name[0] == system}
        left = [value - truth.healthy_m[name] for name, value in ours.items()]
        assert len(left) > 3
        assert max(left) - min(left) < 2e-3
    assert 0.5 < max(found.pseudorange_m.values()) < 8 + 8


def test_healthy_errors_keep_their_bound() -> None:
    """Whatever the noise, nothing healthy is beyond the bound."""
    loud = ReceiverConfig(code_noise_mm=30_000, rate_noise_mm_s=5_000)
    run = simulate(World(sky(), straight(), receiver=loud), ride(), seed=3)
    every = [value for truth in run.truth for value in truth.healthy_m.values()]
    assert 4.0 == max(every) == -min(every)


def test_a_tunnel_silences_and_gives_back() -> None:
    """Nothing is heard in it, everything after it."""
    run = simulate(World(sky(), straight(), (tunnel(200, 400),)), ride(), seed=3)
    inside = [200 <= truth.place_m < 400 for truth in run.truth]
    assert inside == [not epoch.satellites for epoch in run.epochs]
    assert any(inside) and not inside[-1]


def test_a_spoofer_drags_the_place() -> None:
    """All satellites agree on a place 20 m ahead: the differences are those of that place, and none of the true one."""
    spoofed = Fault("false place", begin=5_000, figures={"gathering_m_per_s2": 0.1})
    run = simulate(World(sky(), straight(), receiver=QUIET, faults=(spoofed,)), ride(), seed=3)
    truth, epoch = run.truth[29], run.epochs[29]
    away = 0.1 / 2 * 10**2 + 15.0
    point, along = straight().at(truth.place_m + away)
    x, y, z = ((truth.speed_m_per_s + 1.0) * share for share in along)
    false = residuals(epoch, Place.of_earth_fixed(point), (x, y, z), run.navigation)
    assert max(map(abs, false.pseudorange_m.values())) < 0.05
    assert max(map(abs, _at_truth(run, 29).pseudorange_m.values())) > 5
    assert set(truth.error_m) == set(epoch.satellites)


def test_a_spoofer_that_ends_leaves_nothing_behind() -> None:
    """From the fault's end on, nothing is added to any signal; before its beginning neither."""
    spoofed = Fault("false place", begin=5_000, end=20_000)
    run = simulate(World(sky(), straight(), receiver=QUIET, faults=(spoofed,)), ride(), seed=3)
    dragged = [any(truth.error_m.values()) for truth in run.truth]
    assert [5 < second < 20 for second in range(1, 41)] == dragged


def test_silence_comes_in_cycles() -> None:
    """The named satellite is gone for 3 of every 10 s, the others stay."""
    whole = simulate(World(sky(), straight()), ride(), seed=3)
    name = min(whole.epochs[0].satellites)
    run = simulate(World(sky(), straight(), faults=(Fault("silence", name),)), ride(), seed=3)
    gone = [name not in epoch.satellites for epoch in run.epochs]
    assert [second % 10 >= 7 for second in range(1, 41)] == gone
    assert all(len(a.satellites) - len(b.satellites) <= 1 for a, b in zip(whole.epochs, run.epochs, strict=True))


def test_a_seed_makes_a_run() -> None:
    """Same seed, same run; another seed, another noise."""
    world = World(sky(), straight())
    assert simulate(world, ride(), seed=3) == simulate(world, ride(), seed=3)
    assert simulate(world, ride(), seed=3).epochs != simulate(world, ride(), seed=4).epochs


def test_what_cannot_be_simulated_is_refused() -> None:
    """Off the track, a silence without an end, a false place without a start, a fault of no sky."""
    with pytest.raises(InputError, match="not on the mapped portion"):
        simulate(World(sky(), straight()), ride(start_m=4_900), seed=1)
    for fault, message in (
        (Fault("silence", figures={"period_s": 3.0}), r"silent_s has to be a part of period_s\.$"),
        (Fault("false place", figures={"gathering_m_per_s2": 0.0}), r"gathering_m_per_s2 must be above 0\.$"),
        (Fault("silence", begin=5_000), r"begins after the run, which is 5000 long\.$"),
        (Fault("clouds"), r"^clouds, 0 to the end: a sky has no such fault; it has false place, silence\.$"),
    ):
        with pytest.raises(InputError, match=message):
            simulate(World(sky(), straight(), faults=(fault,)), ride(5), seed=1)
