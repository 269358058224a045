"""Many localizers on one of the example journeys, for campaigns: every vehicle draws its own motion, errors and times of faults."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from safeloc.errors import InputError
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer.simulation.journey import OF_THE_ROUTE, PHYSICS, Journey, Vehicles, speeds_um_s
from safeloc.models.localizer.simulation.journeys import NOMINAL
from safeloc.models.localizer.simulation.simulate import FIRST_SPEED, KINDS, first_but_speed
from safeloc.models.localizer.simulation.sources import Fleet
from safeloc.simulation.faults import Kinds
from safeloc.simulation.many_runs import Array, Drawn, DrawnFigure, ManyRuns, joined
from safeloc.simulation.motion import Leg

TOP, ACCELERATION, STANDS = "speed_share", "acceleration_share", "stands"
"""Figures of the motion."""


def require_journey(name: str) -> None:
    """Refuse the name of a journey that there is not."""
    if name not in NOMINAL:
        raise InputError(f"the localizer has no journey {name!r}; it has {', '.join(NOMINAL)}.")


@dataclass(frozen=True, eq=False)
class LocalizerJourneys:
    """Localizers on one journey; `line` is its name, `system` the localizer with its world.

    libraries  folder for compiled machines; None: a temporary one
    """

    config: LocalizerConfig
    system: TransitionSystem
    line: str
    libraries: Path | None = None

    @property
    def period_ms(self) -> int:
        """The length of a cycle."""
        return self.config.motion.period_ms

    @property
    def figures(self) -> Mapping[str, DrawnFigure]:
        """The figures that may be drawn, by name."""
        return {
            "satellites": DrawnFigure("satellites", 0, 32, NOMINAL[self.line].satellites, "satellites in view"),
            TOP: DrawnFigure("share", 0.05, 1, 1.0, "share of the journey's speeds at which it drives"),
            ACCELERATION: DrawnFigure("share", 0.2, 1.5, 1.0, "share of the journey's acceleration and braking"),
            STANDS: DrawnFigure("cycles", 0, 100_000, 0.0, "how long it stands before it leaves"),
            **PHYSICS,
        }

    @property
    def kinds(self) -> Mapping[str | int, Kinds]:
        """The journey itself, and each balise group by its identity."""
        return {"": KINDS, **{group.identity: KINDS for group in NOMINAL[self.line].groups}}

    @property
    def timeless(self) -> Collection[str | int]:
        """None: a journey's fault of a group takes a time and does not heed it."""
        return ()

    def runs(self, drawn: Drawn, cycles: int) -> ManyRuns:
        """Return the runs of the vehicles."""
        journeys = [self._journey(drawn, run, cycles) for run in range(drawn.vehicles)]
        alike: dict[frozenset[str], list[int]] = {}
        for run, faults in enumerate(drawn.faults):
            KINDS.require(faults)
            alike.setdefault(frozenset(one.kind for one in faults if one.kind in OF_THE_ROUTE), []).append(run)
        parts, chosen = [], dict[str, Array]()
        speeds = np.zeros(drawn.vehicles, dtype=np.int64)
        for which in alike.values():
            vehicles = Vehicles(self.config, [journeys[run] for run in which], [drawn.seeds[run] for run in which])
            runs = Fleet(vehicles, self.system, self.libraries).runs()
            parts.append((np.array(which), ManyRuns(runs.inputs)))
            speeds[which] = speeds_um_s(vehicles.motions)[0]
            for name, values in runs.first.items():
                chosen.setdefault(name, np.zeros(drawn.vehicles, dtype=np.int64))[which] = values
        first: dict[str, Array | Value] = {**first_but_speed(self.config, journeys[0]), **chosen}
        if "satellite" in self.config.arbitration.sources:
            first[FIRST_SPEED] = speeds
        return ManyRuns(joined(parts, drawn.vehicles).inputs, first)

    def _journey(self, drawn: Drawn, run: int, cycles: int) -> Journey:
        """Return the journey of a vehicle with what was drawn for it."""
        nominal, figures = NOMINAL[self.line], {name: float(values[run]) for name, values in drawn.figures.items()}
        speed, stands = figures[TOP], round(figures[STANDS])
        legs = [replace(leg, speed_mm_s=round(leg.speed_mm_s * speed)) for leg in nominal.legs]
        return replace(
            nominal,
            legs=_for_cycles(
                [Leg(0, stands * self.period_ms / 1_000), *legs] if stands else legs, cycles, self.period_ms
            ),
            satellites=round(figures["satellites"]),
            acceleration_mm_s2=max(1, round(nominal.acceleration_mm_s2 * figures[ACCELERATION])),
            troubles=drawn.faults[run],
            physics={name: figures[name] for name in PHYSICS if name in figures},
        )


def _for_cycles(legs: Sequence[Leg], cycles: int, period_ms: int) -> list[Leg]:
    """Return the legs of the first cycles; a vehicle whose journey ends before stands where it ends."""
    kept: list[Leg] = []
    for leg in [*legs, Leg(0, cycles * period_ms / 1_000)]:
        taken = min(max(1, round(leg.seconds * 1_000 / period_ms)), cycles)
        if taken:
            kept.append(replace(leg, seconds=taken * period_ms / 1_000))
        cycles -= taken
    return kept
