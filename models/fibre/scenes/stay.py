"""A train's stay in a line area as the detector follows it, as steps of the whole area."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.language.nodes import Value
from safeloc.language.system import without_ghosts
from safeloc.language.trace import shown
from safeloc.language.units import MM_PER_M, NM_PER_MM, UM_PER_MM
from safeloc.models.fibre.scenes.counters import Ends, Record, events, record_of
from safeloc.models.fibre.scenes.ends import EndHost, Followed, Side
from safeloc.models.fibre.scenes.order import inside_area, patterns_of
from safeloc.models.fibre.scenes.scene import Moment, Scene
from safeloc.models.fibre_area import FibreAreaConfig, compose_machines
from safeloc.models.fibre_area.simulated_counters import come_in, heads, inside, passed, sweep
from safeloc.models.sections import SectionsConfig
from safeloc.runtime.streams.steps import Cell
from safeloc.sensing.fibre.features import TrainSeen
from safeloc.simulation.fibre.trains import Train

Steps = list[dict[str, Cell]]
ENDS: Mapping[str, Side] = {"front": "high", "rear": "low"}
_OVERHANG_MM = 4_500


@dataclass(frozen=True)
class Stay:
    """A stay of the scene's first train between two axle counters, which are clear after a sweep while it comes near. Places in mm.

    between     counters inside the area; each of them gives a record, too
    cuts        virtual sections; `shown`: number of the one that is section_1 of the shipped machine
    miscounted  axles that the entry record has beyond those that passed
    chain_from  second from which the emitter is silent
    split       the second train of the scene is the rear part of the first, lost from this second on
    ghosts      the steps contain the truth
    """

    scene: Scene
    ends: Ends
    cuts: tuple[tuple[int, int], ...]
    shown: int = 1
    between: tuple[int, ...] = ()
    miscounted: int = 0
    chain_from: float | None = None
    split: float | None = None
    ghosts: bool = True

    @property
    def train(self) -> Train:
        """The whole train, as it enters."""
        first, *others = self.scene.trains
        lost = others[0].vehicles if self.split is not None else ()
        return Train((*first.vehicles, *lost), first.course, first.ahead)

    @property
    def config(self) -> FibreAreaConfig:
        """The configuration with all the cuts."""
        plain = FibreAreaConfig()
        return FibreAreaConfig(sections=SectionsConfig(area=plain.sections.area, sections=len(self.cuts)))


@dataclass(frozen=True)
class Stayed:
    """The steps, and the state of each virtual section after each of them."""

    steps: Steps
    states: list[list[str]]


def first_state(stay: Stay, start: Moment, cuts: Sequence[tuple[int, int]]) -> dict[str, Value]:
    """Return the open values at the start: counters, cuts, and the train's place."""
    low, high = (round(MM_PER_M * place) for place in _extent(stay, start))
    first: dict[str, Value] = {
        "area.low_end_mm": stay.ends.low_mm, "area.high_end_mm": stay.ends.high_mm,
    }  # fmt: skip
    for number, (begin, beyond) in enumerate(cuts, 1):
        first |= {f"section_{number}.from_mm": begin, f"section_{number}.to_mm": beyond}
    if not stay.ghosts:
        return first
    ghosts: dict[str, Value] = {
        "axle_section.true_axles": 0, "entry.true_axles": len(stay.train.axles_m()), "train_order.train_1_inside": False,
        "train_order.train_1_place_um": (low + high) // 2 * UM_PER_MM,
        "area.loose_there": False, "area.loose_rear_um": stay.ends.low_mm * UM_PER_MM,
        "area.loose_front_um": stay.ends.low_mm * UM_PER_MM, "area.train_1_true_rear_um": low * UM_PER_MM,
        "area.train_1_true_front_um": high * UM_PER_MM, "front.truth_nm": high * NM_PER_MM,
        "rear.truth_nm": _pattern(stay, start)[0] * NM_PER_MM,
    }  # fmt: skip
    for end in ENDS:
        ghosts |= {f"{end}.true_edge_nm": 0, f"{end}.true_count": 0, f"{end}.section_is_real": False}
    return first | ghosts


def stayed(stay: Stay, heard: Sequence[Moment], begin: int) -> Stayed:
    """Return the stay from moment number `begin` on; the remark `truth_mm` is the front's true place."""
    moments = heard[begin:]
    host = _Host(stay, heard[begin - 1])
    for moment in heard[:begin]:
        host.before(moment)
    passages = events(stay.ends, [_pattern_m(stay, moment) for moment in moments])
    return Stayed([host.step(moment, event) for moment, event in zip(moments, passages, strict=True)], host.states)


@lru_cache(maxsize=8)
def _on_board(config: str) -> Compiled:
    """Return the area without its world, cached for further stays with the same configuration (JSON)."""
    return compile_system(
        without_ghosts(compose_machines(FibreAreaConfig.model_validate_json(config)).composition.system)
    )


class _Host:
    """The host between detector, counters and the machines."""

    def __init__(self, stay: Stay, start: Moment) -> None:
        self._stay, config = stay, stay.config
        self._code = _on_board(config.model_dump_json())
        known = set(self._code.state_names)
        first = {name: value for name, value in first_state(stay, start, stay.cuts).items() if name in known}
        self._state = self._code.first(first)
        self._ends = {
            name: EndHost(stay.scene, Followed(0, side, (stay.ends.low_mm, *stay.between)), config.fibre)
            for name, side in ENDS.items()
        }
        self._entry = _Entry(stay)
        self._axles = _Axles(stay, start)
        self._front_mm = _pattern(stay, start)[1]
        self._modes = [f"section_{number}.mode" for number in range(1, len(stay.cuts) + 1)]
        self.states: list[list[str]] = [[] for _ in stay.cuts]

    def before(self, moment: Moment) -> None:
        """Prepare the host: a moment before the first step."""
        for host in self._ends.values():
            host.before(self._nearest(moment), moment)

    def step(self, moment: Moment, event: str) -> dict[str, Cell]:
        """Return one cycle: inputs, the machines' outputs, and the truth."""
        was = self._code.named_outputs(self._state)
        pattern = self._nearest(moment)
        seen = [one for one in moment.trains if inside_area(one, self._stay.ends)]
        heard: dict[str, Cell] = {}
        for name, host in self._ends.items():
            end = host.heard(pattern, moment, _of(name, was))
            heard |= {f"{name}.{key}": cell for key, cell in end.items() if key != "truth_mm"}
        settled = "front.run_mm" in heard
        heard |= (
            _emitter(moment)
            | self._entry.heard(moment, event, _pattern(self._stay, moment)[1])
            | self._axles.passed(moment)
            | {f"train_order.{name}": cell for name, cell in patterns_of(seen, 1).items()}
            | _verified(seen[0] if settled and len(seen) == 1 else None)
        )
        heard |= {"report.reading_age_ms": 0}
        self._state, _ = self._code.step(self._state, self._code.read(heard))
        self._note()
        return {**heard, **self._truth(moment, heard, was), "truth_mm": _pattern(self._stay, moment)[1]}

    def _note(self) -> None:
        values = dict(zip(self._code.system.state, self._state, strict=True))
        for var, value in values.items():
            if var.name in self._modes:
                self.states[self._modes.index(var.name)].append(shown(var, value))

    def _nearest(self, moment: Moment) -> TrainSeen | None:
        """Return the pattern for the machines of both ends: the one that contains the train, if there is just one."""
        low, high = _pattern(self._stay, moment)
        return holding(moment.trains, (low + high) // 2)

    def _truth(self, moment: Moment, heard: Mapping[str, Cell], was: Mapping[str, Value]) -> dict[str, Cell]:
        if not self._stay.ghosts:
            return {}
        now, truth = self._code.named_outputs(self._state), dict[str, Cell]()
        low, high = _pattern(self._stay, moment)
        for name, host in self._ends.items():
            place = high if name == "front" else low
            own = {**_of(name, heard), "truth_mm": place}
            ghosts = host.ghosts(own, _of(name, was), _of(name, now))
            truth |= {f"{name}.{key}": cell for key, cell in ghosts.items()}
        before, self._front_mm = self._front_mm, high
        place, there = (low + high) // 2 * UM_PER_MM, self._axles.inside > 0
        truth |= {
            "train_order.next_train_1_inside": there,
            "train_order.next_train_1_place_um": place, "train_order.pattern_1_owner": int(there),
        }  # fmt: skip
        return truth | self._axles.truth | _world(self._stay, moment) | _body(self._stay, high, high - before)


class _Axles:
    """Every axle of the train, a lost part's too, as the counters at both ends count it; at first, the sweep of the area.

    truth  what really passed the heads in this cycle, as inputs
    """

    def __init__(self, stay: Stay, start: Moment) -> None:
        self._stay, self._ends = stay, (stay.ends.low_mm, stay.ends.high_mm)
        self._sweep = sweep(stay.config.axle_section)
        self._places = self._of(start)
        self._uncounted = -stay.miscounted
        self.truth: dict[str, Cell] = {}

    def _of(self, moment: Moment) -> list[float]:
        """Return the place of every axle."""
        parts = self._stay.scene.trains[: 1 if self._stay.split is None else 2]
        pairs = zip(parts, moment.truth, strict=False)
        return [float(MM_PER_M * (truth.high_m - behind)) for part, truth in pairs for behind in part.axles_m()]

    def passed(self, moment: Moment) -> dict[str, Cell]:
        """Return the inputs of one cycle; of a counter that miscounts, fewer axles than came in."""
        before, self._places = self._places, self._of(moment)
        true = passed(before, self._places, self._ends)
        missed = min(true["axles_in_low"], max(self._uncounted, 0))
        self._uncounted -= missed
        counted = {**true, "axles_in_low": true["axles_in_low"] - missed}
        cells = heads(counted, true)
        if self._sweep:
            cells = {f"axle_section.{name}": cell for name, cell in self._sweep.pop(0).items()}
        truth = {name: cell for name, cell in cells.items() if ".true_" in name}
        of_trains = {**come_in("own", true), **come_in("other", dict.fromkeys(true, 0))}
        self.truth = {**truth, "entry.axles_of_one_that_enters": len(self._places), **of_trains}
        return {name: cell for name, cell in cells.items() if name not in truth}

    @property
    def inside(self) -> int:
        """Axles in the area."""
        return inside(self._places, self._ends)


class _Entry:
    """The counters: events of the train, and the records in their cycles."""

    def __init__(self, stay: Stay) -> None:
        self._places = (stay.ends.low_mm, *stay.between)
        self._record = record_of(stay.train, miscounted=stay.miscounted)
        self._due_ms: dict[int, int] = {}
        self._front_mm: int | None = None

    def heard(self, moment: Moment, event: str, front_mm: int) -> dict[str, Cell]:
        """Return the inputs of one cycle."""
        before, self._front_mm = self._front_mm, front_mm
        for place in self._places:
            if before is not None and before < place <= front_mm:
                self._due_ms[place] = moment.time_ms + self._record.after_ms
        comes = next((place for place, due in self._due_ms.items() if moment.time_ms >= due), None)
        if comes is not None:
            self._due_ms.pop(comes)
        return {
            "entry.enters_low": int(event == "ENTERS_LOW"), "entry.enters_high": int(event == "ENTERS_HIGH"),
            "entry.leaves_low": event == "LEAVES_LOW", "entry.leaves_high": event == "LEAVES_HIGH",
            "entry.reference_comes": "NOBODY" if comes is None else "AXLE_COUNTER",
            **_recorded(comes or self._places[0], self._record),
        }  # fmt: skip


def _recorded(counter_mm: int, record: Record) -> dict[str, Cell]:
    """Return the record, valid in the cycle in which it comes."""
    return {
        "entry.record_sound": True, "entry.record_axles": record.axles,
        "verification.record_length_low_mm": record.length_mm[0],
        "verification.record_length_high_mm": record.length_mm[1] + 2 * _OVERHANG_MM,
        "verification.record_speed_low_mm_s": record.speed_mm_s[0],
        "verification.record_speed_high_mm_s": record.speed_mm_s[1],
        "verification.record_place_low_mm": counter_mm + record.run_mm[0],
        "verification.record_place_high_mm": counter_mm + record.run_mm[1] + _OVERHANG_MM,
        "verification.record_age_cycles": 1,
    }  # fmt: skip


def _emitter(moment: Moment) -> dict[str, Cell]:
    """Return the pattern that ended in this block; of several, a known one."""
    heard = sorted(moment.heard, key=lambda one: one.emitter is None)
    step: dict[str, Cell] = {"emitter.test_requested": False}
    if not heard:
        return step
    return step | {"emitter.heard_pattern": int(heard[0].bits, 2), "emitter.heard_place_mm": heard[0].fibre_mm}


def _verified(own: TrainSeen | None) -> dict[str, Cell]:
    """Return the detector's readings of the only pattern in the area, once its course is fitted and settled."""
    made: dict[str, Cell] = {}
    if own is None:
        return made
    made["verification.fibre_speed_mm_s"] = (own.speed_mm_s.low + own.speed_mm_s.high) // 2
    if own.length_mm is not None:
        made["verification.fibre_length_mm"] = (own.length_mm.low + own.length_mm.high) // 2
    if own.count is not None and own.count.confident and own.count.axles is not None:
        made["verification.fibre_axles"] = own.count.axles
    return made


def holding(trains: Sequence[TrainSeen], place_mm: int) -> TrainSeen | None:
    """Return the pattern that contains a place; None if none or several do."""
    found = [
        one
        for one in trains
        if (one.low is None or one.low.path_mm.low <= place_mm)
        and (one.high is None or place_mm <= one.high.path_mm.high)
    ]
    return found[0] if len(found) == 1 else None


def _of(name: str, values: Mapping[str, Value] | Mapping[str, Cell]) -> dict[str, Value]:
    """Return the values of one machine, under its own names."""
    prefix = f"{name}."
    return {key.removeprefix(prefix): value for key, value in values.items() if key.startswith(prefix)}  # type: ignore[misc]


# ------------------------------------------------------------------ the truth


def _pattern(stay: Stay, moment: Moment) -> tuple[int, int]:
    """Return the ends of what the fibre can see of the train: a lost part stands silent."""
    low, high = (
        _extent(stay, moment) if not _is_split(stay, moment) else (moment.truth[0].low_m, moment.truth[0].high_m)
    )
    return round(MM_PER_M * low), round(MM_PER_M * high)


def _pattern_m(stay: Stay, moment: Moment) -> tuple[float, float]:
    """Return the same, m."""
    low, high = _pattern(stay, moment)
    return low / MM_PER_M, high / MM_PER_M


def _extent(stay: Stay, moment: Moment) -> tuple[float, float]:
    """Return the ends of the whole train, with a part that it loses."""
    own = moment.truth[0]
    return (own.low_m if stay.split is None else moment.truth[1].low_m), own.high_m


def _body(stay: Stay, high_mm: int, run_mm: int) -> dict[str, Cell]:
    """Return the ends of the train as if it had lost no vehicle, and its run in the cycle."""
    low_mm = high_mm - round(MM_PER_M * stay.train.length_m)
    return {
        "report.next_body_rear_um": low_mm * UM_PER_MM, "report.next_body_front_um": high_mm * UM_PER_MM,
        "report.true_cycle_distance_um": run_mm * UM_PER_MM,
    }  # fmt: skip


def _is_split(stay: Stay, moment: Moment) -> bool:
    return stay.split is not None and moment.second >= stay.split


def _world(stay: Stay, moment: Moment) -> dict[str, Cell]:
    """Return the ghost inputs of the machines behind the fibre's."""
    low, high = (round(MM_PER_M * UM_PER_MM * place) for place in _extent(stay, moment))
    seen_low, seen_high = _pattern(stay, moment)
    split = _is_split(stay, moment)
    axles = len((stay.scene.trains[0] if split else stay.train).axles_m())
    works = stay.chain_from is None or moment.second < stay.chain_from
    return {
        "emitter.next_chain_works": works, "verification.next_true_axles": axles,
        "verification.next_true_length_um": (seen_high - seen_low) * UM_PER_MM,
        "report.next_rear_is_the_trains": not split, "report.next_front_is_the_trains": True,
        "report.next_rear_um": low, "report.next_front_um": high, "area.next_loose_there": False,
        "area.next_loose_rear_um": stay.ends.low_mm * UM_PER_MM, "area.next_loose_front_um": stay.ends.low_mm * UM_PER_MM,
    }  # fmt: skip
