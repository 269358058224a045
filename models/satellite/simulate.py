"""Simulated runs along the example line `valley` through the satellite chain, and as step streams of its machines.

Beside the line stand a station hall and the houses of a street; it leads through a cutting and a tunnel. References are the
line's balise groups, with the speed that odometry has there; a run begins at the first one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from safeloc.language.units import MM_PER_M, NM_PER_MM
from safeloc.models.satellite.chain import ChainConfig, Cycle, EpochChain, Outcome, Reference, Run
from safeloc.models.satellite.variables import SatelliteConfig
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.railway.map.model import Line
from safeloc.railway.map.routes import through_routes
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Topology
from safeloc.runtime.streams.steps import Cell
from safeloc.sensing.satellite.channels import identity
from safeloc.sensing.satellite.line_track import LineTrack
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Motion, VehicleConfig
from safeloc.simulation.satellite.almanacs import broadcast_almanac
from safeloc.simulation.satellite.constellation import GPS, Walker, constellation
from safeloc.simulation.satellite.receiver import ReceiverConfig
from safeloc.simulation.satellite.run import SimulatedRun, Truth, World
from safeloc.simulation.satellite.run import simulate as simulate_signals
from safeloc.simulation.satellite.scenery import Scene, canyon, cutting, station_roof, tunnel
from safeloc.simulation.speed_profile import Halt, drive

Steps = list[dict[str, Cell]]
LINE, START_HEIGHT_M = "valley", 300.0
SCENES = (station_roof(0, 150), canyon(600, 1_800), cutting(2_400, 3_300), tunnel(3_700, 4_100))
"""Buildings beside the line, in m along it."""
BALISE_MM, SPEED_MM_S = 1_000, 300
"""Accuracy of a balise, and of the speed that is known at it."""
ODOMETRY_MM, ODOMETRY_PERCENT = 5, 2


FINE = SatelliteConfig(
    selection=SelectionConfig(
        channels=32, range_threshold_mm=9_000, range_prediction_mm=3_200, range_clock_mm=1_500,
        range_covariance_mm2=9_000_000, speed_covariance_mm2_s2=160_000,
    )
)  # fmt: skip
"""A geodetic receiver of 32 channels: healthy signals keep 4 m and 0.3 m/s, as the recorded one does (1.6 m RMS)."""


@dataclass(frozen=True)
class Journey:
    """One run along the line.

    from_m, to_m   the recorded part of the run; the train has come from the line's beginning
    balises        the line's groups are references; without them only the beginning is one
    odometry       the machine gets the distance run, and checks a common drift of all satellites by it
    lawful         nothing breaks the assumption, so the steps contain the ghosts
    """

    from_m: float = 0.0
    to_m: float = 400.0
    speed_mm_s: int = 25_000
    scenes: tuple[Scene, ...] = SCENES
    faults: tuple[Fault, ...] = ()
    walkers: tuple[Walker, ...] = (GPS,)
    receiver: ReceiverConfig = ReceiverConfig()
    balises: bool = True
    odometry: bool = False
    lawful: bool = True


def false_place(begin_ms: int, drift_m_per_s: float, gathering_m_per_s2: float) -> Fault:
    """Return the spoofed signals of all satellites: their place moves away from the true one from then on."""
    figures = {"drift_m_per_s": drift_m_per_s, "gathering_m_per_s2": gathering_m_per_s2}
    return Fault("false place", begin=begin_ms, figures=figures)


STREET = Journey(620, 760, 14_000)
SHIPPED: Mapping[str, tuple[Journey, int]] = {
    "satellite-station-hall": (Journey(0, 180, 14_000, lawful=False), 7),
    "satellite-street": (STREET, 3),
    "satellite-tunnel": (Journey(4_240, 4_640, scenes=(tunnel(4_300, 4_420),), lawful=False), 2),
    "satellite_drift-spoofed": (
        Journey(
            4_150, 4_550, scenes=(), faults=(false_place(3_000, 3.0, 0.5),), balises=False, odometry=True, lawful=False
        ),
        5,
    ),
}
"""The recordings that ship, each with its seed; `selection-street` is the selection's part of the second one."""


@dataclass(frozen=True)
class Passed:
    """One cycle: the truth of train and signals, the receiver's output, and the chain's result."""

    truth: Truth
    cycle: Cycle
    outcome: Outcome


def worked_line() -> Line:
    """Return the map of the example line."""
    return find_line(LINE)


@cache
def track() -> LineTrack:
    """Return the track of the line's only route. InputError without pyproj (extra `geo`)."""
    return LineTrack(through_routes(Topology(worked_line()), 1), START_HEIGHT_M)


def motion(journey: Journey, config: SatelliteConfig, vehicle: VehicleConfig | None = None) -> Motion:
    """Return the motion from standstill at the line's beginning to a halt at the journey's end, cut to the recorded part."""
    driven = drive(
        vehicle or VehicleConfig(),
        [Halt(round(journey.to_m * MM_PER_M), 3.0, journey.speed_mm_s)],
        [],
        config.period_ms,
    )
    first = int(np.searchsorted(driven.position_nm, round(journey.from_m * MM_PER_M) * NM_PER_MM))
    start = driven.start_nm if first == 0 else int(driven.position_nm[first - 1])
    return replace(driven, position_nm=driven.position_nm[first:], speed_mm_s=driven.speed_mm_s[first:], start_nm=start)


def signals(journey: Journey, config: SatelliteConfig, *, seed: int) -> SimulatedRun:
    """Output of the receiver, with the truth."""
    sky = constellation(journey.walkers, np.random.default_rng(seed))
    (portion,) = track().portions(0.0, journey.to_m)
    world = World(sky, portion, journey.scenes, journey.receiver, journey.faults)
    return simulate_signals(world, motion(journey, config), seed=seed)


def passed(config: ChainConfig, journey: Journey, *, seed: int) -> Iterator[Passed]:
    """Yield the cycles of the journey through the chain."""
    run = signals(journey, config.satellite, seed=seed)
    almanac = broadcast_almanac(run.navigation.ephemerides)
    chain = EpochChain(config, run.navigation, track().portions, almanac)
    rng = np.random.default_rng([seed, 1])
    marks = [round(group.position_mm / MM_PER_M, 3) for group in worked_line().balise_groups] if journey.balises else []
    before: Truth | None = None
    for epoch, truth in zip(run.epochs, run.truth, strict=True):
        reference = _reference(truth, before, marks, rng)
        cycle = Cycle(epoch, reference, _run(truth, before, rng) if journey.odometry and before else None)
        yield Passed(truth, cycle, chain.step(cycle))
        before = truth


def _reference(
    truth: Truth, before: Truth | None, marks: Sequence[float], rng: np.random.Generator
) -> Reference | None:
    if before is not None and not any(before.place_m < mark <= truth.place_m for mark in marks):
        return None
    place = truth.place_m * MM_PER_M + 0.9 * BALISE_MM * float(rng.uniform(-1, 1))
    speed = truth.speed_m_per_s * MM_PER_M + 0.9 * SPEED_MM_S * float(rng.uniform(-1, 1))
    return Reference(round(place), BALISE_MM, round(speed), SPEED_MM_S)


def _run(truth: Truth, before: Truth, rng: np.random.Generator) -> Run:
    true_mm = (truth.place_m - before.place_m) * MM_PER_M
    off = ODOMETRY_PERCENT / 100 * true_mm * float(rng.uniform(-1, 1))
    return Run(round(true_mm + off), ODOMETRY_MM + round(ODOMETRY_PERCENT / 100 * abs(true_mm)))


# ------------------------------------------------------------------ as step streams


def simulate(config: SatelliteConfig, *, seed: int, journey: Journey | None = None) -> Steps:
    """Return one journey as steps of both machines: inputs, ghost inputs if it is lawful, and the remark `truth_mm`."""
    chosen = journey or Journey()
    steps: Steps = []
    for one in passed(ChainConfig(satellite=config), chosen, seed=seed):
        ghosts = _ghosts(one) if chosen.lawful else {}
        steps.append({**one.outcome.inputs, **ghosts, "truth_mm": round(one.truth.place_m * MM_PER_M)})
    return steps


def first_of(config: SatelliteConfig, journey: Journey) -> dict[str, int]:
    """Return first values of the ghosts of a lawful journey."""
    start, begun = motion(journey, config), journey.from_m > 0
    speed = round(float(start.speed_mm_s[0]) * MM_PER_M) if begun else 0
    return {"position.truth_nm": start.start_nm, "position.true_speed_um_s": speed} if journey.lawful else {}


def simulate_selection(config: SelectionConfig, *, seed: int, journey: Journey | None = None) -> Steps:
    """Return the same journey as steps of the selection alone."""
    steps = simulate(SatelliteConfig(selection=config), seed=seed, journey=journey or STREET)
    prefix = "selection."
    return [{key.removeprefix(prefix): step[key] for key in step if key.startswith(prefix)} for step in steps]


def _ghosts(one: Passed) -> dict[str, Cell]:
    truth, inputs = one.truth, one.outcome.inputs
    made: dict[str, Cell] = {
        "position.next_truth_nm": round(truth.place_m * MM_PER_M * NM_PER_MM),
        "position.next_speed_um_s": round(truth.speed_m_per_s * NM_PER_MM),
        "selection.clock_mm": 0,
        "selection.clock_mm_s": 0,
    }
    names = {identity(name): name for name in truth.healthy_m}
    for number in range(1, 1 + sum(key.endswith("_ephemeris_valid") for key in inputs)):
        channel = f"selection.channel_{number}"
        name = names.get(int(inputs.get(f"{channel}_satellite", 0)))
        made[f"{channel}_elevation_mrad"] = round(1_000 * truth.elevation_rad[name]) if name else 0
        for kind, healthy, added in (
            ("", truth.healthy_m, truth.error_m),
            ("_s", truth.healthy_m_per_s, truth.error_m_per_s),
        ):
            made |= _split(channel, kind, name, inputs, healthy, added)
    return made


def _split(
    channel: str,
    kind: str,
    name: str | None,
    inputs: Mapping[str, Cell],
    healthy: Mapping[str, float],
    added: Mapping[str, float],
) -> dict[str, Cell]:
    """Return a difference split into the signal's own error and the parts of prediction and clock."""
    error = 0 if name is None else round((healthy[name] + added[name]) * MM_PER_M)
    measured = inputs.get(f"{channel}_speed_off_mm_s" if kind else f"{channel}_range_off_mm", error)
    own = f"{channel}_speed_error_mm_s" if kind else f"{channel}_error_mm"
    return {own: error, f"{channel}_prediction_mm{kind}": int(measured) - error}
