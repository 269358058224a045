"""Simulated runs over linked and unlinked balise groups, as steps of the machine of the unlinked group, with the true distance.

The run is one of the balise machine: same motion, same odometer, same telegrams. What of them the machine of the unlinked group
reads is passed on.

`python -m safeloc.models.unlinked_group.simulate` writes the runs that ship.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from safeloc.language.units import NM_PER_MM
from safeloc.models.balise.groups import Group
from safeloc.models.balise.simulate import line, vehicle_of
from safeloc.models.balise.simulate import simulate as over_groups
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.unlinked_group.limits import at_the_limits
from safeloc.models.unlinked_group.variables import UnlinkedGroupConfig
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_named
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg, Motion, move, plan

_COMMON = (
    "odometer", "period_ms", "max_speed_mm_s", "max_acceleration_mm_s2", "measuring_step_mm", "gap_limit_cycles", "reversal_mm",
    "antenna_mm", "detection_mm", "default_accuracy_mm", "telegram_age_limit_ms", "last_group_identity",
)  # fmt: skip
"""Figures of the vehicle that both machines have."""
READ = (
    "odometer_mm", "national_accuracy_mm", "telegram_group", "telegram_link", "telegram_check", "telegram_total", "telegram_read",
    "telegram_first", "telegram_last", "telegram_age_ms", "telegram_since_mm",
)  # fmt: skip
"""Inputs of the balise machine that the machine of the unlinked group reads as well."""
PASSED_ON = ("true_cycle_distance_nm", "odometer_next_wander_nm", "true_since_nm", "reading_wander_nm")


def beside(config: UnlinkedGroupConfig) -> BaliseConfig:
    """Return the configuration of the balise machine of the same vehicle."""
    return BaliseConfig.model_validate({name: getattr(config, name) for name in _COMMON})


def mixed_line(first_mm: int = 100_000, spacing_mm: int = 150_000, count: int = 60) -> list[Group]:
    """Return a line of groups of which every third one is unlinked; such a group has two to four balises."""
    groups = line(first_mm, spacing_mm, count)
    return [replace(one, linked=False, balises=max(2, one.balises)) if one.identity % 3 == 2 else one for one in groups]


def simulate(
    config: UnlinkedGroupConfig,
    *,
    seed: int,
    seconds: float = 300.0,
    groups: Sequence[Group] | None = None,
    legs: Sequence[Leg] | None = None,
    dropout: float = 0.01,
    missed: float = 0.03,
    foreign: float = 0.002,
    faults: Sequence[Fault] = (),
    sensor_faults: Sequence[Fault] = (),
) -> Steps:
    """Return one run as steps: inputs and ghost inputs, from which the true distance follows.

    groups  those that the vehicle passes, linked and unlinked
    legs    the run; without it, a random service with reversals
    dropout, missed, foreign  the share of distances that are not measured, of groups that are not read, and of cycles with a
                              group of another track
    faults  named faults of groups, as of the balise machine
    sensor_faults  named faults of `odometer`
    """
    vehicle = beside(config)
    rng = np.random.default_rng(seed + 1_000_000)
    motion = move(vehicle_of(vehicle), legs or plan(vehicle_of(vehicle), seconds, rng), config.period_ms)
    known = mixed_line() if groups is None else groups
    steps = over_groups(
        vehicle, seed=seed, groups=known, motion=motion, dropout=dropout, missed=missed, foreign=foreign, faults=faults,
        sensor_faults=sensor_faults,
    )  # fmt: skip
    return [_passed_on(config, motion, number, step) for number, step in enumerate(steps)]


def _passed_on(config: UnlinkedGroupConfig, motion: Motion, number: int, step: Mapping[str, Cell]) -> dict[str, Cell]:
    """Return the part of a step that the machine reads, and the ghosts: the place read becomes the antenna's distance beyond it."""
    inputs = {name: step[name] for name in READ if name in step}
    antenna = int(motion.position_nm[number]) - int(step["true_since_nm"]) - config.antenna_mm * NM_PER_MM
    beyond = antenna - int(step["read_place_nm"])
    return {**inputs, **{name: step[name] for name in PASSED_ON}, "read_beyond_nm": beyond}


# ------------------------------------------------------------------ named runs


@dataclass(frozen=True)
class _Run:
    """A named run: its legs, which of the groups are unlinked, faults of groups, and those of the odometer."""

    legs: Sequence[Leg]
    unlinked: Sequence[int]
    faults: Sequence[Fault] = ()
    sensor_faults: Sequence[Fault] = ()
    dropout: float = 0.0

    def steps(self, config: UnlinkedGroupConfig) -> Steps:
        """Make the run over groups 250 m apart."""
        groups = [
            replace(one, linked=one.identity not in self.unlinked, balises=max(2, one.balises), accuracy_mm=3_000)
            for one in line(60_000, 250_000, 40)
        ]
        return simulate(
            config,
            seed=3,
            groups=groups,
            legs=self.legs,
            missed=0,
            foreign=0,
            faults=self.faults,
            sensor_faults=self.sensor_faults,
            dropout=self.dropout,
        )


_ALONG = (Leg(30_000, 60),)
_FAULTY = (Fault("corrupted", 2), Fault("incomplete", 3), Fault("stale", 4), Fault("malformed", 5), Fault("missed", 6))


def _worked(outcome: str, run: _Run) -> WorkedRun[UnlinkedGroupConfig]:
    return WorkedRun(outcome, run.steps)


RUNS: Mapping[str, WorkedRun[UnlinkedGroupConfig]] = {
    "unlinked_group-service": _worked(
        "Linked groups pass between two unlinked ones and change nothing; each unlinked one is the reference from its reading on.",
        _Run(_ALONG, (2, 5), dropout=0.01),
    ),
    "unlinked_group-faulty-groups": _worked(
        "Unlinked groups that are damaged, incomplete, old, malformed and missed follow a good one, which stays the reference until "
        "the next good one.",
        _Run((Leg(30_000, 80),), (1, 2, 3, 4, 5, 6, 7), _FAULTY),
    ),
    "unlinked_group-rolled-back": _worked(
        "The vehicle stops, runs back for more than D_NVROLL and loses its reference; going forwards again it takes the next "
        "unlinked group.",
        _Run((Leg(20_000, 30), Leg(0, 30), Leg(-3_000, 10), Leg(0, 10), Leg(20_000, 60)), (1, 3, 5)),
    ),
    "unlinked_group-silent-odometer": _worked(
        "The odometer is silent for a second: the reference is withdrawn after half a second; the next unlinked group is a new one.",
        _Run(_ALONG, (1, 4), sensor_faults=(Fault("drop-out", "odometer", 250, 260),)),
    ),
    "unlinked_group-far-behind": _worked(
        "Distances are missing now and then: two kilometres beyond the only unlinked group a margin exceeds the tolerance, and the "
        "reference is withdrawn.",
        _Run((Leg(39_000, 130),), (1,), dropout=0.02),
    ),
    "unlinked_group-at-the-limits": WorkedRun(
        "Every distance and every reading is as wrong as the laws allow: each group is taken, and the truth lies at an end of its "
        "interval.",
        at_the_limits,
        {"odometer_wander_nm": 0, "true_distance_nm": 0},
    ),
}
"""The recordings that ship, by name."""


if __name__ == "__main__":
    write_named(__file__, RUNS, {}, UnlinkedGroupConfig())
