"""Configuration of the interrogator, of detection and of emitters (FWG-1 to FWG-8, FVA-8).

Channel c of a frame is the change of phase, in rad a frame, between backscatter from `c * channel_mm` and from
`gauge_mm` farther along the fibre. Levels are powers in hundredths of dB (cdB).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations
from typing import Literal

from pydantic import Field, model_validator

from safeloc.config import Config, quantity
from safeloc.language.units import MS_PER_S
from safeloc.sensing.fibre.time_of_flight import most_pulses_hz, speed_mm_s
from safeloc.sensing.figures import LIGHT_MM_S, MILLION

_HALVES_OF_NS_PER_S = 2 * 10**9
SILENT_BITS = 4


class Interrogator(Config):
    """The interrogator: pulses and channels (FWG-1). ValueError if two pulses would be in the fibre at a time."""

    fibre_mm: int = quantity(40_000_000, "mm", 100_000, 200_000_000, "[S] Frauscher: 40 km a side; cable, not track")
    pulse_hz: int = quantity(1_000, "Hz", 10, 100_000, "issue: 1 kHz; [S] Frauscher 2500 Hz")
    pulses_per_frame: int = quantity(1, "pulses", 1, 1_000, "[D] frames are means over so many pulses")
    pulse_ns: int = quantity(50, "ns", 1, 1_000, "[M] 5.1 m of fibre; Frauscher [S] 20 m")
    channel_mm: int = quantity(10_000, "mm", 100, 100_000, "[S] 5 to 10 m")
    gauge_mm: int = quantity(10_000, "mm", 500, 100_000, "[S] 10 m")
    index_ppm: int = quantity(1_468_000, "ppm", 1_000_001, 3_000_000, "[D] V = 204 218 296 m/s")
    index_error_ppm: int = quantity(100, "ppm of the index", 0, 10_000, "[M] calibrated, temperature: 4 m at 40 km")
    trigger_error_ps: int = quantity(20_000, "ps", 0, 10_000_000, "[M] pulse instants are known about: 2 m")

    @model_validator(mode="after")
    def _one_pulse_at_a_time(self) -> Interrogator:
        most = most_pulses_hz(self.fibre_mm, self.index_ppm)
        if self.pulse_hz > most:
            raise ValueError(
                f"{self.pulse_hz} pulses a second are too many for {self.fibre_mm} mm of fibre: light of "
                f"{float(speed_mm_s(self.index_ppm)) / MS_PER_S:.0f} m/s needs 2L/V = {1e6 / float(most):.2f} us there "
                f"and back, so at most V/(2L) = {float(most):.1f} Hz; send fewer, or watch less fibre."
            )
        return self

    @model_validator(mode="after")
    def _whole_gauge(self) -> Interrogator:
        if self.gauge_mm % self.channel_mm:
            raise ValueError(f"gauge_mm ({self.gauge_mm}) has to be a multiple of channel_mm ({self.channel_mm}).")
        return self

    @model_validator(mode="after")
    def _whole_frames(self) -> Interrogator:
        if self.pulse_hz % self.pulses_per_frame:
            raise ValueError(
                f"pulse_hz ({self.pulse_hz}) has to be a multiple of pulses_per_frame ({self.pulses_per_frame})."
            )
        return self

    @property
    def frame_hz(self) -> int:
        """The number of frames a second."""
        return self.pulse_hz // self.pulses_per_frame

    @property
    def pulse_mm(self) -> int:
        """The length of fibre that one pulse lights at a time: V times duration, halved for there and back; rounded up."""
        return -(-LIGHT_MM_S * MILLION * self.pulse_ns // (self.index_ppm * _HALVES_OF_NS_PER_S))

    @property
    def channels(self) -> int:
        """The number of channels whose whole gauge and pulse lie in the fibre."""
        return (self.fibre_mm - self.gauge_mm - self.pulse_mm) // self.channel_mm + 1

    @property
    def gauge_channels(self) -> int:
        """The number of channels between the two ends of a gauge."""
        return self.gauge_mm // self.channel_mm

    @property
    def light_channels(self) -> int:
        """The number of places, a channel apart, whose light is measured: up to the fibre's end."""
        return -(-self.fibre_mm // self.channel_mm)

    @property
    def span_mm(self) -> int:
        """The length of fibre that acts on one channel."""
        return self.gauge_mm + self.pulse_mm


class Band(Config):
    """Windows of frames, and the frequency band whose energy is computed in each."""

    window_frames: int = quantity(50, "frames", 16, 10_000, "[D] 50 ms: 1.5 m at 30 m/s")
    windows_per_block: int = quantity(10, "windows", 1, 100, "[D] a result every 0.5 s")
    low_hz: int = quantity(40, "Hz", 1, 10_000, "[M] above road traffic and the axles' own weight")
    high_hz: int = quantity(200, "Hz", 2, 20_000, "[M] below the optical noise's own growth")

    @property
    def block_frames(self) -> int:
        """The number of frames of a block."""
        return self.window_frames * self.windows_per_block


class Detection(Config):
    """Thresholds for fibre that a train shakes, and the greatest distance of the train from the shaken fibre."""

    threshold_cdb: int = quantity(900, "cdB", 300, 3_000, "[D] over the channel's own quiet: e^-20 a window")
    average_windows: int = quantity(3, "windows", 1, 20, "[D] 150 ms: energies of so many windows are averaged")
    fade_cdb: int = quantity(
        1_300, "cdB", 300, 6_000, "[D] less light than the median by this: a channel's phase is noise"
    )
    floor_s: int = quantity(10, "s", 1, 600, "[D] time in which a channel's quiet is learnt")
    gap_mm: int = quantity(80_000, "mm", 1_000, 1_000_000, "[D] longer than a lowered section or the space of bogies")
    near_mm: int = quantity(4_000, "mm", 500, 50_000, "[M] from rail to cable: energy falls with (1 + (d/near)^2)^2")
    end_error_mm: int = quantity(35_000, "mm", 0, 1_000_000, "[D] measured: where the outermost axle is, worst case")
    length_error_mm: int = quantity(40_000, "mm", 0, 1_000_000, "[D] measured: between outermost axles, worst case")
    speed_error_mm_s: int = quantity(1_500, "mm/s", 0, 50_000, "[D] measured: of the fitted speed, worst case")
    scatter_mm: int = quantity(25_000, "mm", 0, 1_000_000, "[D] a train's ends keep that near to a steady course")
    apart_mm_s: int = quantity(12_000, "mm/s", 0, 200_000, "[D] both ends of a train go at one speed, as measured")
    moved_mm: int = quantity(
        50_000, "mm", 0, 1_000_000, "[D] a source that never moved that far is not reported as a train"
    )
    overhang_mm: int = quantity(4_500, "mm", 0, 20_000, "[M] vehicle beyond its outermost axle")
    most_speed_mm_s: int = quantity(100_000, "mm/s", 1_000, 200_000, "[M, fairly sure] 350 km/h, rounded up")
    most_change_mm_s2: int = quantity(1_500, "mm/s2", 100, 5_000, "[M] traction and brake")
    most_length_mm: int = quantity(1_500_000, "mm", 10_000, 10_000_000, "[M] longest train")
    least_length_mm: int = quantity(5_000, "mm", 0, 1_000_000, "[M] shorter is no vehicle")
    confirm_ms: int = quantity(2_000, "ms", 100, 60_000, "[D] time for which a train is seen before it is reported")
    hold_ms: int = quantity(1_000, "ms", 0, 10_000, "[D] a train not seen for so long may go on under its number")
    fit_ms: int = quantity(5_000, "ms", 500, 60_000, "[D] time over which place and speed are fitted")
    disturbed_percent: int = quantity(60, "% of the fibre", 5, 100, "[D] shaken at once: no train")
    disturbed_hold_ms: int = quantity(10_000, "ms", 0, 600_000, "[M] an earthquake's waves come in groups")
    lost_percent: int = quantity(20, "% of the channels", 0, 100, "[M] channels that may be silent")


class Sections(Config):
    """Thresholds for a rise or fall of a pattern's amplitude over its earlier level, with hysteresis (FWG-1, FWG-8)."""

    change_cdb: int = quantity(
        700, "cdB", 100, 4_000, "[D] a section changes 12 dB, coupling 2 dB a standard deviation"
    )
    return_cdb: int = quantity(400, "cdB", 0, 4_000, "[D] less than that is normal again")
    inset_mm: int = quantity(10_000, "mm", 0, 200_000, "[D] the train's outermost metres are left out")
    window_mm: int = quantity(40_000, "mm", 1_000, 500_000, "[D] the next metres, whose amplitude is taken")
    persist_mm: int = quantity(25_000, "mm", 0, 500_000, "[D] run over which a change has to last: shorter is coupling")
    baseline_mm: int = quantity(250_000, "mm", 10_000, 10_000_000, "[D] run over which normal is learnt")
    least_baseline_mm: int = quantity(
        100_000, "mm", 1_000, 10_000_000, "[D] a shorter one does not show what is normal"
    )
    length_error_mm: int = quantity(30_000, "mm", 0, 1_000_000, "[D] measured: of a section run through, worst case")
    longest_mm: int = quantity(500_000, "mm", 10_000, 100_000_000, "[D] changed for longer is no section: new normal")
    search_mm: int = quantity(
        500_000, "mm", 1_000, 100_000_000, "[D] a signal names a section that near; half their spacing"
    )

    @model_validator(mode="after")
    def _hysteresis(self) -> Sections:
        if self.return_cdb >= self.change_cdb:
            raise ValueError(f"return_cdb ({self.return_cdb}) has to lie below change_cdb ({self.change_cdb}).")
        return self


class Counting(Config):
    """Conditions for a valid count of bogies."""

    bin_mm: int = quantity(1_000, "mm", 100, 10_000, "[D] resolution of the train's profile")
    run_mm: int = quantity(300_000, "mm", 10_000, 10_000_000, "[D] run over which one profile is gathered")
    count_valid_run_mm: int = quantity(
        750_000,
        "mm",
        10_000,
        100_000_000,
        "[D] two profiles, the run between them, and the error by which the run is overestimated",
    )
    dip_percent: int = quantity(20, "% of a cluster's height", 1, 90, "[D] how far the profile falls between clusters")
    agree: int = quantity(3, "profiles", 1, 50, "[D] so many counts in a row agree")
    axles_per_vehicle: int = quantity(
        0, "axles", 0, 64, "0: only clusters are reported; 4: coaches with two bogies each"
    )


class Emitter(Config):
    """A test emitter (FVA-8). At a known place it sends its own pattern bit by bit, as a tone switched on and off."""

    id: str = Field(min_length=1, max_length=200)
    fibre_mm: int = Field(ge=0, le=200_000_000, json_schema_extra={"unit": "mm"})
    bits: str = Field(pattern=r"^[01]+$", min_length=8, max_length=64)


class Emission(Config):
    """Sound patterns of emitters. ValueError if two patterns could be confused."""

    tone_hz: int = quantity(240, "Hz", 1, 20_000, "[M] above the band of trains")
    bit_windows: int = quantity(4, "windows", 2, 100, "[D] 0.2 s a bit")
    contrast_cdb: int = quantity(1_000, "cdB", 300, 4_000, "[D] tone on over tone off")
    fall_cdb: int = quantity(1_500, "cdB", 300, 4_000, "[D] fainter than the loudest by this is off, not on")
    least_distance: int = quantity(4, "bits", 1, 32, "[D] between any two patterns, and of one with itself shifted")
    place_mm: int = quantity(
        30_000, "mm", 1_000, 1_000_000, "[D] a tone received farther from its place is not that emitter's"
    )
    emitters: tuple[Emitter, ...] = ()

    @model_validator(mode="after")
    def _distinguishable(self) -> Emission:
        for emitter in self.emitters:
            if emitter.bits[0] == "0":
                raise ValueError(f"the pattern of {emitter.id} has to begin with 1, so that its beginning is detected.")
            if "0" * SILENT_BITS in emitter.bits:
                raise ValueError(
                    f"{emitter.id} has {SILENT_BITS} zeros in a row, which mean the silence before a pattern."
                )
        for one, other in combinations(self.emitters, 2):
            if one.id == other.id:
                raise ValueError(f"two emitters are named {one.id}.")
            if len(one.bits) != len(other.bits):
                raise ValueError(f"patterns of {one.id} and {other.id} must have the same number of bits.")
            if apart(one.bits, other.bits) < self.least_distance:
                raise ValueError(
                    f"patterns of {one.id} and {other.id} differ in fewer than {self.least_distance} bits."
                )
        return self


def apart(one: str, other: str) -> int:
    """Return the number of bits in which two patterns of one length differ."""
    return sum(a != b for a, b in zip(one, other, strict=True))


class SectionPlace(Config):
    """A localization section on the fibre, in mm of cable (FWG-2, FWG-3)."""

    id: str = Field(min_length=1, max_length=200)
    from_mm: int = Field(ge=0, le=200_000_000, json_schema_extra={"unit": "mm"})
    to_mm: int = Field(ge=0, le=200_000_000, json_schema_extra={"unit": "mm"})
    effect: Literal["raises", "lowers"]


class PointPlace(Config):
    """A known reflecting point on the fibre (FWG-5)."""

    id: str = Field(min_length=1, max_length=200)
    fibre_mm: int = Field(ge=0, le=200_000_000, json_schema_extra={"unit": "mm"})


class Reflections(Config):
    """Thresholds for reflected light, as opposed to scattered light."""

    over_cdb: int = quantity(1_500, "cdB", 300, 6_000, "[D] over the median around: scatter alone e^-22 a channel")
    window_mm: int = quantity(300_000, "mm", 20_000, 10_000_000, "[D] channels around")
    search_mm: int = quantity(100_000, "mm", 1_000, 10_000_000, "[D] drift and trigger together stay below")


class FibreConfig(Config):
    """The configuration of the front end. ValueError if figures contradict each other."""

    interrogator: Interrogator = Interrogator()
    band: Band = Band()
    detection: Detection = Detection()
    sections: Sections = Sections()
    counting: Counting = Counting()
    emission: Emission = Emission()
    reflections: Reflections = Reflections()
    section_places: tuple[SectionPlace, ...] = ()
    point_places: tuple[PointPlace, ...] = ()

    @model_validator(mode="after")
    def _bands(self) -> FibreConfig:
        rate, band = self.interrogator.frame_hz, self.band
        if not band.low_hz < band.high_hz < rate / 2:
            raise ValueError(
                f"a band of {band.low_hz} to {band.high_hz} Hz does not lie below half the frame rate of {rate} Hz."
            )
        if not tones_hz(self):
            raise ValueError(
                f"windows of {band.window_frames} frames resolve no tone between {band.low_hz} and {band.high_hz} Hz at "
                f"{rate} frames a second: take longer windows or a wider band."
            )
        if self.emission.emitters and not band.high_hz < self.emission.tone_hz < rate / 2:
            raise ValueError(
                f"the emitters' tone of {self.emission.tone_hz} Hz has to lie between the band and half the frame rate."
            )
        return self

    @model_validator(mode="after")
    def _places(self) -> FibreConfig:
        end = self.interrogator.fibre_mm
        for section in self.section_places:
            if not section.from_mm < section.to_mm <= end:
                raise ValueError(f"section {section.id} has to lie on the fibre of {end} mm, with from_mm < to_mm.")
        places = [(one.id, one.fibre_mm) for one in self.point_places]
        for name, fibre_mm in [*places, *((one.id, one.fibre_mm) for one in self.emission.emitters)]:
            if fibre_mm > end:
                raise ValueError(f"{name} lies beyond the fibre's end at {end} mm.")
        if self.point_places and self.interrogator.pulse_mm < self.interrogator.channel_mm:
            raise ValueError(
                f"a pulse of {self.interrogator.pulse_mm} mm lights less than {self.interrogator.channel_mm} mm between "
                "channels: a reflecting point may lie in between; take longer pulses or closer channels."
            )
        _unique([one.id for one in self.section_places], "sections")
        _unique([one.id for one in self.point_places], "reflecting points")
        return self

    @property
    def window_ms(self) -> float:
        """The duration of a window, ms."""
        return MS_PER_S * self.band.window_frames / self.interrogator.frame_hz


def tones_hz(config: FibreConfig) -> list[float]:
    """Return the tones that a Hann window resolves and whose main lobes (two cells on either side) lie in the band."""
    cell = config.interrogator.frame_hz / config.band.window_frames
    first, last = math.ceil(config.band.low_hz / cell + 1), math.floor(config.band.high_hz / cell - 1)
    return [number * cell for number in range(first, last + 1)]


def _unique(names: Sequence[str], what: str) -> None:
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError(f"{what} need unique names; given twice: {', '.join(twice)}.")
