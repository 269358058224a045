"""Echoes as the radar front end reports them, in whole numbers with bounds.

Each of a reflector's three corners alone gives bounds of range and sine of the nearest corner. The echo reports the hull of the
three, which contains the true place as long as one of them does.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.units import NM_PER_MM
from safeloc.sensing.corners import nearest
from safeloc.sensing.figures import RadarConfig
from safeloc.sensing.images import in_cdb
from safeloc.sensing.interpolation import Points
from safeloc.sensing.range_law import section_cdbsm
from safeloc.sensing.rounding import ExactBounds, hull, outward
from safeloc.sensing.sensor_errors import range_nm, sine_ppb
from safeloc.sensing.signature import Doubt, Group, Model, Spots, groups

_PPB_PER_PPM = 1_000


@dataclass(frozen=True)
class Echo:
    """One candidate for a reflector: place, intensity and model.

    range_mm, range_error_mm   slant range from antenna to nearest corner, `Sensor.lead_us` after the frame
    sine_ppm, sine_error_ppm   sine of the angle from the antenna's axis, positive to the left, in millionths
    intensity_cdb              of the weakest corner, over the receiver's noise, rounded down
    section_cdbsm              radar cross-section that this power means by the range law
    doubt                      why the echo has no model; None exactly if it has one
    """

    model: Model
    doubt: Doubt | None
    range_mm: int
    range_error_mm: int
    sine_ppm: int
    sine_error_ppm: int
    intensity_cdb: int
    section_cdbsm: int


def echoes(found: Points, config: RadarConfig) -> list[Echo]:
    """Return reflectors and single echoes, nearest first."""
    spots = _spots_of(found, config)
    grouped = groups(spots, config)
    taken = {member for group in grouped for member in group.members}
    alone = [Group(Model.UNKNOWN, (one,), (0,), Doubt.SHAPE) for one in range(len(spots.power)) if one not in taken]
    made = [_echo(group, found, spots, config) for group in [*grouped, *alone]]
    return sorted(made, key=lambda echo: (echo.range_mm, echo.sine_ppm))


def _spots_of(found: Points, config: RadarConfig) -> Spots:
    """Return the most likely places, in mm and sines."""
    sensor = config.sensor
    range_mm = (found.peaks.row + found.range.best) * float(sensor.cell_mm)
    sine = (found.peaks.column - sensor.side_cells + found.angle.best) * float(sensor.sine_cell)
    return Spots(range_mm, sine, found.power)


def _echo(group: Group, found: Points, spots: Spots, config: RadarConfig) -> Echo:
    weakest = min(group.members, key=lambda one: float(spots.power[one]))
    power = float(spots.power[weakest])
    far, aside = _nearest(group, found, config)
    return Echo(
        Model.UNKNOWN if group.doubt else group.model,
        group.doubt,
        *outward(far, NM_PER_MM),
        *outward(aside, _PPB_PER_PPM),
        in_cdb(power),
        section_cdbsm(power, float(spots.range_mm[weakest]), config),
    )


def _nearest(group: Group, found: Points, config: RadarConfig) -> tuple[ExactBounds, ExactBounds]:
    """Return bounds of range (nm) and sine (1e-9) of the nearest corner: the hull of those that each corner gives."""
    sensor = config.sensor
    bounds = [
        nearest(
            range_nm(one, found, sensor), sine_ppb(one, found, sensor), mark * config.reflectors.unit_mm * NM_PER_MM
        )
        for one, mark in zip(group.members, group.marks, strict=True)
    ]
    return hull([one for one, _ in bounds]), hull([one for _, one in bounds])
