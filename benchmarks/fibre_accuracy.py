"""How exact and how sure the fibre front end is, over simulated backscatter: the tables of docs/signals.md.

python -m benchmarks.fibre_accuracy [runs of each condition, 10 unless told]

Each run has a cable of its own, a train of its own (kind, number of vehicles, speed, change of speed, direction), three
localization sections and the index of refraction at an end of its declared error. A figure counts as right when the
truth lies within the stated bounds.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from safeloc.sensing.fibre.features import Bounds, FibreFrame, SectionSignal, TrainSeen
from safeloc.sensing.fibre.figures import FibreConfig, Interrogator, SectionPlace
from safeloc.sensing.fibre.front_end import FrontEnd
from safeloc.simulation.fibre.cable import CableFigures, Section, cable
from safeloc.simulation.fibre.ground import Car
from safeloc.simulation.fibre.optics import Drift, OpticsFigures
from safeloc.simulation.fibre.scene import TrainTruth, World, shots
from safeloc.simulation.fibre.trains import COACH, LOCOMOTIVE, ORE_WAGON, Course, Train, Vehicle

LENGTH_M = 3_500
SECTIONS = (Section(1_000, 1_060, 4.0), Section(1_600, 1_660, 0.25), Section(2_200, 2_300, 4.0, by="material"))
EFFECTS = ("raises", "lowers", "raises")
PLACES = tuple(
    SectionPlace(id=f"S{number}", from_mm=round(one.from_m * 1_000), to_mm=round(one.to_m * 1_000), effect=effect)
    for number, (one, effect) in enumerate(zip(SECTIONS, EFFECTS, strict=True))
)
CONFIG = FibreConfig(interrogator=Interrogator(fibre_mm=LENGTH_M * 1_000), section_places=PLACES)
KINDS: dict[str, tuple[tuple[Vehicle, ...], Vehicle]] = {
    "coaches": ((LOCOMOTIVE,), COACH),
    "ore wagons": ((LOCOMOTIVE,), ORE_WAGON),
    "railcar": ((), COACH),
}
SECONDS = 60
RUN_UP_S = 10.0


@dataclass(frozen=True)
class Condition:
    """What is unlike the first line. Levels in hundredths of dB."""

    name: str
    coupling_cdb: int = 200
    strain: float = 2.5
    snr_cdb: int = 5_000
    cars: int = 0
    sections: bool = True


CONDITIONS = (
    Condition("line with three sections"),
    Condition("no sections", sections=False),
    Condition("coupling twice as uneven (4 dB)", coupling_cdb=400),
    Condition("train 8 dB fainter", strain=1.0),
    Condition("train 8 dB louder", strain=6.0),
    Condition("light 15 dB weaker (as from 37 km)", snr_cdb=3_500),
    Condition("five cars on a road beside", cars=5),
)


@dataclass(frozen=True)
class Sample:
    """One train told in one block: errors in mm and mm/s from the middle of the bounds, and whether the truth is inside."""

    front: tuple[float, bool] | None
    rear: tuple[float, bool] | None
    speed: tuple[float, bool]
    length: tuple[float, bool] | None
    half_width: float


@dataclass
class Tally:
    """What became of one condition's runs."""

    runs: int = 0
    blocks: int = 0
    told: int = 0
    false_trains: int = 0
    samples: list[Sample] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    counts_by_kind: Counter[tuple[str, str]] = field(default_factory=Counter)
    signals: Counter[str] = field(default_factory=Counter)


def run(condition: Condition, tally: Tally, seed: int) -> None:
    """One train past the sections."""
    rng = np.random.default_rng(seed)
    train = _train(condition, rng)
    index_ppm = float(rng.choice([-1, 1])) * CONFIG.interrogator.index_error_ppm
    figures = CableFigures(coupling_cdb=condition.coupling_cdb)
    laid = cable(CONFIG.interrogator, rng, figures=figures, sections=SECTIONS if condition.sections else ())
    cars = tuple(
        Car(rng.uniform(0, LENGTH_M), float(rng.choice([-1, 1]) * rng.uniform(10, 35))) for _ in range(condition.cars)
    )
    optics = OpticsFigures(snr_cdb=condition.snr_cdb)
    world = World(CONFIG, laid, (train,), cars, optics=optics, drift=lambda _: Drift(index_ppm=index_ppm))
    front, passed, made = FrontEnd(CONFIG, 1_000), Passed(), list[SectionSignal]()
    last_count = None
    for shot in shots(world, round(2 * SECONDS), rng):
        outcome = front.receive(shot.block, shot.delivered_ms)
        if not isinstance(outcome, FibreFrame):
            continue
        truth = shot.trains[0]
        tally.blocks += 1
        own = [one for one in outcome.trains if _overlaps(one, truth)]
        tally.false_trains += len(outcome.trains) - len(own)
        tally.told += bool(own)
        for one in own:
            tally.samples.append(_sample(one, truth))
            made += [signal for signal in one.signals if signal.leading and signal.entering]
            last_count = one.count or last_count
            passed.note(truth)
    tally.runs += 1
    judged = _judged_count(last_count.clusters if last_count and last_count.confident else None, train)
    tally.counts[judged] += 1
    tally.counts_by_kind[_kind(train), judged] += 1
    tally.signals.update(_judged_signals(made, passed, condition))


def _train(condition: Condition, rng: np.random.Generator) -> Train:
    heads, wagon = KINDS[str(rng.choice(list(KINDS)))]
    vehicles = (*heads, *[wagon] * int(rng.integers(2, 9)))
    speed, change = float(rng.uniform(12, 45)), float(rng.uniform(-0.3, 0.3))
    later = float(np.clip(speed + change * (SECONDS - RUN_UP_S), 8, 50))
    forward = bool(rng.random() < 0.5)
    sign = 1 if forward else -1
    start = 300.0 if forward else LENGTH_M - 300.0
    course = Course(start, ((RUN_UP_S, sign * speed), (float(SECONDS), sign * later)))
    return Train(vehicles, course, forward, condition.strain)


@dataclass
class Passed:
    """Fibre that the train's front was told on."""

    low_m: float = LENGTH_M
    high_m: float = 0.0

    def note(self, truth: TrainTruth) -> None:
        """The front's place while it was told."""
        front = truth.high_m if truth.speed_m_s > 0 else truth.low_m
        self.low_m, self.high_m = min(self.low_m, front), max(self.high_m, front)


def _overlaps(one: TrainSeen, truth: TrainTruth) -> bool:
    low = one.low.path_mm.low if one.low else 0
    high = one.high.path_mm.high if one.high else LENGTH_M * 1_000
    return low < truth.high_m * 1_000 and high > truth.low_m * 1_000


def _sample(one: TrainSeen, truth: TrainTruth) -> Sample:
    forward = truth.speed_m_s > 0
    low = _error(one.low.path_mm, truth.low_m) if one.low else None
    high = _error(one.high.path_mm, truth.high_m) if one.high else None
    ahead = 1 if forward else -1
    front, rear = (high, low) if forward else (low, high)
    length = _error(one.length_mm, truth.high_m - truth.low_m) if one.length_mm else None
    speed = _error(one.speed_mm_s, truth.speed_m_s)
    width = (one.high.path_mm.high - one.high.path_mm.low) / 2 if one.high else float("nan")
    return Sample(_signed(front, ahead), _signed(rear, ahead), (speed[0] * ahead, speed[1]), length, width)


def _error(bounds: Bounds, truth: float) -> tuple[float, bool]:
    """Middle less truth (m or m/s) in mm or mm/s, and whether the truth is inside."""
    exact = truth * 1_000
    return (bounds.low + bounds.high) / 2 - exact, bounds.low <= exact <= bounds.high


def _signed(error: tuple[float, bool] | None, ahead: int) -> tuple[float, bool] | None:
    """Positive: ahead in direction of travel."""
    return None if error is None else (error[0] * ahead, error[1])


def _judged_count(clusters: int | None, train: Train) -> str:
    """Coaches in a row give a cluster at each joint and one at each end; a locomotive's bogies one to three more."""
    if clusters is None:
        return "not told"
    wagons = sum(one is not LOCOMOTIVE for one in train.vehicles)
    least = wagons + 1
    most = least + (2 if LOCOMOTIVE in train.vehicles else 0)
    return "right" if least <= clusters <= most else "wrong"


def _kind(train: Train) -> str:
    """Which of the kinds of train it is."""
    last = train.vehicles[-1]
    return next(
        kind for kind, (heads, wagon) in KINDS.items() if wagon is last and (train.vehicles[0] in heads) == bool(heads)
    )


def _judged_signals(made: list[SectionSignal], passed: Passed, condition: Condition) -> Counter[str]:
    """Sections whose whole length the front was told on, and some run before to know normal, are expected."""
    expected = Counter(
        place.id
        for place in PLACES
        if condition.sections
        and passed.low_m + 250 < place.from_mm / 1_000
        and place.to_mm / 1_000 + 250 < passed.high_m
    )
    near = Counter(_true_section(signal) for signal in made) if condition.sections else Counter({"none": len(made)})
    judged = Counter(expected=expected.total())
    judged["found"] = sum(min(near[name], 1) for name in expected)
    judged["missed"] = sum(near[name] == 0 for name in expected)
    judged["twice"] = sum(max(near[name] - 1, 0) for name in near if name != "none")
    judged["false"] = near["none"]
    judged["named"] = sum(signal.section == _true_section(signal) for signal in made)
    judged["misnamed"] = sum(signal.section not in (None, _true_section(signal)) for signal in made)
    return judged


def _true_section(signal: SectionSignal) -> str:
    place = (signal.fibre_mm.low + signal.fibre_mm.high) / 2
    near = [
        one.id
        for one in PLACES
        if one.effect == signal.effect.value and one.from_mm - 60_000 <= place <= one.to_mm + 60_000
    ]
    return near[0] if near else "none"


# ------------------------------------------------------------------ tables


def by_quantity(tallies: dict[str, Tally]) -> Iterator[str]:
    """Errors against truth: bias, 95 % and worst, in m and m/s."""
    yield "| condition | quantity | told | bias | 95 % | worst | outside its bounds |"
    yield "|---|---|---|---|---|---|---|"
    for name, tally in tallies.items():
        for quantity in ("front", "rear", "length", "speed"):
            found = [getattr(sample, quantity) for sample in tally.samples]
            errors = [one for one in found if one is not None]
            if errors:
                yield _row(name, quantity, errors)


def _row(name: str, quantity: str, errors: list[tuple[float, bool]]) -> str:
    values = np.array([error for error, _ in errors]) / 1_000
    size, outside = np.abs(values), sum(not inside for _, inside in errors)
    unit = "m/s" if quantity == "speed" else "m"
    cells = (f"{values.mean():+.1f} {unit}", f"{np.percentile(size, 95):.1f}", f"{size.max():.1f}")
    return f"| {name} | {quantity} | {len(errors)} | {' | '.join(cells)} | {_share(outside, len(errors))} |"


def by_condition(tallies: dict[str, Tally]) -> Iterator[str]:
    """What was told, missed and false."""
    yield "| condition | runs | blocks with the train told | false trains | bogie count right / wrong / not told | sections found / expected | twice | false | misnamed |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for name, tally in tallies.items():
        counts = " / ".join(str(tally.counts[one]) for one in ("right", "wrong", "not told"))
        found = f"{tally.signals['found']} / {tally.signals['expected']}"
        rest = " | ".join(str(tally.signals[one]) for one in ("twice", "false", "misnamed"))
        told = f"{100 * tally.told / max(tally.blocks, 1):.0f} %"
        yield f"| {name} | {tally.runs} | {told} | {tally.false_trains} | {counts} | {found} | {rest} |"


def by_kind(tallies: dict[str, Tally]) -> Iterator[str]:
    """Bogie counts of every kind of train, all conditions together."""
    yield "| kind of train | runs | count right | wrong | not told | right of those told |"
    yield "|---|---|---|---|---|---|"
    for kind in KINDS:
        judged = Counter[str]()
        for tally in tallies.values():
            judged.update({verdict: number for (own, verdict), number in tally.counts_by_kind.items() if own == kind})
        told = judged["right"] + judged["wrong"]
        share = f"{100 * judged['right'] / told:.0f} %" if told else "-"
        cells = [str(judged[one]) for one in ("right", "wrong", "not told")]
        yield f"| {kind} | {judged.total()} | {' | '.join(cells)} | {share} |"


def _share(count: int, of: int) -> str:
    return f"0 (< {100 * 3 / of:.2f} %)" if count == 0 else f"{100 * count / of:.2f} %"


def tallied(runs: int, conditions: tuple[Condition, ...] = CONDITIONS) -> dict[str, Tally]:
    """Every condition's runs, with seeds of their own."""
    tallies: dict[str, Tally] = {}
    for number, condition in enumerate(conditions):
        tallies[condition.name] = tally = Tally()
        for seed in range(runs):
            run(condition, tally, 1_000 * number + seed)
    return tallies


def main(runs: int) -> None:
    """Print the tables."""
    tallies = tallied(runs)
    print(*by_quantity(tallies), "", *by_condition(tallies), "", *by_kind(tallies), sep="\n")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10)
