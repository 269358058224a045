"""Small machines whose assumption leads into a dead end after a known number of steps, each with a repaired twin.

A declaration gets `mended` and returns the system; broken and mended differ in one term or range.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from safeloc.language.composition import compose
from safeloc.language.expr import TRUE, Bool, abs_, between, boolean, floor_div, ite, maximum, minimum, number, optional
from safeloc.language.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.language.world import World

(S,) = modes("S")
A, B, C = modes("A", "B", "C")
TWO = modes("FIRST", "SECOND")
GO, K = boolean("i"), number("k", COUNT, 0, 3)


@dataclass(frozen=True)
class Seed:
    """The number of steps of the shortest run into the dead end, and the declaration."""

    depth: int
    make: Callable[[bool], TransitionSystem]


def counter(last: int, allowed: int) -> TransitionSystem:
    """Counts every step, up to `last`; the assumption is that it stays within `allowed`."""
    x = number("x", COUNT, 0, 200)
    up = Transition("up", S, S, TRUE, {x: minimum(x + 1, last)})
    return lower(
        Machine(
            "counter",
            (S,),
            [GO],
            {x: 0},
            {},
            [up],
            world=World(clauses={"assumption": x <= allowed}, reads_machine="the test asks it"),
        )
    )


def late(mended: bool) -> TransitionSystem:
    """No inputs are lawful once 80 is reached."""
    return counter(79 if mended else 200, 79)


def soon(mended: bool) -> TransitionSystem:
    """No inputs are lawful once 5 is reached."""
    return counter(4 if mended else 5, 4)


def very_late(mended: bool) -> TransitionSystem:
    """No inputs are lawful once 100 is reached."""
    return counter(99 if mended else 100, 99)


def mode(mended: bool) -> TransitionSystem:
    """In the second mode the assumption requires more of an input than its range has."""
    now = current_mode(TWO)
    asked = now.eq(TWO[1]).implies(K + K > (5 if mended else 6))
    return lower(
        Machine(
            "mode",
            TWO,
            [K],
            {},
            {},
            [Transition("on", *TWO)],
            world=World(clauses={"assumption": asked}, reads_machine="the test asks it"),
        )
    )


def third_mode(mended: bool) -> TransitionSystem:
    """In the third mode the assumption contradicts itself."""
    now, x = current_mode((A, B, C)), number("x", COUNT, 0, 9)
    rows = [Transition("on", A, B, GO), Transition("count", B, B, x < 4, {x: x + 1}), Transition("off", B, C, rank=1)]
    asked = now.eq(C).implies(K.eq(3) & (GO if mended else K < 2))
    return lower(
        Machine(
            "third",
            (A, B, C),
            [GO, K],
            {x: 0},
            {},
            rows,
            world=World(clauses={"assumption": asked}, reads_machine="the test asks it"),
        )
    )


def error(mended: bool) -> TransitionSystem:
    """An error grows in every step and must stay within 100."""
    e, total = number("e", COUNT, 0 if mended else 1, 3), number("total", COUNT, 0, 100)
    rows = [Transition("add", S, S, TRUE, {total: total + e})]
    return lower(
        Machine(
            "error",
            (S,),
            [e],
            {total: 0},
            {},
            rows,
            world=World(clauses={"assumption": total + e <= 100}, reads_machine="the test asks it"),
        )
    )


def apart(mended: bool) -> TransitionSystem:
    """Two sums must stay near each other, and one always gains on the other."""
    u, v = number("u", COUNT, 1, 2), number("v", COUNT, 0, 2 if mended else 0)
    gap = number("gap", COUNT, -10, 10)
    rows = [Transition("add", S, S, TRUE, {gap: gap + u - v})]
    return lower(
        Machine(
            "apart",
            (S,),
            [u, v],
            {gap: 0},
            {},
            rows,
            world=World(clauses={"assumption": abs_(gap + u - v) <= 10}, reads_machine="the test asks it"),
        )
    )


def battery(mended: bool) -> TransitionSystem:
    """An input is present at least every third step, and each time uses one of five charges."""
    o, gap, charge = optional("o", COUNT, 1, 9), number("gap", COUNT, 0, 3), number("charge", COUNT, 0, 5)
    spent = charge if mended else charge - 1
    rows = [
        Transition("told", S, S, o.present, {gap: 0, charge: maximum(spent, 0)}),
        Transition("silent", S, S, ~o.present, {gap: minimum(gap + 1, 3)}),
    ]
    asked = (o.present | (gap < 2)) & (~o.present | (charge > 0))
    return lower(
        Machine(
            "battery",
            (S,),
            [o],
            {gap: 0, charge: 5},
            {},
            rows,
            world=World(clauses={"assumption": asked}, reads_machine="the test asks it"),
        )
    )


def rising(mended: bool) -> TransitionSystem:
    """Every value of the input is above the last one."""
    o, last = optional("o", COUNT, 0, 9), number("last", COUNT, 0, 9)
    rows = [Transition("told", S, S, o.present, {last: o.value})]
    above = o.value >= last if mended else o.value > last
    return lower(
        Machine(
            "rising",
            (S,),
            [o],
            {last: 0},
            {},
            rows,
            world=World(clauses={"assumption": o.present & above}, reads_machine="the test asks it"),
        )
    )


def end_of_line(mended: bool) -> TransitionSystem:
    """A train that cannot stand still runs on a line that ends."""
    step, truth = number("step", COUNT, 0 if mended else 10, 20), number("truth", COUNT, 0, 100)
    return lower(
        Machine(
            "line", (S,), [GO], {}, {}, [],
            world=World(
                ghosts={truth: 0},
                choices=[step],
                moves={truth: truth + step},
                clauses={"assumption": truth + step <= 100}, reads_machine="the test asks it"),
        )
    )  # fmt: skip


def brakes(mended: bool) -> TransitionSystem:
    """A train may run so fast that it cannot stop before the end of the line."""
    speed, faster, truth = number("speed", COUNT, 0, 5), number("next", COUNT, 0, 5), number("truth", COUNT, 0, 30)
    can_stop: Bool = truth + faster + faster * 5 <= 30 if mended else truth + faster <= 30
    return lower(
        Machine(
            "brakes", (S,), [GO], {}, {}, [],
            world=World(
                ghosts={truth: 0, speed: 0},
                choices=[faster],
                moves={truth: truth + faster, speed: faster},
                clauses={"assumption": (abs_(faster - speed) <= 1) & can_stop}, reads_machine="the test asks it"),
        )
    )  # fmt: skip


def one_way(mended: bool) -> TransitionSystem:
    """A position that moves by one in every step, and never turns, reaches the end of its range."""
    y, d, held = number("y", COUNT, -20, 20), number("d", COUNT, -1, 1), number("held", COUNT, -1, 1)
    rows = [Transition("move", S, S, TRUE, {y: y + d, held: d})]
    moves = d.ne(0) & (held.eq(0) | d.eq(held))
    onward = TRUE if mended else moves
    return lower(
        Machine(
            "way",
            (S,),
            [d],
            {y: 0, held: 0},
            {},
            rows,
            world=World(clauses={"assumption": between(-20, y + d, 20) & onward}, reads_machine="the test asks it"),
        )
    )


def rounded(mended: bool) -> TransitionSystem:
    """An input has to be above a tenth of a counter."""
    x = number("x", COUNT, 0, 100)
    tenth = floor_div(x, 10)
    rows = [Transition("up", S, S, TRUE, {x: minimum(x + 1, 100)})]
    return lower(
        Machine(
            "rounded",
            (S,),
            [K],
            {x: 0},
            {},
            rows,
            world=World(
                clauses={"assumption": minimum(tenth, 3) <= K if mended else tenth <= K},
                reads_machine="the test asks it",
            ),
        )
    )


def window(mended: bool) -> TransitionSystem:
    """An input has to be inside a window that moves out of its range."""
    x = number("x", COUNT, 0, 100)
    low = maximum(x - 30, 0)
    rows = [Transition("up", S, S, TRUE, {x: minimum(x + 1, 100)})]
    return lower(
        Machine(
            "window",
            (S,),
            [K],
            {x: 0},
            {},
            rows,
            world=World(
                clauses={"assumption": (minimum(low, 2) if mended else low) <= K}, reads_machine="the test asks it"
            ),
        )
    )


def parity(mended: bool) -> TransitionSystem:
    """A flag has to say both that a count is even and that it is a multiple of three."""
    two, three = number("two", COUNT, 0, 1), number("three", COUNT, 0, 2)
    rows = [
        Transition("count", S, S, TRUE, {two: ite(two.eq(1), 0 * two, two + 1), three: ite(three.eq(2), 0 * three, three + 1)})
    ]  # fmt: skip
    told = GO.iff(two.eq(0)) & (TRUE if mended else GO.iff(three.eq(0)))
    return lower(
        Machine(
            "parity",
            (S,),
            [GO],
            {two: 0, three: 0},
            {},
            rows,
            world=World(clauses={"assumption": told}, reads_machine="the test asks it"),
        )
    )


def doomed_early(mended: bool) -> TransitionSystem:
    """A choice in the first step is forbidden 50 steps later."""
    x, y = number("x", COUNT, 0, 50), number("y", COUNT, 0, 3)
    rows = [
        Transition("choose", S, S, x.eq(0), {x: 1 + 0 * x, y: K}),
        Transition("wait", S, S, x > 0, {x: minimum(x + 1, 50)}),
    ]
    asked = (x >= 50).implies(y <= 3 if mended else y <= 0)
    return lower(
        Machine(
            "doomed",
            (S,),
            [K],
            {x: 0, y: 0},
            {},
            rows,
            world=World(clauses={"assumption": asked}, reads_machine="the test asks it"),
        )
    )


def nested(mended: bool) -> TransitionSystem:
    """A slow counter behind a fast one runs out."""
    fast, slow = number("fast", COUNT, 0, 7), number("slow", COUNT, 0, 20)
    rows = [
        Transition("carry", S, S, fast.eq(7), {fast: 0 * fast, slow: minimum(slow + 1, 8)}),
        Transition("count", S, S, fast < 7, {fast: fast + 1}),
    ]
    asked = slow <= 8 if mended else slow < 8
    return lower(
        Machine(
            "nested",
            (S,),
            [GO],
            {fast: 0, slow: 0},
            {},
            rows,
            world=World(clauses={"assumption": asked}, reads_machine="the test asks it"),
        )
    )


def wired(mended: bool) -> TransitionSystem:
    """A later machine assumes a property of an earlier one that no machine guarantees."""
    a, q, b, j = number("a", COUNT, 0, 9), number("q", COUNT, 0, 9), number("b", COUNT, 0, 9), boolean("j")
    first = Machine(
        "first", (S,), [GO], {a: 0}, {}, [Transition("up", S, S, TRUE, {a: minimum(a + 1, 3 if mended else 9)})]
    )
    second = Machine(
        "second",
        (S,),
        [q, j],
        {b: 0},
        {},
        [Transition("take", S, S, j, {b: q})],
        world=World(clauses={"assumption": q <= 3}, reads_machine="the test asks it"),
    )
    return compose("wired", [first, second], {q: a}).system


def owing(mended: bool) -> TransitionSystem:
    """The later machine's assumption is discharged; the earlier one's own assumption ends."""
    a, q, b = number("a", COUNT, 0, 20), number("q", COUNT, 0, 20), number("b", COUNT, 0, 20)
    step = number("step", COUNT, 0 if mended else 1, 2)
    add = Transition("add", S, S, TRUE, {a: a + step})
    first = Machine(
        "first",
        (S,),
        [step],
        {a: 0},
        {},
        [add],
        world=World(clauses={"assumption": a + step <= 20}, reads_machine="the test asks it"),
    )
    second = Machine(
        "second",
        (S,),
        [q],
        {b: 0},
        {},
        [Transition("take", S, S, TRUE, {b: q})],
        world=World(clauses={"assumption": q <= 20}, reads_machine="the test asks it"),
    )
    return compose("owing", [first, second], {q: a}, discharge=[second]).system


def at_odds(mended: bool) -> TransitionSystem:
    """Two machines require opposite things of a movement that they share, from the fifteenth step on."""
    step, x, j = number("step", COUNT, -5, 5), number("x", COUNT, 0, 15), boolean("j")
    g = number("g", COUNT, 0, 1)
    up = Transition("up", S, S, TRUE, {x: minimum(x + 1, 15)})
    first = World(
        {g: 0}, [step], {g: g}, {"on at the end": (x >= 15).implies(step >= 1)}, reads_machine="the test asks it"
    )
    second = World({g: 0}, [step], {g: g}, {"not on": step <= (1 if mended else 0)}, reads_machine="the test asks it")
    one = Machine("one", (S,), [GO], {x: 0}, {}, [up], world=first)
    other = Machine("other", (S,), [j], {}, {}, [], world=second)
    return compose("odds", [one, other], {}, shared=[step, g]).system


def open_start(mended: bool) -> TransitionSystem:
    """A first state may be chosen that is near the end."""
    y = number("y", COUNT, 0, 100)
    rows = [Transition("up", S, S, TRUE, {y: minimum(y + 1, 100)})]
    asked = TRUE if mended else y < 40
    return lower(
        Machine(
            "start",
            (S,),
            [GO],
            {y: ANY},
            {},
            rows,
            world=World(clauses={"assumption": asked}, reads_machine="the test asks it"),
            initially=y <= 10,
        )
    )


SEEDS: Mapping[str, Seed] = {
    make.__name__: Seed(depth, make)
    for depth, make in (
        (1, mode),
        (1, rising),
        (2, parity),
        (3, wired),
        (5, soon),
        (5, end_of_line),
        (5, apart),
        (6, third_mode),
        (7, battery),
        (8, brakes),
        (10, owing),
        (15, at_odds),
        (20, one_way),
        (30, open_start),
        (34, window),
        (34, error),
        (40, rounded),
        (50, doomed_early),
        (64, nested),
        (80, late),
        (100, very_late),
    )
}
