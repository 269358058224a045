"""Simulated runs with the direction of travel as step streams, ghosts included: the reflector device's run, and the models it meets.

`python -m safeloc.models.reflector_direction.simulate` writes the recordings.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_MM
from safeloc.models.reflector.simulate import Reflector
from safeloc.models.reflector_device import simulate as device
from safeloc.models.reflector_direction import NAME
from safeloc.models.reflector_direction.configuration import ReflectorDirectionConfig
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_runs
from safeloc.runtime.streams.steps import Cell

FOLDER, SEED = Path(__file__).with_name("recordings"), 7
_OTHERS = ("turn_off.", "stop_point.")
"""Machines of the reflector device that are not composed here."""
_SEEN_MM = 100_000
"""A reflector is recognised from this distance on."""


@dataclass(frozen=True)
class Course:
    """A run along the reflector device's line.

    along      the line's counting direction is that of the run
    permitted  the direction by route and movement authority
    """

    along: bool
    permitted: str
    says: str


COURSES: Mapping[str, Course] = {
    "permitted": Course(
        True,
        "ALONG",
        "The vehicle passes reflector B and the group behind it, and sees reflector C ahead: it runs along the line, as it is permitted to, and "
        "keeps its position.",
    ),
    "wrong-way": Course(
        False,
        "ALONG",
        "The same run, on a line that counts the other way: the models are met in the other order, and the vehicle runs against the direction "
        "that it is permitted to. The host gets no position from the cycle in which the second reflector shows that.",
    ),
}
"""The runs, by the end of the recordings' names."""


def simulate(config: ReflectorDirectionConfig, course: Course, *, seed: int) -> Steps:
    """Return a run along the line as steps: inputs, and ghosts that obey every law."""
    scene = device.SCENES["line"]
    places = device.motion_of(config.device, scene).position_nm
    reflectors = scene.radar.route.reflectors
    steps, last = Steps(), 0
    for step, place_nm in zip(device.simulate(config.device, scene, seed=seed), places, strict=True):
        here = int(place_nm) // NM_PER_MM
        own = {name: cell for name, cell in step.items() if not name.startswith(_OTHERS)}
        met = dict(_met(reflectors, last, here, course, "balise.telegram_group" in step))
        steps.append(own | {f"travel_direction.{name}": cell for name, cell in met.items()})
        last = here
    return steps


def _met(
    reflectors: tuple[Reflector, ...], last_mm: int, here_mm: int, course: Course, read: bool
) -> Iterator[tuple[str, Cell]]:
    """Yield what the direction hears in a cycle: the reflectors passed and ahead, and the map's neighbours of a group that is read."""
    behind = [one for one in reflectors if one.position_mm <= here_mm]
    ahead = [one for one in reflectors if one.position_mm > here_mm]
    passed = [one for one in behind if one.position_mm > last_mm]
    near = [one for one in ahead if one.position_mm - here_mm <= _SEEN_MM]
    sides = (behind[-1:], ahead[:1])
    yield "passed_model", _model(passed[-1:])
    yield "ahead_model", _model(near[:1])
    for name, side in zip(("model_before", "model_after"), sides if course.along else sides[::-1], strict=True):
        yield name, _model(side if read else [])
    yield "route_direction", course.permitted
    yield "next_runs_along", course.along


def _model(reflectors: list[Reflector]) -> str:
    return reflectors[0].model if reflectors else "NONE"


def simulated(config: ReflectorDirectionConfig, seed: int) -> Steps:
    """Return the permitted run along the line; the seed gives the errors of the sensors."""
    return simulate(config, COURSES["permitted"], seed=seed)


def first_state(config: ReflectorDirectionConfig, course: Course) -> dict[str, Value]:
    """Return first values of the open variables: the vehicle stands at place 0, in the direction of the run."""
    return {**device.first_state(config.device), "travel_direction.runs_along": course.along}


def _worked(course: Course) -> WorkedRun[ReflectorDirectionConfig]:
    return WorkedRun(
        course.says,
        lambda config: simulate(config, course, seed=SEED),
        first_state(ReflectorDirectionConfig(), course),
    )


def write(folder: Path = FOLDER) -> list[Path]:
    """Write all recordings, each with its first state; return their paths."""
    runs = {f"{NAME}-{name}": _worked(course) for name, course in COURSES.items()}
    return write_runs(folder, runs, ReflectorDirectionConfig(), short=True)


if __name__ == "__main__":
    print(*write(), sep="\n")
