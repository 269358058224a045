"""A train's stay in a line area as it was heard, as steps of the whole: ends, emitter, entry, verification, area, sections."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from safeloc.backends.compiled import compile_system
from safeloc.models.fibre_area import FibreAreaConfig, compose_machines
from safeloc.models.fibre_parts.variables import NM_PER_MM
from safeloc.models.fibre_scenes.counters import Ends, Record, events, record_of
from safeloc.models.fibre_scenes.ends import EndHost, Followed, Side
from safeloc.models.fibre_scenes.order import order_of
from safeloc.models.fibre_scenes.scene import MM_PER_M, Moment, Scene
from safeloc.nodes import Value
from safeloc.signals.fibre.features import TrainSeen
from safeloc.streams.steps import Cell
from safeloc.system import without_ghosts

Steps = list[dict[str, Cell]]
UM_PER_MM = 1_000
ENDS: Mapping[str, Side] = {"front": "high", "rear": "low"}
OVERHANG_MM = 4_500


@dataclass(frozen=True)
class Stay:
    """A stay of the scene's first train between two axle counters. Places in mm.

    cuts        virtual sections
    counted     numbers of the scene's trains that the counters tell of
    miscounted  axles that the entry record has too many
    recorded    whether the record comes at all
    chain_from  second from which the emitter is silent
    split       the first train's lost part is this train of the scene; axles that remain; second from which it is lost
    ghosts      whether the truth is given with the steps
    """

    scene: Scene
    ends: Ends
    cuts: tuple[tuple[int, int], ...]
    counted: tuple[int, ...] = (0,)
    miscounted: int = 0
    recorded: bool = True
    chain_from: float | None = None
    split: tuple[int, float] | None = None
    ghosts: bool = True


def first_state(stay: Stay, start: Moment) -> dict[str, Value]:
    """What is open at the start: counters, cuts, and where the train is."""
    low, high = (round(MM_PER_M * place) for place in _whole(stay, start))
    first: dict[str, Value] = {
        "area.low_end_mm": stay.ends.low_mm, "area.high_end_mm": stay.ends.high_mm,
    }  # fmt: skip
    for number, (begin, beyond) in enumerate(stay.cuts, 1):
        first |= {f"section_{number}.from_mm": begin, f"section_{number}.to_mm": beyond}
    if not stay.ghosts:
        return first
    ghosts: dict[str, Value] = {
        "area.loose_there": False, "area.loose_rear_um": stay.ends.low_mm * UM_PER_MM,
        "area.loose_front_um": stay.ends.low_mm * UM_PER_MM, "area.train_1_true_rear_um": low * UM_PER_MM,
        "area.train_1_true_front_um": high * UM_PER_MM, "front.truth_nm": high * NM_PER_MM,
        "rear.truth_nm": _pattern(stay, start)[0] * NM_PER_MM,
    }  # fmt: skip
    for end in ENDS:
        ghosts |= {f"{end}.true_edge_nm": 0, f"{end}.true_count": 0, f"{end}.section_is_real": False}
    return first | ghosts


def stay_steps(stay: Stay, moments: Sequence[Moment], config: FibreAreaConfig | None = None) -> Steps:
    """The steps; the remark `truth_mm` is where the front is."""
    host = _Host(stay, config or FibreAreaConfig(), moments[0])
    patterns = order_of(stay.ends, moments, stay.counted).patterns
    told = events(stay.ends, moments, 0)
    return [host.step(moment, own[0], event) for moment, own, event in zip(moments, patterns, told, strict=True)]


class _Host:
    """What stands between detector, counters and the machines."""

    def __init__(self, stay: Stay, config: FibreAreaConfig, start: Moment) -> None:
        self._stay = stay
        system = without_ghosts(compose_machines(config).composition.system)
        self._code, known = compile_system(system), {var.name for var in system.state}
        first = {name: value for name, value in first_state(stay, start).items() if name in known}
        self._state = self._code.first(first)
        self._ends = {
            name: EndHost(stay.scene, Followed(0, side, stay.ends.low_mm), config.fibre) for name, side in ENDS.items()
        }
        record = record_of(stay.scene.trains[0], miscounted=stay.miscounted) if stay.recorded else None
        self._entry = _Entry(stay.ends, record)

    def step(self, moment: Moment, own: TrainSeen | None, event: str) -> dict[str, Cell]:
        """One cycle: what is heard, what the machines make of it, and the truth beside."""
        was = self._code.named_outputs(self._state)
        pattern = self._nearest(moment)
        heard: dict[str, Cell] = {}
        for name, host in self._ends.items():
            end = host.heard(pattern, moment, _of(name, was))
            heard |= {f"{name}.{key}": cell for key, cell in end.items() if key != "truth_mm"}
        settled = "front.run_mm" in heard
        heard |= (
            _emitter(moment) | self._entry.heard(moment, event) | _verified(own if settled else None, own is not None)
        )
        heard |= {"report.reading_age_ms": 0, "area.counters_healthy": True, "area.counters_clear": self._entry.clear}
        self._state, _ = self._code.step(self._state, self._code.read(heard))
        return {**heard, **self._truth(moment, heard, was), "truth_mm": _pattern(self._stay, moment)[1]}

    def _nearest(self, moment: Moment) -> TrainSeen | None:
        """The pattern that the ends' machines go on with: the one that holds the train, where there is just one."""
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
        return truth | _world(self._stay, moment)


class _Entry:
    """The counters: events, the record in its cycle, and whether the area is empty."""

    def __init__(self, ends: Ends, record: Record | None) -> None:
        self._ends, self._record = ends, record
        self._due_ms: int | None = None
        self.clear = True

    def heard(self, moment: Moment, event: str) -> dict[str, Cell]:
        """Inputs of one cycle."""
        if event == "ENTERS_LOW":
            self.clear = False
            self._due_ms = None if self._record is None else moment.time_ms + self._record.after_ms
        comes = self._due_ms is not None and moment.time_ms >= self._due_ms
        self._due_ms = None if comes else self._due_ms
        told: dict[str, Cell] = {"entry.event": event, "entry.reference_comes": "AXLE_COUNTER" if comes else "NOBODY"}
        return told | _recorded(self._ends, self._record)


def _recorded(ends: Ends, record: Record | None) -> dict[str, Cell]:
    """The record, as of the cycle in which it comes."""
    made = record or Record(0, (0, 0), (0, 0), (0, 0), 0)
    return {
        "verification.record_sound": record is not None, "verification.record_axles": made.axles,
        "verification.record_length_low_mm": made.length_mm[0],
        "verification.record_length_high_mm": made.length_mm[1] + 2 * OVERHANG_MM,
        "verification.record_speed_low_mm_s": made.speed_mm_s[0],
        "verification.record_speed_high_mm_s": made.speed_mm_s[1],
        "verification.record_place_low_mm": ends.low_mm + made.run_mm[0],
        "verification.record_place_high_mm": ends.low_mm + made.run_mm[1] + OVERHANG_MM,
        "verification.record_age_cycles": 1 if record is not None else 0,
    }  # fmt: skip


def _emitter(moment: Moment) -> dict[str, Cell]:
    """The pattern that ended in this block; of several, a known one."""
    heard = sorted(moment.heard, key=lambda one: one.emitter is None)
    step: dict[str, Cell] = {"emitter.test_requested": False}
    if not heard:
        return step
    return step | {"emitter.heard_pattern": int(heard[0].bits, 2), "emitter.heard_place_mm": heard[0].fibre_mm}


def _verified(own: TrainSeen | None, associated: bool) -> dict[str, Cell]:
    """What the detector tells of the train's pattern, once its course is fitted and settled."""
    made: dict[str, Cell] = {"verification.associated": associated}
    if own is None:
        return made
    made["verification.fibre_speed_mm_s"] = (own.speed_mm_s.low + own.speed_mm_s.high) // 2
    if own.length_mm is not None:
        made["verification.fibre_length_mm"] = (own.length_mm.low + own.length_mm.high) // 2
    if own.count is not None and own.count.confident and own.count.axles is not None:
        made["verification.fibre_axles"] = own.count.axles
    return made


def holding(trains: Sequence[TrainSeen], place_mm: int) -> TrainSeen | None:
    """The pattern that holds a place; None where none or several do."""
    found = [
        one
        for one in trains
        if (one.low is None or one.low.path_mm.low <= place_mm)
        and (one.high is None or place_mm <= one.high.path_mm.high)
    ]
    return found[0] if len(found) == 1 else None


def _of(name: str, values: Mapping[str, Value] | Mapping[str, Cell]) -> dict[str, Value]:
    """What belongs to one machine, under its own names."""
    prefix = f"{name}."
    return {key.removeprefix(prefix): value for key, value in values.items() if key.startswith(prefix)}  # type: ignore[misc]


# ------------------------------------------------------------------ the truth


def _pattern(stay: Stay, moment: Moment) -> tuple[int, int]:
    """Ends of what the fibre can see of the train: a lost part stands silent."""
    low, high = _whole(stay, moment) if not _is_split(stay, moment) else (moment.truth[0].low_m, moment.truth[0].high_m)
    return round(MM_PER_M * low), round(MM_PER_M * high)


def _whole(stay: Stay, moment: Moment) -> tuple[float, float]:
    """Ends of the whole train, with a part that it loses."""
    own = moment.truth[0]
    return (own.low_m if stay.split is None else moment.truth[stay.split[0]].low_m), own.high_m


def _is_split(stay: Stay, moment: Moment) -> bool:
    return stay.split is not None and moment.second >= stay.split[1]


def _world(stay: Stay, moment: Moment) -> dict[str, Cell]:
    """Ghost inputs of the machines behind the fibre's."""
    low, high = (round(MM_PER_M * UM_PER_MM * place) for place in _whole(stay, moment))
    seen_low, seen_high = _pattern(stay, moment)
    split = _is_split(stay, moment)
    axles = len(stay.scene.trains[0].axles_m())
    lost = 0 if stay.split is None or split else len(stay.scene.trains[stay.split[0]].axles_m())
    works = stay.chain_from is None or moment.second < stay.chain_from
    return {
        "emitter.next_chain_works": works, "verification.next_true_axles": axles + lost,
        "verification.next_true_length_um": (seen_high - seen_low) * UM_PER_MM,
        "report.next_rear_is_the_trains": not split, "report.next_front_is_the_trains": True,
        "report.next_rear_um": low, "report.next_front_um": high, "area.next_loose_there": False,
        "area.next_loose_rear_um": stay.ends.low_mm * UM_PER_MM, "area.next_loose_front_um": stay.ends.low_mm * UM_PER_MM,
    }  # fmt: skip
