"""Whether a given way is the true one: fixes beside another track, counted at places that lie apart."""

from __future__ import annotations

import pytest

from safeloc.railway.guard.guard import Guard, Judgement
from safeloc.railway.guard.judgement_data import as_data
from safeloc.railway.guard.other_way import APART_MM, KEPT, MOST, Beside, OtherWay, doubt
from safeloc.railway.map.imports.geojson_path import route_over
from safeloc.railway.map.model import Line
from safeloc.railway.map.routes import Route
from safeloc.railway.map.topology import Topology
from tests.railway.guard.made import CONFIG, edge, fix, fork, place, tracks

pytest.importorskip("shapely")
pytest.importorskip("pyproj")
BESIDE_M = 4.0
"""Distance of a second track from the given way."""


def double() -> Line:
    """A track of a kilometre, and another one beside it."""
    whole = fork(edge("beside", "B", "C", (0, BESIDE_M), (1_000, BESIDE_M)))
    edges = tuple(one for one in whole.edges if one.id != "side")
    nodes = tuple(
        one.model_copy(update={"kind": "border"}) if one.id != "S" else one for one in whole.nodes if one.id != "Y"
    )
    return whole.model_copy(update={"edges": edges, "nodes": nodes, "switches": ()})


def way(line: Line) -> Route:
    """The way over the stem."""
    return route_over(["stem", "main"], Topology(line))


def counter(line: Line | None = None) -> OtherWay:
    """Nothing counted yet, on that way."""
    line = line or double()
    return OtherWay(tracks(line, way(line)))


def counted(
    other: OtherWay, aside_m: list[float], *, apart_mm: int = APART_MM, first_mm: int = 100_000
) -> Beside | None:
    """Count a row of fixes, so far to the left of the way."""
    told: Beside | None = None
    for number, aside in enumerate(aside_m):
        at_mm = first_mm + number * apart_mm
        told = other.passed(*place(at_mm / 1_000, aside), at_mm, round(aside * 1_000))
    return told


def test_fixes_on_the_way_leave_it_undoubted() -> None:
    """Nearer to the way each time, by as little as it may be."""
    told = counted(counter(), [BESIDE_M / 2 - 0.01] * 30)
    assert told == Beside(KEPT, 0)
    assert not told.doubtful


def test_fixes_on_the_other_track_make_it_doubtful() -> None:
    """With one more than half of the last ones, and not before."""
    assert counted(counter(), [BESIDE_M] * MOST) == Beside(MOST, MOST)
    told = counted(counter(), [BESIDE_M] * (MOST + 1))
    assert told is not None and told.doubtful
    assert not Beside(KEPT, MOST).doubtful


def test_the_doubt_ends_with_as_many_fixes_on_the_way() -> None:
    """Only the last ones count."""
    other = counter()
    counted(other, [BESIDE_M] * KEPT)
    told = counted(other, [0.0] * (KEPT - MOST), first_mm=600_000)
    assert told == Beside(KEPT, MOST)
    assert not told.doubtful


@pytest.mark.parametrize("apart_mm", [0, APART_MM // 30])
def test_a_receiver_that_drifts_at_a_stop_counts_once(apart_mm: int) -> None:
    """Fixes that lie nearer to each other than so have one error, and are one."""
    assert counted(counter(), [BESIDE_M] * 30, apart_mm=apart_mm) == Beside(1, 1)


def test_running_back_counts_as_running_on() -> None:
    """It is the distance that tells fixes apart."""
    assert counted(counter(), [BESIDE_M] * 5, apart_mm=-APART_MM, first_mm=400_000) == Beside(5, 5)


def test_where_no_other_track_is_near_nothing_is_counted() -> None:
    """Beyond the clearance, the last ones stay: such a place tells nothing of the way."""
    other = counter(fork(edge("beside", "B", "C", (0, BESIDE_M), (300, BESIDE_M))))
    assert counted(other, [BESIDE_M] * 4, first_mm=100_000) == Beside(4, 4)
    assert counted(other, [0.0] * 4, first_mm=330_000) == Beside(4, 4)


def test_without_a_way_or_another_track_nothing_is_told() -> None:
    """The guard follows every movement then; or there is nothing to take for the way."""
    assert OtherWay(tracks(double())).passed(*place(100), 100_000, 0) is None
    line = double()
    alone = line.model_copy(
        update={"edges": line.edges[:2], "nodes": tuple(one for one in line.nodes if one.id in "WSE")}
    )
    assert counter(alone).passed(*place(100), 100_000, 0) is None


def test_what_is_forgotten_is_not_counted() -> None:
    """After a new start."""
    other = counter()
    counted(other, [BESIDE_M] * 5)
    other.forget()
    assert counted(other, [BESIDE_M]) == Beside(1, 1)


# ------------------------------------------------------------------ the guard at work


def judged(aside_m: float, *, anew_after: int = -1) -> list[Judgement]:
    """A run of 25 m a second along a track that is so far to the left of the given way."""
    line = double()
    guard, found = Guard(CONFIG, tracks(line, way(line))), list[Judgement]()
    for second in range(36):
        found.append(guard.judge(fix(second, 20 + 25 * second, aside_m)))
        if second == anew_after:
            guard.start_anew()
    return found


def test_every_fix_is_believed_and_the_way_is_told_to_be_doubtful() -> None:
    """On the wrong way nothing else is noticed: all are passed on but the first row, and nothing is withheld for the doubt."""
    wrong, right = judged(BESIDE_M), judged(0.0)
    assert [one.passed for one in wrong] == [one.passed for one in right]
    assert sum(one.passed for one in wrong) > 30
    assert [one.beside is None for one in wrong] == [not one.passed for one in wrong]
    doubtful = [one.beside.doubtful for one in wrong if one.beside is not None]
    assert doubtful == [False] * MOST + [True] * (len(doubtful) - MOST)
    assert not any(one.beside.doubtful for one in right if one.beside is not None)


def test_a_new_start_forgets_the_fixes() -> None:
    """The host may have given another way for it."""
    *_, last = [one.beside for one in judged(BESIDE_M, anew_after=30) if one.beside is not None]
    assert last.fixes < 6


def test_the_judgement_tells_it() -> None:
    """As data, and in words."""
    *_, last = judged(BESIDE_M)
    assert last.beside is not None
    assert as_data(last)["beside"] == {"fixes": 20, "nearer": 20, "doubtful": True}
    assert as_data(judged(BESIDE_M)[0])["beside"] is None
    assert doubt(last.beside).startswith(
        "20 of the last 20 fixes that were passed on beside another track lie nearer to it"
    )
