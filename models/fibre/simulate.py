"""Simulated fibre features as step streams of the fibre and the verification machine, their ghosts included.

The streams hold features, not backscatter: the messages of a detector within its stated bounds. The map's answers depend on
the count that the machine reports, so a stream is made against the machine as it runs on board.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import NM_PER_MM
from safeloc.models.fibre import machine
from safeloc.models.fibre.code import Symbol, make_code
from safeloc.models.fibre.variables import FibreConfig
from safeloc.models.verification.variables import VerificationConfig
from safeloc.runtime.streams.steps import Cell

Steps = list[dict[str, Cell]]
RAISED_CDB, NOISE_CDB = 1_200, 150
SPACING_MM = 1_000_000


@dataclass(frozen=True)
class Section:
    """A localization section of the line, mm, and its symbol."""

    low_mm: int
    high_mm: int
    symbol: Symbol


@dataclass(frozen=True)
class Drive:
    """One run past the sections.

    speeds_mm_s  speed of every cycle, negative: backwards
    missed       numbers of sections whose amplitude does not change; false_mm: places where it changes without a section
    referred     a reference is accepted in cycle number `refers_in`; otherwise the code has to give the place
    sections_below  number of sections below the place of the start, and of that reference
    flight_off_mm  error of the time of flight; None: it is not measured
    points_mm    reflecting points that coincide when the front is near them
    start_mm     position of the end before the first cycle; stuck_mm: stretch in which the amplitude stays raised
    """

    speeds_mm_s: tuple[int, ...]
    missed: tuple[int, ...] = ()
    false_mm: tuple[int, ...] = ()
    referred: bool = True
    refers_in: int = 0
    sections_below: int = 0
    flight_off_mm: int | None = 0
    points_mm: tuple[int, ...] = ()
    start_mm: int = 0
    stuck_mm: tuple[int, int] | None = None


def line(config: FibreConfig, count: int = 12, spacing_mm: int = SPACING_MM) -> list[Section]:
    """Return sections of a position code, evenly spaced."""
    symbols = make_code(count, config.window, config.reach).symbols
    places = range(spacing_mm, spacing_mm * (count + 1), spacing_mm)
    return [
        Section(place, place + (config.long_mm if symbol.long else config.short_mm), symbol)
        for place, symbol in zip(places, symbols, strict=True)
    ]


def below(sections: Sequence[Section], place_mm: int) -> int:
    """Return the number of sections that begin below a place."""
    return sum(section.low_mm < place_mm for section in sections)


def steady(speed_mm_s: int = 30_000, cycles: int = 900) -> tuple[int, ...]:
    """Return a constant speed for every cycle."""
    return (speed_mm_s,) * cycles


def simulate(
    config: FibreConfig, *, seed: int, drive: Drive | None = None, sections: Sequence[Section] | None = None
) -> Steps:
    """Return one run as steps of the fibre machine: inputs, ghost inputs, and the remark `truth_mm`."""
    run = _Run(config, drive or Drive(steady()), list(sections if sections is not None else line(config)), seed)
    return [run.step(number, speed) for number, speed in enumerate(run.drive.speeds_mm_s)]


@lru_cache(maxsize=8)
def on_board(config: str) -> Compiled:
    """Return the machine without its world, cached for further runs with the same configuration (JSON)."""
    return compile_system(without_ghosts(lower(machine(FibreConfig.model_validate_json(config)))))


class _Run:
    """The world, and the machine on board."""

    def __init__(self, config: FibreConfig, drive: Drive, sections: list[Section], seed: int) -> None:
        self.config, self.drive, self.sections = config, drive, sections
        self.rng = np.random.default_rng(seed)
        self.code = on_board(config.model_dump_json())
        self.state = self.code.first()
        coded = len(sections) >= config.window
        self.words = make_code(len(sections), config.window, config.reach) if coded else None
        self.truth_nm, self.edge_nm, self.inside = drive.start_mm * NM_PER_MM, 0, 0
        self.count = drive.sections_below
        self.real, self.upwards = False, True
        spread = config.edge_tolerance_mm * 8 // 10
        self.shifts = self.rng.integers(-spread, spread, endpoint=True, size=(len(sections) + 1, 2))

    def step(self, number: int, speed_mm_s: int) -> dict[str, Cell]:
        """Return one cycle."""
        true_run = speed_mm_s * self.config.period_ms * 1_000
        self.truth_nm += true_run
        inside = self._section(self.truth_nm // NM_PER_MM)
        inputs = self._inputs(true_run, inside) | self._map() | self._references(number)
        ghosts = self._ghosts(inside, speed_mm_s >= 0, true_run, self._is_referred(number))
        self.inside = inside
        self.state, _ = self.code.step(self.state, self.code.read(inputs))
        return {**inputs, **ghosts, "truth_mm": self.truth_nm // NM_PER_MM}

    def _is_referred(self, number: int) -> bool:
        return self.drive.referred and number == self.drive.refers_in

    def _section(self, front_mm: int) -> int:
        """Return the number of the section that the amplitude shows; -1 for a false one, 0 for none."""
        for number, (section, shift) in enumerate(zip(self.sections, self.shifts[1:], strict=True), 1):
            low, high = section.low_mm + int(shift[0]), section.high_mm + int(shift[1])
            if number not in self.drive.missed and low <= front_mm <= high:
                return number
        false = any(abs(front_mm - place) < self.config.short_mm // 2 for place in self.drive.false_mm)
        stuck = self.drive.stuck_mm is not None and self.drive.stuck_mm[0] <= front_mm <= self.drive.stuck_mm[1]
        return -1 if false or stuck else 0

    def _inputs(self, true_run_nm: int, inside: int) -> dict[str, Cell]:
        rises = self.sections[inside - 1].symbol.rises if inside > 0 else True
        level = (RAISED_CDB if rises else -RAISED_CDB) if inside else 0
        amplitude = level + int(self.rng.integers(-NOISE_CDB, NOISE_CDB, endpoint=True))
        run_mm = true_run_nm // NM_PER_MM
        error = int(self.rng.uniform(-0.8, 0.8) * self.config.rate_ppm * abs(run_mm) / 1e6)
        inputs: dict[str, Cell] = {"amplitude_cdb": amplitude, "run_mm": run_mm + error}
        front = self.truth_nm // NM_PER_MM
        if self.drive.flight_off_mm is not None:
            inputs["flight_position_mm"] = front + self.drive.flight_off_mm + int(self.rng.integers(-8_000, 8_000))
        near = [place for place in self.drive.points_mm if abs(place - front) <= 10_000]
        return inputs | ({"reflecting_point_mm": near[0]} if near else {})

    def _map(self) -> dict[str, Cell]:
        """Return the map's sections next to the count that the machine reports."""
        count = int(self.code.named_outputs(self.state)["count"])
        records: dict[str, Cell] = {}
        for name, number, forwards in (("ahead", count + 1, True), ("behind", count, False)):
            known = 1 <= number <= len(self.sections)
            section = self.sections[number - 1] if known else Section(0, 0, Symbol(False, False))
            near, far = (section.low_mm, section.high_mm) if forwards else (section.high_mm, section.low_mm)
            records |= {
                f"{name}_known": known, f"{name}_near_mm": near, f"{name}_far_mm": far,
                f"{name}_rises": section.symbol.rises, f"{name}_long": section.symbol.long,
            }  # fmt: skip
        return records

    def _references(self, number: int) -> dict[str, Cell]:
        """Return the counter's reference, in its cycle, and the map's answer to a word."""
        outputs = self.code.named_outputs(self.state)
        found = None
        if self.words is not None and int(outputs["word_length"]) == self.config.window:
            found = self.words.decode(_spelt(int(outputs["word"]), self.config.window))
        place, count = 0, 0
        if found is not None:
            last, direction = found
            section = self.sections[last - 1]
            place, count = (section.high_mm, last) if direction > 0 else (section.low_mm, last - 1)
        return {
            "reference_accepted": self._is_referred(number), "reference_count": self.drive.sections_below,
            "reference_position_mm": self.truth_nm // NM_PER_MM,
            "word_found": found is not None, "word_count": count, "word_position_mm": place,
        }  # fmt: skip

    def _ghosts(self, inside: int, forwards: bool, true_run: int, referred: bool) -> dict[str, Cell]:
        enters, leaves = inside != 0 and self.inside == 0, inside == 0 and self.inside != 0
        if enters:
            self.real, self.upwards = inside > 0, forwards
            self.count += (1 if forwards else -1) if self.real else 0
        elif leaves and forwards != self.upwards:
            self.count += (1 if forwards else -1) if self.real else 0
        if (enters or leaves) and max(inside, self.inside) > 0:
            section = self.sections[max(inside, self.inside) - 1]
            self.edge_nm = (section.low_mm if forwards == enters else section.high_mm) * NM_PER_MM
        elif enters or leaves:
            self.edge_nm = self.truth_nm
        if referred:
            self.count = self.drive.sections_below
        return {
            "true_run_nm": true_run, "next_true_edge_nm": self.edge_nm, "next_true_count": self.count,
            "next_section_is_real": self.real,
        }  # fmt: skip


def _spelt(word: int, window: int) -> tuple[Symbol, ...]:
    """Return the symbols of a word, oldest first."""
    digits = [word // 4**power % 4 for power in reversed(range(window))]
    return tuple(Symbol(digit >= 2, digit % 2 == 1) for digit in digits)


# ------------------------------------------------------------------ verification


@dataclass(frozen=True)
class Stay:
    """A train's stay in an area: the train, the counter's record, and the fibre's readings.

    counted     axles by the axle counter; lost_from: cycle from which the train has fewer axles (it leaves a wagon behind)
    reference   cycle in which the record comes; None: it never comes
    """

    cycles: int = 60
    axles: int = 40
    counted: int = 40
    length_mm: int = 205_000
    speed_mm_s: int = 25_000
    lost_from: int | None = None
    reference: int | None = 2
    emitter_fails: int | None = None
    error_from: int | None = None


def simulate_stay(config: VerificationConfig, *, seed: int, stay: Stay | None = None) -> Steps:
    """Return one stay as steps of the verification machine: inputs, ghost inputs, and the remark `truth_mm`."""
    stay, rng = stay or Stay(), np.random.default_rng(seed)
    steps: Steps = []
    for cycle in range(stay.cycles):
        front = stay.speed_mm_s * config.period_ms * cycle // 1_000
        axles = stay.axles if stay.lost_from is None or cycle < stay.lost_from else stay.axles - 4
        length = stay.length_mm + int(rng.uniform(-0.4, 0.4) * config.length_tolerance_mm)
        failed = stay.emitter_fails is not None and cycle >= stay.emitter_fails
        step = _reference(stay, cycle, front) | _control(stay, cycle)
        step |= {
            "associated": True, "fibre_position_mm": front + int(rng.integers(-8_000, 8_000)), "fibre_margin_above_mm": 10_000,
            "fibre_margin_below_mm": 10_000, "fibre_located": True,
            "fibre_speed_mm_s": stay.speed_mm_s + int(rng.integers(-500, 500)),
            "fibre_error": stay.error_from is not None and cycle >= stay.error_from,
            "chain_tested": not failed, "chain_failed": failed, "train_leaves": cycle == stay.cycles - 1,
            "next_true_axles": axles, "next_true_length_um": stay.length_mm * 1_000,
            "next_truth_nm": front * NM_PER_MM, "truth_mm": front,
        }  # fmt: skip
        if cycle % 4 == 2:
            step |= {"fibre_axles": axles, "fibre_length_mm": length}
        steps.append(step)
    return steps


def _reference(stay: Stay, cycle: int, front_mm: int) -> dict[str, Cell]:
    return {
        "reference_due": cycle == (2 if stay.reference is None else stay.reference),
        "reference_from": "NOBODY" if stay.reference is None else "AXLE_COUNTER",
        "record_sound": True, "record_axles": stay.counted, "record_length_low_mm": stay.length_mm - 4_000,
        "record_length_high_mm": stay.length_mm + 4_000, "record_speed_low_mm_s": stay.speed_mm_s - 300,
        "record_speed_high_mm_s": stay.speed_mm_s + 300, "record_place_low_mm": front_mm - 5_000,
        "record_place_high_mm": front_mm + 5_000, "record_age_cycles": 0,
    }  # fmt: skip


def _control(stay: Stay, cycle: int) -> dict[str, Cell]:
    """Return count and length from train control, in every tenth cycle."""
    return {"control_axles": stay.counted, "control_length_mm": stay.length_mm} if cycle % 10 == 3 else {}
