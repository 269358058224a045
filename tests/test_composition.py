"""Composition: what an earlier machine computes acts in the same step; a wrong wire is refused."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safeloc.composition import compose
from safeloc.errors import ModelError
from safeloc.expr import Expr, Var, boolean, number, optional
from safeloc.interpret import run
from safeloc.machine import Machine, Transition, modes
from safeloc.units import MM, MS

IDLE, BUSY = modes("IDLE", "BUSY")


class Pair:
    """A counter of millimetres, and an alarm that reads it."""

    def __init__(self) -> None:
        self.step, self.sum = number("step", MM, 0, 10), number("sum", MM, 0, 1000)
        self.counter = Machine(
            name="counter",
            modes=(IDLE, BUSY),
            inputs=[self.step],
            state={self.sum: 0},
            outputs={"sum": self.sum, "high": self.sum > 15},
            transitions=[Transition("add", IDLE, IDLE, self.step > 0, {self.sum: self.sum + self.step})],
        )
        self.level, self.time, self.quiet = number("level", MM, 0, 2000), number("t", MS, 0, 9), boolean("quiet")
        self.extra = optional("extra", MM, 0, 9)
        self.alarm = Machine(
            name="alarm",
            modes=(IDLE, BUSY),
            inputs=[self.level, self.time, self.quiet, self.extra],
            state={},
            outputs={},
            transitions=[Transition("ring", IDLE, BUSY, (self.level > 15) & ~self.quiet)],
        )


def test_a_wire_acts_in_the_same_step() -> None:
    """The alarm rings in the very step in which the sum passes the level, and names carry their machine."""
    pair = Pair()
    whole = compose("both", (pair.counter, pair.alarm), {pair.level: pair.counter.output("sum")}).system
    calm = {"alarm.t": 0, "alarm.quiet": False}
    trace = run(whole, [{"counter.step": 10, **calm}, {"counter.step": 6, **calm}])
    assert [step.fired for step in trace.steps] == [
        {"counter.fired": "add", "alarm.fired": "(stay)"},
        {"counter.fired": "add", "alarm.fired": "ring"},
    ]
    assert trace.steps[-1].outputs["counter.sum"] == 16
    assert [var.name for var in whole.inputs] == [
        "counter.step",
        "alarm.t",
        "alarm.quiet",
        "alarm.extra.present",
        "alarm.extra",
    ]


def test_terms_of_a_part_are_terms_of_the_whole() -> None:
    """`of` rewrites a machine's own term; the rewritten variable is one of the whole's."""
    pair = Pair()
    both = compose("both", (pair.counter, pair.alarm), {pair.level: pair.counter.output("sum")})
    assert both.of(pair.counter)(pair.sum) is both.system.variable("counter.sum")


def test_a_shared_input_is_kept_once() -> None:
    """A variable that both declare as the same object is one input, under its own name."""
    pair = Pair()
    twin = Machine("twin", (IDLE, BUSY), [pair.step], {}, {}, [Transition("go", IDLE, BUSY, pair.step > 3)])
    whole = compose("both", (pair.counter, twin), {}, shared=[pair.step]).system
    assert [var.name for var in whole.inputs] == ["step"]
    assert run(whole, [{"step": 4}]).steps[0].fired == {"counter.fired": "add", "twin.fired": "go"}


def test_a_wired_optional_input_is_no_longer_absent() -> None:
    """Where value and presence are wired, no optional input is left to the stream."""
    pair = Pair()
    wires: dict[Var, Expr] = {pair.extra.value: pair.step, pair.extra.present: pair.step > 0}
    whole = compose("both", (pair.counter, pair.alarm), wires).system
    assert whole.optionals == ()
    assert "alarm.extra" not in [var.name for var in whole.inputs]


WRONG: dict[str, tuple[Callable[[Pair], dict[Var, Expr]], str]] = {
    "unknown input": (
        lambda pair: {boolean("gone"): pair.step > 0},
        "composition 'both': wires lead to ['gone'], which are no inputs of ['counter', 'alarm'].",
    ),
    "kind": (
        lambda pair: {pair.level: pair.step > 0},
        "composition 'both': the wire to 'level' mixes a number and a truth value.",
    ),
    "unit": (
        lambda pair: {pair.time: pair.sum},
        "composition 'both': the wire to 't' carries mm, not ms.",
    ),
    "reads itself": (
        lambda pair: {pair.quiet: pair.level > 3},
        "composition 'both': the wire to 'quiet' reads ['level'], which no earlier machine has.",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_wire_is_refused(name: str) -> None:
    """Unknown input, kind, unit, and a machine that is not earlier: the message names wire and remedy."""
    pair = Pair()
    wires, message = WRONG[name]
    with pytest.raises(ModelError) as caught:
        compose("both", (pair.counter, pair.alarm), wires(pair))
    assert str(caught.value) == message


def test_names_must_differ() -> None:
    """The same machine twice would give two variables one name."""
    pair = Pair()
    with pytest.raises(ModelError, match=r"machines \['counter', 'counter'\] must have distinct names"):
        compose("both", (pair.counter, pair.counter), {})
