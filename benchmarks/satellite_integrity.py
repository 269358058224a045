"""What protection levels are worth on recorded signals: availability and misleading cycles, at an alert limit.

python -m benchmarks.satellite_integrity RECORDINGS [DIAGRAMS]

Every recording and disturbance goes through the chain twice: as it is, where a level contains threshold, prediction and clock error of a
usable signal; and as it was, where it contained the threshold alone. DIAGRAMS is a folder for the Stanford diagrams of both.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from benchmarks.satellite_accuracy import DISTURBED, PHONE_PAIR, diagram, hidden_m
from benchmarks.satellite_recorded import Recording, geodetic, phone, told, truth
from benchmarks.satellite_tally import Tally, quantiles
from safeloc.models.satellite.ahead import Ahead
from safeloc.models.satellite.chain import EpochChain
from safeloc.models.satellite.fix_inputs import StepValues
from safeloc.report.stanford import REGIONS
from safeloc.sensing.satellite.residuals import Residuals
from safeloc.sensing.satellite.solution import Solution
from safeloc.simulation.faults import Fault

HEADS = (
    "recording", "alert limit, m", "added error, m", "level, m: 50 %", "cycles", "available", "withheld", "misleading",
    "hazardous", "longest unseen, s", "prediction or clock beyond its figure",
)  # fmt: skip
PHONE: dict[str, tuple[Fault, ...]] = {
    "as recorded": (),
    "steps of 150 m, two": (Fault("step", PHONE_PAIR, 60_000, 200_000, {"size_m": 150.0}),),
}


class ThresholdAlone(EpochChain):
    """The chain as it was: a level contains the threshold of each used signal, and nothing for prediction and clock."""

    def _fix(self, solution: Solution, predicted: Ahead, offset_s: float) -> StepValues:
        made, chosen = super()._fix(solution, predicted, offset_s), self.config.satellite.selection
        for dilution, further, added in (
            ("fix_dilution_permille", "fix_further_mm", chosen.range_threshold_mm / 1_000),
            ("fix_speed_dilution_permille", "fix_speed_further_um_s", chosen.speed_threshold_mm_s),
        ):
            more = math.ceil(int(made[f"position.{dilution}"]) * added)
            made |= {f"position.{dilution}": 0, f"position.{further}": int(made[f"position.{further}"]) + more}
        return made


@dataclass(frozen=True)
class Trial:
    """A recording with disturbances, as it was or as it is."""

    recording: Recording
    known: list[Residuals]
    name: str
    disturbances: tuple[Fault, ...]
    chain_of: type[EpochChain]

    @property
    def added_mm(self) -> int:
        """Return the error that a level adds for each used signal, with the map's error."""
        chosen, beside = self.recording.config.satellite.selection, self.recording.config.map_error_mm
        return (chosen.range_threshold_mm if self.chain_of is ThresholdAlone else chosen.usable_range_error_mm) + beside

    def run(self) -> Tally:
        """All its cycles."""
        state = "before" if self.chain_of is ThresholdAlone else "after"
        healthy_m = self.recording.config.satellite.selection.range_noise_mm / 1_000
        name = f"{self.recording.name}: {self.name}, {state}"
        tally = Tally(name, healthy_m, self.added_mm / 1_000, hidden_m(self.recording.config))
        tally.add(told(self.recording, self.known, self.disturbances, self.chain_of))
        return tally


def trials(folder: Path) -> Iterator[Trial]:
    """Every recording and disturbance, before and after."""
    for recording, conditions in ((geodetic(folder), DISTURBED), (phone(folder), PHONE)):
        known = truth(recording)
        for name, disturbances in conditions.items():
            for chain_of in (ThresholdAlone, EpochChain):
                yield Trial(recording, known, name, disturbances, chain_of)


def cells(trial: Trial, tally: Tally) -> list[str]:
    """In the order of HEADS."""
    config = trial.recording.config.satellite
    counts, levels = tally.all_reports().counts(config.tolerance_mm), quantiles(tally.levels_mm)
    regions = [f"{counts[region]} ({100 * counts[region] / tally.cycles:.1f} %)" for region in REGIONS]
    return [
        tally.name, f"{config.tolerance_mm / 1_000:.0f}", f"{trial.added_mm / 1_000:.1f}",
        "" if levels is None else f"{levels[0]:.1f}", str(tally.cycles), *regions,
        f"{tally.longest_unseen * config.period_ms / 1_000:.0f}", str(tally.uncompared),
    ]  # fmt: skip


def main() -> None:
    """Print the table."""
    folders = [Path(name) for name in sys.argv[1:]]
    if not folders:
        sys.exit("name the folder of the recordings: python -m benchmarks.satellite_integrity RECORDINGS [DIAGRAMS]")
    print(f"| {' | '.join(HEADS)} |\n|" + "---|" * len(HEADS))
    for trial in trials(folders[0]):
        tally = trial.run()
        print(f"| {' | '.join(cells(trial, tally))} |", flush=True)
        if len(folders) > 1:
            diagram(tally, trial.recording.config.satellite.tolerance_mm, folders[1])


if __name__ == "__main__":
    main()
