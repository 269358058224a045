"""Inputs, state and configuration of the fibre machine for one end of a train."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    Bool,
    BoolVar,
    Num,
    NumVar,
    boolean,
    choice,
    enumeration,
    ite,
    members,
    number,
    optional,
)
from safeloc.language.units import COUNT, MM, MS_PER_S, NM, NM_PER_MM, Unit
from safeloc.models.fibre.ghosts import ghosts

CDB = Unit("cdB")
_BAND = members("amplitude_band", "NORMAL", "RAISED", "LOWERED")
NORMAL, RAISED, LOWERED = _BAND
SIGNAL = members("section_event", "NONE", "POSITION_SIGNAL", "PASSED", "TURNED_BACK")
NO_SIGNAL, POSITION_SIGNAL, PASSED, TURNED_BACK = SIGNAL
WHY = members(
    "fibre_reason",
    "LOCATED", "NO_SIGNAL_YET", "COUNTING", "SILENT", "TOO_WIDE", "FALSE_SECTION", "MISSED_SECTION", "WRONG_LENGTH",
    "NO_END_OF_SECTION", "FLIGHT_DIFFERS", "REFLECTION_DIFFERS",
)  # fmt: skip
(
    LOCATED, NO_SIGNAL_YET, ONLY_COUNTING, SILENT, TOO_WIDE, FALSE_SECTION, MISSED_SECTION, WRONG_LENGTH,
    NO_END_OF_SECTION, FLIGHT_DIFFERS, REFLECTION_DIFFERS,
) = WHY  # fmt: skip
SYMBOLS = 4


class FibreConfig(Config):
    """Accuracy of the detector's features, and the making of the sections."""

    period_ms: int = quantity(500, "ms", 10, 10_000, "[D] the detector's block")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")
    section_limit: int = quantity(10_000, "sections", 1, 1_000_000, "[D] more than any line has")
    change_cdb: int = quantity(700, "cdB", 1, 4_000, "[D] a section changes 12 dB, coupling 2 dB a standard deviation")
    return_cdb: int = quantity(400, "cdB", 0, 4_000, "[D] less than that is normal again")
    short_mm: int = quantity(150_000, "mm", 1_000, 1_000_000, "[D] above twice what an edge is known to")
    long_mm: int = quantity(
        400_000, "mm", 2_000, 10_000_000, "[D] distinguished from the short one at 45 m/s, runs as measured"
    )
    edge_tolerance_mm: int = quantity(30_000, "mm", 1, 1_000_000, "[D] gauge, pulse and window; [S] l. 160: 5 to 10 m")
    rate_ppm: int = quantity(60_000, "ppm", 0, 200_000, "[D] measured over simulation (docs/fibre.md); bogies: 5 000")
    floor_mm: int = quantity(2_000, "mm", 0, 10_000, "[D] measured: of the run of one cycle")
    max_speed_mm_s: int = quantity(100_000, "mm/s", 1, 138_889, "[M, sure] 350 km/h, rounded up")
    gap_limit_cycles: int = quantity(4, "cycles", 0, 1_000, "[M] 2 s without the pattern")
    tolerance_mm: int = quantity(
        400_000, "mm", 1, 100_000_000, "[D] a kilometre between sections at 15 m/s, and silence"
    )
    flight_threshold_mm: int = quantity(60_000, "mm", 1, 10_000_000, "[D] index and slack over 40 km, and the edge")
    reflection_threshold_mm: int = quantity(40_000, "mm", 1, 10_000_000, "[D] the point's own place, and the edge")
    window: int = quantity(
        5, "sections", 2, 20, "[D] fibre.code: 5 distinguish 12 sections, 6 distinguish 24, 8 distinguish 40"
    )
    reach: int = quantity(2, "sections", 1, 10, "[D] the code's law: so near, no two are alike")

    @model_validator(mode="after")
    def _can_tell(self) -> FibreConfig:
        if self.return_cdb >= self.change_cdb:
            raise ValueError(f"return_cdb ({self.return_cdb}) lies below change_cdb ({self.change_cdb}): hysteresis.")
        least = 2 * self.read_tolerance_mm
        if self.short_mm <= least or self.long_mm - self.short_mm <= least:
            raise ValueError(
                f"a length is read within {self.read_tolerance_mm} mm: nothing, short_mm ({self.short_mm}) and long_mm "
                f"({self.long_mm}) have to be farther apart than {least} mm."
            )
        return self

    @property
    def read_tolerance_mm(self) -> int:
        """Tolerance of a length between two edges, mm."""
        return 2 * self.edge_tolerance_mm

    @property
    def unheard_limit_nm(self) -> int:
        """Greatest run without an amplitude, nm; after more, a change may have been met anywhere."""
        return self.tolerance_mm * NM_PER_MM

    @property
    def max_cycle_distance_mm(self) -> int:
        """Greatest run of one cycle, mm rounded up."""
        return -(-self.max_speed_mm_s * self.period_ms // MS_PER_S)


@dataclass(frozen=True, eq=False)
class Record:
    """The map's section ahead of the front or behind it: the edge met first, the other edge, and its symbol."""

    known: BoolVar
    near: NumVar
    far: NumVar
    rises: BoolVar
    long: BoolVar


class Parts:
    """The variables of the machine.

    amplitude        the pattern's amplitude at this end, over its normal
    run              the end's run in this cycle along the line, from the pattern alone
    flight_position           position by the time of flight (1/2 T V, cable map applied)
    reflecting_point       place of the reflecting point with which the pattern coincides
    ahead, behind    the map's sections number count + 1 and count
    reference_accepted        an accepted reference: number of sections below it, and its place
    word_found           the map's answer to the word read: number of sections below, and place of the edge passed last
    band             amplitude: normal, or changed by a section; sections_counted: sections below the front, or signals so far
    counted          some signal was counted; forwards: the last direction of running
    edge, run_since_edge      place of the last edge (while located), and the run since; drift: greatest error of that run
    run_since_amplitude          greatest run of the end since the last amplitude
    upwards, far_edge, long_by_map   of the section being passed: entered upwards; its other edge; its length on the map
    word_read, read       the last symbols read, and their number
    ghosts           variables of the world
    """

    def __init__(self, config: FibreConfig) -> None:
        self.declared = declared = Declared()
        limit, step = config.position_limit_mm, config.max_cycle_distance_mm
        far, drift = 2 * limit, 2 * (config.tolerance_mm + step) * NM_PER_MM
        self.config = config
        self.amplitude = declared.sensor(optional("amplitude_cdb", CDB, -10_000, 10_000))
        self.run = declared.sensor(optional("run_mm", MM, -step, step))
        self.flight_position = declared.sensor(optional("flight_position_mm", MM, -limit, limit))
        self.reflecting_point = declared.sensor(optional("reflecting_point_mm", MM, -limit, limit))
        self.ahead = _record(declared, "ahead", limit)
        self.behind = _record(declared, "behind", limit)
        self.reference_accepted = declared.sensor(boolean("reference_accepted"))
        self.reference_count = declared.sensor(number("reference_count", COUNT, 0, config.section_limit))
        self.reference_position = declared.sensor(number("reference_position_mm", MM, -limit, limit))
        self.word_found = declared.sensor(boolean("word_found"))
        self.word_count = declared.sensor(number("word_count", COUNT, 0, config.section_limit))
        self.word_position = declared.sensor(number("word_position_mm", MM, -limit, limit))
        self.sections_counted = declared.state(
            number("sections_counted", COUNT, -config.section_limit, config.section_limit), first=0
        )
        self.edge = declared.state(number("edge_mm", MM, -limit, limit), first=0)
        self.run_since_edge = declared.state(number("run_since_edge_mm", MM, -far, far), first=0)
        self.drift = declared.state(number("drift_nm", NM, 0, drift), first=0)
        self.silent_cycles = declared.state(number("silent_cycles", COUNT, 0, config.gap_limit_cycles), first=0)
        self.far_edge = declared.state(number("far_edge_mm", MM, -limit, limit), first=0)
        self.word_read = declared.state(number("word_read", COUNT, 0, SYMBOLS**config.window - 1), first=0)
        self.read = declared.state(number("symbols_read", COUNT, 0, config.window), first=0)
        self.counted = declared.state(boolean("signal_counted"), first=False)
        self.upwards = declared.state(boolean("entered_upwards"), first=False)
        self.long_by_map = declared.state(boolean("long_by_map"), first=False)
        self.run_since_amplitude = declared.state(
            number("run_since_amplitude_nm", NM, 0, config.unheard_limit_nm), first=config.unheard_limit_nm
        )
        self.forwards = declared.state(boolean("runs_forwards"), first=True)
        self.band = declared.state(choice("band", enumeration(_BAND)), first=NORMAL)
        self.event = declared.state(choice("event", enumeration(SIGNAL)), first=NO_SIGNAL)
        self.why = declared.state(choice("why", enumeration(WHY)), first=NO_SIGNAL_YET)
        self.ghosts = ghosts(declared, _BAND, limit, step, config.section_limit, config.tolerance_mm)

    def next_to(self, forwards: Bool) -> tuple[Bool, Num, Num, Bool, Bool]:
        """Return the map's section that the end meets in this direction: known, near and far edge, rises, long."""
        a, b = self.ahead, self.behind
        return (
            ite(forwards, a.known, b.known), ite(forwards, a.near, b.near), ite(forwards, a.far, b.far),
            ite(forwards, a.rises, b.rises), ite(forwards, a.long, b.long),
        )  # fmt: skip


def parts(config: FibreConfig) -> Parts:
    """Return fresh variables for one end of a train."""
    return Parts(config)


def _record(declared: Declared, name: str, limit: int) -> Record:
    return Record(
        declared.sensor(boolean(f"{name}_known")),
        declared.sensor(number(f"{name}_near_mm", MM, -limit, limit)),
        declared.sensor(number(f"{name}_far_mm", MM, -limit, limit)),
        declared.sensor(boolean(f"{name}_rises")),
        declared.sensor(boolean(f"{name}_long")),
    )
