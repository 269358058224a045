"""The figures of the source, and troubles of one end of a train: scenes whose light the fibre machine replays.

Source: ES2616413, figures 2 to 4 (the amplitude rises), 5 (code), 7 to 9 (it falls), 10 (reflecting points).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from safeloc.models.fibre.code import Symbol, make_code
from safeloc.models.fibre.scenes.ends import Followed
from safeloc.models.fibre.scenes.scene import Scene, Section
from safeloc.models.fibre.variables import FibreConfig
from safeloc.simulation.fibre.optics import Drift
from safeloc.simulation.fibre.trains import LOCOMOTIVE, ORE_WAGON, Course, Train, coaches

CONFIG = FibreConfig()
QUIET_S, SPEED_M_S = 10, 35.0
_COUNTER_MM = 1_000_000
SPACING_MM = 750_000


@dataclass(frozen=True)
class EndScene:
    """A recording of the fibre machine: `fibre-NAME.jsonl.gz`.

    says      the scene and the expected outcome, in words
    mapped    the sections of the host's map, if they are not those of the scene
    ghosts    the detector stays within the bounds that the machine assumes
    """

    name: str
    title: str
    says: str
    scene: Scene
    followed: Followed = Followed(referred_mm=(_COUNTER_MM,))
    mapped: Sequence[Section] | None = None
    ghosts: bool = True
    marks: dict[str, int] = field(default_factory=lambda: {"axle counter": _COUNTER_MM})


def section(low_m: int, *, rises: bool = True, long: bool = False, by_material: bool = False) -> Section:
    """Return a section as the machine expects it."""
    low = low_m * 1_000
    return Section(low, low + (CONFIG.long_mm if long else CONFIG.short_mm), Symbol(rises, long), by_material)


def passenger(speed_m_s: float = SPEED_M_S, vehicles: int = 6) -> Train:
    """Return a locomotive and coaches; they come to the fibre when the detector has learnt its quiet."""
    return coaches(vehicles, Course(-speed_m_s * QUIET_S, ((0.0, speed_m_s),)))


def _ore_train(speed_m_s: float = SPEED_M_S) -> Train:
    """Return two locomotives and 40 ore wagons, 800 m."""
    return Train((*(LOCOMOTIVE,) * 2, *(ORE_WAGON,) * 40), Course(-speed_m_s * QUIET_S, ((0.0, speed_m_s),)))


RAISED = (section(1_500), section(2_300, long=True, by_material=True))
LOWERED = (section(1_500, rises=False), section(2_300, rises=False, long=True, by_material=True))
THREE = (section(1_500), section(2_200, rises=False), section(2_900, long=True))


def _coded(count: int) -> tuple[Section, ...]:
    symbols = make_code(count, CONFIG.window, CONFIG.reach).symbols
    return tuple(
        section(1_200 + number * SPACING_MM // 1_000, rises=symbol.rises, long=symbol.long)
        for number, symbol in enumerate(symbols)
    )


def _scene(sections: Sequence[Section], length_m: int = 4_000, seconds: int = 112, **more: object) -> Scene:
    return replace(Scene(length_m, seconds, (passenger(),), tuple(sections)), **more)  # type: ignore[arg-type]


FIGURES = (
    EndScene(
        "figure-2-rising",
        "Figures 2 to 4: the amplitude rises",
        "Two sections that raise the amplitude, by coupling and by material. Each is counted when the amplitude rises, and "
        "the place becomes exact again; the return to normal is no second section.",
        _scene(RAISED),
    ),
    EndScene(
        "figure-7-falling",
        "Figures 7 to 9: the amplitude falls",
        "Two sections that lower the amplitude, by a damper and by material. Each is counted when the amplitude falls; the "
        "return to normal is no second section.",
        _scene(LOWERED, seed=2),
    ),
    EndScene(
        "figure-5-code",
        "Figure 5: position code",
        "Six sections of a position code and nothing else to tell the place. Signals are counted from the first one on; "
        "after the fifth section the word is found, and the place is known.",
        _scene(_coded(6), 6_400, 170, seed=3),
        Followed(),
        marks={},
    ),
    EndScene(
        "figure-10-reflecting-points",
        "Figure 10: reflecting points",
        "A reflecting point before each section. Where the pattern coincides with one, its known place agrees with the "
        "place by the count: no error, whatever the index of refraction is.",
        _scene(
            RAISED,
            points={"point 1": 1_400_000, "point 2": 2_200_000, "point 3": 3_200_000},
            drift=lambda _: Drift(index_ppm=5_000),
            seed=4,
        ),
        Followed(referred_mm=(_COUNTER_MM,), flight=False),
    ),
)
_TROUBLES = (
    EndScene(
        "missed-section",
        "A section is missing",
        "The map has three sections, the middle one was taken away. When the whole interval is beyond it, error F "
        "(MISSED_SECTION): nothing is located until a reference.",
        _scene((THREE[0], THREE[2]), seed=5),
        mapped=THREE,
    ),
    EndScene(
        "false-section",
        "A section that is not on the map",
        "Between two sections someone clamped the cable to the rail. The signal does not fit the map: error F "
        "(FALSE_SECTION) in its cycle.",
        _scene((THREE[0], section(2_000), THREE[2]), seed=6),
        mapped=(THREE[0], THREE[2]),
    ),
    EndScene(
        "drift-of-n",
        "Drift of n",
        "The index of refraction drifts by 0.15 % a second from 60 s on. Position signals come at their time, but the place by time of flight drifts away: error F (FLIGHT_DIFFERS) as "
        "soon as it differs by more than its threshold. A smaller difference is not reported and changes no place.",
        _scene(THREE, drift=lambda second: Drift(index_ppm=max(0.0, second - 60) * 1_500), seed=7),
        ghosts=False,
    ),
    EndScene(
        "long-train-front",
        "A train longer than a section: its front",
        "800 m of ore wagons over sections of 150 and 400 m: several are active at once. The front counts each as it "
        "enters it, whatever the rest of the train does.",
        Scene(4_600, 132, (_ore_train(),), THREE, seed=8),
        Followed(referred_mm=(1_350_000,)),
        marks={"axle counter": 1_350_000},
    ),
    EndScene(
        "long-train-rear",
        "A train longer than a section: its rear",
        "The same train. Its rear is followed by a machine of its own and counts each section as it enters it; the two "
        "intervals together hold the train.",
        Scene(4_600, 132, (_ore_train(),), THREE, seed=8),
        Followed(side="low", referred_mm=(1_350_000,)),
        marks={"axle counter": 1_350_000},
    ),
)
END_SCENES = (*FIGURES, *_TROUBLES)
