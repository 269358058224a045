"""How well satellites are selected, and what the position along the track is worth: the tables of docs/satellites.md.

python -m benchmarks.satellite_accuracy [runs of each condition, 5 unless told] [folder of the recordings] [folder for diagrams]

Simulated journeys along the worked line; and, with the folder, recorded signals with disturbances put on them. A signal is
healthy while nothing disturbs it and its error is what the receiver has; of the others it is told whether their whole error
is within the bound that a solution counts for them (then they do no harm), beyond it, or beyond twice of it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from benchmarks.satellite_recorded import Recording, as_told, geodetic, phone, told, truth
from benchmarks.satellite_tally import Cycle, Tally, quantiles
from safeloc.models.satellite.chain import ChainConfig
from safeloc.models.satellite.simulate import FINE, Journey, passed
from safeloc.report.stanford import stanford_diagram
from safeloc.simulation.faults import Fault
from safeloc.simulation.satellite.constellation import GALILEO, GPS
from safeloc.simulation.satellite.receiver import ReceiverConfig

CONFIG = ChainConfig(satellite=FINE)
SKY = Journey(walkers=(GPS, GALILEO))
OPEN = replace(SKY, from_m=4_150, to_m=5_900, scenes=())
QUARTER = frozenset(f"{letter}{number:02d}" for letter in "GE" for number in range(1, 31, 4))
DRAGGED = Fault("false place", begin=5_000, figures={"drift_m_per_s": 3.0, "gathering_m_per_s2": 0.3})
CONDITIONS: dict[str, Journey] = {
    "open line": OPEN,
    "station hall": replace(SKY, to_m=300, speed_mm_s=14_000),
    "street": replace(SKY, from_m=600, to_m=1_800, speed_mm_s=14_000),
    "cutting": replace(SKY, from_m=2_400, to_m=3_300),
    "tunnel": replace(SKY, from_m=3_550, to_m=4_650),
    "outages, 1 s in 10 s": replace(OPEN, faults=(Fault("silence", figures={"silent_s": 1.0}),)),
    "a quarter dragged, 3 m/s": replace(OPEN, faults=(replace(DRAGGED, where=QUARTER),)),
    "all dragged, 3 m/s, odometry": replace(OPEN, faults=(DRAGGED,), odometry=True, balises=False),
    "all dragged, 3 m/s, nothing else": replace(OPEN, faults=(DRAGGED,), balises=False),
}
PAIR, FIVE = frozenset({"G13", "G15"}), frozenset({"G11", "G13", "G15", "E10", "E12"})
PHONE_PAIR = frozenset({"G02", "G06"})
DISTURBED: dict[str, tuple[Fault, ...]] = {
    "as recorded": (),
    "steps of 20 m, two": (Fault("step", PAIR, 60_000, 240_000, {"size_m": 20.0}),),
    "steps of 60 m, five": (Fault("step", FIVE, 60_000, 240_000, {"size_m": 60.0}),),
    "slow ramp, 60 m in 180 s, two": (Fault("ramp", PAIR, 60_000, 240_000, {"size_m": 60.0}),),
    "fast ramp, 60 m in 20 s, two": (Fault("ramp", PAIR, 60_000, 80_000, {"size_m": 60.0}),),
    "the fast ramp, code alone": (Fault("ramp", PAIR, 60_000, 80_000, {"size_m": 60.0, "code_only": True}),),
    "wave of 30 m, 20 s, two": (Fault("wave", PAIR, 60_000, 240_000, {"size_m": 30.0, "period_s": 20.0}),),
    "silence, 1 s in 20 s": (Fault("silence", "", 0, 300_000, {"period_s": 20.0, "silent_s": 1.0}),),
    "all dragged, 60 m in 240 s": (Fault("false place", "", 60_000, 300_000, {"size_m": 60.0}),),
}
HEADS = (
    "condition", "cycles", "signals judged", "healthy excluded", "within the bound, excluded", "beyond, excluded",
    "far beyond, excluded", "solutions taken", "error, m: 50 %, 95 %, worst", "level, m: 50 %", "reported",
    "truth missed", "after a bound broke", "beyond the drift bound",
)  # fmt: skip


def simulated(name: str, journey: Journey, runs: int) -> Tally:
    """One condition."""
    tally = Tally(name, ReceiverConfig().code_bound_mm / 1_000, bound_m(CONFIG), hidden_m(CONFIG))
    for seed in range(1, runs + 1):
        tally.add(_cycles(journey, seed))
    return tally


def _cycles(journey: Journey, seed: int) -> Iterator[Cycle]:
    for one in passed(CONFIG, journey, seed=seed):
        true = one.truth
        errors = {name: true.healthy_m[name] + true.error_m[name] for name in true.error_m}
        yield as_told(CONFIG, one.outcome, round(true.place_m * 1_000), errors, true.error_m)


def recorded(recording: Recording, name: str, disturbances: tuple[Fault, ...]) -> Tally:
    """One disturbance of a recording."""
    healthy_m = recording.config.satellite.selection.range_noise_mm / 1_000
    tally = Tally(f"{recording.name}: {name}", healthy_m, bound_m(recording.config), hidden_m(recording.config))
    tally.add(told(recording, truth(recording), disturbances))
    return tally


def bound_m(config: ChainConfig) -> float:
    """What a solution counts for each used satellite."""
    return float(config.satellite.selection.usable_range_error_mm + config.map_error_mm) / 1_000


def hidden_m(config: ChainConfig) -> float:
    """What prediction and clock are assumed to make of a difference at most."""
    chosen = config.satellite.selection
    return (chosen.range_prediction_mm + chosen.range_clock_mm) / 1_000


@dataclass(frozen=True)
class Row:
    """A tally as a line of the table."""

    tally: Tally

    def cells(self) -> list[str]:
        """In the order of HEADS."""
        one = self.tally
        worth, levels = quantiles(one.errors_mm), quantiles(one.levels_mm)
        return [
            one.name, str(one.cycles), str(sum(one.signals.values())),
            *(self._share(kind) for kind in ("healthy", "within", "beyond", "far beyond")),
            _percent(len(one.errors_mm), one.cycles),
            "" if worth is None else ", ".join(f"{value:.1f}" for value in worth),
            "" if levels is None else f"{levels[0]:.1f}",
            _percent(one.reported, one.cycles), str(one.wrong["kept"]), str(one.wrong["broken"]),
            str(one.drifted_beyond),
        ]  # fmt: skip

    def _share(self, kind: str) -> str:
        share = self.tally.excluded(kind)
        return "" if share is None else f"{100 * share:.1f} % of {self.tally.signals[kind]}"


def _percent(part: int, whole: int) -> str:
    return f"{100 * part / whole:.0f} %" if whole else ""


def _line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


STYLE = (
    "<style>text{font:13px sans-serif;fill:#1c2733}.frame{fill:none;stroke:#cdd5dc}.grid{stroke:#cdd5dc;"
    "stroke-dasharray:3 4}.ink{stroke:#1c2733}</style>"
)


def diagram(tally: Tally, tolerance_mm: int, folder: Path) -> None:
    """The condition's Stanford diagram as a file of its own."""
    name = "-".join("".join(letter if letter.isalnum() else " " for letter in tally.name).split())
    drawn = stanford_diagram(tally.all_reports(), tolerance_mm, f"{tally.name}: error against margin", style=STYLE)
    (folder / f"stanford-{name}.svg").write_text(drawn + "\n", encoding="utf-8")


def trials(runs: int, recordings: Path | None) -> Iterator[tuple[Tally, int]]:
    """Every condition, one after the other, with its tolerable error in mm."""
    for name, journey in CONDITIONS.items():
        yield simulated(name, journey, runs), FINE.tolerance_mm
    if recordings is None:
        return
    still, hand = geodetic(recordings), phone(recordings)
    step = (Fault("step", PHONE_PAIR, 60_000, 200_000, {"size_m": 150.0}),)
    rows = [(still, name, chosen) for name, chosen in DISTURBED.items()]
    rows += [(hand, "as recorded", ()), (hand, "steps of 150 m, two", step)]
    for recording, name, chosen in rows:
        yield recorded(recording, name, chosen), recording.config.satellite.tolerance_mm


def main() -> None:
    """Print the tables."""
    given = sys.argv[1:]
    runs, folders = int(given[0]) if given else 5, [Path(name) for name in given[1:]]
    print(_line(list(HEADS)) + "\n|" + "---|" * len(HEADS))
    for tally, tolerance_mm in trials(runs, folders[0] if folders else None):
        print(_line(Row(tally).cells()), flush=True)
        if len(folders) > 1:
            diagram(tally, tolerance_mm, folders[1])


if __name__ == "__main__":
    main()
