"""Named faults for runs along a line: what goes wrong, where, and what each machine has to make of it.

Only faults are offered that the machine withstands: either the assumption is kept, or its break is found out before it
can do harm. A machine with one odometer cannot notice a wheel that slips for long, and its odometer's law is an assumption;
the odometry machine has two units for that.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from safeloc.errors import InputError

Where = Literal["group", "reflector", "stretch", "stop", "run"]
MACHINES = ("odometry", "balise", "reflector", "stop_point", "route", "turn_off")
NO_POSITION = "no position from it: nothing is ordered"
UNWATCHED = "the switch is not watched: no course is stated"
NOT_VOUCHED_FOR = ("group-early", "group-late", "group-foreign")


@dataclass(frozen=True)
class LineFaultKind:
    """A kind of fault.

    where     group, reflector: at one of them; stretch: between two places; stop: at every stop; run: all the way
    lawful    the machines' assumption is kept
    outcomes  machine -> what it is to do, in words
    kinds     what it is to the simulation of "group", "reader", "distance" or "radar", as far as that makes it
    """

    name: str
    what: str
    where: Where
    lawful: bool
    outcomes: Mapping[str, str]
    kinds: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Asked:
    """A fault as it was asked for; `at` is an identity, or FROM-TO in mm along the route; empty: the usual place."""

    fault: LineFaultKind
    at: str = ""

    @property
    def told(self) -> str:
        """As it was asked for."""
        return f"{self.fault.name}:{self.at}" if self.at else self.fault.name

    def is_at(self, name: str, at: str) -> bool:
        """Whether a fault of this name that struck there (empty: on a stretch, or all the way) is the one asked for."""
        return name == self.fault.name and (not self.at or at in ("", self.at))


def _rejected(reason: str) -> str:
    return f"rejected as {reason}, the interval untouched"


FAULTS: Mapping[str, LineFaultKind] = {
    fault.name: fault
    for fault in (
        LineFaultKind(
            "group-missed", "a balise group is passed without a word", "group", True,
            {
                "odometry": "no reading there; the margin grows on, and nothing is reported beyond the tolerance",
                "balise": "nothing accepted there; where it was announced, counted as missed with its linking reaction",
                "reflector": "no position and no self-test from it: nothing precise until the next group",
                "stop_point": NO_POSITION,
                "turn_off": UNWATCHED,
            },
            {"group": "missed", "reader": "missed"},
        ),
        LineFaultKind("group-corrupted", "check bits of the telegram are wrong", "group", True,
                  {"balise": _rejected("CORRUPTED")},
                  {"group": "corrupted"}),
        LineFaultKind("group-incomplete", "only balise 1 of the group is read", "group", True,
                  {"balise": _rejected("INCOMPLETE")},
                  {"group": "incomplete"}),
        LineFaultKind("group-reversed", "the balises are read in the wrong order", "group", True,
                  {"balise": _rejected("WRONG_DIRECTION")},
                  {"group": "wrong way"}),
        LineFaultKind("group-early", "the group lies 100 m before its place", "group", True,
                  {"balise": "rejected as TOO_EARLY where it was announced; alone it is no more than a candidate"},
                  {"group": "early"}),
        LineFaultKind("group-late", "the group lies 100 m beyond its place", "group", True,
                  {"balise": "rejected as TOO_LATE where it was announced; alone it is no more than a candidate"},
                  {"group": "late"}),
        LineFaultKind("group-stale", "the telegram comes 5 s late", "group", True, {"balise": _rejected("STALE")},
                  {"group": "stale"}),
        LineFaultKind("group-malformed", "the telegram lacks its age", "group", True, {"balise": _rejected("MALFORMED")},
                  {"group": "malformed"}),
        LineFaultKind(
            "group-repeated", "the reading is delivered twice", "group", True,
            {"odometry": "the second one is rejected as a repetition", "balise": _rejected("REPEATED")},
            {"group": "duplicate", "reader": "repeated"},
        ),
        LineFaultKind(
            "group-foreign", "the group says an identity that this line has not", "group", True,
            {"odometry": "rejected as unknown", "balise": "rejected as NOT_ANNOUNCED; alone it is no more than a candidate"},
            {"group": "other identity", "reader": "foreign"},
        ),
        LineFaultKind("distance-missing", "the odometer is silent", "stretch", True, {
            "odometry": "the device's other unit goes on with the greater charge; nothing is reported without both for long",
            "balise": "the top speed is charged, and beyond the gap limit nothing is reported",
            "reflector": "the top speed is charged, and beyond the gap limit nothing is reported: SENSOR_FAILURE",
            "stop_point": "position lost: nothing is ordered, and where a stop was pending, hold",
            "route": "the top speed is charged, and beyond the gap limit nothing is reported: SENSOR_FAILURE",
            "turn_off": UNWATCHED,
        },
                  {"distance": "drop-out"}),
        LineFaultKind("distance-jump", "the odometer counts 50 m in one cycle", "stretch", False, {
            "odometry": "refused as impossible; the top speed is charged in its place",
            "balise": "refused as impossible; the top speed is charged in its place",
            "reflector": "refused as impossible; the top speed is charged in its place",
            "stop_point": "refused as impossible; the stop is still made on the measured distance",
            "route": "refused as impossible; the top speed is charged in its place",
            "turn_off": "refused as impossible; the course is stated as before",
        },
                  {"distance": "jump"}),
        LineFaultKind("wheel-slide", "the wheel turns a quarter too slow", "stretch", False, {
            "odometry": "the units disagree: the difference is charged, or the change is refused",
        },
                  {"distance": "slide"}),
        LineFaultKind("wheel-slip", "the wheel turns a quarter too fast", "stretch", False, {
            "odometry": "the units disagree: the difference is charged, or the change is refused",
        },
                  {"distance": "slip"}),
        LineFaultKind("wheel-stuck", "the wheel says standstill while the vehicle runs", "stretch", False, {
            "odometry": "the units disagree: the difference is charged, or the change is refused",
        },
                  {"distance": "stuck"}),
        LineFaultKind("frames-missing", "no radar frames come", "reflector", True, {
            "reflector": "not precise; missing frames are no lost reflector until the time is up",
            "stop_point": "no precise position: the stop is not confirmed",
            "turn_off": UNWATCHED,
        },
                  {"radar": "pause"}),
        LineFaultKind("reflector-hidden", "the radar's frames show no reflector", "reflector", True, {
            "reflector": "not found: not precise there",
            "stop_point": "no precise position: the stop is not confirmed",
            "turn_off": UNWATCHED,
        },
                  {"radar": "blind"}),
        LineFaultKind("echoes-weak", "all echoes are 20 dB weaker", "reflector", True, {
            "reflector": "below the minimum intensity: not precise there",
            "stop_point": "no precise position: the stop is not confirmed",
            "turn_off": UNWATCHED,
        },
                  {"radar": "weak"}),
        LineFaultKind("echoes-shifted", "from the middle of the view zone on, the radar measures 20 m too far", "reflector", False, {
            "reflector": "rejected as OUT_OF_WINDOW: the position runs on by odometry",
        },
                  {"radar": "shift"}),
        LineFaultKind("decoy", "a strong echo of a model that is not looked for, 30 m ahead", "reflector", True, {
            "reflector": "rejected as OTHER_MODEL",
        },
                  {"radar": "decoy"}),
        LineFaultKind("reflector-gone", "a reflector of the map is not at the track", "reflector", True, {
            "reflector": "not found: not precise there",
            "stop_point": "no precise position: the stop is not confirmed",
            "route": "nothing is refuted by what is not seen: perhaps undecided, never another route",
            "turn_off": UNWATCHED,
        }),
        LineFaultKind("model-misread", "a reflector is taken for a model that this line has not", "reflector", False,
                  {"route": "no route fits: nothing is reported until the next start"}),
        LineFaultKind("authority-wrong", "the movement authority names another way than the one taken", "run", True, {
            "route": "flagged as soon as that route is refuted",
            "turn_off": "the course seen is stated, and that it contradicts the authority",
        }),
        LineFaultKind("stop-overrun", "the vehicle stops 3 m beyond the stop point", "stop", True,
                  {"stop_point": "overrun: hold, then backwards at reduced speed into the window"}),
        LineFaultKind("stop-short", "the vehicle stops 2 m before the stop point", "stop", True,
                  {"stop_point": "short: hold, then forwards at reduced speed into the window"}),
    )
}  # fmt: skip


def parse(asked: Sequence[str], machines: Sequence[str], *, trust_first: bool = False) -> list[Asked]:
    """Faults from `NAME` or `NAME:PLACE`.

    InputError for an unknown name, one that none of the machines has, and a displaced or exchanged group where the first
    group is vouched for: it may be that one.
    """
    found = []
    for text in asked:
        name, _, at = text.partition(":")
        if name not in FAULTS:
            raise InputError(f"no fault {name!r}. {told()}")
        if not set(FAULTS[name].outcomes) & set(machines):
            having = ", ".join(FAULTS[name].outcomes)
            raise InputError(f"fault {name} is for {having}, and here is {', '.join(machines)}.")
        if trust_first and name in NOT_VOUCHED_FOR:
            raise InputError(f"fault {name} and --trust-first contradict each other: such a group is not vouched for.")
        found.append(Asked(FAULTS[name], at))
    return found


def told() -> str:
    """Every fault, what it is, where it may be put, and what each machine makes of it."""
    lines = ["Faults (NAME, or NAME:PLACE):"]
    for fault in FAULTS.values():
        places = {
            "group": ", at group NAME:ID",
            "reflector": ", at reflector NAME:ID",
            "stretch": ", NAME:FROM-TO in mm along the route",
        }
        law = "" if fault.lawful else " (breaks the assumption)"
        lines.append(f"  {fault.name}: {fault.what}{places.get(fault.where, '')}{law}")
        lines += [f"      {machine}: {outcome}" for machine, outcome in fault.outcomes.items()]
    return "\n".join(lines)
