"""Draw the picture of README.md from a simulated run of odometry: `python -m tests.story_picture` writes docs/story.svg.

A train passes two markers, and there is no third one: the reported interval, the true position in it, and the withdrawal.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from safeloc.models.odometry.simulate import simulate
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.proof.drawn_runs.quick import quick_run
from safeloc.report.drawing import Axis
from safeloc.reported import Reported
from safeloc.shipped_machines import ENTRIES
from safeloc.simulation.motion import Leg

PICTURE = Path(__file__).parents[1] / "docs" / "story.svg"
COMMAND = "python -m tests.story_picture"
MARKERS_MM = (250_000, 850_000)
CONFIG = OdometryConfig(trust_first_marker=True)
WIDTH, HEIGHT, TRACK, TOP, BOTTOM = 920, 400, 62, 118, 352
STYLE = (
    "text{font:13px sans-serif;fill:#222}.soft{fill:#5b6770}.head{font-weight:bold}.page{fill:#fff}"
    ".rail{stroke:#5b6770;stroke-width:3}.sleepers{stroke:#98a1a9;stroke-width:9;stroke-dasharray:3 9}.train{fill:#0072b2}"
    ".marker{fill:#e69f00;stroke:#222}.post{stroke:#e69f00;stroke-width:1.6;stroke-dasharray:4 3}"
    ".interval{fill:#56b4e9;fill-opacity:.45;stroke:#0072b2;stroke-width:1.2}.position{fill:none;stroke:#0072b2;stroke-width:1.6}"
    ".truth{stroke:#009e73;stroke-width:2.4}.limit{stroke:#d55e00;stroke-width:1.4;stroke-dasharray:7 4}"
    ".lost{fill:#98a1a9;fill-opacity:.28}.grid{stroke:#dde2e6}"
    "@media(prefers-color-scheme:dark){.page{fill:#14181c}text{fill:#e6e6e6}.soft{fill:#a8b3bc}.grid{stroke:#30383f}"
    ".train,.position,.interval{stroke:#56b4e9}.train{fill:#56b4e9}.rail{stroke:#a8b3bc}}"
)


@dataclass(frozen=True)
class Cycle:
    """The true position after a cycle, and the reported position and interval less the true position; None if none is reported."""

    truth_mm: int
    off_mm: int | None
    interval_mm: tuple[int, int] | None


@cache
def run() -> tuple[Cycle, ...]:
    """The run: from standstill to 35 m/s, over two markers and on without any."""
    target = ENTRIES["odometry"].make(CONFIG)
    markers = list(enumerate(MARKERS_MM, 1))
    steps = simulate(
        CONFIG,
        seed=3,
        markers=markers,
        missed=0.0,
        foreign=0.0,
        dropout=0.0,
        legs=[Leg(speed_mm_s=35_000, seconds=77.0)],
    )
    inputs = {var.name for var in target.system.inputs}
    trace = quick_run(
        target.system, [{name: step[name] for name in step if name in inputs} for step in steps], first={}
    )
    return tuple(_cycle(int(step["truth_mm"]), one.outputs) for step, one in zip(steps, trace.steps, strict=True))


def _cycle(truth_mm: int, outputs: object) -> Cycle:
    assert isinstance(outputs, dict)
    interval = Reported().interval_mm(outputs)
    if interval is None:
        return Cycle(truth_mm, None, None)
    low, high = interval
    return Cycle(truth_mm, outputs["position_mm"] - truth_mm, (low - truth_mm, high - truth_mm))


def across(cycles: Sequence[Cycle]) -> Axis:
    """The true position, across the page."""
    return Axis(0, cycles[-1].truth_mm, 70, WIDTH - 20)


UP = Axis(-36_000, 36_000, BOTTOM, TOP)
"""What is reported, less the true position."""


def drawn() -> str:
    """The picture as SVG."""
    cycles = run()
    x = across(cycles)
    parts = [
        *_frame(x),
        *_lost(cycles, x),
        *_reported(cycles, x),
        *_markers(x),
        *_lines(x),
        *_words(cycles, x),
        *_track(x),
    ]
    label = (
        "a train passes two markers: its reported interval contains the true position, and is withdrawn when too wide"
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" role="img" '
        f'aria-label="{label}"><style>{STYLE}</style>{"".join(parts)}</svg>\n'
    )


def _frame(x: Axis) -> Iterator[str]:
    yield f'<rect class="page" width="{WIDTH}" height="{HEIGHT}"/>'
    for value in (-30, -20, -10, 0, 10, 20, 30):
        y = UP.at(value * 1_000)
        yield f'<path class="grid" d="M{x.begin} {y:.1f}H{x.end}"/>{_text(x.begin - 8, y + 4, f"{value:+d} m" if value else "0", "end", "soft")}'
    for value in x.ticks:
        yield _text(x.at(value), BOTTOM + 18, f"{value / 1_000:.0f} m", "middle", "soft")
    yield _text(x.end, BOTTOM + 38, "true position of the train's front", "end", "soft")
    yield _text(x.begin, BOTTOM + 38, "reported, less the true position", "start", "soft")


def _lost(cycles: Sequence[Cycle], x: Axis) -> Iterator[str]:
    for begin, end in ((0, first(cycles).truth_mm), (withdrawn(cycles).truth_mm, cycles[-1].truth_mm)):
        yield f'<rect class="lost" x="{x.at(begin):.1f}" y="{TOP}" width="{x.at(end) - x.at(begin):.1f}" height="{BOTTOM - TOP}"/>'


def _reported(cycles: Sequence[Cycle], x: Axis) -> Iterator[str]:
    known = [
        (x.at(one.truth_mm), one.off_mm, one.interval_mm)
        for one in cycles
        if one.interval_mm and one.off_mm is not None
    ]
    upper = [f"{at:.1f} {UP.at(interval[1]):.1f}" for at, _, interval in known]
    lower = [f"{at:.1f} {UP.at(interval[0]):.1f}" for at, _, interval in reversed(known)]
    yield f'<path class="interval" d="M{"L".join([*upper, *lower])}Z"/>'
    yield f'<path class="position" d="M{"L".join(f"{at:.1f} {UP.at(off):.1f}" for at, off, _ in known)}"/>'


def _markers(x: Axis) -> Iterator[str]:
    for number, place in enumerate(MARKERS_MM, 1):
        at = x.at(place)
        yield f'<path class="post" d="M{at:.1f} {TRACK}V{BOTTOM}"/>'
        yield f'<path class="marker" d="M{at - 8:.1f} {TRACK + 14}h16l-8 -14z"/>'
        yield _text(at + 12, TRACK + 20, f"marker {number}", "start", "head")


def _lines(x: Axis) -> Iterator[str]:
    yield f'<path class="truth" d="M{x.begin} {UP.at(0):.1f}H{x.end}"/>'
    for side in (-1, 1):
        yield f'<path class="limit" d="M{x.begin} {UP.at(side * CONFIG.tolerance_mm):.1f}H{x.end}"/>'


def _words(cycles: Sequence[Cycle], x: Axis) -> Iterator[str]:
    lost, middle = x.at(withdrawn(cycles).truth_mm), x.at(sum(MARKERS_MM) / 2)
    tolerance = CONFIG.tolerance_mm // 1_000
    yield _text(x.begin + 6, UP.at(14_000), "unknown", "start", "head")
    yield _text(middle, UP.at(23_500), "grows by the error law", "middle", "head")
    yield _text(x.at(MARKERS_MM[1]) + 10, UP.at(-25_500), "a marker makes it narrow again", "start", "head")
    yield _text(x.at(MARKERS_MM[1]) + 10, UP.at(23_500), "and again, when the rear end reads it", "start", "soft")
    yield _text(lost + 8, UP.at(14_000), "withdrawn:", "start", "head")
    yield _text(lost + 8, UP.at(14_000) + 17, "wider than", "start")
    yield _text(lost + 8, UP.at(14_000) + 34, "tolerable", "start")
    yield _text(middle, UP.at(-CONFIG.tolerance_mm) - 5, f"tolerable: {tolerance} m", "middle", "soft")
    yield _text(lost - 10, UP.at(0) - 7, "true position: always inside", "end", "head")


def _track(x: Axis) -> Iterator[str]:
    """The track with the train on it, between the markers, in its true length."""
    yield f'<path class="sleepers" d="M{x.begin} {TRACK}H{x.end}"/><path class="rail" d="M{x.begin} {TRACK}H{x.end}"/>'
    front = x.at(sum(MARKERS_MM) / 2 + 60_000)
    rear = front - (x.at(CONFIG.vehicle_length_mm) - x.at(0))
    yield f'<path class="train" d="M{rear:.1f} {TRACK - 3}v-24H{front - 22:.1f}q14 2 22 24z"/>'
    yield _text(front + 10, TRACK - 12, "where is its front?", "start", "head")


def _text(x: float, y: float, words: str, anchor: str, kind: str = "") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" class="{kind}">{words}</text>'


def first(cycles: Sequence[Cycle]) -> Cycle:
    """The first cycle with a reported interval."""
    return next(one for one in cycles if one.interval_mm is not None)


def withdrawn(cycles: Sequence[Cycle]) -> Cycle:
    """The cycle in which the interval is withdrawn for good."""
    return next(one for one in cycles[cycles.index(first(cycles)) :] if one.interval_mm is None)


if __name__ == "__main__":
    PICTURE.write_text(drawn(), encoding="utf-8")
    print(f"{PICTURE} is drawn.")
