"""The guard at work: time, row, probation, ways, and what becomes of deliveries that are no position."""

from __future__ import annotations

import math
import random

import pytest

from safeloc.errors import InputError
from safeloc.railway.guard.deliveries import Delivery
from safeloc.railway.guard.guard import Guard, Judgement
from safeloc.railway.map.places import Place
from safeloc.railway.map.routes import Route
from safeloc.railway.map.topology import Run, Topology
from tests.railway.guard.made import CONFIG, edge, fix, fork, guard, place

pytest.importorskip("shapely")
pytest.importorskip("pyproj")


def believed(made: Guard | None = None, x: float = 100) -> Guard:
    """A guard that has believed a receiver at rest, with the last fix at 0.8 s."""
    made = made or guard()
    for number in range(3):
        made.judge(fix(0.4 * number, x))
    return made


def reasons(judgements: list[Judgement]) -> list[str]:
    """What became of each."""
    return [one.reason for one in judgements]


def test_a_row_is_passed_on_with_its_interval() -> None:
    """The third fix in a row is passed on, with 10 m on either side and the places of the interval's ends."""
    made = guard()
    found = [made.judge(fix(0.4 * number, 100)) for number in range(3)]
    assert ["UNCONFIRMED", "UNCONFIRMED", "PASSED"] == reasons(found)
    last = found[-1]
    assert (Place("stem", 100_000), (89_998, 110_002)) == (last.place, last.interval_mm)
    assert (Place("stem", 89_998), Place("stem", 110_002)) == last.ends


def test_a_false_fix_off_the_track_and_back() -> None:
    """A spell off the track is withheld; the fixes after it are believed again only as a row."""
    made = believed()
    spell = made.judge(fix(1.2, 100, 90))
    back = [made.judge(fix(1.6 + 0.4 * number, 100)) for number in range(3)]
    assert ("OFF_TRACK", "PROBATION") == (spell.reason, spell.mode)
    assert ["UNCONFIRMED", "UNCONFIRMED", "PASSED"] == reasons(back)


def test_a_jump_narrows_nothing() -> None:
    """The interval after a jump is the one that silence would have left."""
    jumped, silent = believed(), believed()
    one = jumped.judge(fix(1.2, 300))
    other = silent.judge(Delivery(9, 1_200))
    assert ("JUMP", "NO_FIX") == (one.reason, other.reason)
    assert one.window_mm == other.window_mm


@pytest.mark.parametrize(
    ("delivery", "reason"),
    [
        (fix(0.8, 100), "DUPLICATE"),
        (fix(0.4, 100), "OUT_OF_ORDER"),
        (Delivery(9, 1_200, *place(100), received_ms=2_300), "STALE"),
        (Delivery(9, 1_200, *place(100), received_ms=1_100), "FUTURE"),
        (Delivery(9, 1_200, math.nan, 0.0), "NOT_FINITE"),
        (Delivery(9, 1_200, 0.0, math.inf), "NOT_FINITE"),
        (Delivery(9, 1_200, 1e30, 1e30), "MALFORMED"),
        (Delivery(9, 1_200), "NO_FIX"),
        (Delivery(9), "NO_FIX"),
        (Delivery(9, wrong="cut off"), "MALFORMED"),
        (fix(1.2, 100_000_000 / 10, 0), "OFF_TRACK"),
        (fix(1.2, 101, speed_mm_s=50_000), "SPEED_DISAGREES"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_is_withheld(delivery: Delivery, reason: str) -> None:
    """Each has its reason, and the next good fix is judged as before."""
    made = believed()
    found = made.judge(delivery)
    assert (reason, False) == (found.reason, found.passed)


def test_a_late_fix_gets_the_error_of_its_age() -> None:
    """What came 100 ms after it was taken is wider by what the vehicle runs in that time, on either side."""
    made = guard()
    found = [made.judge(Delivery(1, 400 * number, *place(100), received_ms=400 * number + 100)) for number in range(3)]
    low, high = found[-1].interval_mm or (0, 0)
    assert high - low == pytest.approx(2 * (10_000 + 3_000), abs=10)


def test_a_long_silence_withdraws() -> None:
    """After an hour nothing is held; on a route the place last known has been carried through it, step by step."""
    made = believed()
    found = made.judge(fix(3_600, 100))
    assert ("UNCONFIRMED", "RECOVERING") == (found.reason, found.mode)


def test_a_frozen_receiver() -> None:
    """The same place again is withheld while the receiver tells a speed; at rest it is a fix like any other."""
    made = believed()
    assert "DUPLICATE" == made.judge(fix(1.2, 100, speed_mm_s=5_000)).reason
    assert "PASSED" == made.judge(fix(1.6, 100, speed_mm_s=0)).reason


def test_a_clock_that_was_set_back_begins_anew() -> None:
    """As many late fixes in order as make a row end what is held; then times count from there."""
    made = guard()
    for number in range(3):
        made.judge(fix(1_000 + 0.4 * number, 100))
    late = [made.judge(fix(0.4 * number, 100)) for number in range(3)]
    after = [made.judge(fix(1.2 + 0.4 * number, 100)) for number in range(3)]
    assert ["OUT_OF_ORDER"] * 3 == reasons(late)
    assert ("WITHDRAWN", ["UNCONFIRMED", "UNCONFIRMED", "PASSED"]) == (late[-1].mode, reasons(after))


def test_a_single_late_fix_does_not_set_the_clock_back() -> None:
    """One wrong time leaves what is held as it is."""
    made = believed()
    made.judge(fix(0.2, 100))
    assert made.judge(fix(1.2, 100)).passed


def test_over_a_switch() -> None:
    """Near the switch the track is not clear; on a known route it is."""
    topology = Topology(fork())
    route = Route(topology, (Run("stem", "increasing"), Run("main", "increasing")), 0, 500_000)
    steps = [fix(0.4 * number, 400 + 4 * number) for number in range(60)]
    free, known = list(guard().judge_all(steps)), list(guard(route).judge_all(steps))
    assert "AMBIGUOUS" in reasons(free)
    assert {"UNCONFIRMED", "PASSED"} == set(reasons(known))


def test_farther_than_positions_count() -> None:
    """Without a route positions begin anew, with a new row; a route that is too long is refused beforehand."""
    config = CONFIG.model_copy(update={"position_limit_mm": 600_000})
    steps = [fix(0.4 * number, 400 + 4 * number) for number in range(100)]
    found = list(guard(config=config).judge_all(steps))
    assert "PASSED" == found[-1].reason
    assert all(abs(one.position_mm or 0) <= 600_000 for one in found)
    topology = Topology(fork())
    route = Route(topology, (Run("stem", "increasing"), Run("main", "increasing")), 0, 500_000)
    with pytest.raises(InputError, match="the way is 1000000 mm long; raise position_limit_mm 600000"):
        guard(route, config=config)


# ------------------------------------------------------------------ never a wrong interval, never a wrong track


@pytest.mark.thorough(ordinary=5)
@pytest.mark.parametrize("seed", range(12))
def test_passed_fixes_hold_a_vehicle_that_obeys_the_law(seed: int) -> None:
    """On a fork with a parallel track: whatever the faults, a passed interval holds the vehicle, on its own track."""
    rng = random.Random(seed)
    config = CONFIG.model_copy(update={"offset_limit_mm": 5_000, "track_clearance_mm": rng.choice((5_000, 6_000))})
    made = guard(line=fork(edge("beside", "A", "B", (0, 4.5), (480, 4.5))), config=config)
    branch = rng.choice(("main", "side"))
    passed = 0
    run = _run(rng)
    for second, along in run[rng.randrange(8) :: rng.choice((4, 7, 10))]:
        x, y = _place(branch, along)
        false = rng.random() < 0.05
        off = rng.uniform(-4.9, 4.9)
        shown = (x + 150, y + 60) if false else _beside(branch, along + rng.uniform(-9.5, 9.5), off)
        found = made.judge(fix(second, *shown))
        if found.passed:
            passed += 1
            assert found.interval_mm is not None and found.place is not None and found.position_mm is not None
            low, high = found.interval_mm
            shift = _along(branch, found.place) - found.position_mm
            then = _at((found.at_ms or 0) / 1_000, run)
            assert low <= round(then * 1_000) - shift <= high, (second, along, found)
    assert passed > 20


def _run(rng: random.Random) -> list[tuple[float, float]]:
    """Seconds and metres along the way, twenty a second, at speeds that change by 1 m/s2 at most."""
    along, speed, made = 20.0, 0.0, []
    for number in range(3_200):
        made.append((0.05 * number, along))
        change = 0.05 * rng.choice((-1, 0, 1, 1)) if number % 20 else 0.0
        after = min(max(speed + change, 0.0), 12.0)
        along, speed = along + 0.025 * (speed + after), after
    return [one for one in made if one[1] < 950]


def _at(second: float, run: list[tuple[float, float]]) -> float:
    """Metres along the way at a time, which is one of the run."""
    return run[min(round(second * 20), len(run) - 1)][1]


def _place(branch: str, along: float) -> tuple[float, float]:
    return _beside(branch, along, 0.0)


def _beside(branch: str, along: float, off: float) -> tuple[float, float]:
    """A place so far along stem and branch, and so far to the left."""
    if along <= 500 or branch == "main":
        return along, off
    slant = math.hypot(300, 50)
    if along <= 500 + slant:
        share = (along - 500) / slant
        return 500 + 300 * share - off * 50 / slant, 50 * share + off * 300 / slant
    return 800 + along - 500 - slant, 50 + off


def _along(branch: str, where: Place) -> int:
    """mm along the vehicle's way; no place for a track that the vehicle is not on."""
    assert where.edge in ("stem", branch), where
    return where.position_mm + (0 if where.edge == "stem" else 500_000)


def test_a_configuration_has_its_own_row() -> None:
    """As many fixes as are asked for, no fewer."""
    config = CONFIG.model_copy(update={"confirmations": 6})
    found = list(guard(config=config).judge_all([fix(0.4 * number, 100) for number in range(6)]))
    assert ["UNCONFIRMED"] * 5 + ["PASSED"] == reasons(found)


@pytest.mark.parametrize("seed", range(6))
def test_back_over_the_switch_and_on_over_the_other_branch(seed: int) -> None:
    """A vehicle that goes back over a switch and takes the other branch is never told on the one it left."""
    rng = random.Random(seed)
    made, second, edges = guard(), 0.0, set[str]()
    for branch, along in _shunting():
        found = made.judge(fix(second, *_beside(branch, along + rng.uniform(-9, 9), rng.uniform(-4, 4))))
        second += 0.4
        if found.passed:
            assert found.interval_mm is not None and found.place is not None and found.position_mm is not None
            low, high = found.interval_mm
            shift = _along(branch, found.place) - found.position_mm
            assert low <= round(along * 1_000) - shift <= high, (second, branch, along, found)
            edges.add(found.place.edge)
    assert {"stem", "main", "side"} == edges


def _shunting() -> list[tuple[str, float]]:
    """Branch and metres along the way, each 0.4 s: to 750 m on the main track, back to 350 m, to 800 m on the side."""
    made = [("main", along) for along in _travelled(200, 750)]
    made += [("main", along) for along in _travelled(750, 350)]
    return made + [("side", along) for along in _travelled(350, 800)]


def _travelled(begin: float, end: float) -> list[float]:
    """From rest to rest with 1 m/s2 up and down and 12 m/s at most, each 0.4 s."""
    length, found, gone, speed = abs(end - begin), [begin], 0.0, 0.0
    while gone < length - 0.3:
        stop = speed * speed / 2
        after = max(min(speed + 0.4, 12.0), 0.0) if gone + stop + speed * 0.8 < length else max(speed - 0.4, 0.2)
        gone = min(gone + 0.2 * (speed + after), length)
        speed = after
        found.append(begin + math.copysign(gone, end - begin))
    return found + [end] * 12
