"""Looking ahead and behind over switches, by shortest distance; carrying along what the worst route brings."""

from __future__ import annotations

from safeloc.railway.map.topology import Run
from safeloc.railway.map.walk import Walk, carried
from tests.railway.map.made import fork, group, reflector, straight

STEM, LEFT, RIGHT = (Run(name, "increasing") for name in ("stem", "left", "right"))


def fork_walk() -> Walk:
    """A balise on the stem and a reflector on each branch."""
    line = fork(
        stem_mm=1_000_000,
        left_mm=500_000,
        right_mm=500_000,
        balise_groups=(group(1, "stem", 900_000),),
        reflectors=(
            reflector("l", "left", 200_000),
            reflector("l2", "left", 300_000),
            reflector("r", "right", 0, "B"),
        ),
    )
    return Walk(line)


def seen(found: object) -> dict[str, int]:
    """Identity and distance."""
    return {one.element.id: one.distance_mm for one in found}  # type: ignore[attr-defined]


def test_ahead_looks_down_every_branch() -> None:
    """Everything within reach, the start included, nothing behind it."""
    walk = fork_walk()
    assert {"g1": 0, "r": 100_000, "l": 300_000} == seen(walk.ahead(STEM, 900_000, 300_000))
    assert {"l": 200_000 - 1, "l2": 300_000 - 1} == seen(walk.ahead(LEFT, 1, 10**9))


def test_behind_looks_back_to_where_vehicles_come_from() -> None:
    """From a branch back over the switch to the stem."""
    walk = fork_walk()
    assert {"l": 50_000, "g1": 350_000} == seen(walk.behind(LEFT, 250_000, 10**9))
    assert {"r": 100_000, "g1": 200_000} == seen(walk.behind(RIGHT, 100_000, 200_000))
    assert {"r": 100_000} == seen(walk.behind(RIGHT, 100_000, 199_999))


def test_first_ahead_stops_at_the_first_on_every_route() -> None:
    """One a branch, of those that are wanted."""
    walk = fork_walk()
    assert {"l": 300_000, "r": 100_000} == seen(walk.first_ahead(STEM, 900_001 - 1, 10**9, lambda e: e.id != "g1"))
    assert {"l2": 400_000} == seen(walk.first_ahead(STEM, 900_000, 10**9, lambda e: e.id == "l2"))
    assert {} == seen(walk.first_ahead(STEM, 900_000, 399_999, lambda e: e.id == "l2"))


def test_references_lie_in_the_direction_of_the_run() -> None:
    """Against the edge the order turns round, and reflectors for the other direction are not seen."""
    line = straight(1_000, travel="both", balise_groups=(group(1, "e0", 5), group(2, "e0", 900)))
    walk = Walk(line.model_copy(update={"reflectors": (reflector("r", "e0", 400, view_from_mm=300, view_to_mm=1),)}))
    there, again = (
        [(offset, one.id) for offset, one in walk.references[Run("e0", way)]]  # type: ignore[arg-type]
        for way in ("increasing", "decreasing")
    )
    assert [(5, "g1"), (400, "r"), (900, "g2")] == there
    assert [(100, "g2"), (995, "g1")] == again
    assert 5 == walk.place(Run("e0", "decreasing"), 995).position_mm


def test_the_worst_is_carried_along() -> None:
    """Lengths add up over runs that set nothing anew; a run that does starts again from its own."""
    walk = Walk(straight(10, 20, 30))
    fresh = {"e1": 5}
    arriving, loops = carried(
        walk,
        lambda _: 1,
        lambda run: fresh.get(run.edge),
        lambda run, count: count + walk.topology.length_mm(run),
        max,
    )
    assert {"e0": 1, "e1": 11, "e2": 5} == {run.edge: value for run, value in arriving.items()}
    assert [] == loops
