"""Runs of a fibre that is wrong unnoticed, each within its figure: errors that a verification by count and length cannot see.

The runs obey all laws of the world: the counter's record is true, and the train moves as trains do. The recordings are
written by `python -m safeloc.models.verification.unnoticed`; a test checks that they come out the same.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from safeloc.language.nodes import Value
from safeloc.language.units import MS_PER_S, NM_PER_MM, UM_PER_MM
from safeloc.models.fibre.simulate import Stay, simulate_stay
from safeloc.models.verification.variables import VerificationConfig
from safeloc.runtime.streams.steps import Cell, write_steps

CONFIG = VerificationConfig()
FOLDER = Path(__file__).with_name("recordings")
ENTRY, FROM_CYCLE, CYCLES = 2, 12, 90
Steps = list[dict[str, Cell]]


@dataclass(frozen=True)
class Unnoticed:
    """Wrong readings of the fibre from a cycle on, and the train's motion meanwhile.

    what    the error, in words
    beside_mm  distance of the interval from the front before the train leaves; 0: it contains the front
    tells   cycle, the front (mm) and the true readings -> the fibre's readings; None: no reading
    brakes_mm_s2  unseen braking of the train from that cycle on
    from_cycle  the first cycle in which the fibre is wrong
    """

    what: str
    beside_mm: int
    tells: Callable[[int, int, Mapping[str, Cell]], Mapping[str, Cell | None]]
    brakes_mm_s2: int = 0
    from_cycle: int = FROM_CYCLE


def _another_train(cycle: int, _: int, __: Mapping[str, Cell]) -> Mapping[str, Cell | None]:
    """Report the pattern of a train with as many axles that runs on when the train brakes."""
    return {"fibre_position_mm": _unbraked_mm(cycle)}


def _place_stands(_: int, __: int, ___: Mapping[str, Cell]) -> Mapping[str, Cell | None]:
    """Report one and the same place while the train runs on; no speed."""
    return {"fibre_position_mm": _unbraked_mm(FROM_CYCLE), "fibre_speed_mm_s": None}


def _place_wanders(cycle: int, front_mm: int, _: Mapping[str, Cell]) -> Mapping[str, Cell | None]:
    """Report a place that gains 20 m on the train in each cycle; count and length are right."""
    return {"fibre_position_mm": front_mm + 20_000 * (cycle - FROM_CYCLE)}


def _place_off(_: int, front_mm: int, __: Mapping[str, Cell]) -> Mapping[str, Cell | None]:
    """Report a place that is off by the tolerance, half the record's width and the interval's lower margin: 30, 5 and 10 m."""
    return {"fibre_position_mm": front_mm + 45_000}


def _length_off(_: int, __: int, inputs: Mapping[str, Cell]) -> Mapping[str, Cell | None]:
    """Report a length that is off by the tolerance and half the record's spread; no count."""
    return {"fibre_length_mm": 249_000, "fibre_axles": None} if "fibre_length_mm" in inputs else {}


def _old_values(cycle: int, _: int, __: Mapping[str, Cell]) -> Mapping[str, Cell | None]:
    """Repeat count and length of the entry in every eleventh cycle."""
    known = cycle % 11 == 10
    return {"fibre_axles": 40 if known else None, "fibre_length_mm": 205_000 if known else None}


RUNS: Mapping[str, Unnoticed] = {
    "another-train": Unnoticed(
        "the pattern of another train of equal count and length", 633_750, _another_train, 1_000
    ),
    "place-stands": Unnoticed("a place that stands while the train runs on", 940_000, _place_stands),
    "place-wanders": Unnoticed("a place that gets ahead of the train", 1_510_000, _place_wanders),
    "place-off": Unnoticed("a place that is off by the tolerance", 35_000, _place_off, from_cycle=0),
    "length-off": Unnoticed("a length that is off by the tolerance and the record's bounds", 0, _length_off),
    "values-from-memory": Unnoticed("count and length that are told from memory", 0, _old_values),
}


def _unbraked_mm(cycle: int) -> int:
    return Stay().speed_mm_s * CONFIG.period_ms * cycle // MS_PER_S


def steps_of(run: Unnoticed, config: VerificationConfig = CONFIG, cycles: int = CYCLES) -> Steps:
    """Return the steps of a run, ghosts included."""
    return [
        _step(run, cycle, dict(one))
        for cycle, one in enumerate(simulate_stay(config, seed=1, stay=Stay(cycles=cycles)))
    ]


def first_of() -> dict[str, Value]:
    """Return the ghosts of the train before the first step."""
    stay = Stay()
    return {
        "true_axles": stay.axles, "true_length_um": stay.length_mm * UM_PER_MM, "truth_nm": 0,
        "true_speed_um_s": stay.speed_mm_s * UM_PER_MM, "record_width_nm": 0, "record_spread_um": 0,
    }  # fmt: skip


def _step(run: Unnoticed, cycle: int, inputs: dict[str, Cell]) -> dict[str, Cell]:
    front, speed = _moved(run, cycle)
    inputs |= {"truth_mm": front, "next_truth_nm": front * NM_PER_MM, "next_true_speed_um_s": speed * UM_PER_MM}
    if cycle < run.from_cycle:
        return inputs
    wrong = {**inputs, **run.tells(cycle, front, inputs)}
    return {name: cell for name, cell in wrong.items() if cell is not None}


def _moved(run: Unnoticed, cycle: int) -> tuple[int, int]:
    """Return front and speed, mm and mm/s."""
    speed, front = Stay().speed_mm_s, _unbraked_mm(min(cycle, run.from_cycle))
    for _ in range(run.from_cycle, cycle):
        speed = max(0, speed - run.brakes_mm_s2 * CONFIG.period_ms // MS_PER_S)
        front += speed * CONFIG.period_ms // MS_PER_S
    return front, speed


def write(folder: Path) -> None:
    """Write the recordings anew."""
    for name, run in RUNS.items():
        path = folder / f"verification_doubted-{name}.jsonl.gz"
        write_steps(path, steps_of(run), machine="verification_doubted", first=first_of(), short=True)


if __name__ == "__main__":
    write(FOLDER)
