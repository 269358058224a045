"""Two vehicles that measure reflectors on one line: each has a machine of its own and hears the other vehicle; both intervals hold (RFL-15).

No output of one machine is an input of the other, so what is proved of one for any echoes of other vehicles holds of each of two. These runs show
the scene: the laws of both are kept at once, one vehicle hides reflectors from the other, and neither is taken for a reflector.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pytest

from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.system import lower
from safeloc.language.trace import Trace
from safeloc.language.units import NM_PER_MM
from safeloc.language.verdict import Violated
from safeloc.models.reflector import build, echo
from safeloc.models.reflector.simulate import FIGURE_1, Scene, lawful, simulate
from safeloc.models.reflector.simulation.scene import NOWHERE, OtherVehicle
from safeloc.models.reflector.variables import ReflectorConfig, parts
from safeloc.properties.reflector import properties
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move
from tests.models.edited_terms import edited
from tests.models.test_reflector import zones
from tests.models.test_reflector_edits import showing

CONFIG = ReflectorConfig()
Steps = list[dict[str, Cell]]
AHEAD_CYCLES, LENGTH_MM = 70, 20_000
ALONE = Scene(FIGURE_1, pauses=0, clutter=0)
LINE_MM = 1_000_000
"""Length of the line: the vehicles that run against one another begin at its two ends."""


def motion() -> Motion:
    """A run of 900 m at 20 m/s, past both reflectors of the figure."""
    return move(VehicleConfig(max_speed_mm_s=int(CONFIG.max_speed_mm_s * 0.9)), [Leg(20_000, 45)], CONFIG.period_ms)


def ends_mm(scene: str) -> list[int]:
    """Of each cycle of a vehicle, the place of the other one's end, in its own coordinates."""
    places = [int(place) // NM_PER_MM for place in motion().position_nm]
    if scene == "behind one another":
        later = [*places[AHEAD_CYCLES:], *[places[-1]] * AHEAD_CYCLES]
        return [place - LENGTH_MM for place in later]
    return [LINE_MM - place for place in places]


def streams(scene: str) -> Iterator[Steps]:
    """The run of each vehicle on this line: on one track behind one another, or against one another on two tracks."""
    hears = replace(ALONE, others=(OtherVehicle(tuple(ends_mm(scene))),))
    for seed, one in enumerate((hears, ALONE if scene == "behind one another" else hears)):
        yield [lawful(step) for step in simulate(CONFIG, seed=seed, scene=one, motion=motion())]


def replayed(stream: Steps) -> tuple[Trace, list[str]]:
    """The run of the machine as it is built now, and the claims that do not hold in it."""
    made = build(parts(CONFIG))
    claims = properties(made)
    trace = run(lower(made.machine), stream)
    return trace, [
        one.name for one, found in zip(claims, check_all(trace, claims), strict=True) if isinstance(found, Violated)
    ]


def reflectors_seen(stream: Steps) -> int:
    """In how many cycles the first echo is that of a reflector."""
    return sum(step["echo_1_true_model"] != NOWHERE for step in stream)


SCENES = ("behind one another", "against one another")
MEASURED = ["DELOCALIZED", "VIEW", "PASSING", "ODOMETRY"]
WAYS = {
    "behind one another": [*MEASURED, "SEARCH", "VIEW", "PASSING", "ODOMETRY"],
    "against one another": [*MEASURED, "SEARCH", "NOT_READY", "DELOCALIZED"],
}
"""Modes in order. Behind another vehicle the second reflector is seen late; it stays hidden beyond the search run by one that comes nearer."""


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("scene", SCENES)
def test_both_intervals_hold(scene: str) -> None:
    """Every claim holds in both runs; a reflector that the other vehicle hides is measured late, or ends the procedure."""
    for stream in streams(scene):
        trace, broken = replayed(stream)
        assert broken == []
        assert zones(trace) == WAYS[scene]


@pytest.mark.parametrize("scene", SCENES)
def test_one_vehicle_hides_a_reflector(scene: str) -> None:
    """Without the other vehicle more is seen: it hides a reflector for two seconds and more."""
    heard, _ = streams(scene)
    alone = simulate(CONFIG, seed=0, scene=ALONE, motion=motion())
    assert reflectors_seen(alone) - reflectors_seen(heard) > 20


def test_a_vehicle_without_a_place_in_each_cycle_is_refused() -> None:
    """Else its last place would count on, or an index would be out of range."""
    cycles = len(motion().position_nm)
    with pytest.raises(ValueError, match=f"needs a place for each cycle of the run, {cycles};"):
        simulate(CONFIG, seed=0, scene=replace(ALONE, others=(OtherVehicle((0,)),)), motion=motion())


@pytest.mark.thorough
def test_a_machine_that_takes_it_for_a_reflector_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """An echo without a model is taken for the reflector that is searched: a claim fails in this very run."""
    edited(monkeypatch, echo, "judge", showing(lambda shown, searched: searched))
    stream = next(iter(streams("behind one another")))
    assert replayed(stream)[1] != []
