"""The world of a section between axle counters: the axles in it, and the driver of a sweep.

A sweep is a train that runs on sight through a section of unknown state. Its driver sees whatever stands in his way. If he
runs from one end to the other, he sees everything that stood in the section when he came in; if he turns, he sees nothing of
the part beyond. Only the counters notice vehicles that he loses on the way.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Expr, Lit, Num, all_of, between, ite
from safeloc.language.world import Law, World
from safeloc.models.axle_section.variables import (
    FROM_HIGH,
    FROM_LOW,
    IN_HIGH,
    IN_LOW,
    NO_HEAD,
    NOBODY,
    OUT_HIGH,
    OUT_LOW,
    RAN_THROUGH,
    TURNED_HIGH,
    TURNED_LOW,
    Parts,
)


def world(own: Parts) -> World:
    """Return the world: axles in the section, and the progress of the sweep."""
    return own.declared.world(
        moves={
            own.axles: _axles_after(own),
            own.sweep: _sweep_after(own),
            own.true_axles_before_sweep: _stood_after(own),
        },
        clauses=_clauses(own),
    )


def _clauses(own: Parts) -> dict[str, Bool | Law]:
    return {
        "a head without a fault counts every axle": Law(
            (~own.fault).implies(_counts_are_true(own)),
            "As long as neither head is at fault, every axle that passes a head is reported once, in its cycle and with its direction.",
            source="[M] the safety case of the axle counter",
            owner="supplier",
            check="counts of neighbouring sections compared; the sweep after every reset",
        ),
        "no more axles leave than are in the section": Law(
            between(own.axles.low, _axles_after(own), own.axles.high),
            "Axles come and go only over the two heads, and a section holds no more than twice the longest train.",
            figures=("axle_limit",),
            source="[D] a section without switches or sidings",
            owner="infrastructure",
            check="layout of the section",
        ),
        **_sweep_laws(own),
    }


def _sweep_laws(own: Parts) -> dict[str, Bool | Law]:
    """Return the laws of a sweep's report; they do not exclude vehicles lost on the way, or beyond its turning point."""
    ran = own.sweep.eq(RAN_THROUGH)
    turned = own.sweep.one_of(TURNED_LOW, TURNED_HIGH)
    return {
        "a sweep passes the heads with its axles": Law(
            _over_the_heads(own),
            "The first axle of a sweep comes in, and its last one goes out, over a head.",
            source="[D] the two heads bound the section",
            owner="infrastructure",
            check="layout of the section",
        ),
        "who reports a sweep has left the section": Law(
            own.reported_clear.implies(ran | turned),
            "A sweep is reported only when its train came in after the last request for a reset, and has left the section.",
            source="[S] Frauscher FAdC manual p. 33: a sweep train before clear",
            owner="operator",
            check="the rule book; times of request, passage and report",
        ),
        "who ran through saw all that stood in the section": Law(
            (own.reported_clear & ran).implies(own.true_axles_before_sweep.eq(0)),
            "A driver who ran on sight from one end to the other reports the section free only if nothing stood "
            "in it when he came in.",
            source="[D] running on sight",
            owner="operator",
            check="the rule book",
        ),
    }


def _counts_are_true(own: Parts) -> Bool:
    """Return the condition that at each head, in each direction, the reported axles are those that really passed it."""
    counted, true = (*own.into, *own.out), (*own.true_into, *own.true_out)
    return all_of(one.eq(other) for one, other in zip(counted, true, strict=True))


def _axles_after(own: Parts) -> Num:
    (in_low, in_high), (out_low, out_high) = own.true_into, own.true_out
    return own.axles + in_low + in_high - out_low - out_high


def _over_the_heads(own: Parts) -> Bool:
    """Return the condition that the sweep's first axle comes in, and its last one goes out, over a head."""
    passes, inside = own.sweep_passes, own.sweep.one_of(FROM_LOW, FROM_HIGH)
    axles = {IN_LOW: own.true_into[0], IN_HIGH: own.true_into[1], OUT_LOW: own.true_out[0], OUT_HIGH: own.true_out[1]}
    over = [passes.eq(head).implies(number > 0) for head, number in axles.items()]
    return all_of(over) & ite(inside, ~passes.one_of(IN_LOW, IN_HIGH), ~passes.one_of(OUT_LOW, OUT_HIGH))


def _sweep_after(own: Parts) -> Num:
    """Return the progress of the sweep. A request for reset orders a new one: earlier runs are no sweep."""
    inside_after: dict[Lit, Expr] = {IN_LOW: FROM_LOW, IN_HIGH: FROM_HIGH, NO_HEAD: own.sweep}
    inside_after[OUT_LOW] = ite(own.sweep.eq(FROM_LOW), TURNED_LOW, RAN_THROUGH)
    inside_after[OUT_HIGH] = ite(own.sweep.eq(FROM_HIGH), TURNED_HIGH, RAN_THROUGH)
    after: Num = own.sweep
    for head, where in inside_after.items():
        assert isinstance(where, Num)
        after = ite(own.sweep_passes.eq(head), where, after)
    return ite(own.reset_requested, NOBODY, after)


def _stood_after(own: Parts) -> Num:
    """Return the axles that stand in the section when the sweep comes in."""
    return ite(own.sweep_passes.one_of(IN_LOW, IN_HIGH), own.axles, own.true_axles_before_sweep)
