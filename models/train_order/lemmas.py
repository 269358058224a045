"""Lemmas for the proofs of the association of patterns; they are proved themselves."""

from __future__ import annotations

from safeloc.language.expr import Bool, all_of, any_of
from safeloc.models.train_order.variables import Parts


def lemmas(own: Parts, ordered: Bool) -> dict[str, Bool]:
    """Return the lemmas: the order has no gaps, and names exactly the trains between the counters, from the low end on."""
    gaps = [here.eq(0).implies(there.eq(0)) for here, there in zip(own.order, own.order[1:], strict=False)]
    apart = [a.ne(0).implies(a.ne(b)) for n, a in enumerate(own.order) for b in own.order[:n]]
    return {
        "the order has no gaps": all_of(gaps),
        "no train is there twice": all_of(apart),
        "without an order no pattern belongs to anyone": ordered | all_of(one.eq(0) for one in own.belongs),
        "the order names the trains that are there": ordered.implies(_names(own)),
        "the order is true": ordered.implies(_ascends(own)),
    }


def _names(own: Parts) -> Bool:
    return all_of(train.inside.iff(any_of(one.eq(train.number) for one in own.order)) for train in own.trains)


def _ascends(own: Parts) -> Bool:
    """Return the condition that of two trains, one after the other in the order, the first is nearer to the low end."""
    pairs = [(a, b) for a in own.trains for b in own.trains if a is not b]
    return all_of(
        (here.eq(a.number) & there.eq(b.number)).implies(a.place < b.place)
        for here, there in zip(own.order, own.order[1:], strict=False)
        for a, b in pairs
    )
