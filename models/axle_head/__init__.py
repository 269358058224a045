"""One counting head: axles and their direction from the overlapping pulses of two channels (FVA-5).

A wheel that rolls up damps channel A, then both, then B alone, then none; rolling down, the other way round. Only the
whole sequence counts an axle (overlapping pulses, DP 1 728 700). A wheel that turns back on the head unwinds the
sequence and counts nothing. A change of the channels that no wheel makes leaves the direction unknown: the head is disturbed.

Each channel tells by its current that it is alive: a cut or shorted cable, or a sensor that has come off the rail, draws another one.
As long as one is not alive, the head is disturbed; and after that until both channels are free. Wheels that pass then are not counted,
and the head tells so (`may_miss`), also in the sample in which the disturbance ends.

A step of this machine is one sample of both channels; samples come so often that no wheel passes between two of them.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.errors import InputError
from safeloc.language.expr import FALSE, TRUE, Bool, Lit
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.units import US_PER_S
from safeloc.models.axle_head.lemmas import lemmas
from safeloc.models.axle_head.variables import (
    AXLE,
    DOWN,
    NO_AXLE,
    UP,
    AxleHeadConfig,
    Parts,
    parts,
)
from safeloc.models.axle_head.world import world

__all__ = [
    "AXLE",
    "DOWN",
    "NO_AXLE",
    "UP",
    "AxleHead",
    "AxleHeadConfig",
    "Parts",
    "axle_speed_mm_s",
    "build",
    "machine",
    "parts",
]
MODES = ("FREE", "A_FIRST", "BOTH_UP", "B_LAST", "B_FIRST", "BOTH_DOWN", "A_LAST", "DISTURBED")
REQUIREMENTS = ("FVA-4", "FVA-5")


AxleHead = Model[Parts]


def machine(config: AxleHeadConfig | None = None) -> Machine:
    """Return the machine of one counting head (FVA-5)."""
    return build(parts(config or AxleHeadConfig())).machine


def build(own: Parts) -> AxleHead:
    """Return the machine over the given variables."""
    table = modes(*MODES)
    current = current_mode(table)
    made = own.declared.machine(
        name="axle_head",
        modes=table,
        outputs={
            "counted": own.axle,
            "damped": current.ne(table[0]),
            "disturbed": current.eq(table[-1]),
            "may_miss": current.eq(table[-1]) | own.ended,
        },
        transitions=list(_table(own, table)),
        world=world(own),
        lemmas=lemmas(own, current, table),
        doc=(
            "Axles and their direction from the overlapping pulses of a two-channel head. A sample that no wheel "
            "can make after the previous one disturbs the head until both channels are free, and so does a channel that is not "
            "alive. Assumed: wheels follow each other with both channels free between them, a channel that is alive is damped by the "
            "wheels on its stretch and by nothing else, and wheels are sampled often enough."
        ),
    )
    return Model(made, own)


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    free, a_first, both_up, b_last, b_first, both_down, a_last, disturbed = table
    alive = own.channel_a_alive & own.channel_b_alive
    no, a, both, b = (
        alive & ~own.channel_a_damped & ~own.channel_b_damped,
        alive & own.channel_a_damped & ~own.channel_b_damped,
        alive & own.channel_a_damped & own.channel_b_damped,
        alive & ~own.channel_a_damped & own.channel_b_damped,
    )

    def row(name: str, source: Lit | tuple[Lit, ...], target: Lit, when: Bool, axle: Lit = NO_AXLE) -> Transition:
        ended = TRUE if source is disturbed else FALSE
        return Transition(name, source, target, when, {own.axle: axle, own.ended: ended}, REQUIREMENTS)

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
    yield row("a channel is not alive", table[:-1], disturbed, ~alive)
    yield row("free again", disturbed, free, no)
    yield row("stay free", free, free, no)


# ------------------------------------------------------------------ speed


def axle_speed_mm_s(elapsed_us: int, config: AxleHeadConfig | None = None) -> tuple[int, int]:
    """Return bounds of an axle's speed, mm/s, from the time between the rises of the two channels, rounded outward (FVA-5).

    Each rise is known to one sample. InputError for a time in which no permitted wheel gets from one channel to the other.
    """
    config = config or AxleHeadConfig()
    near, far = config.spacing_mm - config.spacing_error_mm, config.spacing_mm + config.spacing_error_mm
    longest, shortest = elapsed_us + config.sample_us, max(elapsed_us - config.sample_us, 1)
    low, high = near * US_PER_S // longest, -(-far * US_PER_S // shortest)
    if elapsed_us < 0 or low > config.max_speed_mm_s:
        raise InputError(f"{elapsed_us} us between the channels: faster than {config.max_speed_mm_s} mm/s; no wheel.")
    return low, min(high, config.max_speed_mm_s)
