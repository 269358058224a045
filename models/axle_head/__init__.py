"""One counting head: axles and their direction from the overlapping pulses of two channels (FVA-5).

A wheel that runs up damps channel A, then both, then B alone, then none; running down, the other way round. Only the
whole sequence counts an axle (overlapping pulses, DP 1 728 700). A wheel that turns back on the head unwinds the
sequence and counts nothing. A step that no wheel makes leaves the direction unknown: the head is disturbed.

A step of this machine is one sample of both channels, often enough that no wheel passes between two samples.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.errors import InputError
from safeloc.language.expr import Bool, BoolVar, Lit, NumVar, Var, all_of, boolean, choice, enumeration, ite, members
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes

AXLE = members("axle", "NONE", "UP", "DOWN")
NO_AXLE, UP, DOWN = AXLE
WHEEL = members("wheel", "OFF", "OVER_A", "OVER_BOTH", "OVER_B")
OFF, OVER_A, OVER_BOTH, OVER_B = WHEEL
MODES = ("FREE", "A_FIRST", "BOTH_UP", "B_LAST", "B_FIRST", "BOTH_DOWN", "A_LAST", "DISTURBED")
TRACE = ("FVA-4", "FVA-5")
US_PER_S = 1_000_000


class AxleHeadConfig(Config):
    """What the sampling rests on. ValueError where a wheel could pass between two samples."""

    sample_us: int = quantity(500, "us", 1, 100_000, "[M] 2 kHz")
    overlap_mm: int = quantity(60, "mm", 1, 1_000, "[M, unsure] shortest stretch in which a wheel damps both channels")
    spacing_mm: int = quantity(150, "mm", 1, 1_000, "[M, unsure] between the two channels")
    spacing_error_mm: int = quantity(2, "mm", 0, 100, "[M, unsure]")
    max_speed_mm_s: int = quantity(100_000, "mm/s", 1, 138_889, "[M, sure] 350 km/h")

    @model_validator(mode="after")
    def _sampled_often_enough(self) -> AxleHeadConfig:
        run = self.max_speed_mm_s * self.sample_us
        if run >= self.overlap_mm * US_PER_S:
            raise ValueError(
                f"in {self.sample_us} us a wheel runs {run / US_PER_S:.1f} mm, and damps both channels for only "
                f"{self.overlap_mm} mm; sample more often."
            )
        if self.spacing_error_mm >= self.spacing_mm:
            raise ValueError("spacing_error_mm lies below spacing_mm.")
        return self


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables: channels damped, the axle counted in this sample; ghosts: where the wheel is, and came from."""

    config: AxleHeadConfig
    a: BoolVar
    b: BoolVar
    axle: NumVar
    place: NumVar
    next_place: NumVar
    from_low: BoolVar


def parts(config: AxleHeadConfig) -> Parts:
    """Fresh variables for one head."""
    wheel = enumeration(WHEEL)
    return Parts(
        config,
        boolean("channel_a_damped"),
        boolean("channel_b_damped"),
        choice("axle", enumeration(AXLE)),
        choice("wheel", wheel),
        choice("next_wheel", wheel),
        boolean("wheel_from_low"),
    )


AxleHead = Model[Parts]


def machine(config: AxleHeadConfig | None = None) -> Machine:
    """The machine of one counting head (FVA-5)."""
    return build(parts(config or AxleHeadConfig())).machine


def build(own: Parts) -> AxleHead:
    """The machine over the given variables."""
    table = modes(*MODES)
    current = current_mode(table)
    made = Machine(
        name="axle_head",
        modes=table,
        inputs=[own.a, own.b],
        state={own.axle: NO_AXLE},
        outputs={"counted": own.axle, "damped": current.ne(table[0]), "disturbed": current.eq(table[-1])},
        transitions=list(_table(own, table)),
        ghosts={own.place: OFF, own.from_low: False},
        ghost_inputs=[own.next_place],
        ghost_moves={own.place: own.next_place, own.from_low: _from_low(own)},
        assumption=_wheel_is_where_it_damps(own),
        lemmas=_lemmas(own, current, table),
        mode_variable=current,
        doc=(
            "Axles and their direction from the overlapping pulses of a two-channel head. A sample that no wheel can make "
            "after the one before disturbs the head until both channels are free. Assumed "
            "of truth: wheels follow each other with both channels free between them, damp nothing but what they are "
            "over, and are sampled often enough."
        ),
    )
    return Model(made, own)


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    free, a_first, both_up, b_last, b_first, both_down, a_last, disturbed = table
    none: dict[Var, Lit] = {own.axle: NO_AXLE}
    no, a, both, b = ~own.a & ~own.b, own.a & ~own.b, own.a & own.b, ~own.a & own.b

    def row(name: str, source: Lit | tuple[Lit, ...], target: Lit, when: Bool, axle: Lit = NO_AXLE) -> Transition:
        return Transition(name, source, target, when, {own.axle: axle}, TRACE)

    yield row("wheel on A", free, a_first, a)
    yield row("wheel on B", free, b_first, b)
    yield row("then on both, upwards", a_first, both_up, both)
    yield row("then on both, downwards", b_first, both_down, both)
    yield row("then on B alone", both_up, b_last, b)
    yield row("then on A alone", both_down, a_last, a)
    yield row("axle upwards", b_last, free, no, UP)
    yield row("axle downwards", a_last, free, no, DOWN)
    yield row("turned back off A", a_first, free, no)
    yield row("turned back off B", b_first, free, no)
    yield row("turned back to A", both_up, a_first, a)
    yield row("turned back to B", both_down, b_first, b)
    yield row("turned back to both, upwards", b_last, both_up, both)
    yield row("turned back to both, downwards", a_last, both_down, both)
    yield row("both at once", free, disturbed, both)
    yield row("no overlap after A", (a_first, a_last), disturbed, b)
    yield row("no overlap after B", (b_first, b_last), disturbed, a)
    yield row("both gone at once", (both_up, both_down), disturbed, no)
    yield row("free again", disturbed, free, no)
    yield Transition("stay free", free, free, no, none, TRACE, 1)


# ------------------------------------------------------------------ the environment, and what helps to prove


def _wheel_is_where_it_damps(own: Parts) -> Bool:
    """One wheel at a time, without jumps, and no false damping: what a head without a fault hears."""
    place, then = own.place, own.next_place
    steps = {OFF: (OFF, OVER_A, OVER_B), OVER_A: (OFF, OVER_A, OVER_BOTH), OVER_BOTH: (OVER_A, OVER_BOTH, OVER_B)}
    steps[OVER_B] = (OFF, OVER_BOTH, OVER_B)
    runs = [place.eq(here).implies(then.one_of(*there)) for here, there in steps.items()]
    heard = own.a.iff(then.one_of(OVER_A, OVER_BOTH)) & own.b.iff(then.one_of(OVER_B, OVER_BOTH))
    return all_of([heard, *runs])


def _from_low(own: Parts) -> Bool:
    """Ghost: the wheel over the head came from below."""
    comes = own.place.eq(OFF) & own.next_place.ne(OFF)
    return ite(comes, own.next_place.eq(OVER_A), own.from_low)


def _lemmas(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> dict[str, Bool]:
    free, a_first, both_up, b_last, b_first, both_down, a_last, disturbed = table
    up = {a_first: OVER_A, both_up: OVER_BOTH, b_last: OVER_B}
    down = {b_first: OVER_B, both_down: OVER_BOTH, a_last: OVER_A}
    places = [current.eq(mode).implies(own.place.eq(place) & own.from_low) for mode, place in up.items()]
    places += [current.eq(mode).implies(own.place.eq(place) & ~own.from_low) for mode, place in down.items()]
    return {
        "the mode is where the wheel is": all_of([current.eq(free).implies(own.place.eq(OFF)), *places]),
        "a wheel does not disturb": current.ne(disturbed),
    }


# ------------------------------------------------------------------ speed


def axle_speed_mm_s(elapsed_us: int, config: AxleHeadConfig | None = None) -> tuple[int, int]:
    """Bounds of an axle's speed, mm/s, from the time between the two channels' rises, rounded outward (FVA-5).

    Each instant is known to one sample. InputError for a time in which no permitted wheel gets from one to the other.
    """
    config = config or AxleHeadConfig()
    near, far = config.spacing_mm - config.spacing_error_mm, config.spacing_mm + config.spacing_error_mm
    longest, shortest = elapsed_us + config.sample_us, max(elapsed_us - config.sample_us, 1)
    low, high = near * US_PER_S // longest, -(-far * US_PER_S // shortest)
    if elapsed_us < 0 or low > config.max_speed_mm_s:
        raise InputError(f"{elapsed_us} us between the channels: faster than {config.max_speed_mm_s} mm/s; no wheel.")
    return low, min(high, config.max_speed_mm_s)
