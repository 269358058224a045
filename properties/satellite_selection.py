"""Properties of satellite selection (SAT-1 to SAT-4, SAT-6, SAT-D1)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, Optional, all_of, any_of, as_num, before, between, ite, minimum
from safeloc.language.spec import Property, always, reachable
from safeloc.language.units import COUNT
from safeloc.models.satellite_selection import Selection
from safeloc.models.satellite_selection.variables import (
    ABSENT,
    EXCLUDED,
    EXPIRED,
    SILENT,
    UNLISTED,
    USABLE,
    WARMING,
    Channel,
    Removal,
    SelectionConfig,
)

LAW = "differences are the signal's error plus the prediction's, less the clock's"
_COARSE = "the elevation by a current almanac is off by no more than its accuracy"
BOUNDED = "the prediction's error makes no more of the difference than configured, nor does the clock's"
for_all_inputs = partial(always, requirements=("SAT-1", "SAT-D1"), unconditional=True)


def properties(model: Selection) -> list[Property]:
    """Return all properties of the selection machine."""
    makers = (_kept_out, _healthy_stay, _standing_is_reported, _bounded, _listed)
    found = [prop for one in model.own.channels for make in makers for prop in make(model, one)]
    return [*found, _subset(model), *_once(model), *_counted(model), *_almanac(model)]


def _kept_out(model: Selection, one: Channel) -> Iterator[Property]:
    """Properties of usable satellites: none of them violates the criterion."""
    config, name, usable = model.own.config, f"channel {one.number}", one.standing.eq(USABLE)
    yield for_all_inputs(
        f"{name}: a violation is not usable",
        usable.implies(~violated(one, config, config.removal)),
        statement="a satellite that violates the criterion in this cycle is not in the list of usable ones in this cycle",
        requirements=("SAT-1", "SAT-3", "SAT-4"),
    )
    yield for_all_inputs(
        f"{name}: no expired data",
        usable.implies(one.ephemeris_valid & one.satellite.present),
        statement="no satellite without valid ephemeris, or not in view, is usable",
    )
    known = one.satellite.value.eq(before(one.held)) if config.warm_up_cycles > 1 else one.satellite.present
    yield for_all_inputs(
        f"{name}: no covariance, not usable",
        usable.implies(_has_spread(model, one) & known & one.warm.eq(config.warm_up_cycles)),
        statement="a satellite that has no covariance over a window yet, or that has just come, is not usable",
        requirements=("SAT-3", "SAT-4"),
    )


def _healthy_stay(model: Selection, one: Channel) -> Iterator[Property]:
    """Properties of excluded satellites: none of them is healthy."""
    config, name = model.own.config, f"channel {one.number}"
    ready = _measured(model, one) & _has_spread(model, one) & one.warm.eq(config.warm_up_cycles)
    yield always(
        f"{name}: a healthy one stays",
        one.standing.eq(EXCLUDED).implies(~_healthy(model, one)),
        statement="a satellite whose errors are within the noise is not excluded while the prediction and the clock are "
        "within their bounds: the thresholds lie above all together",
        requirements=("SAT-4",),
        assumption=LAW,
    )
    yield for_all_inputs(
        f"{name}: exclusion leaves no trace",
        one.standing.eq(USABLE).iff(
            ready & ~_reported_before(model, one) & ~violated(one, config, config.removal) & ~_unlisted(model, one)
        ),
        statement="whether a satellite is usable follows from this cycle's measurements and almanac, and its warm-up, alone: "
        "earlier exclusions count for nothing, as the list starts anew from all visible ones",
    )


def _standing_is_reported(model: Selection, one: Channel) -> Iterator[Property]:
    """Claim the reason why a satellite is not usable, and how long it has been followed."""
    config, name, now = model.own.config, f"channel {one.number}", one.standing
    received = one.satellite.present & ~_reported_before(model, one)
    here = received & ~_unlisted(model, one)
    measured, ready = _measured(model, one), _has_spread(model, one) & one.warm.eq(config.warm_up_cycles)
    meanings = (
        (ABSENT, ~received),
        (UNLISTED, received & _unlisted(model, one)),
        (EXPIRED, here & ~one.ephemeris_valid),
        (SILENT, here & one.ephemeris_valid & ~_is_compared(model, one)),
        (WARMING, here & measured & ~ready),
        (EXCLUDED, here & measured & ready & violated(one, config, config.removal)),
    )
    yield for_all_inputs(
        f"{name}: an unusable satellite has its true reason",
        all_of(now.eq(label).iff(meaning) for label, meaning in meanings),
        statement="a channel is reported to be empty, not to be listed by the almanac, to have expired data, to lack a "
        "measurement, to lack a covariance, or to violate the criterion exactly where that is so",
        requirements=("SAT-1", "SAT-3", "SAT-6", "SAT-D1"),
    )
    followed = one.satellite.value.eq(before(one.held)) & (before(one.warm) > 0)
    cycles = ite(followed, minimum(before(one.warm) + 1, config.warm_up_cycles), as_num(1, COUNT))
    yield for_all_inputs(
        f"{name}: a window counts one satellite's measurements",
        one.warm.eq(ite(measured, cycles, as_num(0, COUNT))) & one.held.eq(_identity(one)),
        statement="the window of a covariance begins anew with another satellite and after each cycle without all that is "
        "compared; it counts cycles one by one",
        requirements=("SAT-3", "SAT-D1"),
    )


def _bounded(model: Selection, one: Channel) -> Iterator[Property]:
    """Properties of the error that the criterion leaves: only the strict one bounds it."""
    config, usable, clock = model.own.config, one.standing.eq(USABLE), model.own
    if config.removal != "either":
        return
    rows = (
        ("pseudorange", "range", one.error, one.prediction, clock.clock, config.range_prediction_mm, config.range_clock_mm, config.range_threshold_mm),
        ("doppler", "speed", one.speed_error, one.prediction_mm_s, clock.clock_mm_s, config.speed_prediction_mm_s, config.speed_clock_mm_s, config.speed_threshold_mm_s),
    )  # fmt: skip
    for compared, name, error, offset, off_clock, prediction, clock_most, threshold in rows:
        if config.compared not in (compared, "both"):
            continue
        most = threshold + prediction + clock_most
        as_configured = between(-prediction, offset, prediction) & between(-clock_most, off_clock, clock_most)
        yield always(
            f"channel {one.number}: a usable {name} is bounded",
            (usable & as_configured).implies((error < most) & (error > -most)),
            statement=f"the {name} error of a usable satellite is below the sum of the threshold and the greatest errors of "
            f"prediction and clock; the threshold alone is no bound",
            requirements=("SAT-1", "SAT-4"),
            assumption=f"{LAW}; {BOUNDED}",
        )


def _listed(model: Selection, one: Channel) -> Iterator[Property]:
    """Claim what a current almanac excludes, in the almanac's own figures and in the sky."""
    config, name, current = model.own.config, f"channel {one.number}", _is_current(model)
    low = config.almanac_mask_mrad - config.almanac_accuracy_mrad
    yield for_all_inputs(
        f"{name}: what the almanac does not list is not usable",
        (current & one.standing.eq(USABLE)).implies(
            one.almanac.present & (one.almanac.value >= config.almanac_mask_mrad)
        ),
        statement="with a current almanac no satellite is usable that it does not have, has as unhealthy, or has below its mask",
        requirements=("SAT-6", "SAT-D1"),
    )
    yield always(
        f"{name}: a usable satellite is above the horizon",
        (current & one.standing.eq(USABLE)).implies((one.elevation >= low) & (one.elevation > 0)),
        statement="with a current almanac every usable satellite stands above the horizon, by at least the mask less the almanac's accuracy",
        requirements=("SAT-6",),
        assumption=_COARSE,
    )
    high = config.almanac_mask_mrad + config.almanac_accuracy_mrad
    yield always(
        f"{name}: the almanac refuses none in full view",
        (current & one.almanac.present & (one.elevation >= high)).implies(one.standing.ne(UNLISTED)),
        statement="a satellite that a current almanac has, and that stands above the mask by at least the almanac's accuracy, "
        "is not refused because of the almanac",
        requirements=("SAT-6",),
        assumption=_COARSE,
    )


def _almanac(model: Selection) -> Iterator[Property]:
    """Claim what follows from an almanac that is too old, or missing."""
    machine, own, current = model.machine, model.own, _is_current(model)
    standings = [one.standing for one in own.channels]
    if own.config.almanac == "required":
        wanted, stated = (
            own.usable_satellites.eq(0),
            "no satellite is usable, since which ones may be visible is not known",
        )
    else:
        wanted = all_of(standing.ne(UNLISTED) for standing in standings)
        stated = "no satellite is refused because of it: it is not used, and those may be visible that are received"
    yield for_all_inputs(
        "an expired almanac is not used",
        (~current).implies(wanted) & machine.flag("almanac_current").iff(current),
        statement=f"without an almanac, and with one that is older than its limit, {stated}; the machine reports which of both it is",
        requirements=("SAT-6", "SAT-D1"),
    )


def _is_current(model: Selection) -> Bool:
    """There is an almanac, no older than its limit."""
    age = model.own.almanac_age
    return age.present & ~(age.value > model.own.config.almanac_limit_s)


def _unlisted(model: Selection, one: Channel) -> Bool:
    """The almanac keeps the satellite of this channel from being used."""
    config = model.own.config
    missing = ~one.almanac.present | (one.almanac.value < config.almanac_mask_mrad)
    if config.almanac == "required":
        return missing | ~_is_current(model)
    return missing & _is_current(model)


def violated(one: Channel, config: SelectionConfig, removal: Removal) -> Bool:
    """Return whether one of the compared quantities, as measured, violates the criterion."""
    return any_of(_violations(one, config, removal))


def _violations(one: Channel, config: SelectionConfig, removal: Removal) -> Iterator[Bool]:
    """Return the violations of the criterion, in figures of the properties: differences to either side, and variability."""
    if config.compared != "doppler":
        yield _violates(one.off, config.range_threshold_mm, one.covariance, config.range_covariance_mm2, removal)
    if config.compared != "pseudorange":
        yield _violates(
            one.speed_off, config.speed_threshold_mm_s, one.speed_covariance, config.speed_covariance_mm2_s2, removal
        )


def _violates(off: Optional, most: int, covariance: Optional, most_covariance: int, removal: Removal) -> Bool:
    if removal == "either":
        return (off.value >= most) | (off.value <= -most) | (covariance.value >= most_covariance)
    return ((off.value > most) | (off.value < -most)) & (covariance.value > most_covariance)


def _is_compared(model: Selection, one: Channel) -> Bool:
    """Each quantity that the criterion compares was measured."""
    compared = model.own.config.compared
    needed = [one.off.present] if compared != "doppler" else []
    return all_of([*needed, *([one.speed_off.present] if compared != "pseudorange" else [])])


def _has_spread(model: Selection, one: Channel) -> Bool:
    """Each covariance that the criterion compares is there."""
    compared = model.own.config.compared
    needed = [one.covariance.present] if compared != "doppler" else []
    return all_of([*needed, *([one.speed_covariance.present] if compared != "pseudorange" else [])])


def _measured(model: Selection, one: Channel) -> Bool:
    """In view, with valid data, and all that is compared was measured."""
    return one.ephemeris_valid & _is_compared(model, one) & one.satellite.present


def _identity(one: Channel) -> Num:
    """Return the identity of the satellite that is received, 0: none."""
    return ite(~one.satellite.present, as_num(0, COUNT), one.satellite.value)


def _reported_before(model: Selection, one: Channel) -> Bool:
    """An earlier channel receives the same satellite."""
    return any_of(
        other.satellite.present & one.satellite.value.eq(other.satellite.value)
        for other in model.own.channels[: one.number - 1]
    )


def _healthy(model: Selection, one: Channel) -> Bool:
    """Errors within the noise, prediction and clock within their bounds, covariance below its threshold."""
    config = model.own.config
    quiet = (one.covariance.value < config.range_covariance_mm2) & (
        one.speed_covariance.value < config.speed_covariance_mm2_s2
    )
    bounds = (
        (one.error, config.range_noise_mm),
        (one.prediction, config.range_prediction_mm),
        (one.speed_error, config.speed_noise_mm_s),
        (one.prediction_mm_s, config.speed_prediction_mm_s),
        (model.own.clock, config.range_clock_mm),
        (model.own.clock_mm_s, config.speed_clock_mm_s),
    )
    return quiet & all_of(between(-most, term, most) for term, most in bounds)


def _subset(model: Selection) -> Property:
    """Between the two criteria: what either machine keeps, told apart from the terms that it judges by."""
    config, own = model.own.config, model.own
    if config.removal == "either":
        kept = [one.standing.eq(USABLE).implies(~violated(one, config, "both")) for one in own.channels]
    else:
        kept = [one.standing.eq(EXCLUDED).implies(violated(one, config, "either")) for one in own.channels]
    return for_all_inputs(
        "the strict criterion admits no more satellites",
        all_of(kept),
        statement="every satellite that the strict criterion keeps (one violation removes) is also kept by the lax one (only both "
        "together remove)",
        requirements=("SAT-4",),
    )


def _once(model: Selection) -> Iterator[Property]:
    """Of the first of two channels, since one of the two has to give way."""
    channels = model.own.channels
    for number, one in enumerate(channels[1:], 1):
        identity = one.satellite.value
        yield for_all_inputs(
            f"channel {one.number}: no satellite twice",
            one.standing.eq(USABLE).implies(
                all_of(
                    ~earlier.satellite.present | earlier.satellite.value.ne(identity) for earlier in channels[:number]
                )
            ),
            statement="a satellite that an earlier channel receives as well is not usable in this one: the machine "
            "uses it once",
        )


def _counted(model: Selection) -> Iterator[Property]:
    machine, own = model.machine, model.own
    total = as_num(0, COUNT)
    for one in own.channels:
        total = total + ite(machine.flag(f"channel_{one.number}_usable"), as_num(1, COUNT), 0)
    none, some = machine.modes
    yield for_all_inputs(
        "the number of usable satellites is reported",
        machine.output("usable").eq(total) & machine.mode.eq(ite(total.eq(0), none, some)),
        statement="the reported number of usable satellites is the number of usable channels, and the machine reports whether there is any",
        requirements=("SAT-1",),
    )
    yield for_all_inputs(
        "a usable channel is reported",
        all_of(machine.flag(f"channel_{one.number}_usable").iff(one.standing.eq(USABLE)) for one in own.channels),
        statement="a channel is reported as usable exactly if its standing is USABLE",
        requirements=("SAT-1",),
    )
    yield reachable(
        "all channels usable",
        own.usable_satellites.eq(own.config.channels),
        statement="every channel can be usable at once",
        requirements=("SAT-1",),
    )
