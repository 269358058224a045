"""Named scenes of a train in a line area, each with the expected outcome in words.

One area of 3.2 km for all: a test emitter before it, axle counters at both ends, four localization sections, six virtual
ones. The trains are of seven coaches, 28 axles. `verified-20-km` is the source's own area, with a third counter inside.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

from safeloc.language.units import MM_PER_M
from safeloc.models.fibre.code import make_code
from safeloc.models.fibre.scenes.counters import Ends
from safeloc.models.fibre.scenes.figures import CONFIG, QUIET_S, SPEED_M_S, section
from safeloc.models.fibre.scenes.scene import Scene
from safeloc.models.fibre.scenes.stay import Stay
from safeloc.simulation.faults import Fault
from safeloc.simulation.fibre.emitters import Sounding
from safeloc.simulation.fibre.trains import COACH, Course, Train

EMITTER_MM, EMITTER_BITS = 1_000_000, "1011001011100011"
SOUNDS_FROM_S, SOUNDS_EVERY_S = 12, 9
ENDS = Ends(2_000_000, 5_200_000)
COACHES = 7
_FAST_M_S = 44.0
_START_M = -SPEED_M_S * QUIET_S


@dataclass(frozen=True)
class AreaScene:
    """A recording of the whole: `fibre_area-NAME.jsonl.gz`, from second `from_s` of the scene on.

    says  the scene and the expected outcome, in words, with errors that cannot be noticed
    """

    name: str
    title: str
    says: str
    stay: Stay
    from_s: float = 52.0

    @property
    def marks(self) -> Mapping[str, int]:
        """Places with names."""
        ends = self.stay.ends
        inner = {f"axle counter {number}": place for number, place in enumerate(self.stay.between, 2)}
        last = f"axle counter {len(inner) + 2}"
        return {"emitter": EMITTER_MM, "axle counter 1": ends.low_mm, **inner, last: ends.high_mm}


@dataclass(frozen=True)
class OrderScene:
    """A recording of the machine that associates patterns with trains: `train_order-NAME.jsonl.gz`; all trains of the scene."""

    name: str
    title: str
    says: str
    scene: Scene
    ends: Ends
    from_s: float = 60.0


def unit(coaches: int = COACHES, start_m: float = _START_M, *speeds: tuple[float, float], ahead: bool = True) -> Train:
    """Return a multiple unit, by default at 35 m/s."""
    return Train((COACH,) * coaches, Course(start_m, speeds or ((0.0, SPEED_M_S),)), ahead)


def sounding(until_s: float) -> tuple[Sounding, ...]:
    """Return the emitter's pattern, time after time."""
    count = int((until_s - SOUNDS_FROM_S) // SOUNDS_EVERY_S)
    begins = (SOUNDS_FROM_S + SOUNDS_EVERY_S * number for number in range(count))
    return tuple(Sounding(EMITTER_BITS, EMITTER_MM / MM_PER_M, begin) for begin in begins)


def cuts(ends: Ends, count: int) -> tuple[tuple[int, int], ...]:
    """Return the area cut into virtual sections of equal length."""
    length = (ends.high_mm - ends.low_mm) // count
    bounds = [ends.low_mm + number * length for number in range(count)] + [ends.high_mm]
    return tuple((low, high - 1) for low, high in pairwise(bounds))


AREA = Scene(
    6_200,
    168,
    (unit(),),
    (section(2_500), section(3_250, rises=False), section(4_000, long=True), section(4_900, rises=False)),
    emitters=(("emitter", EMITTER_MM, EMITTER_BITS),),
    soundings=sounding(185),
)
STAY = Stay(AREA, ENDS, cuts(ENDS, 6), shown=3)


def _with(**changed: object) -> Scene:
    return replace(AREA, **changed)  # type: ignore[arg-type]


SPLIT_S, SPLIT_M = 95.0, 5 * COACH.length_m
SCENARIOS = (
    AreaScene(
        "verified-run",
        "A verified run",
        "Nothing goes wrong. The counter's record is matched by count, length, place and speed; from then on the position "
        "is reported, and each section is OCCUPIED while the train may be in it and FREE again behind it.",
        STAY,
    ),
    AreaScene(
        "ghost-train",
        "A ghost train",
        "A pattern like that of a second train comes towards the first one, and no counter has reported a second train: "
        "with two patterns for one train, neither is associated with it. The position is withheld (NOT_ASSOCIATED) in "
        "that cycle, and no section that the train may be in becomes FREE. A ghost that comes exactly while the train "
        "itself gives no signal is taken for the train by the order; only count, length, speed and jumps can then "
        "reveal it.",
        replace(
            STAY,
            scene=_with(trains=(unit(), unit(4, 5_600, (0, 0.0), (85, 0.0), (95, -25.0), ahead=False)), seed=2),
            ghosts=False,
        ),
    ),
    AreaScene(
        "lost-train",
        "A lost train",
        "For 12.5 s nothing comes from the interrogator. The position is withheld at once, both ends are lost (SILENT), the "
        "emitter's pattern is overdue (CHAIN_FAILED), and the trust does not come back without a new reference. The "
        "train's interval grows at the line's top speed: sections become UNKNOWN, none becomes FREE before it is "
        "counted out.",
        replace(STAY, scene=_with(faults=(Fault("missing", "", 190, 215),), seed=3)),
    ),
    AreaScene(
        "split-train",
        "A split train",
        "The last two coaches come off and roll to a stand. The pattern grows longer than the record: UNTRUSTED (LENGTH). "
        "When the parts are 80 m apart there are two patterns for one train, which belong to nobody. The lost part stands "
        "silent; its section never becomes FREE, not even when the rest has left, for fewer axles come out than went in.",
        replace(
            STAY,
            scene=_with(
                trains=(
                    unit(5),
                    unit(2, _START_M - SPLIT_M, (0, SPEED_M_S), (SPLIT_S, SPEED_M_S), (SPLIT_S + 30, 0.0)),
                ),
                seed=4,
            ),
            split=SPLIT_S,
            ghosts=False,
        ),
    ),
    AreaScene(
        "counter-miscount",
        "The counter miscounts",
        "The entry counter counts 24 of 28 axles. The fibre counts 28: UNTRUSTED (COUNT) with the record, for the whole "
        "stay. When other axles leave than entered, the counters disagree: nothing is FREE until they are reset and the "
        "area is swept. Were the fibre to miscount alike, nothing would show.",
        replace(STAY, scene=_with(seed=5), miscounted=-4, ghosts=False),
    ),
    AreaScene(
        "emitter-failure",
        "The emitter fails",
        "The emitter falls silent. When its pattern is overdue, the chain counts as failed: UNTRUSTED (CHAIN_FAILED) in that "
        "cycle, and the reported position is revoked. Sections become UNKNOWN as the train's interval grows.",
        replace(STAY, scene=_with(soundings=sounding(98), seed=6), chain_from=93.0),
    ),
)
_TWO_TRAINS = OrderScene(
    "two-trains-close",
    "Two trains close together",
    "A second train closes up to 50 m behind the first one and falls back again. Nearer than 80 m the detector sees one "
    "pattern for two trains: it belongs to nobody, and both positions are withheld until there are two again, which "
    "belong to the trains by their order.",
    Scene(
        6_200,
        160,
        (
            unit(),
            unit(
                5,
                _START_M - 450,
                (0, SPEED_M_S),
                (60, SPEED_M_S),
                (64, 40.0),
                (98, 40.0),
                (102, SPEED_M_S),
                (115, SPEED_M_S),
                (120, 30.0),
            ),
        ),
        seed=8,
    ),
    Ends(1_500_000, 5_900_000),
    from_s=50.0,
)
_LONG_ENDS = Ends(2_000_000, 22_000_000)
VERIFIED_20_KM = AreaScene(
    "verified-20-km",
    "A verified run through 20 km",
    "A line area of 20 km with three axle counters: entry, middle, exit. The record of the middle one agrees with that of "
    "the entry, and the train is trusted from the first record to the exit; twenty sections of a kilometre become "
    "OCCUPIED and FREE again one after the other.",
    Stay(
        Scene(
            23_000,
            526,
            (unit(COACHES, -_FAST_M_S * QUIET_S, (0, _FAST_M_S)),),
            tuple(
                section(2_700 + 1_500 * number, rises=symbol.rises, long=symbol.long)
                for number, symbol in enumerate(make_code(13, CONFIG.window, CONFIG.reach).symbols)
            ),
            emitters=AREA.emitters,
            soundings=sounding(526),
            seed=7,
        ),
        _LONG_ENDS,
        cuts(_LONG_ENDS, 20),
        shown=10,
        between=(12_000_000,),
        ghosts=False,
    ),
    from_s=43.0,
)
AREA_SCENES = (*SCENARIOS, VERIFIED_20_KM)
ORDER_SCENES = (_TWO_TRAINS,)
