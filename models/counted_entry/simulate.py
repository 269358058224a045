"""Simulated trains that are counted into an area and then followed by the fibre, as steps of the counted entry.

The passages are those of the counter's own simulation. From the cycle of its record on, the fibre reports a train's count, length,
speed and place, until the first axle of the next train reports that it has left.

`python -m safeloc.models.counted_entry.simulate` writes the runs that ship, `... simulate FOLDER` those that are made on demand.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from random import Random

from safeloc.language.interpret import run
from safeloc.language.nodes import Value
from safeloc.language.system import lower
from safeloc.language.trace import Step
from safeloc.language.units import NM_PER_MM, UM_PER_MM
from safeloc.models import axle_counter
from safeloc.models.axle_counter import simulate as counting
from safeloc.models.counted_entry.configuration import CountedEntryConfig
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_named
from safeloc.runtime.streams.steps import Cell

_OVERHANG_MM = 3_000
_MARGIN_MM = 10_000
_NOISE_MM = 8_000
_COUNTED_EVERY = 4  # cycles from one count of the fibre to the next
Fibre = Callable[[dict[str, Cell]], dict[str, Cell]]
"""What the fibre reports, from what it would report rightly."""


def simulate(config: CountedEntryConfig, *, seed: int) -> Steps:
    """Return four trains one after the other, each of its own length and course."""
    return entered(config, counting.simulate(config.counter, seed=seed), seed=seed)


def entered(
    config: CountedEntryConfig, passages: Sequence[Mapping[str, Cell]], *, seed: int, fibre: Fibre = dict
) -> Steps:
    """Return the steps of these passages, with the fibre's readings of each train from its record on."""
    followed, steps = _Followed(config, Random(seed), fibre), Steps()
    counter = lower(axle_counter.machine(config.counter))
    for given, step in zip(passages, run(counter, list(passages)).steps, strict=True):
        steps.append({f"axle_counter.{name}": cell for name, cell in given.items()} | followed.cycle(step))
    return steps


class _Followed:
    """The train of the last record, and the fibre's readings of it."""

    def __init__(self, config: CountedEntryConfig, rng: Random, fibre: Fibre) -> None:
        self._config, self._rng, self._fibre = config, rng, fibre
        self._front_nm, self._cycle, self._here = 0, 0, False

    def cycle(self, counted: Step) -> dict[str, Cell]:
        """Return the cells of the train and of the verification for one cycle of the counter."""
        state, begins = counted.state, self._cycle == 0
        recorded = bool(counted.outputs["record_sound"])
        leaves = begins or (self._here and bool(state["axles_counted"]) and not recorded)
        self._here = recorded or (self._here and not leaves)
        if self._here:
            self._front_nm = self._config.counter_mm * NM_PER_MM + _foremost_nm(state) + _OVERHANG_MM * NM_PER_MM
        self._cycle += 1
        speed = int(state["true_speed_um_s"]) if self._here else 0
        truth: dict[str, Cell] = {
            "train.next_front_nm": self._front_nm, "train.next_front_speed_um_s": speed,
            "train.next_overhang_nm": _OVERHANG_MM * NM_PER_MM,
            "train.first_axle_counted_beyond_nm": 0, "train.last_axle_counted_beyond_nm": 0,
        }  # fmt: skip
        told = self._fibre(self._readings(state, speed)) if self._here else {"associated": False}
        return truth | {f"verification_doubted.{name}": cell for name, cell in _quiet(leaves, told).items()}

    def _readings(self, state: Mapping[str, Value], speed_um_s: int) -> dict[str, Cell]:
        off = self._rng.randint(-_NOISE_MM, _NOISE_MM)
        told: dict[str, Cell] = {
            "associated": True, "fibre_position_mm": self._front_nm // NM_PER_MM + off, "fibre_located": True,
            "fibre_margin_above_mm": _MARGIN_MM, "fibre_margin_below_mm": _MARGIN_MM, "chain_tested": True,
            "fibre_speed_mm_s": speed_um_s // UM_PER_MM + self._rng.randint(-500, 500),
        }  # fmt: skip
        if self._cycle % _COUNTED_EVERY == 0:
            told["fibre_axles"] = int(state["true_axles"])
            told["fibre_length_mm"] = abs(int(state["true_length_nm"])) // NM_PER_MM
        return told


def _foremost_nm(state: Mapping[str, Value]) -> int:
    """Return how far up the line from the counter the foremost axle is: of a train that came downwards the last one."""
    run_nm, length_nm = int(state["true_run_nm"]), int(state["true_length_nm"])
    return run_nm if state["last_axle_upwards"] else run_nm - length_nm


def _quiet(leaves: bool, told: Mapping[str, Cell]) -> dict[str, Cell]:
    """Return the cells of a cycle, with those at rest that are not reported."""
    at_rest: dict[str, Cell] = {
        "fibre_located": False, "fibre_margin_above_mm": 0, "fibre_margin_below_mm": 0, "fibre_error": False,
        "chain_tested": False, "chain_failed": False, "train_leaves": leaves,
    }  # fmt: skip
    return at_rest | dict(told)


# ------------------------------------------------------------------ named runs


def _two_trains(config: CountedEntryConfig) -> Steps:
    return [dict(step) for step in counting.RUNS["axle_counter-service"].steps(config.counter)]


def _service(config: CountedEntryConfig) -> Steps:
    return entered(config, _two_trains(config), seed=1)


def _miscounted(config: CountedEntryConfig) -> Steps:
    """The fibre counts one axle too few of each train."""

    def fewer(told: dict[str, Cell]) -> dict[str, Cell]:
        count = told.get("fibre_axles")
        return told if count is None else {**told, "fibre_axles": int(count) - 1}

    return entered(config, _two_trains(config), seed=2, fibre=fewer)


RUNS: Mapping[str, WorkedRun[CountedEntryConfig]] = {
    "counted_entry-service": WorkedRun("Two trains are counted, and verified from the cycle of their records on.", _service),
    "counted_entry-miscounted": WorkedRun(
        "The fibre counts one axle too few: each train is withheld from the first count on.", _miscounted
    ),
}  # fmt: skip
"""The recordings that ship, by name."""
ON_DEMAND: Mapping[str, WorkedRun[CountedEntryConfig]] = {}

if __name__ == "__main__":
    write_named(__file__, RUNS, ON_DEMAND, CountedEntryConfig())
