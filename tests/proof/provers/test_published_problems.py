"""Problems that others have published with their verdicts, written in our language: we agree with every one.

From jkind: smooth, farmer, bridge_and_torch, integrate. From Pono: simple_counter_integer,
combined-true, combined-false. Their files are not part of this project; numbers are bounded here, as our language
asks, by ranges that their reachable states do not leave.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import pytest

from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Num,
    NumVar,
    all_of,
    any_of,
    as_num,
    boolean,
    choice,
    enumeration,
    ite,
    maximum,
    members,
    number,
)
from safeloc.language.machine import ANY, Initial, Machine, Transition, modes
from safeloc.language.spec import Goal, always, never, observe
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Violated, word
from safeloc.language.world import World
from safeloc.proof.provers.bmc import bmc
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove_one

RUN = modes("RUN")[0]
Var = NumVar | BoolVar


def _data_flow(
    name: str, inputs: list[Var], state: Mapping[Var, Initial], step: Mapping[Var, Expr], assume: Bool
) -> Machine:
    """A data-flow program as a machine of one transition that always fires."""
    return Machine(
        name,
        (RUN,),
        inputs,
        state,
        {},
        [Transition("step", RUN, RUN, set=step)],
        world=World(clauses={"assumption": assume}, reads_machine="the test asks it"),
    )


def smooth() -> tuple[Goal, int]:
    """`counter <= 10` fails once the signal has been true for eleven steps."""
    x, y, z, w = inputs = [number(name, COUNT, -100, 100) for name in "xyzw"]
    counter = number("counter", COUNT, 0, 1000)
    signal = (x < y) & (y < z) & (z < w) & (x < w)
    step: dict[Var, Expr] = {counter: ite(signal, counter + 1, 0)}
    machine = _data_flow("smooth", [*inputs], {counter: 0}, step, counter < 1000)
    return observe(lower(machine), always("cex", counter <= 10)), 11


def farmer() -> tuple[Goal, int]:
    """Wolf, goat and cabbage can all be brought across: the puzzle's solution is the counterexample, at K = 8."""
    _, wolf, goat, cabbage = payload = members("payload", "EMPTY", "WOLF", "GOAT", "CABBAGE")
    chosen = choice("choice", enumeration(payload))
    sides = {member: boolean(f"{member.label}_right") for member in (wolf, goat, cabbage)}
    rower, fine = boolean("farmer_right"), boolean("fine")
    crossed: dict[Var, Expr] = {side: ite(chosen.eq(member), ~side, side) for member, side in sides.items()}
    safe = all_of(
        sides[one].iff(sides[other]).implies(rower.iff(sides[one])) for one, other in ((wolf, goat), (goat, cabbage))
    )
    wellformed = all_of(chosen.eq(member).implies(rower.iff(side)) for member, side in sides.items())
    step: dict[Var, Expr] = {**crossed, rower: ~rower, fine: fine & safe & wellformed}
    start: dict[Var, Initial] = {**dict.fromkeys(sides.values(), False), rower: False, fine: True}
    machine = _data_flow("farmer", [chosen], start, step, TRUE)
    solved = all_of(sides.values()) & rower & fine & safe
    return observe(lower(machine), never("solved", solved)), 7


def bridge(*, cheaper: bool) -> tuple[Goal, int | None]:
    """Four people cross a bridge with one torch: 15 minutes are enough (violated), and no less is (valid)."""
    people = {boolean(f"{name}_moves"): boolean(name) for name in "abcd"}
    torch, cost = boolean("torch"), number("cost", COUNT, 0, 200)
    slowest: Num = as_num(0, COUNT)
    crowd: Num = as_num(0, COUNT)
    for moves, minutes in zip(people, (1, 2, 5, 8), strict=True):
        slowest = maximum(slowest, ite(moves, as_num(minutes, COUNT), 0))
        crowd = crowd + ite(moves, as_num(1, COUNT), 0)
    allowed = all_of(moves.implies(side.iff(torch)) for moves, side in people.items())
    across: dict[Var, Expr] = {side: ite(moves, ~side, side) for moves, side in people.items()}
    start: dict[Var, Initial] = {**dict.fromkeys(people.values(), False), torch: False, cost: 0}
    step: dict[Var, Expr] = {**across, torch: ~torch, cost: cost + slowest}
    assume = allowed & any_of(people) & (crowd <= 2) & (cost < 190)
    machine = _data_flow("bridge", [*people], start, step, assume)
    solved = all_of(people.values())
    if cheaper:
        return observe(lower(machine), never("prop1", solved & (cost < 15))), None
    return observe(lower(machine), never("prop2", solved & cost.eq(15))), 5


def integrate() -> tuple[Goal, None]:
    """The sum of positive inputs only is positive (prop1, valid)."""
    x, total, history = number("x", COUNT, -9, 9), number("total", COUNT, -1000, 1000), boolean("history")
    started = boolean("started")
    step: dict[Var, Expr] = {total: total + x, history: history & (x > 0), started: TRUE}
    within = (total + x <= 1000) & (total + x >= -1000)
    machine = _data_flow("integrate", [x], {total: 0, history: True, started: False}, step, within)
    return observe(lower(machine), always("prop1", (started & history).implies(total > 0))), None


def simple_counter() -> tuple[Goal, None]:
    """A counter that starts again after 5 never exceeds 6 (valid)."""
    counter = number("counter", COUNT, 0, 100)
    step: dict[Var, Expr] = {counter: ite(counter > 5, 0, counter + 1)}
    machine = _data_flow("simple_counter_integer", [], {counter: 0}, step, counter < 100)
    return observe(lower(machine), always("bounded", counter <= 6)), None


def combined(*, least: int, most: int, depth: int | None) -> tuple[Goal, int | None]:
    """x + y is at most 5; b2 says x + y + v >= 5 and b1 says x + y <= 4, in the step before, for a constant v."""
    x, y = number("x", COUNT, -50, 50), number("y", COUNT, -50, 50)
    v, b1, b2, byte = number("v", COUNT, -50, 50), boolean("b1"), boolean("b2"), number("c", COUNT, 0, 255)
    step: dict[Var, Expr] = {b1: x + y <= 4, b2: x + y + v >= 5, byte: ite(byte < 5, byte + 1, 0)}
    assume = (x + y <= 5) & (v >= least) & (v <= most)
    machine = _data_flow("combined", [x, y], {v: ANY, b1: True, b2: False, byte: 0}, step, assume)
    return observe(lower(machine), never("both", b1 & b2)), depth


VALID: dict[str, Callable[[], tuple[Goal, int | None]]] = {
    "bridge_and_torch prop1": lambda: bridge(cheaper=True),
    "integrate prop1": integrate,
    "simple_counter_integer": simple_counter,
    "combined-true": lambda: combined(least=0, most=0, depth=None),
}
INVALID: dict[str, Callable[[], tuple[Goal, int | None]]] = {
    "smooth": smooth,
    "farmer": farmer,
    "bridge_and_torch prop2": lambda: bridge(cheaper=False),
    "combined-false": lambda: combined(least=-50, most=1, depth=1),
}


@pytest.mark.parametrize("name", VALID)
def test_published_as_valid(name: str) -> None:
    """A problem that its authors call valid is proved, for runs of any length."""
    goal, _ = VALID[name]()
    assert word(prove_one(goal, Limits(depth=10, seconds=60.0))) == "proved"


@pytest.mark.parametrize("name", INVALID)
def test_published_as_invalid(name: str) -> None:
    """A problem that its authors call invalid is violated, in the least number of steps."""
    goal, steps = INVALID[name]()
    verdict = bmc(goal, Limits(depth=15, seconds=60.0))
    assert isinstance(verdict, Violated)
    assert verdict.trace is not None
    assert len(verdict.trace.steps) == steps
