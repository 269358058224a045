"""Ghosts of a reading whose reader was late or beside its place: what the world may choose so that the reading keeps its laws, if anything.

    reader   end A ran, since the reader stood over the spot, what the reading says, but for the run in the latency and the units' rate
    map      the spot lies within its accuracy of where the map has the marker
    vehicle  the readers are as far apart as configured, within the tolerance

Spot and distance of the readers are the world's to choose. So a reading breaks a law only where no choice keeps all three; then both are
as they truly are, which names the law that is broken.
"""

from __future__ import annotations

from safeloc.language.units import NM_PER_MM
from safeloc.models.odometry.ghosts import READERS
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.odometry.world import far_away_mm
from safeloc.simulation.sensors import Reading


def late_marker(
    config: OdometryConfig, reading: Reading, truth_nm: int, ran_nm: int, mounting_mm: float
) -> dict[str, int | bool]:
    """Return the ghosts of a reading with a true spot.

    truth_nm     place of end A at the end of the cycle; ran_nm: its run in the cycle
    mounting_mm  how far ahead of its place the reader is
    """
    assert reading.place_mm is not None and reading.spot_nm is not None
    name, place_nm, at_rear = READERS[reading.end], reading.place_mm * NM_PER_MM, reading.end != 0
    length_nm = config.vehicle_length_mm * NM_PER_MM if at_rear else 0
    truly_nm = length_nm - round(mounting_mm * NM_PER_MM) if at_rear else 0
    slack_nm = config.vehicle_length_tolerance_mm * NM_PER_MM if at_rear else 0
    truly_nm = min(
        max(truly_nm, 0), length_nm + slack_nm
    )  # the world knows no longer vehicle: then the reader was not over its marker
    spot_nm, stray = reading.spot_nm, abs(place_nm - reading.spot_nm) > far_away_mm(config) * NM_PER_MM
    if not stray:
        least, most = off_nm(config, reading.since_mm, ran_nm)
        accuracy_nm, run_nm = reading.accuracy_mm * NM_PER_MM, truth_nm - reading.since_mm * NM_PER_MM
        low = max(run_nm - most, place_nm - accuracy_nm + length_nm - slack_nm)
        high = min(run_nm - least, place_nm + accuracy_nm + length_nm + slack_nm)
        if low <= high:
            both = min(max(spot_nm + truly_nm, low), high)
            near = min(max(spot_nm, place_nm - accuracy_nm), place_nm + accuracy_nm)
            truly_nm = min(max(both - near, length_nm - slack_nm), length_nm + slack_nm)
            spot_nm = both - truly_nm
    found: dict[str, int | bool] = {f"{name}_spot_nm": spot_nm, f"{name}_stray": stray}
    return {**found, "true_length_nm": truly_nm} if at_rear else found


def off_nm(config: OdometryConfig, since_mm: int, ran_nm: int) -> tuple[int, int]:
    """Return the least and the greatest distance by which the run since the reading may exceed what it says, nm."""
    twice, window = 2 * config.period_ms, config.reader_latency_ms
    unsteady = config.max_acceleration_mm_s2 * config.period_ms**2 * window
    wrong = abs(since_mm) * max(config.first_unit.rate_ppm, config.second_unit.rate_ppm) * twice
    ran = ran_nm * 2 * window
    return -((unsteady + wrong - min(ran, 0)) // twice), (max(ran, 0) + unsteady + wrong) // twice
