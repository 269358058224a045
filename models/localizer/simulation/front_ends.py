"""Inputs of many vehicles besides their own sources: distances, radio links, and the front ends of satellites and fibre.

Each function returns columns of inputs under the names of the composition.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import NM_PER_MM, UM_PER_MM
from safeloc.models.localizer.simulation.columns import Column, Columns
from safeloc.models.localizer.simulation.journey import BLOCK_CYCLES, SPOOFED_MM, Stretch, Vehicles, speeds_um_s
from safeloc.models.localizer.simulation.off_the_map import sections_off_mm
from safeloc.models.localizer.simulation.reflected import Receivers
from safeloc.models.localizer.simulation.sky import NO_EPOCH, TWO_PORTIONS, Sky, noise, signals, solution
from safeloc.models.motion.simulate import Measured
from safeloc.models.verification.variables import FROM
from safeloc.simulation.physics.fibre_coupling import coupled
from safeloc.simulation.physics.multipath import DEVIATION, reflections

_SENDERS = tuple(one.label for one in FROM)


def common(vehicles: Vehicles, measured: Measured) -> Columns:
    """Return the true step and place, and the distances that all sources share."""
    columns = {"true_cycle_distance_nm": Column(vehicles.motions.distance_nm)}
    for name, unit in (("motion.odometer_mm", measured.odometer), ("motion.check_mm", measured.check)):
        if unit is not None:
            columns[name] = Column(unit.distance_mm, unit.present)
    if measured.check is not None:
        columns["odometer_next_wander_nm"] = Column(measured.reported.wander_nm)
        columns["motion.lawful_next_wander_nm"] = Column(measured.lawful.wander_nm)
    if vehicles.config.motion.check is not None and vehicles.config.motion.unmeasured is not None:
        columns["motion.next_between_pulses_nm"] = Column(measured.lawful.between_pulses_nm)
    return columns


def _truths_mm(vehicles: Vehicles) -> NDArray[np.int64]:
    return np.asarray(vehicles.motions.position_nm // NM_PER_MM, dtype=np.int64)


def links(vehicles: Vehicles) -> Columns:
    """Return the inputs of the radio links: every fifth cycle a report that arrives two cycles later; fibre reports arrive at once."""
    turn = np.arange(vehicles.shape[0])[:, None] % BLOCK_CYCLES
    columns = {
        "uplink.sent": Column(turn == 0),
        "uplink.arrived": Column((turn == 2) & ~vehicles.acting("uplink silent")),
    }
    if "fibre" in vehicles.config.sources:
        columns["downlink.arrived"] = Column(~vehicles.acting("downlink silent"))
    return columns


# ------------------------------------------------------------------ satellites


def satellite(vehicles: Vehicles) -> Columns:
    """Return the output of the satellites' front ends."""
    config, truth = vehicles.config.satellite.selection, _truths_mm(vehicles)
    undecided = vehicles.first.undecided(truth)
    dark = _within(vehicles.first.dark, truth) | vehicles.acting("satellites lost")
    received = _in_a_row(~(dark | undecided))
    missing = np.where(undecided, TWO_PORTIONS, NO_EPOCH)
    sky = Sky(vehicles.satellites, received, vehicles.acting("multipath"), missing)
    drawn = noise(config, sky, vehicles.rngs("satellite signals"), vehicles.rngs("satellite solution"))
    spoofed = truth + np.cumsum(SPOOFED_MM * vehicles.acting("spoofing"), axis=0)
    speed = speeds_um_s(vehicles.motions)[1:]
    columns = signals(config, sky, drawn) | solution(config, sky, drawn, spoofed, speed)
    columns |= _reflected(vehicles, sky, columns, spoofed, speed)
    return columns | {"position.next_speed_um_s": Column(speed)}


def _reflected(
    vehicles: Vehicles, sky: Sky, columns: Columns, place_mm: NDArray[np.int64], speed_um_s: NDArray[np.int64]
) -> Columns:
    """Return the columns that reflections change, for the vehicles whose signals are reflected."""
    config, which = vehicles.config.satellite.selection, vehicles.figures[DEVIATION] > 0
    satellites = min(config.channels, int(sky.seen.max(initial=0)))
    if not (which.any() and satellites and sky.received.any()):
        return {}
    found = reflections(vehicles.figures, vehicles.seeds, satellites, vehicles.shape[0])
    ready = sky.received >= config.warm_up_cycles
    fastest_um_s = vehicles.config.satellite.max_speed_mm_s * UM_PER_MM
    receivers = Receivers(config, columns, which, ready, found, vehicles.config.motion.period_ms, fastest_um_s)
    return receivers.reflected(place_mm, speed_um_s)


def _within(stretches: Sequence[Stretch], places_mm: NDArray[np.int64]) -> NDArray[np.bool_]:
    found = np.zeros(places_mm.shape, dtype=np.bool_)
    for one in stretches:
        found |= one.holds(places_mm)
    return found


def _in_a_row(flags: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return for each cycle the number of cycles in a row, up to it, in which the flag is set."""
    number = np.arange(1, len(flags) + 1)[:, None]
    unset = np.maximum.accumulate(np.where(flags, 0, number), axis=0)
    return np.asarray(number - unset, dtype=np.int64)


# ------------------------------------------------------------------ the fibre, and the axle counter before it


def fibre(vehicles: Vehicles) -> Columns:
    """Return the output of the fibre's front ends, and of the axle counters at the area's border."""
    journey, front = vehicles.first, _truths_mm(vehicles)
    speed = vehicles.motions.speed_mm_s.astype(np.int64)
    inside = _within([] if journey.fibre is None else [journey.fibre], front)
    if journey.astray is not None:
        inside &= front < journey.astray.switch_mm
    before = np.vstack([np.zeros_like(inside[:1]), inside[:-1]])
    columns = _record(vehicles, front, speed, inside & ~before)
    columns |= {
        "next_true_axles": Column(journey.axles),
        "next_true_length_um": Column(journey.length_mm * 1_000),
    }
    columns |= _pattern(vehicles, front, speed, inside)
    columns["train_leaves"] = Column(before & ~inside)
    return {f"verification.{name}": column for name, column in columns.items()}


def _record(
    vehicles: Vehicles, front: NDArray[np.int64], speed: NDArray[np.int64], due: NDArray[np.bool_]
) -> dict[str, Column]:
    """Return the reports of the axle counters, in the cycle in which the front passes them."""
    journey = vehicles.first
    sender = np.where(due, _SENDERS.index("AXLE_COUNTER"), _SENDERS.index("NOBODY"))
    return {
        "reference_due": Column(due),
        "reference_from": Column(sender),
        "record_sound": Column(True),
        "record_axles": Column(journey.axles + 2 * vehicles.having("fibre miscount")),
        "record_length_low_mm": Column(journey.length_mm - 2_000),
        "record_length_high_mm": Column(journey.length_mm + 2_000),
        "record_speed_low_mm_s": Column(speed - 300),
        "record_speed_high_mm_s": Column(speed + 300),
        "record_place_low_mm": Column(front - 5_000),
        "record_place_high_mm": Column(front + 5_000),
        "record_age_cycles": Column(0),
    }


def _pattern(
    vehicles: Vehicles, front: NDArray[np.int64], speed: NDArray[np.int64], inside: NDArray[np.bool_]
) -> dict[str, Column]:
    """Return the features that the fibre determines in a block, every fifth cycle; nothing between them."""
    located = inside & (np.arange(len(front))[:, None] % BLOCK_CYCLES == 0)
    off_mm, faster_mm_s, longer_mm = _drawn(vehicles, located)
    off_mm = off_mm - sections_off_mm(vehicles, front)
    axles, behind_mm, shorter_mm = _coupled(vehicles, front, located)
    located = located & (axles > 0)
    return {
        "associated": Column(located),
        "fibre_located": Column(located),
        "fibre_margin_above_mm": Column(12_000),
        "fibre_margin_below_mm": Column(12_000),
        "fibre_error": Column(inside & vehicles.acting("fibre error")),
        "chain_tested": Column(inside),
        "chain_failed": Column(False),
        "fibre_position_mm": Column(front + off_mm - behind_mm, located),
        "fibre_speed_mm_s": Column(speed + faster_mm_s, located),
        "fibre_axles": Column(axles, located),
        "fibre_length_mm": Column(np.maximum(vehicles.first.length_mm + longer_mm - shorter_mm, 0), located),
    }


def _coupled(
    vehicles: Vehicles, front: NDArray[np.int64], located: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return what the coupling lets the fibre find in these cycles: axles, how far behind the front it puts the front, and how much too short
    the train: arrays [cycle, vehicle].
    """
    journey, shape = vehicles.first, vehicles.shape
    axles, behind, shorter = np.full(shape, journey.axles), np.zeros(shape, np.int64), np.zeros(shape, np.int64)
    if journey.fibre is None:
        return axles, behind, shorter
    fibres = coupled(vehicles.figures, vehicles.seeds, journey.fibre.begin_mm, journey.fibre.end_mm)
    for vehicle, fibre in fibres.items():
        cycles, rng = np.flatnonzero(located[:, vehicle]), vehicles.seeds[vehicle].rng("fibre fading")
        found = fibre.received(front[cycles, vehicle], journey.length_mm, journey.axles, rng)
        axles[cycles, vehicle], behind[cycles, vehicle] = found.axles, found.first_mm
        shorter[cycles, vehicle] = journey.length_mm - (found.last_mm - found.first_mm)
    return axles, behind, shorter


def _drawn(vehicles: Vehicles, located: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the errors of place, speed and length in these cycles: array [3, cycle, vehicle]."""
    found = np.zeros((3, *vehicles.shape), dtype=np.int64)
    most = vehicles.config.fibre.length_tolerance_mm
    for vehicle, rng in enumerate(vehicles.rngs("fibre")):
        cycles = np.flatnonzero(located[:, vehicle])
        found[0, cycles, vehicle] = rng.integers(-8_000, 8_000, len(cycles))
        found[1, cycles, vehicle] = rng.integers(-300, 300, len(cycles))
        found[2, cycles, vehicle] = (rng.uniform(-0.4, 0.4, len(cycles)) * most).astype(np.int64)
    return found
