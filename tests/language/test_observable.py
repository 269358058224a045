"""Observable conditions of a world's laws: of one law, of a part, of two together, over a run; if one is violated, so is a law."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import replace

import pytest

from safeloc.language.composition import Clause, compose
from safeloc.language.expr import (
    Bool,
    NumVar,
    Optional,
    Var,
    abs_,
    all_of,
    any_of,
    between,
    boolean,
    ite,
    minimum,
    number,
)
from safeloc.language.interpret import evaluate
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.nodes import Value
from safeloc.language.observable import Seen, seen
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.terms import variables
from safeloc.language.units import MM
from safeloc.language.world import World

(ON,) = modes("ON")
TRUTH, NEXT, STEP = number("truth", MM, -50, 50), number("next", MM, -50, 50), number("step", MM, -5, 5)
ONE_LOW, ONE_HIGH = number("one_low", MM, -60, 60), number("one_high", MM, -60, 60)
TWO, VALID = number("two", MM, -60, 60), boolean("two_valid")
HEARD = number("heard", MM, -60, 60)


def machine(name: str, laws: Mapping[str, Bool], *inputs: Var | Optional, world: World | None = None) -> Machine:
    """A machine that keeps one more than the first number that it hears."""
    kept = number("kept", MM, -60, 60)
    first = next(var for var in inputs if isinstance(var, NumVar))
    around = World({TRUTH: ANY}, [NEXT], {TRUTH: NEXT}, dict(laws)) if world is None else world
    rows = [Transition("keep", ON, ON, set={kept: minimum(first + 1, 60)})]
    return Machine(name, (ON,), list(inputs), {kept: 0}, {"kept": kept}, rows, around)


def told(system: TransitionSystem) -> dict[str, tuple[str, bool]]:
    """Everything observable by its name: its term, and whether it is all that its clause says."""
    return {str(one): (repr(one.term), one.is_equivalent) for one in seen(system).observables}


def test_what_reads_no_ghost_is_observable_as_a_whole() -> None:
    """And what reads nothing else is not observable at all."""
    laws = {"ends are in order": ONE_LOW <= ONE_HIGH, "slow": between(-5, NEXT - TRUTH, 5)}
    assert {"m: ends are in order": ("(<= one_low one_high)", True)} == told(
        lower(machine("m", laws, ONE_LOW, ONE_HIGH))
    )


def test_the_part_that_reads_no_ghost_is_split_off() -> None:
    """Also behind a condition, and of a negated alternative; what is left over is not told to be all of it."""
    law = VALID.implies((ONE_LOW <= ONE_HIGH) & (ONE_LOW <= NEXT)) & ~((NEXT < 0) | (ONE_HIGH < 0))
    found = told(lower(machine("m", {"l": law}, ONE_LOW, ONE_HIGH, VALID)))
    assert {"m: l": ("(and (or (not two_valid) (<= one_low one_high)) (not (< one_high 0)))", False)} == found


def test_two_laws_that_bound_the_same_truth_exclude_each_other() -> None:
    """An interval and a point that both hold the truth: the point is in the interval."""
    laws = {"interval": between(ONE_LOW, NEXT, ONE_HIGH), "point": VALID.implies(NEXT.eq(TWO))}
    (both,) = seen(lower(machine("m", laws, ONE_LOW, ONE_HIGH, TWO, VALID))).observables
    assert "m: interval / m: point" == str(both)
    for low, high, two, valid, expected in (
        (1, 3, 2, True, True), (1, 3, 0, True, False), (1, 3, 4, True, False), (1, 3, 4, False, True),
    ):  # fmt: skip
        values: dict[Var, Value] = {ONE_LOW: low, ONE_HIGH: high, TWO: two, VALID: valid}
        assert [expected] == evaluate([both.term], values)


def test_bounds_of_multiples_are_compared() -> None:
    """Twice the truth and its contrary bound the truth as well; rounding goes to where nothing is claimed too much."""
    laws = {"twice": TWO <= NEXT * 2, "contrary": ONE_LOW <= 0 - NEXT}
    (both,) = seen(lower(machine("m", laws, TWO, ONE_LOW))).observables
    for two, low, expected in ((4, -2, True), (5, -2, False), (5, -3, True), (4, -1, False)):
        assert [expected] == evaluate([both.term], {TWO: two, ONE_LOW: low})


@pytest.mark.parametrize(
    ("law", "last"),
    [
        (ONE_LOW <= NEXT, 5), (ONE_LOW < NEXT, 4), (~(NEXT <= ONE_LOW), 4), (~(NEXT < ONE_LOW), 5),
    ],
)  # fmt: skip
def test_a_bound_is_exact(law: Bool, last: int) -> None:
    """A truth of 5 is told by another law; up to this number the bound holds, and not beyond."""
    (both,) = seen(lower(machine("m", {"bound": law, "point": NEXT.eq(TWO)}, TWO, ONE_LOW))).observables
    assert [[True], [False]] == [evaluate([both.term], {TWO: 5, ONE_LOW: low}) for low in (last, last + 1)]


def test_bounds_that_no_values_violate_are_left_out() -> None:
    """The ends of a line exclude each other never."""
    laws = {"on the line": between(-50, NEXT, 50), "on the long line": between(-60, NEXT, 60)}
    assert {} == told(lower(machine("m", laws, ONE_LOW)))


def test_ghosts_that_inputs_decide_are_remembered() -> None:
    """The last number that was heard is no secret; a ghost that starts anywhere is, and one that moves by a secret."""
    heard, free, moved = number("last", MM, -60, 60), number("free", MM, -60, 60), number("moved", MM, -60, 60)
    laws = {"near": abs_(ONE_LOW - heard) <= 9, "far": ONE_LOW <= free, "moves": ONE_LOW <= moved}
    around = World({heard: 0, free: ANY, moved: 0}, [NEXT], {heard: ONE_LOW, free: ONE_LOW, moved: NEXT}, laws)
    found = seen(lower(machine("m", {}, ONE_LOW, world=around)))
    assert ["m: near"] == [str(one) for one in found.observables]
    assert {heard: 0} == dict(found.first)
    assert found.recalls(found.observables[0])
    assert ["m: far", "m: moves"] == [str(one) for one in found.stated if not found.of(one)]


# ------------------------------------------------------------------ over a run


WANDER, NEXT_WANDER = number("wander", MM, -4, 4), number("next_wander", MM, -4, 4)
RUN = World(
    {WANDER: ANY}, [STEP, NEXT_WANDER], {WANDER: ite(VALID, NEXT_WANDER, WANDER)},
    {
        "unit one": VALID.implies(between(-1, STEP - TWO - (NEXT_WANDER - WANDER), 1)),
        "unit two": between(ONE_LOW, STEP, ONE_HIGH),
    },
)  # fmt: skip


def drive(cycles: list[tuple[int, int, int, bool]], world: World = RUN) -> list[bool]:
    """Whether nothing observable is violated in each cycle of these inputs (two, low, high, valid)."""
    around = seen(lower(machine("m", {}, ONE_LOW, ONE_HIGH, TWO, VALID, world=world)))
    memory: dict[Var, Value] = dict(around.first)
    found = []
    for two, low, high, valid in cycles:
        values: dict[Var, Value] = {TWO: two, ONE_LOW: low, ONE_HIGH: high, VALID: valid, **memory}
        holds, recalled, *moved = evaluate([around.at_once, around.recalled, *around.memory.values()], values)
        memory = dict(zip(memory, moved, strict=True))
        found.append(bool(holds and recalled))
    return found


def test_what_wanders_is_used_up_over_a_run() -> None:
    """A unit that tells 3 more in every cycle is within its error twice (2 + 2 <= 8, rate 1 each), and then no more."""
    assert [True, True, True, True, False] == drive([(3, 0, 0, True)] * 5)
    assert [True, True, True, True, True, True] == drive([(3, 0, 0, True), (-1, 0, 0, True)] * 3)
    assert [True] * 8 == drive([(3, 0, 0, True)] * 4 + [(0, 0, 0, False)] + [(3, 0, 0, True)] * 3)


def test_what_does_not_move_whenever_the_law_is_in_force_is_not_summed() -> None:
    """The law speaks of a change that is not made while the unit is silent: nothing follows for a run."""
    always = {
        "unit one": between(-1, STEP - TWO - (NEXT_WANDER - WANDER), 1),
        "unit two": between(ONE_LOW, STEP, ONE_HIGH),
    }
    assert {} == told(lower(machine("m", {}, ONE_LOW, ONE_HIGH, TWO, VALID, world=replace(RUN, clauses=always))))


def test_what_wanders_in_both_is_used_up_by_both() -> None:
    """Of the same drift, the other unit's one-off error takes its share: 2 in a cycle, and 8 + 2 altogether."""
    also, next_also = number("also", MM, -1, 1), number("next_also", MM, -1, 1)
    other = {"unit two": between(ONE_LOW, STEP + (next_also - also), ONE_HIGH)}
    both = replace(
        RUN, ghosts={**RUN.ghosts, also: ANY}, choices=[*RUN.choices, next_also],
        moves={**RUN.moves, also: next_also}, clauses={**RUN.clauses, **other},
    )  # fmt: skip
    assert [True] * 4 + [False] == drive([(3, 0, 0, True)] * 5)
    assert [True] * 5 + [False] == drive([(3, 0, 0, True)] * 6, both)


# ------------------------------------------------------------------ in a composition


def test_wires_are_put_in_and_guaranteed_laws_are_seen_too() -> None:
    """A machine hears what an earlier one makes of its input in the same cycle; its law is judged all the same."""
    first = machine("first", {"holds": NEXT.eq(ONE_LOW)}, ONE_LOW)
    second = machine("second", {"holds": NEXT.eq(HEARD)}, HEARD)
    whole = compose(
        "both", [first, second], {HEARD: first.output("kept")}, shared=[TRUTH, NEXT], discharge=[Clause(second, "holds")]
    ).system  # fmt: skip
    around = seen(whole)
    assert [("first: holds", False), ("second: holds", True)] == [(str(one), one.guaranteed) for one in around.stated]
    (both,) = around.observables
    assert {"first.one_low", "first.kept after"} == {var.name for var in variables([both.term])}


# ------------------------------------------------------------------ it never cries wolf


def test_what_is_seen_to_be_broken_is_broken() -> None:
    """In drawn worlds and cycles: where all laws hold of the truth, everything observable holds, and so does the short form."""
    draw = random.Random(7)
    lawful = 0
    for _ in range(40):
        laws = {f"law {number_}": _drawn(draw) for number_ in range(3)}
        around = seen(lower(machine("m", laws, ONE_LOW, ONE_HIGH, TWO, VALID)))
        if around.observables:
            lawful += _lawful_cycles(draw, around)
    assert lawful > 1000


def _lawful_cycles(draw: random.Random, around: Seen) -> int:
    """The cycles of a lawful drive, each drawn until all laws hold of it; what was drawn in vain may be violated."""
    found, truth = 0, 0
    laws, observables = [one.term for one in around.stated], [one.term for one in around.observables]
    memory: dict[Var, Value] = dict(around.first)
    for _ in range(400):
        values: dict[Var, Value] = {
            **{var: draw.randint(-6, 6) for var in (NEXT, ONE_LOW, ONE_HIGH, TWO)}, VALID: draw.random() < 0.7,
            TRUTH: truth, **memory,
        }  # fmt: skip
        short = all(evaluate([around.at_once, around.recalled], values))
        shown = all(evaluate(observables, values))
        assert shown or not short  # the short form misses nothing
        if all(evaluate(laws, values)):
            assert shown
            memory = dict(zip(memory, evaluate(list(around.memory.values()), values), strict=True))
            found, truth = found + 1, int(values[NEXT])
    return found


def _drawn(draw: random.Random) -> Bool:
    """A law over the truth and the inputs, of the forms that laws have."""
    hidden = draw.choice([NEXT, NEXT - TRUTH, NEXT * 2, 0 - NEXT, NEXT * 3 - TRUTH * 3])
    slack = draw.randint(0, 4)
    simple: list[Bool] = [
        between(ONE_LOW - slack, hidden, ONE_HIGH + slack), hidden.eq(TWO), TWO - slack < hidden, ~(hidden < ONE_LOW),
        ~(hidden <= TWO),
        abs_(hidden - TWO) <= slack, any_of([hidden <= TWO, TWO < ONE_LOW]), ONE_LOW <= ONE_HIGH + slack,
    ]  # fmt: skip
    one, two = draw.sample(simple, 2)
    guard: list[Bool] = [VALID, ~VALID, TWO < ONE_LOW, VALID & (ONE_LOW < ONE_HIGH)]
    return draw.choice(
        [one, one & two, draw.choice(guard).implies(one), draw.choice(guard).implies(all_of([one, two]))]
    )
