"""How exact and how sure the radar front end is, over simulated frames: the tables of docs/signals.md.

python -m benchmarks.radar_accuracy [frames of each condition, 400 unless told]

Every frame has a reflector of each model in turn, anywhere in view, at any speed up to 40 m/s, the sensor at an end of
each of its declared errors. An echo is right when range and sine of the truth lie within their stated bounds.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from safeloc.sensing.echoes import Echo
from safeloc.sensing.figures import RadarConfig
from safeloc.sensing.images import RadarImage
from safeloc.sensing.radar import Frame, read
from safeloc.sensing.signature import MARKS, Model
from safeloc.simulation.radar import Bias, Points, Weather, image, points
from safeloc.simulation.radar_scene import Clutter, World, rain, seen, slant_mm, world
from safeloc.simulation.radar_track import Reflector

CONFIG = RadarConfig()
PLACE_MM = 200_000
NEAREST_MM, FARTHEST_MM, BAND_MM = 8_000, 140_000, 20_000
TOP_MM_S = 40_000
SAME_MM = 3_000
SECTION_M2 = 10 ** (CONFIG.reflectors.section_cdbsm(CONFIG.sensor.carrier_mhz) / 1_000)


@dataclass(frozen=True)
class Condition:
    """What stands and falls around the reflector; `foreign`: corners of sheet metal nearer than 10 m to it."""

    name: str
    clutter: Clutter = field(default_factory=Clutter)
    rain_mm_h: int = 0
    wall_mm: float | None = None
    double_bounce: bool = False
    lost: int = 0
    foreign: int = 0


CONDITIONS = (
    Condition("line with masts and ballast"),
    Condition("violent rain, 50 mm/h", rain_mm_h=50),
    Condition("clutter ten times as strong", clutter=Clutter(mast_cdbsm=1_000, stone_cdbsm=-1_500)),
    Condition("tunnel: wall 5 m away, echoes of echoes", wall_mm=5_000, double_bounce=True),
    Condition("one corner lost", lost=1),
    Condition("one corner lost, one foreign corner", lost=1, foreign=1),
    Condition("five foreign corners", foreign=5),
    Condition("no reflector, eight foreign corners", lost=3, foreign=8),
)


@dataclass(frozen=True)
class Shot:
    """One frame's truth and outcome. The echo is that of the reflector's model at its place, if there is one."""

    range_mm: float
    true_mm: float
    true_sine: float
    echo: Echo | None
    verdict: str
    read_s: float
    draw_s: float


def run(condition: Condition, frames: int, seed: int) -> Iterator[Shot]:
    """Frames of one condition; twenty on each line."""
    rng = np.random.default_rng(seed)
    for number in range(frames):
        if number % 20 == 0:
            model = list(MARKS)[number // 20 % len(MARKS)]
            reflector = Reflector(model, PLACE_MM, lost=_lost(condition, rng))
            scene = world(
                CONFIG, [reflector], rng, length_mm=380_000, clutter=condition.clutter,
                wall_mm=condition.wall_mm, double_bounce=condition.double_bounce,
            )  # fmt: skip
            bias = Bias(*(float(one) for one in rng.choice([-1, 1], 3)))
        yield _shot(condition, scene, reflector, bias, rng)


def _lost(condition: Condition, rng: np.random.Generator) -> tuple[int, ...]:
    return tuple(int(one) for one in rng.choice(3, condition.lost, replace=False))


def _shot(condition: Condition, scene: World, reflector: Reflector, bias: Bias, rng: np.random.Generator) -> Shot:
    along, speed = PLACE_MM - rng.uniform(NEAREST_MM, FARTHEST_MM), float(rng.uniform(0, TOP_MM_S))
    found = seen(scene, along).together(_foreign(condition.foreign, PLACE_MM - along, rng))
    if condition.rain_mm_h:
        found = found.together(rain(condition.rain_mm_h, rng, 150_000))
    began = time.process_time()
    weather = Weather(rain_mm_h=condition.rain_mm_h)
    power = image(found, CONFIG, rng, speed_mm_s=speed, weather=weather, bias=bias)
    drawn = time.process_time()
    outcome = read(RadarImage(power, 0, 0), CONFIG)
    done = time.process_time()
    true = slant_mm(scene, reflector, along + speed * float(CONFIG.sensor.lead_us) / 1e6)
    at_frame = slant_mm(scene, reflector, along)
    sine = reflector.left_mm / at_frame
    echo, verdict = _judged(outcome, reflector, true, sine) if isinstance(outcome, Frame) else (None, "no frame")
    return Shot(at_frame, true, sine, echo, verdict, done - drawn, drawn - began)


def _foreign(count: int, ahead_mm: float, rng: np.random.Generator) -> Points:
    """Corners like those of a reflector, 6 dB stronger or weaker, on the same side."""
    along = ahead_mm + rng.uniform(-2_000, 10_000, count)
    slant = np.hypot(along, 3_000.0)
    return points(slant, -3_000.0 / slant, SECTION_M2 * 10 ** rng.uniform(-0.6, 0.6, count))


def _judged(frame: Frame, reflector: Reflector, true_mm: float, sine: float) -> tuple[Echo | None, str]:
    known = [echo for echo in frame.echoes if echo.model is not Model.UNKNOWN]
    own = [one for one in known if one.model is reflector.model and abs(one.range_mm - true_mm) < SAME_MM]
    if [one for one in known if one not in own] or len(own) > 1:
        return None, "wrong model"
    if not own:
        return None, "not known"
    inside = abs(own[0].range_mm - true_mm) <= own[0].range_error_mm
    inside &= abs(own[0].sine_ppm - 1e6 * sine) <= own[0].sine_error_ppm
    return own[0], "right" if inside else "outside its bound"


# ------------------------------------------------------------------ tables


def by_range(shots: list[Shot]) -> Iterator[str]:
    """Errors of range and sine against truth, band by band of range."""
    yield "| range, m | frames | known | bias, mm | 95 %, mm | worst, mm | stated bound, mm | worst / bound | angle 95 %, mrad | worst | bound | worst / bound |"
    yield "|---|---|---|---|---|---|---|---|---|---|---|---|"
    for low in range(0, FARTHEST_MM, BAND_MM):
        band = [shot for shot in shots if low <= shot.range_mm < low + BAND_MM]
        hits = [(shot, shot.echo) for shot in band if shot.echo is not None]
        if hits:
            yield _row(f"{low // 1_000} to {(low + BAND_MM) // 1_000}", len(band), hits)


def _row(name: str, frames: int, hits: list[tuple[Shot, Echo]]) -> str:
    error = np.array([echo.range_mm - shot.true_mm for shot, echo in hits])
    bound = np.array([echo.range_error_mm for _, echo in hits])
    angle = np.abs([echo.sine_ppm / 1_000 - 1_000 * shot.true_sine for shot, echo in hits])
    limit = np.array([echo.sine_error_ppm / 1_000 for _, echo in hits])
    size = np.abs(error)
    cells = [
        name, str(frames), f"{100 * len(hits) / frames:.1f} %", f"{error.mean():+.1f}", f"{np.percentile(size, 95):.1f}",
        f"{size.max():.1f}", f"{bound.min()} to {bound.max()}, half {np.median(bound):.0f}", f"{(size / bound).max():.2f}",
        f"{np.percentile(angle, 95):.1f}", f"{angle.max():.1f}", f"{limit.min():.1f} to {limit.max():.1f}",
        f"{(angle / limit).max():.2f}",
    ]  # fmt: skip
    return f"| {' | '.join(cells)} |"


def by_condition(runs: dict[str, list[Shot]]) -> Iterator[str]:
    """What became of the frames of each condition; 3 / frames is the 95 % bound where nothing was seen."""
    names = ("right", "not known", "wrong model", "outside its bound", "no frame")
    yield f"| condition | frames | {' | '.join(names)} |"
    yield f"|---|---|{'---|' * len(names)}"
    for name, shots in runs.items():
        counted = Counter(shot.verdict for shot in shots)
        cells = [_share(counted[verdict], len(shots), verdict) for verdict in names]
        yield f"| {name} | {len(shots)} | {' | '.join(cells)} |"


def _share(count: int, frames: int, verdict: str) -> str:
    if count == 0 and verdict in ("wrong model", "outside its bound"):
        return f"0 (< {100 * 3 / frames:.2f} %)"
    return f"{100 * count / frames:.1f} %"


def by_speed(runs: dict[str, list[Shot]]) -> Iterator[str]:
    """Processor time of reading a frame, and of simulating one."""
    yield "| condition | frames a second read | slowest frame, ms | frames a second simulated |"
    yield "|---|---|---|---|"
    for name, shots in runs.items():
        reading, drawing = (np.array([pick(shot) for shot in shots]) for pick in _TIMES)
        yield f"| {name} | {1 / np.median(reading):.0f} | {1_000 * reading.max():.0f} | {1 / np.median(drawing):.0f} |"


_TIMES: tuple[Callable[[Shot], float], ...] = (lambda shot: shot.read_s, lambda shot: shot.draw_s)


def main(frames: int) -> None:
    """Print the tables."""
    runs = {one.name: list(run(one, frames, seed)) for seed, one in enumerate(CONDITIONS)}
    print(*by_range(runs[CONDITIONS[0].name]), "", *by_condition(runs), "", *by_speed(runs), sep="\n")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 400)
