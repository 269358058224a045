"""The world of a head's samples: the wheels that truly passed in a cycle, and the motion of a wheel on the head.

A train brakes and accelerates while its wheels are on the head. So a wheel that is fast enough cannot stop there, and takes about as long
over each of the two channels.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Lit, Num, abs_, all_of, between, exact_to, ite, maximum, minimum
from safeloc.language.units import COUNT, UM, UM_PER_MM, UM_S, US, US_PER_S
from safeloc.language.world import Law, World
from safeloc.models.axle_head import DOWN, UP
from safeloc.models.counting_head.configuration import CountingHeadConfig
from safeloc.models.counting_head.variables import Parts

HEARD = "the head counts each wheel that passes, or tells"
PLACE = "the head's mode is where the wheel is"
_PM = UM_S.times(US)


def world(own: Parts) -> World:
    """Return the world: the wheels of this cycle, and place and speed of the one that is nearest to the head."""
    over = own.true_samples >= own.cycle_samples

    def after(passed: Num, way: Lit) -> Num:
        more = ite(over, Lit(0, COUNT), passed) + ite(own.passes.eq(way), Lit(1, COUNT), 0)
        return minimum(more, own.cycle_samples)

    comes, disturbed = ~_on(own, own.wheel) & _on(own, own.wheel_now), own.head_mode.eq(own.head_modes[-1])
    return own.declared.world(
        moves={
            own.true_samples: ite(over, Lit(1, COUNT), own.true_samples + 1),
            own.true_axles_upwards: after(own.true_axles_upwards, UP),
            own.true_axles_downwards: after(own.true_axles_downwards, DOWN),
            own.wheel: own.wheel_now,
            own.from_low: own.wheel_now_from_low,
            own.speed: own.next_speed,
            own.was_disturbed: disturbed,
            own.speed_came: ite(
                disturbed | own.was_disturbed, Lit(0, UM_S), ite(comes, abs_(own.next_speed), own.speed_came)
            ),
        },
        clauses={**_head_laws(own), **motion(own, _on(own, own.wheel) | _on(own, own.wheel_now))},
    )


def _on(own: Parts, wheel: Num) -> Bool:
    return between(0, wheel, own.config.end_um - 1)


def _head_laws(own: Parts) -> dict[str, Bool | Law]:
    return {
        HEARD: Law(
            own.counted.eq(own.passes) | own.may_miss,
            "In each sample the head counts the wheel that leaves it on the far side, with its direction, and no other; or it tells that it may "
            "have missed one.",
            source="proved of the counting head",
            owner="supplier",
            check="proved in the composition",
        ),
        PLACE: Law(
            _place(own),
            "In each sample the head's mode gives the stretch on which the wheel is, and the side that it came from, unless the head is disturbed.",
            figures=("spacing_mm", "overlap_mm"),
            source="proved of the counting head",
            owner="supplier",
            check="proved in the composition",
        ),
        "a wheel comes from where it was": _same_wheel(own),
    }


def _same_wheel(own: Parts) -> Law:
    came = ~_on(own, own.wheel) & _on(own, own.wheel_now)
    return Law(
        own.wheel_now_from_low.iff(ite(came, own.wheel < 0, own.from_low)),
        "A wheel comes from the side on which it was before it came on the head.",
        source="[D] a definition, as in the counting head",
        owner="nobody",
    )


def _place(own: Parts) -> Bool:
    """Return the condition that the mode is where the wheel is."""
    free, *modes, _ = own.head_modes
    alone, end, wheel = own.config.alone_um, own.config.end_um, own.wheel_now
    on_a, on_both, on_b = (
        between(0, wheel, alone - 1),
        between(alone, wheel, end - alone - 1),
        between(end - alone, wheel, end - 1),
    )
    low = own.wheel_now_from_low
    stretches = ((on_a, low), (on_both, low), (on_b, low), (on_b, ~low), (on_both, ~low), (on_a, ~low))
    places = [own.head_mode.eq(mode).implies(on & way) for mode, (on, way) in zip(modes, stretches, strict=True)]
    return all_of([own.head_mode.eq(free).implies(~_on(own, wheel)), *places])


def change_um_s(config: CountingHeadConfig) -> int:
    """Return by how much a wheel's speed changes at most in a sample, um/s rounded up: the world's own figure, not the one that the machine reckons with."""
    return -(-config.counter.change_mm_s2 * UM_PER_MM * config.head.sample_us // US_PER_S)


def motion(own: Parts, holds: Bool) -> dict[str, Bool | Law]:
    """Return the laws of a wheel's motion from sample to sample.

    holds  the wheel before and after the sample is one and the same, of one train
    """
    slow, fast = minimum(own.speed, own.next_speed), maximum(own.speed, own.next_speed)
    sample, rounding = Lit(own.config.head.sample_us, US), exact_to(Lit(1, UM), _PM)
    run = exact_to(own.wheel_now - own.wheel, _PM)
    return {
        "a wheel on the head keeps to its train's traction and brakes": Law(
            holds.implies(abs_(own.next_speed - own.speed) <= Lit(change_um_s(own.config), UM_S)),
            "From one sample to the next, a wheel changes its speed by no more than the train's traction or brakes can.",
            figures=("change_mm_s2", "sample_us"),
            source="[M, fairly sure] traction and brake",
            owner="operator",
            check="vehicle approval",
        ),
        "a wheel on the head runs as fast as it is": Law(
            holds.implies((run > slow * sample - rounding) & (run < fast * sample + rounding)),
            "From one sample to the next, a wheel runs as far as at a speed between that before and that after; places are in whole um.",
            figures=("sample_us",),
            source="[D] kinematics",
            owner="operator",
            check="none needed",
        ),
    }
