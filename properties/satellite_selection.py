"""What must hold of satellite selection (SAT-1 to SAT-4, SAT-D1)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, Optional, all_of, any_of, between
from safeloc.language.spec import Property, always, earlier_num, reachable
from safeloc.models.satellite_selection import ABSENT, EXCLUDED, EXPIRED, USABLE, Channel, Removal, Selection, accepts

LAW = "differences are the signal's error plus the prediction's, less the clock's"


def properties(model: Selection) -> list[Property]:
    """Every property of the selection machine."""
    found = [prop for one in model.own.channels for prop in _of_channel(model, one)]
    return [*found, _subset(model), *_once(model), *_reached(model)]


def _of_channel(model: Selection, one: Channel) -> Iterator[Property]:
    config, name = model.own.config, f"channel {one.number}"
    usable = one.standing.eq(USABLE)
    yield always(
        f"{name}: a violation is not usable",
        usable.implies(~any_of(_violations(model, one))),
        statement="a satellite that violates the criterion in this cycle is not in the list of usable ones in this cycle",
        requirements=("SAT-1", "SAT-3", "SAT-4"),
        unconditional=True,
    )
    yield always(
        f"{name}: no expired data",
        usable.implies(one.ephemeris & one.identity.present),
        statement="no satellite without valid ephemeris, or not in view, is usable",
        requirements=("SAT-1", "SAT-D1"),
        unconditional=True,
    )
    known = one.identity.value.eq(earlier_num(one.held)) if config.warm_up_cycles > 1 else one.identity.present
    spread = {
        "pseudorange": one.covariance.present,
        "doppler": one.speed_covariance.present,
        "both": one.covariance.present & one.speed_covariance.present,
    }[config.compared]
    yield always(
        f"{name}: no covariance, not usable",
        usable.implies(spread & known & one.warm.eq(config.warm_up_cycles)),
        statement="a satellite that has no covariance over a window yet, or that has just come, is not usable",
        requirements=("SAT-3", "SAT-4"),
        unconditional=True,
    )
    yield always(
        f"{name}: a healthy one stays",
        one.standing.eq(EXCLUDED).implies(~_healthy(model, one)),
        statement="a satellite whose errors are within the noise is not excluded while the prediction and the clock are "
        "within their bounds: the thresholds lie above all together",
        requirements=("SAT-4",),
        assumption=LAW,
    )
    yield always(
        f"{name}: exclusion leaves no trace",
        one.standing.eq(USABLE).iff(
            one.standing.ne(ABSENT) & one.standing.ne(EXPIRED) & _would_do(model, one) & spread & _heard(model, one)
        ),
        statement="whether a satellite is usable follows from this cycle's measurements and its warm-up alone: earlier "
        "exclusions count for nothing, as the list starts anew from all visible ones",
        requirements=("SAT-1", "SAT-D1"),
        unconditional=True,
    )


def _violations(model: Selection, one: Channel) -> Iterator[Bool]:
    """What the criterion removes, in figures of its own: differences to either side, and variability."""
    config = model.own.config
    if config.compared != "doppler":
        yield _violates(one.off, config.range_threshold_mm, one.covariance, config.range_covariance_mm2, config.removal)
    if config.compared != "pseudorange":
        yield _violates(
            one.speed_off,
            config.speed_threshold_mm_s,
            one.speed_covariance,
            config.speed_covariance_mm2_s2,
            config.removal,
        )


def _violates(off: Optional, most: int, covariance: Optional, most_covariance: int, removal: Removal) -> Bool:
    if removal == "either":
        return (off.value >= most) | (off.value <= -most) | (covariance.value >= most_covariance)
    return ((off.value > most) | (off.value < -most)) & (covariance.value > most_covariance)


def _would_do(model: Selection, one: Channel) -> Bool:
    config = model.own.config
    return accepts(one, config, config.removal) & one.warm.eq(config.warm_up_cycles)


def _heard(model: Selection, one: Channel) -> Bool:
    compared = model.own.config.compared
    needed = [one.off.present] if compared != "doppler" else []
    return all_of([*needed, *([one.speed_off.present] if compared != "pseudorange" else [])])


def _healthy(model: Selection, one: Channel) -> Bool:
    """Errors within the noise, prediction and clock within their bounds, covariance below its threshold."""
    config = model.own.config
    quiet = (one.covariance.value < config.range_covariance_mm2) & (
        one.speed_covariance.value < config.speed_covariance_mm2_s2
    )
    bounds = (
        (one.error, config.range_noise_mm),
        (one.offset, config.range_prediction_mm),
        (one.speed_error, config.speed_noise_mm_s),
        (one.speed_offset, config.speed_prediction_mm_s),
        (model.own.clock, config.range_clock_mm),
        (model.own.speed_clock, config.speed_clock_mm_s),
    )
    return quiet & all_of(between(-most, term, most) for term, most in bounds)


def _subset(model: Selection) -> Property:
    config = model.own.config
    strict = [accepts(one, config, "either").implies(accepts(one, config, "both")) for one in model.own.channels]
    return always(
        "the strict criterion keeps no more",
        all_of(strict),
        statement="whatever the strict criterion (either violation removes) keeps, the lax one (both must be violated) keeps "
        "as well",
        requirements=("SAT-4",),
        unconditional=True,
    )


def _once(model: Selection) -> Iterator[Property]:
    """Of the first of two channels, since one of the two has to give way."""
    channels = model.own.channels
    for number, one in enumerate(channels[1:], 1):
        told = one.identity.value
        yield always(
            f"channel {one.number}: no satellite twice",
            one.standing.eq(USABLE).implies(
                all_of(~earlier.identity.present | earlier.identity.value.ne(told) for earlier in channels[:number])
            ),
            statement="a satellite that an earlier channel receives as well is not usable here: it counts once",
            requirements=("SAT-1", "SAT-D1"),
            unconditional=True,
        )


def _reached(model: Selection) -> Iterator[Property]:
    yield reachable(
        "all channels usable",
        model.own.usable.eq(model.own.config.channels),
        statement="every channel can be usable at once",
        requirements=("SAT-1",),
    )
