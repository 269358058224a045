"""Selection of usable satellites: measured against predicted Doppler and pseudorange (SAT-1 to SAT-4, SAT-6, SAT-D1).

The prediction comes from the state at the cycle before and the mapped track alone (SAT-1); its differences to what was
measured, the receiver's clock removed, are the inputs. In every cycle the list of usable satellites (LSVU) starts from
all visible ones (LSV; source [0051], [0055]), and a satellite leaves it by what is measured in this cycle: nothing is
kept of earlier exclusions.

A current almanac gives the satellites that may be visible; one that is received and not among them is not usable. An almanac
that is too old decides nothing: then all that are received may be visible, or none, as configured.

Each channel is ABSENT, UNLISTED (not possibly visible by the almanac), EXPIRED (no valid ephemeris), SILENT (a quantity is missing), WARMING (no covariance yet),
EXCLUDED (the criterion is violated) or USABLE.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import TRUE, Bool, Expr, Lit, Num, abs_, all_of, any_of, as_num, ite, minimum
from safeloc.language.machine import Machine, Model, Transition, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT
from safeloc.models.satellite_selection.variables import (
    ABSENT,
    EXCLUDED,
    EXPIRED,
    SILENT,
    STANDING,
    UNLISTED,
    USABLE,
    WARMING,
    Channel,
    Compared,
    Parts,
    Removal,
    SelectionConfig,
    parts,
)
from safeloc.models.satellite_selection.world import is_current, world
from safeloc.models.vocabulary.how_many import how_many

__all__ = [
    "ABSENT",
    "EXCLUDED",
    "EXPIRED",
    "SILENT",
    "STANDING",
    "UNLISTED",
    "USABLE",
    "WARMING",
    "Channel",
    "Compared",
    "Parts",
    "Removal",
    "Selection",
    "SelectionConfig",
    "accepts",
    "build",
    "machine",
    "parts",
    "standing",
    "warm",
]


class Selection(Model[Parts]):
    """The machine with its variables: a class of its own, by which the localizer tells its machines apart."""


def machine(config: SelectionConfig | None = None) -> Machine:
    """Make the selection machine (SAT-1 to SAT-4)."""
    return build(parts(config or SelectionConfig())).machine


def build(own: Parts) -> Selection:
    """Build the machine over the given variables."""
    table = modes("NONE_USABLE", "SOME_USABLE")
    outputs: dict[str, Expr] = {"usable": own.usable_satellites, "almanac_current": own.current}
    outputs |= {f"channel_{one.number}_usable": one.standing.eq(USABLE) for one in own.channels}
    made = own.declared.machine(
        name="selection",
        modes=table,
        outputs=outputs,
        transitions=list(_table(own, table)),
        world=world(own),
        lemmas={
            "usable satellites are counted": own.usable_satellites.eq(
                how_many(one.standing.eq(USABLE) for one in own.channels)
            )
        },
        doc=(
            "The usable satellites among the visible ones. Assumed: a difference is the signal's own error plus what the "
            "prediction's error makes of it, less the error of the clock; a current almanac has each satellite about where it is. "
            "Nothing is assumed of a signal's error."
        ),
    )
    return Selection(made, own)


# ------------------------------------------------------------------ the criterion


def accepts(one: Channel, config: SelectionConfig, removal: Removal) -> Bool:
    """Return whether the criterion keeps the satellite. It tests |difference|: a one-sided test misses half the faults."""
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


def _received(one: Channel, config: SelectionConfig) -> Bool:
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
    """Return the number of cycles in which this channel heard the same satellite, up to the warm-up, with this cycle."""
    same = one.satellite.present & one.satellite.value.eq(one.held) & _received(one, own.config) & one.ephemeris_valid
    first = one.satellite.present & _received(one, own.config) & one.ephemeris_valid
    return ite(same, minimum(one.warm + 1, own.config.warm_up_cycles), ite(first, as_num(1, COUNT), 0))


def standing(own: Parts, one: Channel) -> Num:
    """Return the standing of the channel's satellite in this cycle."""
    config = own.config
    ready = _spread(one, config) & (warm(own, one) >= config.warm_up_cycles)
    standing = ite(accepts(one, config, config.removal), USABLE, EXCLUDED)
    by_signal = ite(_received(one, config), ite(ready, standing, WARMING), SILENT)
    by_data = ite(possibly_visible(own, one), ite(one.ephemeris_valid, by_signal, EXPIRED), UNLISTED)
    return ite(one.satellite.present & ~_is_twice(own, one), by_data, ABSENT)


def possibly_visible(own: Parts, one: Channel) -> Bool:
    """Return whether the almanac lets the channel's satellite be visible; a current one has it, and not below its mask."""
    listed = one.almanac.present & (one.almanac.value >= own.config.almanac_mask_mrad)
    if own.config.almanac == "required":
        return is_current(own) & listed
    return ~is_current(own) | listed


def _is_twice(own: Parts, one: Channel) -> Bool:
    """The same satellite on an earlier channel: a duplicate counts once."""
    earlier = [other for other in own.channels if other.number < one.number]
    return any_of(other.satellite.present & other.satellite.value.eq(one.satellite.value) for other in earlier)


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    none, some = table
    count = how_many(standing(own, one).eq(USABLE) for one in own.channels)
    requirements = ("SAT-1", "SAT-3", "SAT-4", "SAT-6", "SAT-D1")
    every = together(
        {own.usable_satellites: count, own.current: is_current(own)}, *(_channel(own, one) for one in own.channels)
    )
    yield Transition("no satellite is usable", table, none, count.eq(0), every, requirements, 0)
    yield Transition("satellites are selected", table, some, TRUE, every, requirements, 1)


def _channel(own: Parts, one: Channel) -> Updates:
    """Standing, warm-up and identity of a channel's satellite."""
    identity = ite(one.satellite.present, one.satellite.value, as_num(0, COUNT))
    return {one.standing: standing(own, one), one.warm: warm(own, one), one.held: identity}
