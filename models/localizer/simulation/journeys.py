"""Example journeys of the localizer and the faults on them, each with its outcome in words, which the tests check."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from safeloc.models.balise.groups import Group
from safeloc.models.localizer.simulation.journey import Journey, Stretch
from safeloc.models.localizer.simulation.junction import Junction
from safeloc.models.reflector.simulate import Balise, Reflector, Route
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg

METRO = Journey(
    legs=[Leg(0, 2), Leg(15_000, 45), Leg(0, 30)],
    markers=[(number, number * 100_000) for number in range(1, 9)],
    groups=[
        Group(1, 20_000, accuracy_mm=1_000), Group(2, 170_000, accuracy_mm=1_000, reflector_mm=229_960, search_mm=140_000),
        Group(3, 320_000, accuracy_mm=1_000, reflector_mm=80_040), Group(4, 470_000, accuracy_mm=1_000), Group(5, 620_000, accuracy_mm=1_000),
        Group(6, 770_000, accuracy_mm=1_000),
    ],
    reflectors=Route(
        (Balise(3, 320_000), Balise(5, 620_000)), (Reflector(400_000, "A", 80_000), Reflector(640_000, "B", 80_000))
    ),
    dark=[Stretch(-1_000_000, 10_000_000)],
    length_mm=40_000,
    latched=1.0,
)  # fmt: skip
"""A metro train that runs into a station in a tunnel: markers, balises, and radar reflectors at the stopping place. The telegrams of the second and the third group tell
the distance to reflector A; the map has those from the third and the fifth."""

MAIN_LINE = Journey(
    legs=[Leg(0, 2), Leg(38_000, 90), Leg(0, 60)],
    markers=[(number, number * 500_000) for number in range(1, 9)],
    groups=[Group(number, number * 300_000 - 200_000) for number in range(1, 16)],
    dark=[Stretch(1_400_000, 2_100_000)],
    length_mm=200_000,
)
"""A main line train with satellites in view, except in a tunnel of 700 m."""

STEM = [Group(number, number * 300_000 - 220_000) for number in range(1, 4)]
THROUGH = [Group(number, number * 300_000 - 220_000) for number in range(4, 14)]
ASIDE = [Group(100 + number, number * 300_000 - 220_000) for number in range(4, 14)]
"""Groups up to the switch, and behind it at equal distances on both branches: only identities distinguish the branches."""
SWITCH_MM, SET_MM = 950_000, 850_000

FREIGHT = Journey(
    legs=[Leg(0, 2), Leg(22_000, 120), Leg(0, 60)],
    groups=[*STEM, *THROUGH],
    dark=[Stretch(2_200_000, 2_300_000)],
    fibre=Stretch(500_000, 2_000_000),
    junction=Junction(SWITCH_MM, SET_MM, ASIDE),
    axles=44,
    length_mm=205_000,
    acceleration_mm_s2=400,
)
"""A freight train through a fibre-equipped area, entered over an axle counter, with a junction in it. Behind its end, where no
satellite is in view for 100 m, only balises remain. The route over the switch is changed 100 m before it: linking for the other
branch is replaced."""

OFF_THE_FIBRE = replace(
    FREIGHT, groups=[*STEM, *ASIDE], fibre=Stretch(500_000, SWITCH_MM), junction=Junction(SWITCH_MM, SET_MM, THROUGH)
)
"""The same train on a route into the branch without a fibre; linking announces that branch."""

NOMINAL: Mapping[str, Journey] = {"metro": METRO, "main-line": MAIN_LINE, "freight": FREIGHT}


@dataclass(frozen=True)
class Case:
    """One fault on a journey, and its outcome.

    fires        transitions of the composition that fire because of it, as `machine: transition`
    outcome      the outcome in words
    undetectable the reason why no machine notices it before a wrong interval is reported; empty: no interval is wrong
    remains      an error that the interval, which contains the truth, does not show, and that no machine notices at once
    """

    journey: str
    trouble: Fault
    fires: tuple[str, ...]
    outcome: str
    undetectable: str = ""
    remains: str = ""

    @property
    def name(self) -> str:
        """Name of the case: the journey and the kind of fault."""
        return f"{self.journey}: {self.trouble.kind}"


def with_troubles(cases: Sequence[Case]) -> Journey:
    """Return the journey of the cases, with the faults of all of them."""
    return replace(NOMINAL[cases[0].journey], troubles=[case.trouble for case in cases])


SPOOFED = (
    "all solutions are drawn away together, by less in a cycle than the prediction allows: as long as the drift is within "
    "what the other sources leave open, nothing on board differs from a true run"
)
_BRANCH = (
    "on which branch the vehicle is: the one coordinate counts along either, and behind the switch the truth is the distance run "
    "along the branch taken. From the switch to the first group behind it both branches look alike on board; until the last "
    "source is withdrawn the distance that is passed on is right, and its branch may be wrong"
)
_BALISE_UNREAD = ("balise: expected group missed",)
_UNANNOUNCED = (*_BALISE_UNREAD, "balise: telegram rejected", "balise: tolerance exceeded")
_SILENT = ("motion: silent too long", "balise: sensors failed")
_SLIDES = ("motion: units disagree", "balise: sensors failed")


def _metro(
    kind: str, fires: tuple[str, ...], outcome: str, *, group: int = 0, undetectable: str = "", begin: int = 380
) -> Case:
    return Case("metro", Fault(kind, group or "", begin, 480), fires, outcome, undetectable)


def _main(kind: str, fires: tuple[str, ...], outcome: str, *, group: int = 0, undetectable: str = "") -> Case:
    return Case("main-line", Fault(kind, group or "", 800, 900), fires, outcome, undetectable)


def _freight(
    kind: str,
    fires: tuple[str, ...],
    outcome: str,
    *,
    group: int = 0,
    undetectable: str = "",
    remains: str = "",
) -> Case:
    return Case("freight", Fault(kind, group or "", 800, 1_000), fires, outcome, undetectable, remains)


CASES: tuple[Case, ...] = (
    _metro("odometer silent", (*_SILENT, "reflector: nothing to rely on", "odometry: hand over to rear device"),
           "balises and reflectors, which hear that odometer, withdraw; odometry goes on with the other device and radar"),
    _metro("odometer slides", (*_SLIDES, "reflector: nothing to rely on"),
           "the wheel measures a quarter too little: refused as it begins, then the radar's surplus is added to the error"),
    _metro("radar blind", ("reflector: balise too coarse for a self-test",),
           "no echo comes as the group is read, and later the position is too coarse to test the radar by: it is not used", begin=300),
    _metro("radar shifted", ("reflector: self-test failed at the balise",),
           "60 m too far: the self-test against the reference reflector fails, the radar is not used", begin=300),
    _metro("marker misplaced", ("odometry: trailing reading at rear",),
           "a marker read with its neighbour's identity lies outside the window and is refused; the rear reader's counts"),
    _metro("balise corrupted", (*_BALISE_UNREAD, "balise: telegram rejected"), "rejected; nothing is narrowed by it", group=4),
    _metro("balise missed", _BALISE_UNREAD, "the margin grows until the next group", group=4),
    _metro("balise displaced", _BALISE_UNREAD, "a group that lies 140 m further is found outside its window", group=4),
    _metro("balise turned", ("balise: group passed in the wrong direction",), "a group read the wrong way round is refused; the third in a row would end the position", group=4),
    _metro("uplink silent", ("uplink: report has become too old",), "the trackside knows nothing after a second"),
    _main("odometer silent", _SILENT, "satellites and odometry's radar go on; balises withdraw"),
    _main("odometer slides", _SLIDES, "both units' difference is added to the error; balises withdraw; satellites go on"),
    _main("satellites lost", ("selection: no satellite is usable",), "odometry leads until satellites are back"),
    _main("multipath", ("selection: satellites are selected",), "the one channel is excluded; the others locate on"),
    _main("spoofing", ("position: tolerance exceeded",), "solutions that no more meet the prediction are refused",
          undetectable=SPOOFED),
    _main("marker misplaced", ("odometry: tolerance exceeded",), "refused; odometry withdraws when its margin is used up"),
    _main("balise corrupted", (*_BALISE_UNREAD, "balise: telegram rejected"), "rejected; others go on", group=7),
    _main("balise missed", _BALISE_UNREAD, "the margin grows; others lead", group=7),
    _main("balise displaced", _BALISE_UNREAD, "found outside its window, or too late for it; others lead", group=7),
    _main("uplink silent", ("uplink: report has become too old",), "the trackside knows nothing after a second"),
    _freight("odometer silent", _SILENT, "satellites and the fibre go on; balises withdraw"),
    _freight("odometer slides", _SLIDES, "both units' difference is added to the error; balises withdraw; satellites and the fibre go on"),
    _freight("satellites lost", ("arbitration: fibre takes over",), "fibre and balises lead, whichever is narrower"),
    _freight("multipath", ("selection: satellites are selected",), "the one channel is excluded; the others locate on"),
    _freight("spoofing", ("position: tolerance exceeded",),
             "solutions that no more meet the prediction are refused; the fibre leads on", undetectable=SPOOFED),
    _freight("fibre miscount", ("verification: mismatch", "downlink: report revokes"),
             "the counter's axles are not the fibre's: untrusted, and its position never comes on board"),
    _freight("fibre error", ("verification: mismatch", "downlink: report revokes"),
             "error signal F: the reported position is revoked, on board in the same cycle"),
    _freight("downlink silent", ("downlink: report has become too old",), "the fibre's position ages and is withdrawn"),
    _freight("balise corrupted", (*_BALISE_UNREAD, "balise: telegram rejected"), "rejected; satellites lead", group=6),
    _freight("balise missed", _BALISE_UNREAD, "the margin grows; satellites lead", group=6),
    _freight("balise displaced", _BALISE_UNREAD, "found outside its window, or too late for it; satellites lead", group=6),
    _freight("uplink silent", ("uplink: report has become too old",), "the trackside knows nothing after a second"),
    _freight("other branch taken", (*_UNANNOUNCED, "verification: train has left"),
             "no group of that branch is accepted, the one expected is missed; the fibre ends trust at the switch, satellites "
             "stay withheld: balises withdraw last, and no source comes back", remains=_BRANCH),
    _freight("linking not replaced", _UNANNOUNCED,
             "no group of the route is in the linking: refused, the one expected is missed, balises withdraw and satellites stay "
             "withheld; the fibre goes on, and past it nothing is left", remains=_BRANCH),
)  # fmt: skip


def pairs(journey: str) -> Iterator[tuple[Case, Case]]:
    """Yield every pair of different cases on one journey."""
    yield from combinations([case for case in CASES if case.journey == journey], 2)
