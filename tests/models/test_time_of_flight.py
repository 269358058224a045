"""Time of flight T and distance Ls of a train's end: reported when measured, absent otherwise, and true within their bounds."""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import pytest
from pydantic import ValidationError

from safeloc.codegen.c99 import library_texts
from safeloc.codegen.c99_layout import layout_of
from safeloc.language.interpret import run
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.models.time_of_flight import TimeOfFlight, TimeOfFlightConfig, build, parts
from safeloc.models.time_of_flight.simulate import RUNS, Ride, measured
from safeloc.properties.time_of_flight import properties
from safeloc.runtime.streams.steps import Cell, read_steps
from safeloc.sensing.fibre.time_of_flight import bounds_mm, time_ps
from safeloc.sensing.rounding import ExactBounds
from tests.models.everything_proved import unproved_of
from tests.models.fibre_family import mode_labels
from tests.shipped_recordings import shipped

CONFIG = TimeOfFlightConfig()
UNMAPPED: dict[str, Cell] = {"map_known": False, "map_distance_mm": 0, "map_position_mm": 0, "map_upwards": True}


@cache
def made() -> TimeOfFlight:
    """The machine with its variables."""
    return build(parts(CONFIG))


def timed(*delays_ps: int | None, mapped: dict[str, Cell] = UNMAPPED) -> Trace:
    """One cycle for each delay."""
    steps = [mapped | ({} if delay is None else {"delay_ps": delay}) for delay in delays_ps]
    return run(without_ghosts(lower(made().machine)), steps)


def bounds(trace: Trace, cycle: int, name: str = "distance_", place: str = "distance_mm") -> tuple[int, int]:
    """Bounds reported of the distance, or of the place."""
    reported = trace.steps[cycle].outputs
    return reported[place] - reported[f"{name}margin_below_mm"], reported[place] + reported[f"{name}margin_above_mm"]


def test_the_figure_of_the_source() -> None:
    """100 us are 10.2 km by half the product; the printed quotient would be no distance."""
    trace = timed(100_000_000)
    low, high = bounds(trace, 0)
    assert 100_000_000 == trace.steps[0].outputs["flight_time_ps"]
    assert low <= 10_210_915 <= high
    assert 10_210_915 - low - CONFIG.pattern_error_mm <= 10_210_915 * 100 // 10**6 + 12_050


@pytest.mark.parametrize("delay_ps", [0, 1, 117_931, 5_000_000, 97_931_000, 391_740_000])
def test_bounds_are_those_of_the_front_end(delay_ps: int) -> None:
    """The exact fractions of the sensing room, with the same errors, lie within the machine's; inside by the index's rounding to a millionth, and 3 mm."""
    low, high = bounds(timed(delay_ps), 0)
    time = ExactBounds(Fraction(delay_ps), Fraction(delay_ps)).widened(CONFIG.time_error_ps)
    exact = bounds_mm(time, CONFIG.index_ppm, CONFIG.index_error_ppm).widened(CONFIG.pattern_error_mm)
    inside_mm = 3 + high // CONFIG.index_ppm
    assert low <= max(exact.low, 0) < low + inside_mm
    assert high - inside_mm < exact.high <= high


def test_reported_with_a_delay_and_absent_without() -> None:
    """What was reported is not reported again in a cycle without a delay, nor in one with a delay beyond the fibre's end."""
    end_ps = int(time_ps(CONFIG.fibre_mm, CONFIG.index_ppm))
    trace = timed(end_ps, None, end_ps, end_ps + 1_000_000, None)
    assert ["DISTANCE", "UNMEASURED", "DISTANCE", "BEYOND", "UNMEASURED"] == mode_labels(made().machine, trace)
    assert [True, False, True, False, False] == [bool(step.outputs["distance_reported"]) for step in trace.steps]
    assert [False, False, False, True, False] == [bool(step.outputs["beyond_fibre"]) for step in trace.steps]
    assert not any(0 <= step.outputs["distance_mm"] < CONFIG.fibre_mm * 2 for step in trace.steps[1::2])


@pytest.mark.parametrize("upwards", [True, False])
@pytest.mark.parametrize("point_mm", [9_000_000, 12_000_000])
def test_the_place_along_the_track(point_mm: int, *, upwards: bool) -> None:
    """From a surveyed point before or behind, on either side: the cable's length, or up to 3 % less, and the survey's error."""
    mapped: dict[str, Cell] = {
        "map_known": True, "map_distance_mm": point_mm, "map_position_mm": 500_000, "map_upwards": upwards,
    }  # fmt: skip
    trace = timed(100_000_000, mapped=mapped)
    (low, high), (near, far) = bounds(trace, 0), bounds(trace, 0, "", "position_mm")
    ran = sorted(
        (1 if upwards else -1) * Fraction(one - point_mm) * share / 100 for one in (low, high) for share in (97, 100)
    )
    assert near <= 500_000 + ran[0] - CONFIG.map_error_mm < near + 1
    assert far - 1 < 500_000 + ran[-1] + CONFIG.map_error_mm <= far


@pytest.mark.parametrize("name", RUNS)
def test_a_recording_is_its_run(name: str) -> None:
    """What ships is what the named run makes."""
    assert list(RUNS[name].steps(CONFIG)) == [dict(step) for step in read_steps(shipped(name)).steps]


def test_what_is_reported_of_the_runs() -> None:
    """Gaps in time of flight and in the map are gaps in what is reported."""
    modes = mode_labels(made().machine, run(lower(made().machine), measured(CONFIG, Ride(5, 10**6, 0, unmeasured=(2,), unmapped=(3,)))))  # fmt: skip
    assert ["PLACED", "PLACED", "UNMEASURED", "DISTANCE", "PLACED"] == modes


def test_one_pulse_at_a_time() -> None:
    """A pulse rate at which a pattern could belong to either of two pulses is refused."""
    with pytest.raises(ValidationError, match=r"a pattern could belong to either; send fewer \(pulse_hz\)"):
        TimeOfFlightConfig(pulse_hz=2_552)


def test_outputs_have_their_names_in_c() -> None:
    """Time of flight and distance are fields of the exported outputs."""
    header = library_texts(layout_of(without_ghosts(lower(made().machine))), "Told.")["time_of_flight.h"]
    for name in ("flight_time_ps", "distance_reported", "distance_mm", "distance_margin_below_mm", "position_mm"):
        assert f" {name};" in header


@pytest.mark.thorough
def test_everything_is_proved() -> None:
    """All properties, without bound."""
    assert unproved_of(made().machine, properties(made())) == {}
