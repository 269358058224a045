"""The vehicle's own movement: the odometer that all ways of locating on board share, and the true position of the vehicle.

    SILENT     there was no usable distance for longer than permitted
    MEASURING  distances come, or are missing for no longer than permitted

`distance_mm` is the distance estimated for the cycle: the measured one if it is reported, else 0; no guess takes the place of a
missing distance. Without a check unit this machine assumes no error law: each machine that uses the distance adds the error of
its own law, and assumes that the odometer keeps it.

With a check unit, which measures the same distance by another principle, only one of the two is assumed to keep its law, and
it is unknown which (safeloc.models.motion.unit_check). The machine reports a distance where both units measured, and with it
`more_nm`, the error to add beyond the law `MotionConfig.reported_law`. It is proved that both together cover the error, whatever the
other unit does.
"""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import Field, model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import TRUE, Bool, Expr, Lit, Optional, Var, number
from safeloc.language.machine import Model, Transition, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import MM
from safeloc.models.motion.reported_error import lemmas, with_reported_error
from safeloc.models.motion.unit_check import UnitCheck, reported_law, unit_check
from safeloc.models.motion.unmeasured import Unmeasured
from safeloc.models.motion.world import Surroundings, ghosts, initially, world
from safeloc.models.vocabulary.error_law import MOST_RATE_PPM, WHEEL, ErrorLaw
from safeloc.models.vocabulary.measured import ADMITTED, Limits
from safeloc.models.vocabulary.measuring_world import Physics
from safeloc.models.vocabulary.odometer import odometer

__all__ = ["Motion", "MotionConfig", "Parts", "build", "parts"]
REQUIREMENTS = ("MRK-4", "MRK-D1")


class MotionConfig(Config):
    """Limits of the vehicle's movement, its odometer, and the unit that checks it, if there is one."""

    odometer: ErrorLaw = WHEEL
    check: ErrorLaw | None = None
    band_mm: int = quantity(100, "mm", 0, 50_000, "[D] what two units jitter against each other: some measuring steps")
    period_ms: int = quantity(100, "ms", 10, 1_000, "[S] SUBSET-041: application cycle up to 100 ms")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    max_acceleration_mm_s2: int = quantity(2_500, "mm/s2", 1, 10_000, "[M] 2.5 m/s2 with track brake")
    measuring_step_mm: int = quantity(14, "mm", 0, 10_000, "[S] 100 pulses a turn: 13.4 mm")
    between_pulses_mm: int = quantity(
        20,
        "mm",
        0,
        10_000,
        "[D] the farthest that a vehicle gets between two pulses: 13.4 mm, while the wheel slides by a third",
    )
    standing_believed: bool = Field(
        default=True,
        description="the vehicle counts as standing, and stays between two pulses of the odometer, where the odometer measures nothing and the check unit no more than its floor",
    )
    creep_mm_s: int = quantity(
        0, "mm/s", 0, 10_000, "[M] 0: a vehicle that counts as standing does not creep on past the next pulse"
    )
    gap_limit_cycles: int = quantity(5, "cycles", 0, 1_000, "[D] 0.5 s without any distance")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")

    @model_validator(mode="after")
    def _can_check(self) -> MotionConfig:
        if self.check is None:
            return self
        if self.creep_mm_s and not self.standing_believed:
            raise ValueError(
                f"creep_mm_s is {self.creep_mm_s}, but standing_believed is false: a creep is added only to a vehicle that counts "
                "as standing; leave one of them out."
            )
        if self.standing_believed and self.between_pulses_mm < self.measuring_step_mm:
            raise ValueError(
                f"between_pulses_mm is {self.between_pulses_mm}, less than measuring_step_mm {self.measuring_step_mm}: an odometer "
                "that measures nothing misses up to one step; state at least that, or set standing_believed to false."
            )
        for name, law in (("odometer", self.odometer), ("check", self.check)):
            if law.drift_mm_s2:
                raise ValueError(f"{name}.drift_mm_s2 must be 0: units are compared that count distance.")
            if law.rate_ppm > MOST_RATE_PPM or law.floor_mm_s > self.max_speed_mm_s:
                raise ValueError(
                    f"{name}.rate_ppm must not exceed {MOST_RATE_PPM}, nor its floor_mm_s max_speed_mm_s "
                    f"{self.max_speed_mm_s}: such a unit measures no distance."
                )
        return self

    @property
    def reported_law(self) -> ErrorLaw:
        """The error law of the reported distance, without the error that is reported beyond it."""
        return (
            self.odometer
            if self.check is None
            else reported_law(self.odometer, self.check, self.band_mm, self.unmeasured)
        )

    @property
    def physics(self) -> Physics:
        """The world's figures of the vehicle's movement and its measurement."""
        return Physics.of(self)

    @property
    def unmeasured(self) -> Unmeasured | None:
        """The most that a vehicle runs which counts as standing; None where none counts as standing."""
        return Unmeasured(self.creep_mm_s, self.between_pulses_mm) if self.standing_believed else None

    @property
    def limits(self) -> Limits:
        """Limits of the odometer, rounded so that the checks are no tighter than physics."""
        return Limits.of(self, 1, self.position_limit_mm)


class Parts:
    """The variables of the machine and its world.

    odometer, check   the units: inputs, and state of their checks
    distance          state: the distance estimated for the cycle
    ghosts            of the world
    """

    def __init__(self, config: MotionConfig) -> None:
        self.declared = declared = Declared()
        self.config, limits = config, config.limits
        farthest, check = limits.max_cycle_distance_mm, config.check
        self.odometer = odometer(config.odometer, limits).declare(declared)
        self.check = None
        if check is not None:
            self.check = unit_check(declared, self.odometer, check, config.band_mm, config.unmeasured)
        self.distance = declared.state(number("distance_mm", MM, -farthest, farthest), first=0)
        laws = None if check is None else (config.odometer, check)
        line, reported = config.position_limit_mm, config.reported_law
        self.ghosts = ghosts(declared, config.physics, line, laws, reported, config.unmeasured)

    @property
    def around(self) -> Surroundings:
        """The ghosts with the inputs and figures that the world reads."""
        check = None if self.check is None else self.check.unit
        return Surroundings(self.ghosts, self.config.physics, self.odometer, check, self.config.unmeasured)

    @property
    def reported(self) -> Bool:
        """The cycle's distance is reported."""
        return self.odometer.admitted if self.check is None else self.check.checked

    @property
    def failed(self) -> Bool:
        """No distance was reported for longer than permitted."""
        return self.odometer.failed if self.check is None else self.check.failed

    @property
    def inputs(self) -> list[Optional]:
        """The measured distances."""
        return [self.odometer.measured] if self.check is None else [self.odometer.measured, self.check.unit.measured]


class Motion(Model[Parts]):
    """The machine together with the terms it was built from."""

    @property
    def reported(self) -> Bool:
        """After the step: the cycle's distance is reported."""
        return self.own.odometer.last_verdict.eq(ADMITTED) if self.own.check is None else self.own.check.reported

    @property
    def shared(self) -> list[Var]:
        """Ghosts that the machines that use the distance share with this one."""
        seen = self.own.ghosts
        return [
            seen.truth,
            seen.true_cycle_distance,
            *([] if seen.units is None else (seen.units.reported, seen.units.next_reported)),
        ]


def parts(config: MotionConfig) -> Parts:
    """Declare the variables of one vehicle."""
    return Parts(config)


def build(own: Parts) -> Motion:
    """Build the machine over the given variables."""
    table = modes("SILENT", "MEASURING")
    around = world(own.declared, own.around)
    made = own.declared.machine(
        name="motion",
        modes=table,
        outputs=_outputs(own),
        transitions=list(_rows(own, table)),
        world=around if own.check is None else with_reported_error(around, own.around, own.check),
        initially=initially(own.around),
        lemmas={} if own.check is None else lemmas(own.around, own.check),
        doc=(
            "The vehicle's odometer, which reports only distances that the vehicle can have run, and the true movement: no "
            "faster than the highest speed, and on the line. With a check unit one of the two units, unknown which, is assumed to "
            "keep its law; and, unless configured otherwise, the vehicle is assumed to stay between two pulses where the odometer "
            "measures nothing and the check unit no more than its floor; each distance comes with its error bound. Without a check unit the "
            "machines that use the distance assume its error law."
        ),
    )
    return Motion(made, own)


def _rows(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    silent, measuring = table
    distance = own.odometer.distance if own.check is None else own.check.distance
    every = together(own.odometer.listen(), *_checked(own.check), {own.distance: distance})
    agree = TRUE if own.check is None else ~own.check.disagree
    yield Transition("distance reported", table, measuring, own.reported & agree, every, ("MRK-4",), 0)
    if own.check is not None:
        yield Transition("units disagree", table, measuring, own.check.disagree, every, REQUIREMENTS, 0)
        alone = own.check.alone & ~own.failed
        yield Transition("distance without its check", measuring, measuring, alone, every, REQUIREMENTS, 1)
    yield Transition("silent too long", measuring, silent, own.failed, every, ("MRK-D1",), 1)
    yield Transition("distance missing", measuring, measuring, TRUE, every, ("MRK-D1",), 2)
    yield Transition("still silent", silent, silent, TRUE, every, ("MRK-D1",), 2)


def _checked(check: UnitCheck | None) -> Iterator[Updates]:
    """The check unit's distance, and the comparison of both, where there is such a unit."""
    if check is not None:
        yield check.unit.listen()
        yield {check.apart: check.apart_after, check.reported: check.checked, check.more: check.beyond}
        yield {check.unreported: check.unheard_after}


def _outputs(own: Parts) -> dict[str, Expr]:
    outputs: dict[str, Expr] = {"distance_mm": own.distance, "measured": own.odometer.last_verdict}
    if own.check is None:
        return outputs
    reported: dict[str, Expr] = {
        "reported": own.check.reported,
        "more_nm": own.check.more,
        "check_measured": own.check.unit.last_verdict,
    }
    return outputs | reported
