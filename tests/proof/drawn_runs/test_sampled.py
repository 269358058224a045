"""Runs for checking a back end: every source gives some, each run is of the promised kind, and they can be repeated."""

from __future__ import annotations

from safeloc.catalogue import load_target
from safeloc.language.interpret import holds, read_inputs, run
from safeloc.language.system import environment, lower, without_ghosts
from safeloc.proof.drawn_runs.sampled import drawn_run, sampled_runs
from safeloc.runtime.streams.gzipped import name_of
from tests.examples import EXAMPLES, build_odometer


def test_every_source_is_used() -> None:
    """There are recorded streams, the simulation, a lawful run and one of any inputs, each at most as long as asked
    for.
    """
    target = load_target("odometry")
    runs = sampled_runs(target, steps=40)
    names = [*map(name_of, target.streams), "simulated", "lawful", "any inputs in range"]
    assert names == [one.name for one in runs]
    assert all(0 < len(one.steps) <= 40 for one in runs)


def test_runs_are_of_what_runs_on_board() -> None:
    """No ghosts and no remarks: the system without ghosts takes every step."""
    target = load_target("balise")
    on_board = without_ghosts(target.system)
    for one in sampled_runs(target, steps=15):
        assert len(run(on_board, one.steps, first=one.first).steps) == len(one.steps)


def test_the_same_seed_gives_the_same_runs() -> None:
    """The same seed repeats the runs, and another seed gives others."""
    system = EXAMPLES[0].system
    assert drawn_run(system, 3, 50, lawful=True) == drawn_run(system, 3, 50, lawful=True)
    assert drawn_run(system, 3, 50, lawful=True) != drawn_run(system, 4, 50, lawful=True)


def test_a_lawful_run_stays_reported() -> None:
    """Inputs of a lawful run keep their ranges; drawn ones of both kinds fire every transition of the odometer in time."""
    system = lower(build_odometer(1000).machine)
    fired = set()
    on_board = without_ghosts(system)
    for seed in range(6):
        for lawful in (True, False):
            drawn = drawn_run(system if lawful else on_board, seed, 80, lawful=lawful)
            for record in drawn.steps:
                assert holds(environment(on_board), read_inputs(on_board, record))
            fired |= {step.fired["fired"] for step in run(on_board, drawn.steps).steps}
    assert {"reference", "tolerance exceeded", "run on"} <= fired
