"""Recorded trains, and the made-up receiver that ships: what is passed on, what is withheld, and that no track is wrong."""

from __future__ import annotations

from collections import Counter
from functools import cache
from itertools import groupby, pairwise

import pytest

from safeloc.models.guard.positions import FAULTS, FOLDER, csv_text, junction, nmea_text, receiver_reports
from safeloc.models.guard.variables import GuardConfig
from safeloc.railway.guard.deliveries import Delivery
from safeloc.railway.guard.fields import Columns
from safeloc.railway.guard.figures import find_vehicle, guard_config
from safeloc.railway.guard.guard import Guard, Judgement
from safeloc.railway.guard.nmea import nmea_deliveries
from safeloc.railway.guard.streams import csv_deliveries
from safeloc.railway.guard.tracks import Tracks
from safeloc.railway.map.imports.geojson_path import route_over
from safeloc.railway.map.model import Line
from safeloc.railway.map.routes import Route
from safeloc.railway.map.toml_files import load_line, to_toml
from safeloc.railway.map.topology import Topology
from tests.data_sources import data_file
from tests.railway.map.recorded_trains import network, route_of

pytest.importorskip("shapely")
pytest.importorskip("pyproj")
LOGS = ("28876", "31176", "31259", "29083")
CONFIG = guard_config(find_vehicle("desiro-br642"))
LEFT = (5916, 2026, 7855, 7818, 9754, 5831, 2013, 9755, 2014, 7819, 7154, 9422, 1388)
MIDDLE = (5916, 2026, 7855, 7818, 9754, 5831, 3955, 5977, 7820, 9755, 2014, 7819, 7154, 9422, 1388)
WAYS_28586 = {name: [f"88_L_{number}" for number in way] for name, way in (("left", LEFT), ("middle", MIDDLE))}
"""The train ran over one of these."""
RECORDED = Columns(flag="position_type")
MADE_UP = Columns(speed="speed_m_s", flag="quality")


def guarded(
    line: Line, route: Route | None, deliveries: list[Delivery], config: GuardConfig = CONFIG, both: bool = False
) -> list[Judgement]:
    """What the guard makes of a stream."""
    tracks = Tracks(
        line, clear_mm=config.track_clearance_mm, reach_mm=config.tolerance_mm, route=route, both_directions=both
    )
    return list(Guard(config, tracks).judge_all(deliveries))


@cache
def recorded(log: str) -> tuple[Judgement, ...]:
    """A recorded train on the way it took."""
    with data_file(f"trains/log_{log}.csv").open(newline="", encoding="utf-8") as lines:
        return tuple(guarded(network(), route_of(log), list(csv_deliveries(lines, RECORDED, log))))


def reasons(judgements: tuple[Judgement, ...] | list[Judgement]) -> dict[str, int]:
    """How many for each reason."""
    return dict(Counter(one.reason for one in judgements))


# ------------------------------------------------------------------ recorded trains


@pytest.mark.parametrize(
    ("log", "expected"),
    [
        ("28876", {"PASSED": 1128, "UNCONFIRMED": 4}),
        ("31176", {"PASSED": 710, "UNCONFIRMED": 4}),
        ("31259", {"PASSED": 668, "OFF_TRACK": 504, "UNCONFIRMED": 14, "ACROSS": 3}),
        ("29083", {"PASSED": 483, "OFF_TRACK": 299, "UNCONFIRMED": 79, "ACROSS": 14, "AGAINST": 2, "DOUBTFUL": 1}),
    ],
)
def test_recorded_trains(log: str, expected: dict[str, int]) -> None:
    """Clean logs are passed on but for the first row; of the faulty one nothing that is off the track."""
    assert expected == reasons(recorded(log))


@pytest.mark.parametrize("log", LOGS)
def test_what_is_passed_on_keeps_the_limits(log: str) -> None:
    """Each fix that is passed on lies near the track, inside its interval, and the interval is within the tolerance."""
    for one in recorded(log):
        if one.passed:
            assert one.interval_mm is not None and one.offset_mm is not None
            assert one.position_mm is not None
            assert one.interval_mm[0] <= one.position_mm <= one.interval_mm[1]
            assert one.offset_mm <= CONFIG.offset_limit_mm
            assert one.interval_mm[1] - one.interval_mm[0] <= 2 * CONFIG.tolerance_mm
            assert one.ends[0] is not None


DRAGGED_S = (225, 540)
"""In log 28586 the receiver has jumped aside at a stop, and tells for so long what it reckons; no position of these is true."""


@cache
def deliveries_of(log: str) -> tuple[Delivery, ...]:
    """The fixes of a log."""
    with data_file(f"trains/log_{log}.csv").open(newline="", encoding="utf-8") as lines:
        return tuple(csv_deliveries(lines, RECORDED, log))


def told_while_dragged(way: str, config: GuardConfig, both: bool) -> tuple[int, int]:
    """Fixes of log 28586 that are passed on, and those of them that are false."""
    found = guarded(
        network(), route_over(WAYS_28586[way], Topology(network())), list(deliveries_of("28586")), config, both
    )
    start = found[0].delivery.time_ms or 0
    passed = [((one.delivery.time_ms or 0) - start) // 1_000 for one in found if one.passed]
    return len(passed), sum(DRAGGED_S[0] <= second <= DRAGGED_S[1] for second in passed)


UNTOLD = CONFIG.model_copy(update={"course_base_mm": 1_000_000})
"""No two fixes are so far from each other: no course is told."""


@pytest.mark.parametrize(
    ("way", "config", "both", "expected"),
    [
        ("left", CONFIG, False, (688, 0)),
        ("middle", CONFIG, False, (693, 0)),
        ("left", UNTOLD, False, (697, 0)),
        ("middle", UNTOLD, False, (702, 0)),
        ("left", CONFIG, True, (696, 8)),
        ("middle", CONFIG, True, (741, 48)),
        ("left", UNTOLD, True, (731, 34)),
        ("middle", UNTOLD, True, (757, 55)),
    ],
)
def test_a_receiver_that_drags_a_false_place_back_over_the_way(
    way: str, config: GuardConfig, both: bool, expected: tuple[int, int]
) -> None:
    """None of the false fixes is passed on: the course refuses them, and so does the place last known, each without the other. Where
    the way may be run in both directions, the course alone is left, and a part of them runs along the way."""
    assert expected == told_while_dragged(way, config, both)


def test_flags_do_not_count() -> None:
    """In the faulty log every fix that claims to be precise is withheld, and those that are passed on claim the least."""
    by_flag = Counter((one.delivery.flag, one.passed) for one in recorded("29083"))
    assert 0 == by_flag["NARROW_INT3", True] == by_flag["PROPAGATED", True]
    assert {"SINGLE": 483} == {flag: number for (flag, passed), number in by_flag.items() if passed}


def test_a_receiver_in_doubt_comes_back_with_a_row() -> None:
    """Between a false fix and the next one that is passed on, there are always as many that agree as are asked for."""
    told_ = [one.reason for one in recorded("29083")]
    runs = [(reason, len(list(run))) for reason, run in groupby(told_)]
    for (before, row), (_, after) in pairwise(pairwise(runs)):
        if (before[0], row[0], after[0]) == ("OFF_TRACK", "UNCONFIRMED", "PASSED"):
            assert row[1] >= CONFIG.confirmations - 1
    assert ("OFF_TRACK", "PASSED") not in {(one[0], other[0]) for one, other in pairwise(runs)}


@pytest.mark.parametrize("log", LOGS)
def test_without_the_way_no_track_is_wrong(log: str) -> None:
    """On the whole network, where tracks lie side by side, what cannot be told is ambiguous, and none is told wrongly."""
    with data_file(f"trains/log_{log}.csv").open(newline="", encoding="utf-8") as lines:
        found = guarded(network(), None, list(csv_deliveries(lines, RECORDED, log)))
    edges = {run.edge for run in route_of(log).runs}
    assert [one.place for one in found if one.passed and one.place is not None and one.place.edge not in edges] == []
    assert reasons(found)["AMBIGUOUS"] > 300


# ------------------------------------------------------------------ the made-up receiver


def test_shipped_files_are_what_the_model_makes() -> None:
    """Map and streams that ship can be made again."""
    assert (FOLDER / "junction.toml").read_text(encoding="utf-8") == to_toml(junction())
    assert (FOLDER / "junction.csv").read_text(encoding="utf-8") == csv_text()
    assert (FOLDER / "junction.nmea").read_bytes().decode() == nmea_text()


def made_up(way: str | None = "stem,main") -> list[Judgement]:
    """The made-up receiver, guarded."""
    line = load_line(FOLDER / "junction.toml")
    route = None if way is None else route_over(way.split(","), Topology(line))
    with (FOLDER / "junction.csv").open(encoding="utf-8") as lines:
        return guarded(line, route, list(csv_deliveries(lines, MADE_UP, "junction.csv")))


def test_every_fault_is_withheld_for_its_reason() -> None:
    """Off the track, displaced, frozen, not there, wrong in speed, not finite, repeated, late, cut off."""
    found = reasons(made_up())
    assert {
        "OFF_TRACK",
        "JUMP",
        "NO_FIX",
        "SPEED_DISAGREES",
        "NOT_FINITE",
        "DUPLICATE",
        "OUT_OF_ORDER",
        "MALFORMED",
    } < set(found)
    assert found["PASSED"] > 90


@pytest.mark.parametrize("way", ["stem,main", None], ids=["way known", "way open"])
def test_the_truth_is_in_every_interval(way: str | None) -> None:
    """Whatever is wrong, every interval that is reported holds the vehicle."""
    truth = {1_000 * one.second: one.truth_mm for one in receiver_reports()}
    start = min(one.delivery.time_ms for one in made_up(way) if one.delivery.time_ms is not None)
    held = 0
    for one in made_up(way):
        at = truth.get((one.delivery.time_ms or 0) - start)
        if one.passed and at is not None and one.interval_mm is not None:
            held += 1
            begun = _along(one) - (one.position_mm or 0)
            assert one.interval_mm[0] + begun <= at <= one.interval_mm[1] + begun, one
    assert held > 60


def _along(one: Judgement) -> int:
    """mm along stem and main of where the fix lies."""
    assert one.place is not None and one.place.edge in ("stem", "main")
    return one.place.position_mm + (0 if one.place.edge == "stem" else 1_000_000)


def test_nothing_passes_while_something_is_wrong() -> None:
    """In the seconds of a fault that shows, and until the row is full again, nothing is passed on."""
    start = min(one.delivery.time_ms or 0 for one in made_up() if one.delivery.time_ms is not None)
    passed = {((one.delivery.time_ms or 0) - start) // 1_000 for one in made_up() if one.passed}
    for seconds, name in FAULTS.items():
        assert not passed & set(seconds), name


def test_nmea_says_the_same() -> None:
    """The same receiver by RMC sentences: the same seconds are passed on."""
    pytest.importorskip("pynmeagps")
    line = junction()
    route = route_over(["stem", "main"], Topology(line))
    found = guarded(line, route, list(nmea_deliveries(nmea_text().splitlines())))
    one, other = ({each.delivery.time_ms for each in each_ if each.passed} for each_ in (found, made_up()))
    assert one == other


# ------------------------------------------------------------------ another way than the true one


NEIGHBOURS = {
    "28876": (16908, 2016, 5900, 11648, 127, 9748),
    "31176": (24041, 6041, 11968, 11885, 7137, 109, 3956, 5898, 13697, 2011, 2010, 7815, 9751, 3992, 127, 126, 9749),
    "31259": (5916, 2026, 7855, 7818, 9754, 5831, 2013, 9755, 2014, 7819, 7154, 5589, 18686),
    "29083": (5916, 2026, 42, 111, 2094, 1932),
}
"""Ways that the trains did not take, and along which many fixes are passed on."""


def most_beside(judgements: list[Judgement] | tuple[Judgement, ...]) -> tuple[int, int]:
    """The most fixes of the last 20 that are nearer to a track off the way, and at how many fixes the way is doubtful."""
    told = [one.beside for one in judgements if one.beside is not None]
    return max(one.nearer for one in told), sum(one.doubtful for one in told)


@pytest.mark.parametrize("log", LOGS)
def test_the_way_that_a_train_took_is_not_doubtful(log: str) -> None:
    """However the receiver drifts at a stop, or goes astray and is withheld."""
    most, doubtful = most_beside(recorded(log))
    assert most <= 6
    assert doubtful == 0


@pytest.mark.parametrize("log", LOGS)
def test_a_way_that_a_train_did_not_take_is_doubtful(log: str) -> None:
    """The fixes are believed along it, and nearly all of the last ones lie nearer to another track."""
    route = route_over([f"88_L_{number}" for number in NEIGHBOURS[log]], Topology(network()))
    most, doubtful = most_beside(guarded(network(), route, list(deliveries_of(log))))
    assert most == 20
    assert doubtful > 20


def test_of_two_possible_ways_one_is_doubtful() -> None:
    """The train of log 28586 ran over the left or the middle track; its fixes say the middle one."""
    told = {}
    for name, way in WAYS_28586.items():
        told[name] = most_beside(guarded(network(), route_over(way, Topology(network())), list(deliveries_of("28586"))))
    assert told == {"left": (17, 102), "middle": (8, 0)}
