"""The reasons of a guard: their meaning in words, and their marks. Passed fixes are dots, withheld ones crosses."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.report.drawing import BLUE, BROWN, GREEN, GREY, ORANGE, PURPLE, RED, SKY

PASSED = "PASSED"
WORDS: Mapping[str, str] = {
    "PASSED": "passed on",
    "UNCONFIRMED": "agrees, but too few have agreed in a row",
    "OFF_TRACK": "farther off the track than allowed",
    "AMBIGUOUS": "more than one track is too near",
    "JUMP": "the vehicle cannot have reached it",
    "SPEED_DISAGREES": "speed disagrees with the distance run",
    "DOUBTFUL": "only its error bound overlaps the vehicle's possible positions",
    "ACROSS": "its course crosses the track",
    "AGAINST": "it runs against the permitted direction",
    "OUT_OF_REACH": "out of reach from the last known position",
    "TOO_COARSE": "its error bound exceeds the tolerable error",
    "NO_FIX": "the receiver has no position",
    "MALFORMED": "no readable position",
    "NOT_FINITE": "not a finite number",
    "STALE": "older than allowed",
    "FUTURE": "its time is later than its arrival",
    "DUPLICATE": "the same time again, or the same position while moving",
    "OUT_OF_ORDER": "older than an earlier one",
    "NOTHING": "nothing was delivered",
}
_COLOURS: Mapping[str, str] = {
    "PASSED": BLUE,
    "UNCONFIRMED": SKY,
    "OFF_TRACK": RED,
    "AMBIGUOUS": BROWN,
    "JUMP": ORANGE,
    "SPEED_DISAGREES": PURPLE,
    "DOUBTFUL": GREEN,
}


def _colour(reason: str) -> str:
    """Return the colour of a reason; grey for reasons that leave no place on the map."""
    return _COLOURS.get(reason, GREY)


def mark(x: float, y: float, reason: str, size: float = 3) -> str:
    """Return a dot for a fix that is passed on, a cross for one that is withheld."""
    if reason == PASSED:
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{size * 0.8:.1f}" fill="{_colour(reason)}" class="passed"/>'
    arms = f"M{x - size:.1f} {y - size:.1f}l{2 * size} {2 * size}m0 {-2 * size}l{-2 * size} {2 * size}"
    return f'<path d="{arms}" stroke="{_colour(reason)}" stroke-width="1.3" fill="none" class="withheld"/>'
