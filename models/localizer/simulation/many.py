"""Many localizers on one of the example journeys, for campaigns: every vehicle draws its own errors and times of faults."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from safeloc.errors import InputError
from safeloc.language.system import TransitionSystem
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer.simulation.journey import OF_THE_ROUTE, Vehicles
from safeloc.models.localizer.simulation.journeys import NOMINAL
from safeloc.models.localizer.simulation.simulate import KINDS, first_state
from safeloc.models.localizer.simulation.sources import Fleet
from safeloc.simulation.faults import Kinds
from safeloc.simulation.many_runs import Drawn, DrawnFigure, ManyRuns, joined
from safeloc.simulation.motion import Leg


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
        return {"satellites": DrawnFigure("satellites", 0, 32, NOMINAL[self.line].satellites, "satellites in view")}

    @property
    def kinds(self) -> Mapping[str | int, Kinds]:
        """The journey itself, and each balise group by its identity."""
        return {"": KINDS, **{group.identity: KINDS for group in NOMINAL[self.line].groups}}

    @property
    def timeless(self) -> Collection[str | int]:
        """None: a journey's fault of a group takes a time and does not heed it."""
        return ()

    def runs(self, drawn: Drawn, cycles: int, rng: np.random.Generator) -> ManyRuns:
        """Return the runs of the vehicles."""
        seeds, nominal = rng.integers(0, 2**31, drawn.vehicles).tolist(), NOMINAL[self.line]
        nominal = replace(nominal, legs=_for_seconds(nominal.legs, cycles * self.period_ms / 1_000))
        satellites = np.rint(drawn.figures["satellites"]).astype(np.int64).tolist()
        alike: dict[frozenset[str], list[int]] = {}
        for run, faults in enumerate(drawn.faults):
            KINDS.require(faults)
            alike.setdefault(frozenset(one.kind for one in faults if one.kind in OF_THE_ROUTE), []).append(run)
        parts = []
        for which in alike.values():
            journeys = [replace(nominal, satellites=satellites[run], troubles=drawn.faults[run]) for run in which]
            vehicles = Vehicles(self.config, journeys, [seeds[run] for run in which])
            inputs = Fleet(vehicles, self.system, self.libraries).inputs()
            parts.append((np.array(which), ManyRuns({name: values[:cycles] for name, values in inputs.items()})))
        return ManyRuns(joined(parts, drawn.vehicles).inputs, first_state(self.config, nominal))


def _for_seconds(legs: Sequence[Leg], seconds: float) -> list[Leg]:
    """Return the legs of the first seconds; a vehicle whose journey ends before stands where it ends."""
    kept: list[Leg] = []
    for leg in legs:
        if seconds > 0:
            kept.append(replace(leg, seconds=min(leg.seconds, seconds)))
        seconds -= leg.seconds
    return [*kept, Leg(0, seconds)] if seconds > 0 else kept
