"""Named faults for runs along a line: the fault, its place, and the reaction that each machine has to show.

Each machine gets only faults that it withstands: either its assumption still holds, or it notices the fault before it
reports anything wrong. A machine with one odometer cannot notice a long slip of the wheel, since it assumes the odometer's error
law. The odometry machine has two units for that.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from safeloc.errors import InputError

Where = Literal["group", "reflector", "stretch", "stop", "run"]
MACHINES = ("odometry", "balise", "reflector", "stop_point", "route", "turn_off")
NO_POSITION = "no position from it: nothing is ordered"
_UNWATCHED = "the switch is not watched: no course is stated"
_NOT_VOUCHED_FOR = ("group-early", "group-late", "group-foreign")


@dataclass(frozen=True)
class LineFaultKind:
    """A kind of fault.

    where     group, reflector: at one of them; stretch: between two places; stop: at every stop; run: all the way
    lawful    the machines' assumption still holds, but for that of the machines in `breaks`
    outcomes  machine -> the reaction that it has to show, in words
    kinds     name of the fault in the simulation of "group", "reader", "distance" or "radar", if that simulates it
    breaks    machines whose assumption it breaks although it is lawful for the others
    """

    name: str
    what: str
    where: Where
    lawful: bool
    outcomes: Mapping[str, str]
    kinds: Mapping[str, str] = field(default_factory=dict)
    breaks: tuple[str, ...] = ()

    def lawful_for(self, machine: str) -> bool:
        """Return whether the assumption of this machine still holds."""
        return self.lawful and machine not in self.breaks


@dataclass(frozen=True)
class Asked:
    """A requested fault; `at` is an identity, or FROM-TO in mm along the route; empty: the usual place."""

    fault: LineFaultKind
    at: str = ""

    @property
    def as_requested(self) -> str:
        """The fault as it was requested."""
        return f"{self.fault.name}:{self.at}" if self.at else self.fault.name

    def is_at(self, name: str, at: str) -> bool:
        """Return whether a fault of this name that struck there (empty: on a stretch, or all the way) is the requested one."""
        return name == self.fault.name and (not self.at or at in ("", self.at))


def _rejected(reason: str) -> str:
    return f"rejected as {reason}, the interval untouched"


FAULTS: Mapping[str, LineFaultKind] = {
    fault.name: fault
    for fault in (
        LineFaultKind(
            "group-missed", "the vehicle passes a balise group and reads nothing", "group", True,
            {
                "odometry": "no reading there; the margin grows on, and beyond the tolerance there is no position",
                "balise": "nothing accepted there; an announced group counts as missed, with its linking reaction",
                "reflector": "the group gives no position and no self-test: not precise until the next group",
                "stop_point": NO_POSITION,
                "turn_off": _UNWATCHED,
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
                  {"balise": "rejected as TOO_EARLY if it was announced; otherwise only a candidate"},
                  {"group": "early"}),
        LineFaultKind("group-late", "the group lies 100 m beyond its place", "group", True,
                  {"balise": "rejected as TOO_LATE if it was announced; otherwise only a candidate"},
                  {"group": "late"}),
        LineFaultKind("group-stale", "the telegram comes 5 s late", "group", True, {"balise": _rejected("STALE")},
                  {"group": "stale"}),
        LineFaultKind("group-malformed", "the telegram lacks its age", "group", True, {"balise": _rejected("MALFORMED")},
                  {"group": "malformed"}),
        LineFaultKind(
            "group-repeated", "the reader delivers the reading twice", "group", True,
            {"odometry": "the second reading is rejected as a repetition", "balise": _rejected("REPEATED")},
            {"group": "duplicate", "reader": "repeated"},
            breaks=("odometry",),  # the vehicle has run on, and the repeated reading does not say so
        ),
        LineFaultKind(
            "group-foreign", "the group sends an identity that is not on this line", "group", True,
            {"odometry": "rejected as unknown", "balise": "rejected as NOT_ANNOUNCED; without announcements only a candidate"},
            {"group": "other identity", "reader": "foreign"},
        ),
        LineFaultKind("distance-missing", "the odometer is silent", "stretch", True, {
            "odometry": "the device's other unit goes on, with a greater error; without both for long there is no position",
            "balise": "the margin grows by the top speed; beyond the gap limit there is no position",
            "reflector": "the margin grows by the top speed; beyond the gap limit there is no position: SENSOR_FAILURE",
            "stop_point": "position lost: no order, or hold if a stop was pending",
            "route": "the margin grows by the top speed; beyond the gap limit there is no route: SENSOR_FAILURE",
            "turn_off": _UNWATCHED,
        },
                  {"distance": "drop-out"}),
        LineFaultKind("distance-jump", "the odometer counts 50 m in one cycle", "stretch", True, {
            "odometry": "refused as impossible; the margin grows by the top speed instead",
            "balise": "refused as impossible; the margin grows by the top speed instead",
            "reflector": "refused as impossible; the margin grows by the top speed instead",
            "stop_point": "refused as impossible; the vehicle still stops by the measured distance",
            "route": "refused as impossible; the margin grows by the top speed instead",
            "turn_off": "refused as impossible; the course stays as before",
        },
                  {"distance": "jump"}),
        LineFaultKind("wheel-slide", "the wheel turns a quarter too slow", "stretch", False, {
            "odometry": "the units disagree: the margin grows by the difference, or the change is refused",
        },
                  {"distance": "slide"}),
        LineFaultKind("wheel-slip", "the wheel turns a quarter too fast", "stretch", False, {
            "odometry": "the units disagree: the margin grows by the difference, or the change is refused",
        },
                  {"distance": "slip"}),
        LineFaultKind("wheel-stuck", "the wheel measures standstill while the vehicle runs", "stretch", False, {
            "odometry": "the units disagree: the margin grows by the difference, or the change is refused",
        },
                  {"distance": "stuck"}),
        LineFaultKind("frames-missing", "no radar frames come", "reflector", True, {
            "reflector": "not precise; the reflector counts as lost only after the time limit",
            "stop_point": "no precise position: no confirmation of the stop",
            "turn_off": _UNWATCHED,
        },
                  {"radar": "pause"}),
        LineFaultKind("reflector-hidden", "the radar's frames show no reflector", "reflector", True, {
            "reflector": "not found: not precise there",
            "stop_point": "no precise position: no confirmation of the stop",
            "turn_off": _UNWATCHED,
        },
                  {"radar": "blind"}),
        LineFaultKind("echoes-weak", "all echoes are 20 dB weaker", "reflector", True, {
            "reflector": "below the minimum intensity: not precise there",
            "stop_point": "no precise position: no confirmation of the stop",
            "turn_off": _UNWATCHED,
        },
                  {"radar": "weak"}),
        LineFaultKind("echoes-shifted", "from the middle of the view zone on, the radar measures 20 m too far", "reflector", False, {
            "reflector": "rejected as OUT_OF_WINDOW: the position runs on by odometry",
        },
                  {"radar": "shift"}),
        LineFaultKind("decoy", "a strong echo of a model other than the searched one, 30 m ahead", "reflector", False, {
            "reflector": "rejected as OTHER_MODEL",
        },
                  {"radar": "decoy"}),
        LineFaultKind("reflector-gone", "a reflector of the map is not at the track", "reflector", True, {
            "reflector": "not found: not precise there",
            "stop_point": "no precise position: no confirmation of the stop",
            "route": "a reflector that is not seen refutes nothing: perhaps undecided, never another route",
            "turn_off": _UNWATCHED,
        }),
        LineFaultKind("model-misread", "the radar recognises a model that is not on this line", "reflector", False,
                  {"route": "no route fits: no report until the next start"}),
        LineFaultKind("authority-wrong", "the movement authority names another way than the one taken", "run", True, {
            "route": "reports the contradiction as soon as that route is refuted",
            "turn_off": "reports the course seen, and that it contradicts the authority",
        }),
        LineFaultKind("stop-overrun", "the vehicle stops 3 m beyond the stop point", "stop", True,
                  {"stop_point": "overrun: hold, then backwards at reduced speed into the window"}),
        LineFaultKind("stop-short", "the vehicle stops 2 m before the stop point", "stop", True,
                  {"stop_point": "short: hold, then forwards at reduced speed into the window"}),
    )
}  # fmt: skip


def parse(asked: Sequence[str], machines: Sequence[str], *, trust_first: bool = False) -> list[Asked]:
    """Return the faults that `NAME` or `NAME:PLACE` request.

    InputError for an unknown name, for a fault that none of the machines has, and for a displaced or exchanged group if the
    vehicle trusts its first group, since the fault may hit that one.
    """
    found = []
    for text in asked:
        name, _, at = text.partition(":")
        if name not in FAULTS:
            raise InputError(f"no fault {name!r}. {fault_table()}")
        if not set(FAULTS[name].outcomes) & set(machines):
            having = ", ".join(FAULTS[name].outcomes)
            raise InputError(f"fault {name} is for {having}, but the run is for {', '.join(machines)}.")
        if trust_first and name in _NOT_VOUCHED_FOR:
            raise InputError(
                f"fault {name} and --trust-first contradict each other: the first group may be the faulty one."
            )
        found.append(Asked(FAULTS[name], at))
    return found


def fault_table() -> str:
    """Return a text of every fault: its meaning, its place, and the reaction of each machine."""
    lines = ["Faults (NAME, or NAME:PLACE):"]
    for fault in FAULTS.values():
        places = {
            "group": ", at group NAME:ID",
            "reflector": ", at reflector NAME:ID",
            "stretch": ", NAME:FROM-TO in mm along the route",
        }
        of = f" of {', '.join(fault.breaks)}" if fault.breaks else ""
        law = f" (breaks the assumption{of})" if of or not fault.lawful else ""
        lines.append(f"  {fault.name}: {fault.what}{places.get(fault.where, '')}{law}")
        lines += [f"      {machine}: {outcome}" for machine, outcome in fault.outcomes.items()]
    return "\n".join(lines)
