"""Worked journeys of the localizer, and what goes wrong on them: each with its outcome in words, checked by the tests."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from safeloc.models.balise_parts.groups import Group
from safeloc.models.localizer_streams import Journey, Stretch, Trouble
from safeloc.models.reflector_streams import Balise, Reflector, Route
from safeloc.simulation.motion import Leg

METRO = Journey(
    legs=[Leg(0, 2), Leg(15_000, 45), Leg(0, 30)],
    markers=[(number, number * 100_000) for number in range(1, 9)],
    groups=[Group(number, number * 150_000 - 130_000) for number in range(1, 7)],
    reflectors=Route((Balise(1, 170_000), Balise(2, 470_000)), (Reflector(250_000, "A", 80_000), Reflector(640_000, "B", 150_000))),
    dark=[Stretch(-1_000_000, 10_000_000)],
    length_mm=40_000,
)
"""A metro train into a station, all in a tunnel: markers, balises, and radar reflectors where it has to stop."""

MAIN_LINE = Journey(
    legs=[Leg(0, 2), Leg(38_000, 90), Leg(0, 60)],
    markers=[(number, number * 500_000) for number in range(1, 9)],
    groups=[Group(number, number * 300_000 - 200_000) for number in range(1, 16)],
    dark=[Stretch(1_400_000, 2_100_000)],
    length_mm=200_000,
)
"""A main line train, satellites in view but for a tunnel of 700 m."""

FREIGHT = Journey(
    legs=[Leg(0, 2), Leg(22_000, 120), Leg(0, 60)],
    groups=[Group(number, number * 300_000 - 220_000) for number in range(1, 14)],
    dark=[Stretch(2_200_000, 2_300_000)],
    fibre=Stretch(500_000, 2_000_000),
    axles=44,
    length_mm=205_000,
    acceleration_mm_s2=400,
)
"""A freight train through a fibre-equipped area with a junction, entered over an axle counter."""

NOMINAL: Mapping[str, Journey] = {"metro": METRO, "main-line": MAIN_LINE, "freight": FREIGHT}
