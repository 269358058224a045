"""Configuration of the reflector device: its machines, and the figures that they share."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from pydantic import model_validator

from safeloc.config import CompositionConfig, Config, quantity
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.delocalized import DelocalizedConfig
from safeloc.models.localizer.configuration import LocalizerConfig
from safeloc.models.motion import MotionConfig
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.route.variables import RouteConfig
from safeloc.models.stop_point.variables import StopPointConfig
from safeloc.models.turn_off import TurnOffConfig

MOST_ROUTES = 4
"""The most routes that are carried beside each other."""


class AnchoredConfig(CompositionConfig):
    """One vehicle with odometer, balise reader and radar; what they share is said once, in `motion`, and must be the same in each."""

    motion: MotionConfig = MotionConfig()
    balise: BaliseConfig = BaliseConfig()
    reflector: ReflectorConfig = ReflectorConfig(last_balise_identity=16_777_216, reference_tolerance_mm=25_000)

    @property
    def vehicle(self) -> LocalizerConfig:
        """The same figures as those of a localizer of these machines; ValueError where they are not those of one vehicle."""
        return LocalizerConfig(
            sources=("balise", "reflector"),
            tolerance_mm=self.reflector.tolerance_mm,
            motion=self.motion,
            balise=self.balise,
            reflector=self.reflector,
        )

    @model_validator(mode="after")
    def _drawn_from_one_vehicle(self) -> AnchoredConfig:
        """Refuse figures of machines that are not those of one vehicle, or with which an accepted group is no reading of the reflector machine."""
        _ = self.vehicle
        return self

    @property
    def host(self) -> DelocalizedConfig:
        """The limits of what the host gets: those of the reflector machine."""
        own = self.reflector
        return DelocalizedConfig(tolerance_mm=own.tolerance_mm, position_limit_mm=own.position_limit_mm)


class ReflectorDeviceConfig(AnchoredConfig):
    """The vehicle with its course at switches, the routes on which it may be, and the stop at a platform."""

    turn_off: TurnOffConfig = TurnOffConfig()
    route: RouteConfig = RouteConfig(routes=MOST_ROUTES, start_error_mm=20_000)
    stop: StopPointConfig = StopPointConfig()
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

    passing_range_mm: int = quantity(
        30_000, "mm", 1, 300_000, "[D] a view zone ends 5 m before its reflector, and 4.5 m are run in a cycle; the rest is spare"
    )  # fmt: skip

    @model_validator(mode="after")
    def _one_vehicle(self) -> ReflectorDeviceConfig:
        for name, config, figures in self._shared_figures():
            for figure, value in figures.items():
                if getattr(config, figure) != value:
                    raise ValueError(
                        f"{name}.{figure} is {getattr(config, figure)}, but the vehicle's is {value} (motion, reflector); make "
                        "them the same."
                    )
        return self

    def _shared_figures(self) -> Iterator[tuple[str, Config, Mapping[str, object]]]:
        """Yield, for each machine, the figures in which it has to be of the one vehicle."""
        moves = self.vehicle.motion
        line, tolerance = {"position_limit_mm": moves.position_limit_mm}, {"tolerance_mm": self.reflector.tolerance_mm}
        yield "turn_off", self.turn_off, line
        yield "stop", self.stop, {**line, **tolerance, "max_speed_mm_s": moves.max_speed_mm_s}
        physics = (
            "period_ms", "max_speed_mm_s", "max_acceleration_mm_s2", "measuring_step_mm", "gap_limit_cycles",
        )  # fmt: skip
        own = {"odometer": moves.reported_law, "checked_distance": moves.check is not None}
        yield "route", self.route, {**own, **tolerance, **{figure: getattr(moves, figure) for figure in physics}}

    @model_validator(mode="after")
    def _carried(self) -> ReflectorDeviceConfig:
        own = self.route
        if own.routes > MOST_ROUTES:
            raise ValueError(f"route.routes is {own.routes}: no more than {MOST_ROUTES} are carried; lower it.")
        if own.range_limit_mm < self.reflector.range_limit_mm:
            raise ValueError(
                f"route.range_limit_mm {own.range_limit_mm} is below reflector.range_limit_mm {self.reflector.range_limit_mm}: "
                "an echo from farther away would be no sighting; raise it."
            )
        return self

    @model_validator(mode="after")
    def _seen_before_it_is_passed(self) -> ReflectorDeviceConfig:
        own, cycle_mm = self.reflector, -(-self.reflector.max_speed_mm_s * self.reflector.period_ms // 1_000)
        least, most = own.near_range_mm + cycle_mm, own.range_limit_mm - own.radar_offset_mm
        if not least <= self.passing_range_mm < most:
            raise ValueError(
                f"passing_range_mm {self.passing_range_mm} must be at least {least} (reflector.near_range_mm and the run of a cycle, or a "
                f"reflector is passed unseen) and less than {most} (reflector.range_limit_mm ahead of the front end); change it."
            )
        return self

    @model_validator(mode="after")
    def _own_side(self) -> ReflectorDeviceConfig:
        if self.own_track_right_mm > self.own_track_left_mm:
            raise ValueError(
                f"own_track_right_mm {self.own_track_right_mm} is to the left of own_track_left_mm {self.own_track_left_mm}: no image would "
                "stand by the own track; exchange them, or set own_track_range_mm to 0."
            )
        return self
