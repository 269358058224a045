"""A train that locates itself on board and runs through a line area with virtual sections, as step streams.

`python -m safeloc.models.localizer_sections.simulate` writes them; the tests check that it still writes the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from safeloc.errors import InputError
from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_MM, NM_PER_UM
from safeloc.models.balise.groups import Group
from safeloc.models.localizer.simulation.simulate import Journey, Steps, Stretch
from safeloc.models.localizer.simulation.simulate import first_state as localizer_first
from safeloc.models.localizer.simulation.simulate import simulate as simulate_localizer
from safeloc.models.localizer_sections import NAME, LocalizerSectionsConfig
from safeloc.runtime.streams.steps import Cell, write_steps
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg

FOLDER, SEED = Path(__file__).with_name("recordings"), 3


@dataclass(frozen=True)
class Scene:
    """A journey through an area: places in mm, times in cycles.

    ends_mm      places of the axle counters
    sections_mm  begin and end of each section of the configuration
    clear        cycle in which the axle counters report the area empty, before the train comes
    parts        cycle from which the rear part stands still and train integrity is no longer confirmed; None: never
    says         the expected outcome in words
    """

    journey: Journey
    ends_mm: tuple[int, int]
    sections_mm: tuple[tuple[int, int], ...]
    clear: int = 5
    parts: int | None = None
    says: str = ""


RUN = Journey(
    legs=[Leg(0, 1), Leg(15_000, 47), Leg(0, 2)],
    groups=[Group(number, number * 150_000 - 120_000) for number in range(1, 7)],
    fibre=Stretch(200_000, 1_500_000),
    axles=44,
    length_mm=200_000,
    acceleration_mm_s2=1_000,
)
ENDS, SECTION = (200_000, 1_500_000), (260_000, 340_000)
SCENES: Mapping[str, Scene] = {
    "through": Scene(
        RUN, ENDS, (SECTION,),
        says="The train enters, occupies the section and leaves it behind: FREE again when its rear end has passed.",
    ),
    "parted": Scene(
        RUN, ENDS, (SECTION,), parts=340,
        says="The rear part is lost and stands in the section: the front end runs on, the section is not FREE again.",
    ),
    "silent-uplink": Scene(
        replace(RUN, troubles=[Fault("uplink silent", "", 340, 10_000)]), ENDS, (SECTION,),
        says="The radio link falls silent while the train is in the section: located on board, it leaves, and the section "
        "is not FREE again.",
    ),
}  # fmt: skip
"""The scenes, by the end of the recordings' names."""


def simulate(config: LocalizerSectionsConfig, scene: Scene, *, seed: int) -> Steps:
    """Return the scene as steps, ghosts included. InputError for a scene with another number of sections than configured."""
    if len(scene.sections_mm) != config.sections.sections:
        raise InputError(
            f"the scene has {len(scene.sections_mm)} sections; the configuration has {config.sections.sections}."
        )
    steps, far = simulate_localizer(config.localizer, scene.journey, seed=seed), _first_far_nm(config)
    front = before = 0
    made: Steps = []
    for cycle, step in enumerate(steps):
        before, front = front, front + _as_int(step["true_cycle_distance_nm"])
        complete = scene.parts is None or cycle < scene.parts
        far = front - config.train.length_mm * NM_PER_MM if complete else far
        made.append({**step, **_train(complete, far), **_area(config, scene, cycle, before, front, far)})
    return made


def _as_int(cell: Cell) -> int:
    assert isinstance(cell, int)
    return cell


def _first_far_nm(config: LocalizerSectionsConfig) -> int:
    return -config.train.length_mm * NM_PER_MM


def _train(complete: bool, far_nm: int) -> dict[str, Cell]:
    return {"ends.train_whole": complete, "ends.next_far_end_nm": far_nm}


def _area(
    config: LocalizerSectionsConfig, scene: Scene, cycle: int, before_nm: int, front_nm: int, rear_nm: int
) -> dict[str, Cell]:
    """Return the inputs of undisturbed axle counters: clear once, then they count the train in as its front end passes."""
    low, high = (end * NM_PER_MM for end in scene.ends_mm)
    step: dict[str, Cell] = {
        "area.counters_healthy": True, "area.counters_clear": cycle == scene.clear,
        "area.train_1_event": "ENTERS_LOW" if before_nm < low <= front_nm else "NONE",
        "area.axle_between": low < front_nm and rear_nm < high, "area.next_loose_there": False,
        "area.next_loose_rear_um": 0, "area.next_loose_front_um": 0,
    }  # fmt: skip
    for number in range(2, config.sections.area.trains + 1):
        name = f"area.train_{number}"
        step |= {
            f"{name}_event": "NONE", f"{name}_report_age_ms": 0, f"{name}_trusted": False, f"{name}_integer": False,
            f"{name}_downwards": False, f"{name}_next_rear_um": 0, f"{name}_next_front_um": 0,
        }  # fmt: skip
    return step


def first_state(config: LocalizerSectionsConfig, scene: Scene) -> dict[str, Value]:
    """Return first values of the open variables: the vehicle, its train, the ends of the area and of its sections."""
    far = _first_far_nm(config)
    first: dict[str, Value] = {
        **localizer_first(config.localizer, scene.journey),
        "ends.faces_upwards": True, "far_end_nm": far,
        "train_1_true_rear_um": far // NM_PER_UM, "train_1_true_front_um": 0,
        "area.low_end_mm": scene.ends_mm[0], "area.high_end_mm": scene.ends_mm[1],
        "area.loose_there": False, "area.loose_rear_um": 0, "area.loose_front_um": 0,
    }  # fmt: skip
    for number in range(2, config.sections.area.trains + 1):
        first |= {f"area.train_{number}_true_{end}_um": 0 for end in ("rear", "front")}
    for number, (start, end) in enumerate(scene.sections_mm, 1):
        first |= {f"section_{number}.from_mm": start, f"section_{number}.to_mm": end}
    return first


def write(folder: Path = FOLDER) -> list[Path]:
    """Write all recordings, each with its first state; return their paths."""
    config, paths = LocalizerSectionsConfig(), list[Path]()
    for name, scene in SCENES.items():
        paths.append(folder / f"{NAME}-{name}.jsonl.gz")
        steps, first = simulate(config, scene, seed=SEED), first_state(config, scene)
        write_steps(paths[-1], steps, machine=NAME, first=first, short=True)
    return paths


if __name__ == "__main__":
    for path in write():
        print(path)
