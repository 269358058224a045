"""Configuration of reflectors with the route: its machines, and the figures that they share."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import quantity
from safeloc.models.reflector_device.configuration import AnchoredConfig, ReflectorDeviceConfig
from safeloc.models.route.variables import RouteConfig
from safeloc.models.stop_point.variables import StopPointConfig
from safeloc.models.turn_off import TurnOffConfig

MOST_ROUTES = 4
"""The most routes that are carried beside each other."""


class ReflectorRouteConfig(AnchoredConfig):
    """One vehicle with odometer, balise reader and radar, its course at switches and the routes on which it may be."""

    turn_off: TurnOffConfig = TurnOffConfig()
    route: RouteConfig = RouteConfig(routes=MOST_ROUTES, start_error_mm=20_000)
    sighting_error_mm: int = quantity(
        10_000, "mm", 0, 50_000, "[D] beyond an echo's own error: the radar's systematic error, 2.3 m run in its latency, survey"
    )  # fmt: skip
    own_track_range_mm: int = quantity(
        20_000, "mm", 0, 300_000, "[D] as near as that a curve of 300 m moves an image by 0.7 m; 0: no echo is told to be by the own track"
    )  # fmt: skip
    own_track_right_mm: int = quantity(
        -4_000, "mm", -50_000, 50_000, "[D] reflectors stand 2.5 m to the right of the axis, less curve and radar; left is positive"
    )  # fmt: skip
    own_track_left_mm: int = quantity(
        -1_000, "mm", -50_000, 50_000, "[D] as own_track_right_mm; those of a track 4 m away stand beyond, on either side"
    )  # fmt: skip

    @model_validator(mode="after")
    def _one_vehicle(self) -> ReflectorRouteConfig:
        moves, own = self.vehicle.motion, self.route
        if own.routes > MOST_ROUTES:
            raise ValueError(f"route.routes is {own.routes}: no more than {MOST_ROUTES} are carried; lower it.")
        if own.range_limit_mm < self.reflector.range_limit_mm:
            raise ValueError(
                f"route.range_limit_mm {own.range_limit_mm} is below reflector.range_limit_mm {self.reflector.range_limit_mm}: "
                "an echo from farther away would be no sighting; raise it."
            )
        wanted = {
            "odometer": moves.reported_law,
            "checked_distance": moves.check is not None,
            "tolerance_mm": self.reflector.tolerance_mm,
            **{
                figure: getattr(moves, figure)
                for figure in (
                    "period_ms", "max_speed_mm_s", "max_acceleration_mm_s2", "measuring_step_mm", "gap_limit_cycles",
                )
            },
        }  # fmt: skip
        line = {"position_limit_mm": moves.position_limit_mm}
        for name, config, figures in (("route", own, wanted), ("turn_off", self.turn_off, line)):
            for figure, value in figures.items():
                if getattr(config, figure) != value:
                    raise ValueError(
                        f"{name}.{figure} is {getattr(config, figure)}, but the vehicle's is {value} (motion, reflector); make "
                        "them the same."
                    )
        return self

    @model_validator(mode="after")
    def _own_side(self) -> ReflectorRouteConfig:
        if self.own_track_right_mm > self.own_track_left_mm:
            raise ValueError(
                f"own_track_right_mm {self.own_track_right_mm} is to the left of own_track_left_mm {self.own_track_left_mm}: no image would "
                "stand by the own track; exchange them, or set own_track_range_mm to 0."
            )
        return self

    @property
    def device(self) -> ReflectorDeviceConfig:
        """The reflector device of the same vehicle, which the simulation drives along the line."""
        return ReflectorDeviceConfig(
            motion=self.motion,
            balise=self.balise,
            reflector=self.reflector,
            turn_off=self.turn_off,
            stop=StopPointConfig(
                position_limit_mm=self.motion.position_limit_mm,
                max_speed_mm_s=self.motion.max_speed_mm_s,
                tolerance_mm=self.reflector.tolerance_mm,
            ),
        )
