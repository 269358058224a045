"""The vehicle of a marker device: its true movement, and the antenna of its receiver, which lies behind end A.

The machine computes nothing. It has the ghosts that the other machines share: where end A is, and where the antenna is.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import TRUE, NumVar, between, number
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.units import NM, NM_PER_MM
from safeloc.language.world import Law
from safeloc.models.guard.variables import reach_nm
from safeloc.models.marker_device.configuration import MarkerDeviceConfig
from safeloc.models.odometry.ghosts import Movement
from safeloc.models.vocabulary.vehicle_world import ON_THE_LINE, line_law

NAME = "vehicle"
DATA = "the antenna is where the data say"


@dataclass(frozen=True, eq=False)
class Antenna:
    """The machine, and where the antenna is.

    moved    ghosts: the true movement of end A
    place    ghost: the antenna's true place along the line, nm; it runs as end A does
    """

    machine: Machine
    moved: Movement
    place: NumVar


def antenna(config: MarkerDeviceConfig) -> Antenna:
    """Build the machine of the vehicle, with its movement."""
    declared, table, moved = Declared(), modes("MOVING"), _movement(config)
    truth, true_cycle_distance = declared.ghost(moved.truth, first=ANY), declared.choice(moved.true_cycle_distance)
    farthest = 2 * reach_nm(config.guard)  # as far as the guard's world lets a vehicle go
    place = declared.ghost(number("antenna_nm", NM, -farthest, farthest), first=ANY)
    laws = _laws(config, moved, place)
    made = declared.machine(
        name=NAME,
        modes=table,
        outputs={},
        transitions=[Transition("moves", table[0], table[0], TRUE, {}, ("MRK-D6",), 0)],
        world=declared.world(
            moves={truth: truth + true_cycle_distance, place: place + true_cycle_distance},
            clauses=laws,
        ),
        initially=laws[DATA].term,
        lemmas={"the antenna is behind end A": laws[DATA].term},
        doc="The true movement of end A, and of the antenna behind it. Assumed: the antenna is where the vehicle's data say.",
    )
    return Antenna(made, moved, place)


def _movement(config: MarkerDeviceConfig) -> Movement:
    line, farthest = config.farthest_mm * NM_PER_MM, config.odometry.max_speed_mm_s * config.odometry.period_ms * 1_000
    return Movement(number("truth_nm", NM, -line, line), number("true_cycle_distance_nm", NM, -farthest, farthest))


def _laws(config: MarkerDeviceConfig, moved: Movement, place: NumVar) -> dict[str, Law]:
    behind, slack = config.antenna_mm * NM_PER_MM, config.antenna_tolerance_mm * NM_PER_MM
    return {
        DATA: Law(
            between(behind - slack, moved.truth - place, behind + slack),
            "The antenna of the receiver is as far behind end A as the vehicle's data say, within their tolerance.",
            ("antenna_mm", "antenna_tolerance_mm"),
            "[D] drawing of the vehicle",
            "operator",
            "vehicle data entry; positions of the receiver against fixed markers at both readers",
        ),
        ON_THE_LINE: line_law(moved.truth, moved.truth + moved.true_cycle_distance),
    }
