"""Six of the nine operational scenarios of the Hybrid Level 3 principles, as data: where trains are, and what the states are to be.

Line of eight sections of one length, in three detection sections of two, three and three. Places are in tenths of a section. The
states are those of a published formal model of the principles (case study of the conference ABZ 2018), step by step; U, F, O, A:
UNKNOWN, FREE, OCCUPIED, AMBIGUOUS. The principles leave times open, so a step lasts `STEP_S` here.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.models.sections.simulate import FollowerRun, Scene, TrainRun

TENTH_MM = 50_000
SECTION_MM = 10 * TENTH_MM
CUTS = tuple((n * SECTION_MM + (1 if n else 0), (n + 1) * SECTION_MM) for n in range(8))
DETECTION = ((0, 2 * SECTION_MM), (2 * SECTION_MM + 1, 5 * SECTION_MM), (5 * SECTION_MM + 1, 8 * SECTION_MM))
STEP_S = 40
_SPEED_MM_S = TENTH_MM // 2
_ENTERS_S = 10
_APART_S = 12
"""From the entry of a train until that of the vehicle behind it."""
NEVER = ((0, 10_000),)


@dataclass(frozen=True)
class Published:
    """A scenario.

    fronts   the place of the train's front at each step; it stands half a tenth before that
    states   the published states at each step
    length_mm, left_behind_mm  the train, and its part that stays behind after the first step
    silent   first and last step, counted from 1, at which the train tells nothing
    behind   the places of a vehicle of 200 m that tells nothing, and comes in behind the train
    """

    fronts: tuple[int, ...]
    states: tuple[str, ...]
    length_mm: int = 200_000
    left_behind_mm: int = 0
    silent: tuple[int, int] | None = None
    behind: tuple[int, ...] = ()


SCENARIOS = {
    "1, normal running": Published(
        (10, 15, 20, 30, 35, 45, 50, 60),
        ("OFFFFFFF", "OOFFFFFF", "FOFFFFFF", "FFOFFFFF", "FFOOFFFF", "FFFOOFFF", "FFFFOFFF", "FFFFFOFF"),
        450_000,
    ),
    "2, splitting": Published(
        (20, 20, 25, 35, 45, 52, 60),
        ("FOFFFFFF", "FAFFFFFF", "FUAFFFFF", "FUUAFFFF", "FUUUAFFF", "FUUUAAFF", "FUFFFOFF"),
        450_000,
        250_000,
    ),
    "3, shadow train": Published(
        (25, 35, 45, 52, 63, 68),
        ("UUAFFFFF", "UUUAFFFF", "FFUUAFFF", "FFUUUUFF", "FFUUUAAF", "FFFFFUAF"),
        silent=(4, 4),
        behind=(15, 20, 25, 35, 45, 55),
    ),
    "5, integrity lost": Published(
        (18, 20, 25, 38, 48, 54, 60),
        ("FOFFFFFF", "FAFFFFFF", "FUAFFFFF", "FUUAFFFF", "FUUUAFFF", "FUUUAAFF", "FUFFFAFF"),
        350_000,
        150_000,
    ),
    "6, connection lost": Published(
        (20, 20, 20, 30, 40, 40, 50, 60),
        ("FOFFFFFF", "FUFFFFFF", "FUFFFFFF", "FFUUUFFF", "FFUUUFFF", "FFUAUFFF", "FFUAAFFF", "FFFFFOFF"),
        silent=(2, 5),
    ),
    "7, connection lost, sections released": Published(
        (30, 40, 40, 50, 53, 53, 60, 70),
        ("FFOFFFFF", "FFFOFFFF", "FFFUUUUF", "FFFUUUUF", "FFFUUUUF", "FFFFOOFF", "FFFFFOFF", "FFFFFFOF"),
        silent=(3, 5),
    ),
}


def seconds(what: Published) -> tuple[int, ...]:
    """Return the second at the end of each step: all stand then, and what is to happen in the step has happened."""
    first = _ENTERS_S + _APART_S + max(_run_s(what.fronts[0]), _run_s((what.behind or (0,))[0])) + 5
    return tuple(first + STEP_S * number for number in range(len(what.states)))


def scene(what: Published, *, counted: bool) -> Scene:
    """Return the scene; a vehicle that tells nothing is a train where borders count, and a follower where they do not."""
    ends = seconds(what)
    trains = [_train(what, ends)]
    follower = None
    if what.behind:
        enters = _ENTERS_S + _APART_S
        speeds = _speeds(what.behind, ends, enters)
        if counted:
            trains.append(TrainRun(2, enters, 200_000, speeds, NEVER))
        else:
            follower = FollowerRun(enters, 200_000, speeds)
    return Scene(
        (0, 8 * SECTION_MM),
        CUTS,
        tuple(trains),
        ends[-1] + 1,
        clear=(3,) if counted else (),
        follower=follower,
        inner_mm=DETECTION,
    )


def _train(what: Published, ends: tuple[int, ...]) -> TrainRun:
    silent = ()
    if what.silent is not None:
        first, last = what.silent
        silent = ((ends[first - 2] + 1, ends[last - 1] + 1),)
    splits = ends[0] + 1 if what.left_behind_mm else None
    return TrainRun(
        1, _ENTERS_S, what.length_mm, _speeds(what.fronts, ends, _ENTERS_S), silent, splits, what.left_behind_mm
    )


def _run_s(tenths: int) -> int:
    """Return the seconds of a run from the low end to half a tenth before a place."""
    return 2 * tenths - 1


def _speeds(places: tuple[int, ...], ends: tuple[int, ...], enters: int) -> tuple[tuple[int, int], ...]:
    """Return speeds since the entry: to each place in its step, then standing."""
    found = [(0, _SPEED_MM_S), (_run_s(places[0]), 0)]
    for number in range(1, len(places)):
        if places[number] > places[number - 1]:
            start = ends[number - 1] + 1 - enters
            found += [(start, _SPEED_MM_S), (start + 2 * (places[number] - places[number - 1]), 0)]
    return tuple(found)
