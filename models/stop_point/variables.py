"""Configuration and variables of the stop-point machine."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    NumVar,
    Optional,
    boolean,
    choice,
    enumeration,
    members,
    number,
    optional,
)
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM, MM_S, NM, NM_PER_MM

ORDER = members("order", "NONE", "PROCEED", "BRAKE", "HOLD", "CREEP", "REVERSE")
NO_ORDER, PROCEED, BRAKE, HOLD, CREEP, REVERSE = ORDER
MODES = ("IDLE", "APPROACH", "BRAKING", "STOPPED", "SHORT", "CREEPING", "OVERRUN", "REPOSITIONING", "HELD")
REASON = members("stop_reason", "NONE", "NO_POSITION", "TOO_FAR", "TOO_COARSE", "NOT_AHEAD", "UNKNOWN_STOP")
NO_REASON, NO_POSITION, TOO_FAR, TOO_COARSE, NOT_AHEAD, UNKNOWN_STOP = REASON
_MOST_WINDOW_MM = 10_000


class StopPointConfig(Config):
    """Everything about vehicle and platform that the stop-point machine depends on."""

    stop_points: int = quantity(2, "count", 1, 16, "[S] source fig. 2: two; l. 81: several a platform")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")
    tolerance_mm: int = quantity(30_000, "mm", 1, 500_000, "[S] OCORA 7239: 30 m on main line")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    speed_error_mm_s: int = quantity(100, "mm/s", 0, 5_000, "[M] 0.36 km/h; SUBSET-041 asks for 2 km/h only")
    standstill_mm_s: int = quantity(50, "mm/s", 0, 1_000, "[D] below one pulse in 100 ms")
    brake_mm_s2: int = quantity(800, "mm/s2", 1, 5_000, "[S] service brake 0.8 to 1.0 m/s2")
    reaction_ms: int = quantity(1_500, "ms", 0, 10_000, "[M] until the brake acts, one cycle included")
    reduced_speed_mm_s: int = quantity(833, "mm/s", 1, 10_000, "[M] 3 km/h for repositioning")
    reposition_limit_mm: int = quantity(
        5_000, "mm", 0, 100_000, "[M] farther back only under the dispatcher's authority"
    )

    @model_validator(mode="after")
    def _can_move(self) -> StopPointConfig:
        if self.reduced_speed_mm_s <= self.speed_error_mm_s + self.standstill_mm_s:
            raise ValueError(
                "reduced_speed_mm_s must exceed speed_error_mm_s and standstill_mm_s together, or no movement is allowed."
            )
        return self


@dataclass(frozen=True, eq=False)
class MapStop:
    """Inputs: one stop point of the platform; absent where the map has none. Lengths in mm.

    position       place of end A when the vehicle has stopped
    before, after  length of the stop window on either side of it
    """

    position: Optional
    before: NumVar
    after: NumVar


class Parts:
    """The variables of the machine.

    valid      the position is valid; precise: a measurement gives it
    selected_stop   number of the stop point that the mission selects, from 1 on; absent: none
    permitted  the vehicle may move within the platform at reduced speed (dispatcher, doors, rear clear)
    departure  the stop is served, the vehicle may leave it
    released   the person in charge takes over: the stop is given up
    stop, before, after  place and window of the pending stop
    pending_number, served_number      numbers of the pending stop and of the one served last; 0: none
    to_go   distance to the pending stop, as shown
    run_out    ghost: distance that the vehicle still runs if the order to brake comes in the next cycle
    """

    def __init__(self, config: StopPointConfig) -> None:
        self.declared = declared = Declared()
        limit, fast = config.position_limit_mm, config.max_speed_mm_s
        reach, error = (limit + config.tolerance_mm) * NM_PER_MM, config.speed_error_mm_s
        self.config = config
        self.valid = declared.sensor(boolean("position_valid"))
        self.precise = declared.sensor(boolean("position_precise"))
        self.position = declared.sensor(number("position_mm", MM, -limit, limit))
        self.above = declared.sensor(number("margin_above_mm", MM, 0, config.tolerance_mm))
        self.below = declared.sensor(number("margin_below_mm", MM, 0, config.tolerance_mm))
        self.speed = declared.sensor(number("speed_mm_s", MM_S, -fast, fast))
        self.stops = tuple(_map_stop(declared, number_, limit) for number_ in range(1, config.stop_points + 1))
        self.selected_stop = declared.sensor(optional("selected_stop", COUNT, 1, config.stop_points))
        self.permitted = declared.sensor(boolean("reposition_permitted"))
        self.departure = declared.sensor(boolean("departure"))
        self.released = declared.sensor(boolean("released"))
        self.stop = declared.state(number("stop_mm", MM, -limit, limit), first=0)
        self.before = declared.state(number("before_mm", MM, 0, _MOST_WINDOW_MM), first=0)
        self.after = declared.state(number("after_mm", MM, 0, _MOST_WINDOW_MM), first=0)
        self.pending_number = declared.state(number("pending_number", COUNT, 0, config.stop_points), first=0)
        self.served_number = declared.state(number("served_number", COUNT, 0, config.stop_points), first=0)
        self.to_go = declared.state(number("to_go_mm", MM, -2 * limit, 2 * limit), first=0)
        self.reason = declared.state(choice("held_reason", enumeration(REASON)), first=NO_REASON)
        self.truth = declared.ghost(number("truth_nm", NM, -reach, reach), first=ANY)
        self.true_speed = declared.ghost(number("true_speed_mm_s", MM_S, -fast - error, fast + error), first=ANY)
        self.run_out = declared.ghost(number("run_out_nm", NM, 0, _longest_nm(config)), first=ANY)
        self.next_truth = declared.choice(number("next_truth_nm", NM, -reach, reach))
        self.next_true_speed = declared.choice(number("next_true_speed_mm_s", MM_S, -fast - error, fast + error))
        self.next_run_out = declared.choice(number("next_run_out_nm", NM, 0, _longest_nm(config)))


def parts(config: StopPointConfig) -> Parts:
    """Return fresh variables for one machine."""
    return Parts(config)


def _longest_nm(config: StopPointConfig) -> int:
    """Return the run-out from the highest speed, reaction included, nm."""
    fastest = config.max_speed_mm_s + config.speed_error_mm_s
    return (fastest * config.reaction_ms // 1_000 + fastest * fastest // (2 * config.brake_mm_s2) + 1) * NM_PER_MM


def _map_stop(declared: Declared, number_: int, limit_mm: int) -> MapStop:
    return MapStop(
        declared.sensor(optional(f"stop_{number_}_position_mm", MM, -limit_mm, limit_mm)),
        declared.sensor(number(f"stop_{number_}_before_mm", MM, 0, _MOST_WINDOW_MM)),
        declared.sensor(number(f"stop_{number_}_after_mm", MM, 0, _MOST_WINDOW_MM)),
    )
