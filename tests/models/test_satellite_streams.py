"""Simulated journeys along the worked line, through the chain and as streams."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

from safeloc.catalogue import load_target
from safeloc.language.interpret import run
from safeloc.models.satellite.chain import ChainConfig
from safeloc.models.satellite.simulate import (
    FINE,
    SHIPPED,
    STREET,
    Journey,
    Passed,
    false_place,
    first_of,
    passed,
    simulate,
    simulate_selection,
    track,
    worked_line,
)
from safeloc.models.satellite.variables import FIX, SatelliteConfig
from safeloc.runtime.streams.gzipped import name_of
from safeloc.runtime.streams.steps import read_steps
from safeloc.simulation.satellite.constellation import GALILEO, GPS
from safeloc.simulation.satellite.scenery import SceneKind, tunnel

pytest.importorskip("pyproj")
CONFIG = SatelliteConfig()
BOTH = Journey(walkers=(GPS, GALILEO))
SPOOFED = replace(
    BOTH, from_m=4_150, to_m=4_900, scenes=(), faults=(false_place(5_000, 3.0, 0.3),), odometry=True, balises=False
)


@cache
def driven(journey: Journey, seed: int = 1) -> list[Passed]:
    """One journey, driven once: with 32 channels where the sky has two constellations."""
    config = FINE if len(journey.walkers) > 1 else CONFIG
    return list(passed(ChainConfig(satellite=config), journey, seed=seed))


def wrong(told: list[Passed]) -> list[int]:
    """Cycles whose reported interval misses the truth."""
    reported = load_target("satellite").reported
    assert reported is not None
    pairs = [(reported.interval_mm(one.outcome.outputs), one.truth.place_m * 1_000) for one in told]
    return [n for n, (ends, truth) in enumerate(pairs) if ends is not None and not ends[0] <= truth <= ends[1]]


def test_the_line_and_its_scenes() -> None:
    """One route; every scene lies on it, and the tunnel is where the map has it."""
    length_m = worked_line().edges[0].length_mm / 1_000
    assert length_m == pytest.approx(track().portions(0, 10)[0].end_m)
    (mapped,) = worked_line().tunnels[0].stretches
    (own,) = [scene for scene in Journey().scenes if scene.kind == "tunnel"]
    assert (mapped.from_mm, mapped.to_mm) == (own.from_m * 1_000, own.to_m * 1_000)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_recordings_are_these_journeys(name: str) -> None:
    """What ships is what the journey gives; a figure may be rounded the other way on another machine."""
    journey, seed = SHIPPED[name]
    told = read_steps(next(path for path in load_target(name.split("-")[0]).streams if name_of(path) == name))
    made = simulate(CONFIG, seed=seed, journey=journey)
    assert [sorted(step) for step in made] == [sorted(step) for step in told.steps]
    assert dict(told.first) == first_of(CONFIG, journey)
    for step, other in zip(made, told.steps, strict=True):
        assert step["truth_mm"] == other["truth_mm"]
        assert step["position.fix_missing"] == other["position.fix_missing"]


def test_the_selection_alone_sees_the_same() -> None:
    """Its stream is the selection's part of the whole one."""
    (whole, part) = simulate(CONFIG, seed=5, journey=STREET), simulate_selection(CONFIG.selection, seed=5)
    assert [{f"selection.{key}": value for key, value in step.items()} for step in part] == [
        {key: value for key, value in step.items() if key.startswith("selection.")} for step in whole
    ]


def test_a_stream_replays_to_what_the_chain_said() -> None:
    """The interpreter, given the recorded steps, ends every step with the chain's outputs."""
    steps = simulate(CONFIG, seed=1, journey=STREET)
    target = load_target("satellite")
    bare = [{key: value for key, value in step.items() if key != "truth_mm"} for step in steps]
    trace = run(target.system, bare, first=first_of(CONFIG, STREET))
    outputs = [
        {name: step.outputs[name] for name in one.outcome.outputs}
        for step, one in zip(trace.steps, driven(STREET), strict=True)
    ]
    assert [dict(one.outcome.outputs) for one in driven(STREET)] == outputs


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("kind", ["open sky", "urban canyon", "cutting", "tunnel", "station roof"])
def test_the_truth_is_inside_in_every_scene(kind: SceneKind) -> None:
    """No interval misses the truth; something is reported in each scene, and nothing is left of it deep in the tunnel."""
    ends = {"open sky": (4_300, 4_700), "urban canyon": (600, 900), "cutting": (2_400, 2_700), "tunnel": (3_600, 3_900), "station roof": (0, 120)}  # fmt: skip
    told = driven(replace(BOTH, from_m=ends[kind][0], to_m=ends[kind][1], speed_mm_s=20_000))
    valid = [bool(one.outcome.outputs["position.valid"]) for one in told]
    assert not wrong(told)
    assert valid[0]
    assert (kind == "tunnel") == (not valid[-1])


def test_detours_are_excluded_in_the_street() -> None:
    """Far reflected signals leave the list; most signals stay."""
    pairs = [
        (name in one.outcome.usable, abs(one.truth.error_m[name]))
        for one in driven(replace(BOTH, from_m=560, to_m=1_200, speed_mm_s=14_000))
        for name, standing in one.outcome.standings.items()
        if standing in ("USABLE", "EXCLUDED")
    ]
    far, near = [usable for usable, error in pairs if error > 25], [usable for usable, error in pairs if error < 1]
    assert len(far) > 3
    assert sum(far) < len(far) / 10
    assert sum(near) / len(near) > 0.9


def test_odometry_ends_a_spoofed_position() -> None:
    """All signals drift by 3 m/s together: no satellite is excluded for it; solutions are found to have drifted, and it ends."""
    told = driven(SPOOFED)
    drifted = [FIX[int(one.outcome.outputs["position.fix"])].label == "DRIFTED" for one in told]
    valid = [bool(one.outcome.outputs["position.valid"]) for one in told]
    first, lost = drifted.index(True), valid.index(False)
    assert len(told[first].outcome.usable) == len(told[first].outcome.standings)
    assert any(drifted[lost - CONFIG.coast_limit_cycles - 1 : lost + 1])
    assert not any(valid[lost:])


def test_without_odometry_a_spoofer_misleads() -> None:
    """The stated assumption, shown: the same signals without odometry lead the interval away from the truth."""
    assert wrong(driven(replace(SPOOFED, odometry=False)))


def test_behind_a_tunnel_a_balise_brings_the_position_back() -> None:
    """Lost in 150 m of tunnel; reported again from the next group on, and not before."""
    told = driven(Journey(4_250, 4_800, scenes=(tunnel(4_300, 4_450),)))
    valid = [bool(one.outcome.outputs["position.valid"]) for one in told]
    lost = valid.index(False)
    back = valid.index(True, lost)
    assert told[back].cycle.reference is not None
    assert 4_500 < told[back].truth.place_m < 4_510
    assert not wrong(told)
