"""Short runs past a front end, from the simulation of backscatter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from safeloc.sensing.fibre.features import FibreFrame, TrainSeen
from safeloc.sensing.fibre.figures import Detection, FibreConfig, Interrogator
from safeloc.sensing.fibre.front_end import FrontEnd, Outcome
from safeloc.simulation.faults import Fault
from safeloc.simulation.fibre.cable import Section, cable
from safeloc.simulation.fibre.scene import Shot, World, shots
from safeloc.simulation.fibre.trains import COACH, Course, Train

LENGTH_M = 2_000
QUIET_S = 3.5
CONFIG = FibreConfig(interrogator=Interrogator(fibre_mm=LENGTH_M * 1_000), detection=Detection(floor_s=3))


def coaches(count: int, start_m: float, speed_m_s: float, strain: float = 2.5) -> Train:
    """Silent until quiet is learnt, then at one speed; end A in front."""
    course = Course(start_m, ((0.0, 0.0), (QUIET_S, 0.0), (QUIET_S + 0.5, speed_m_s)))
    return Train((COACH,) * count, course, speed_m_s >= 0, strain)


def world(
    *trains: Train,
    config: FibreConfig = CONFIG,
    seed: int = 0,
    sections: Sequence[Section] = (),
    points_m: Sequence[float] = (),
    absorber: bool = True,
    **more: Any,
) -> World:
    """Trains over a cable without slack."""
    laid = cable(
        config.interrogator, np.random.default_rng(seed), sections=sections, points_m=points_m, absorber=absorber
    )
    return World(config, laid, trains, **more)


def seen(scene: World, blocks: int, *, seed: int = 0, faults: Sequence[Fault] = ()) -> list[tuple[Shot, Outcome]]:
    """What was delivered with its truth, and what the front end made of it."""
    front = FrontEnd(scene.config, 1_000)
    run = shots(scene, blocks, np.random.default_rng(seed + 1_000), faults=faults)
    return [(shot, front.receive(shot.block, shot.delivered_ms)) for shot in run]


def frames(outcomes: Sequence[tuple[Shot, Outcome]]) -> list[tuple[Shot, FibreFrame]]:
    """Those that were read."""
    return [(shot, outcome) for shot, outcome in outcomes if isinstance(outcome, FibreFrame)]


def told(outcomes: Sequence[tuple[Shot, Outcome]]) -> list[tuple[Shot, TrainSeen]]:
    """Every train that was told, with its block."""
    return [(shot, train) for shot, frame in frames(outcomes) for train in frame.trains]
