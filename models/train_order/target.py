"""The catalogue entry of the machine that keeps the order of trains."""

from __future__ import annotations

from safeloc.models import train_order
from safeloc.models.fibre.picture import order_picture
from safeloc.models.train_order import TrainOrderConfig
from safeloc.models.train_order.simulate import simulate
from safeloc.properties import train_order as claims
from safeloc.target import Entry, Family, Hazard, Target, single


def target(config: TrainOrderConfig) -> Target:
    """Make the machine."""
    model = train_order.build(train_order.parts(config))
    return single(
        model.machine,
        claims.properties(model),
        config,
        simulate=lambda seed: simulate(config, seed=seed),
        pictures=(order_picture(),),
    )


ENTRIES = (
    Entry(
        "train_order",
        "whose a pattern is, by order on the track",
        TrainOrderConfig,
        target,
        Family.FIBRE,
        place=70,
        simulates=True,
        no_interval="It tells whose a pattern is.",
        hazard=Hazard(
            "a pattern is taken for that of another train",
            (
                "a pattern holds its train",
                "the order is that on the track",
            ),
        ),
    ),
)
