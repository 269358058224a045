"""Which visible satellites are usable: measured against predicted Doppler and pseudorange (SAT-1 to SAT-4, SAT-D1).

The prediction comes from the state at the cycle before and the mapped track alone (SAT-1); its differences to what was
measured, the receiver's clock removed, are the inputs. In every cycle the list of usable satellites (LSVU) starts from
all visible ones (LSV; source [0051], [0055]), and a satellite leaves it by what is measured in this cycle: nothing is
kept of earlier exclusions.

Each channel is ABSENT, EXPIRED (no valid ephemeris), SILENT (a quantity is missing), WARMING (no covariance yet),
EXCLUDED (the criterion is violated) or USABLE.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from pydantic import Field, model_validator

from safeloc.config import Config, quantity
from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Optional,
    Var,
    abs_,
    all_of,
    any_of,
    as_num,
    boolean,
    choice,
    enumeration,
    ite,
    members,
    minimum,
    number,
    optional,
)
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.units import COUNT, MM, MM_S, Unit

STANDING = members("standing", "ABSENT", "EXPIRED", "SILENT", "WARMING", "EXCLUDED", "USABLE")
ABSENT, EXPIRED, SILENT, WARMING, EXCLUDED, USABLE = STANDING
Compared = Literal["doppler", "pseudorange", "both"]
Removal = Literal["either", "both"]
SQUARE_MM, SQUARE_MM_S = MM.times(MM), MM_S.times(MM_S)


class SelectionConfig(Config):
    """The criterion, with its thresholds.

    compared  which quantities are compared; a satellite that violates one of them is removed ([0068])
    removal   either: unless difference AND covariance are below their thresholds, strictly ([0066], [0067]; default)
              both: only where difference AND covariance are above them ([0049], [0050])
    """

    channels: int = quantity(8, "count", 1, 32, "[D] satellites in view at a time, several constellations up to 32")
    compared: Compared = Field(default="both", description="Doppler, pseudorange, or both")
    removal: Removal = Field(default="either", description="what removes a satellite")
    range_threshold_mm: int = quantity(15_000, "mm", 1, 10_000_000, "[D] above prediction error and noise")
    speed_threshold_mm_s: int = quantity(1_500, "mm/s", 1, 1_000_000, "[D] above prediction error and noise")
    range_covariance_mm2: int = quantity(25_000_000, "mm2", 1, 10**14, "[D] (5 m)2; line of sight p50 2.56 m")
    speed_covariance_mm2_s2: int = quantity(250_000, "mm2/s2", 1, 10**12, "[D] (0.5 m/s)2; line of sight 0.19 m/s")
    range_noise_mm: int = quantity(8_000, "mm", 0, 10_000_000, "[D] 3 x 2.56 m: pseudorange error of a healthy signal")
    speed_noise_mm_s: int = quantity(
        600, "mm/s", 0, 1_000_000, "[D] 3 x 0.19 m/s: range rate error of a healthy signal"
    )
    range_prediction_mm: int = quantity(4_000, "mm", 0, 10_000_000, "[D] A T^2 at 0.2 s, and the state's own error")
    speed_prediction_mm_s: int = quantity(700, "mm/s", 0, 1_000_000, "[D] 2 A T at 0.2 s, and the state's own error")
    range_clock_mm: int = quantity(2_500, "mm", 0, 10_000_000, "[D] 3 x 1.25 x 2.56 m / sqrt(16): a median's error")
    speed_clock_mm_s: int = quantity(150, "mm/s", 0, 1_000_000, "[D] 3 x 1.25 x 0.19 m/s / sqrt(25): a median's error")
    warm_up_cycles: int = quantity(2, "cycles", 1, 1_000, "[S] [0071]: variability needs two samples at least")
    last_identity: int = quantity(1_000, "count", 1, 1_000_000, "[D] satellites of all constellations")

    @model_validator(mode="after")
    def _keeps_healthy_ones(self) -> SelectionConfig:
        """The threshold rule: above noise, prediction and clock error, or healthy satellites go when the train brakes."""
        rows = (
            ("range_threshold_mm", self.range_threshold_mm, self.range_off_at_most_mm),
            ("speed_threshold_mm_s", self.speed_threshold_mm_s, self.speed_off_at_most_mm_s),
        )
        for name, value, least in rows:
            if value <= least:
                raise ValueError(
                    f"{name} {value} is not above noise, prediction and clock error together, {least}: healthy satellites "
                    "would be excluded while the train brakes; raise it."
                )
        return self

    @property
    def range_off_at_most_mm(self) -> int:
        """The greatest difference of a healthy pseudorange."""
        return self.range_noise_mm + self.range_prediction_mm + self.range_clock_mm

    @property
    def speed_off_at_most_mm_s(self) -> int:
        """The greatest difference of a healthy range rate."""
        return self.speed_noise_mm_s + self.speed_prediction_mm_s + self.speed_clock_mm_s


@dataclass(frozen=True, eq=False)
class Channel:
    """One receiver channel. Differences are measured less predicted, mm and mm/s; covariances over the window.

    error, speed_error            ghosts: the signal's own error
    offset, speed_offset          ghosts: what the prediction's error makes of it along the line of sight
    """

    number: int
    identity: Optional
    ephemeris: BoolVar
    off: Optional
    speed_off: Optional
    covariance: Optional
    speed_covariance: Optional
    standing: NumVar
    held: NumVar
    warm: NumVar
    error: NumVar
    speed_error: NumVar
    offset: NumVar
    speed_offset: NumVar

    @property
    def inputs(self) -> list[Var | Optional]:
        """What is heard on it in a cycle."""
        return [self.identity, self.ephemeris, self.off, self.speed_off, self.covariance, self.speed_covariance]

    @property
    def ghosts(self) -> list[Var]:
        """The choices of the world."""
        return [self.error, self.speed_error, self.offset, self.speed_offset]


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine. clock, speed_clock: ghosts, what the receiver's clock was estimated wrong by."""

    config: SelectionConfig
    channels: tuple[Channel, ...]
    usable: NumVar
    clock: NumVar
    speed_clock: NumVar


def parts(config: SelectionConfig) -> Parts:
    """Fresh variables for one machine."""
    channels = tuple(_channel(n, config) for n in range(1, config.channels + 1))
    return Parts(
        config,
        channels,
        number("usable_satellites", COUNT, 0, config.channels),
        number("clock_mm", MM, -(10**9), 10**9),
        number("clock_mm_s", MM_S, -(10**8), 10**8),
    )


def _channel(number_: int, config: SelectionConfig) -> Channel:
    name, far, fast = f"channel_{number_}", 10**9, 10**8

    def covariance(kind: str, unit: Unit) -> Optional:
        return optional(f"{name}_{kind}", unit, 0, 10**15)

    return Channel(
        number_,
        optional(f"{name}_satellite", COUNT, 1, config.last_identity),
        boolean(f"{name}_ephemeris_valid"),
        optional(f"{name}_range_off_mm", MM, -far, far),
        optional(f"{name}_speed_off_mm_s", MM_S, -fast, fast),
        covariance("range_covariance_mm2", SQUARE_MM),
        covariance("speed_covariance_mm2_s2", SQUARE_MM_S),
        choice(f"{name}_standing", enumeration(STANDING)),
        number(f"{name}_held", COUNT, 0, config.last_identity),
        number(f"{name}_warm_cycles", COUNT, 0, config.warm_up_cycles),
        number(f"{name}_error_mm", MM, -3 * far, 3 * far),
        number(f"{name}_speed_error_mm_s", MM_S, -3 * fast, 3 * fast),
        number(f"{name}_prediction_mm", MM, -2 * far, 2 * far),
        number(f"{name}_prediction_mm_s", MM_S, -2 * fast, 2 * fast),
    )


@dataclass(frozen=True, eq=False)
class Selection:
    """The machine together with its variables."""

    machine: Machine
    own: Parts


def machine(config: SelectionConfig | None = None) -> Machine:
    """The selection machine (SAT-1 to SAT-4)."""
    return build(parts(config or SelectionConfig())).machine


def build(own: Parts) -> Selection:
    """The machine over the given variables."""
    table = modes("NONE_USABLE", "SOME_USABLE")
    state: dict[Var, Lit | int] = {own.usable: 0}
    for one in own.channels:
        state |= {one.standing: ABSENT, one.held: 0, one.warm: 0}
    outputs: dict[str, Expr] = {"usable": own.usable}
    outputs |= {f"channel_{one.number}_usable": one.standing.eq(USABLE) for one in own.channels}
    made = Machine(
        name="selection",
        modes=table,
        inputs=[var for one in own.channels for var in one.inputs],
        state=state,
        outputs=outputs,
        transitions=list(_table(own, table)),
        ghosts={},
        ghost_inputs=[*(var for one in own.channels for var in one.ghosts), own.clock, own.speed_clock],
        assumption=all_of(_is_compared(own, one) for one in own.channels),
        lemmas={"usable ones are counted": own.usable.eq(_count(one.standing.eq(USABLE) for one in own.channels))},
        mode_variable=current_mode(table),
        doc=(
            "The usable satellites among the visible ones. Assumed: a difference is the signal's own error plus what the "
            "prediction's error makes of it, less the error of the clock. Nothing is assumed of a signal's error."
        ),
    )
    return Selection(made, own)


# ------------------------------------------------------------------ the criterion


def accepts(one: Channel, config: SelectionConfig, removal: Removal) -> Bool:
    """Whether the criterion keeps the satellite. |difference| is what counts: a one-sided test misses half the faults."""
    checks = []
    if config.compared in ("pseudorange", "both"):
        checks.append(_kept(abs_(one.off.value), config.range_threshold_mm, one.covariance.value, config.range_covariance_mm2, removal))  # fmt: skip
    if config.compared in ("doppler", "both"):
        checks.append(_kept(abs_(one.speed_off.value), config.speed_threshold_mm_s, one.speed_covariance.value, config.speed_covariance_mm2_s2, removal))  # fmt: skip
    return all_of(checks)


def _kept(off: Num, most: int, covariance: Num, most_covariance: int, removal: Removal) -> Bool:
    if removal == "either":
        return (off < most) & (covariance < most_covariance)
    return (off <= most) | (covariance <= most_covariance)


def _heard(one: Channel, config: SelectionConfig) -> Bool:
    """Every quantity that is compared was measured."""
    needed = {"pseudorange": [one.off], "doppler": [one.speed_off], "both": [one.off, one.speed_off]}
    return all_of(item.present for item in needed[config.compared])


def _spread(one: Channel, config: SelectionConfig) -> Bool:
    """Every covariance that is compared exists."""
    needed = {
        "pseudorange": [one.covariance],
        "doppler": [one.speed_covariance],
        "both": [one.covariance, one.speed_covariance],
    }
    return all_of(item.present for item in needed[config.compared])


def warm(own: Parts, one: Channel) -> Num:
    """How many cycles the same satellite was heard on this channel, this one included, up to the warm-up."""
    same = one.identity.present & one.identity.value.eq(one.held) & _heard(one, own.config) & one.ephemeris
    first = one.identity.present & _heard(one, own.config) & one.ephemeris
    return ite(same, minimum(one.warm + 1, own.config.warm_up_cycles), ite(first, as_num(1, COUNT), 0))


def standing(own: Parts, one: Channel) -> Num:
    """What the channel is in this cycle."""
    config = own.config
    ready = _spread(one, config) & (warm(own, one) >= config.warm_up_cycles)
    judged = ite(accepts(one, config, config.removal), USABLE, EXCLUDED)
    heard = ite(_heard(one, config), ite(ready, judged, WARMING), SILENT)
    return ite(one.identity.present & ~_is_twice(own, one), ite(one.ephemeris, heard, EXPIRED), ABSENT)


def _is_twice(own: Parts, one: Channel) -> Bool:
    """The same satellite on an earlier channel: a duplicate counts once."""
    earlier = [other for other in own.channels if other.number < one.number]
    return any_of(other.identity.present & other.identity.value.eq(one.identity.value) for other in earlier)


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    none, some = table
    count = _count(standing(own, one).eq(USABLE) for one in own.channels)
    judged: dict[Var, Expr] = {own.usable: count}
    for one in own.channels:
        judged |= {one.standing: standing(own, one), one.warm: warm(own, one)}
        judged[one.held] = ite(one.identity.present, one.identity.value, as_num(0, COUNT))
    trace = ("SAT-1", "SAT-3", "SAT-4", "SAT-D1")
    yield Transition("no satellite is usable", table, none, count.eq(0), judged, trace, 0)
    yield Transition("satellites are selected", table, some, TRUE, judged, trace, 1)


def _count(terms: Iterator[Bool]) -> Num:
    total = as_num(0, COUNT)
    for term in terms:
        total = total + ite(term, as_num(1, COUNT), 0)
    return total


def _is_compared(own: Parts, one: Channel) -> Bool:
    """A difference is the signal's error plus the prediction's along the line of sight, less the clock's, common to all."""
    ranges = one.off.present.implies(one.off.value.eq(one.error + one.offset - own.clock))
    speeds = one.speed_off.present.implies(one.speed_off.value.eq(one.speed_error + one.speed_offset - own.speed_clock))
    return ranges & speeds
