"""Composition: what an earlier machine computes acts in the same step; a wrong wire is refused."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import permutations

import pytest

from safeloc.errors import ModelError
from safeloc.language.composition import compose
from safeloc.language.expr import Expr, NumVar, Var, before, boolean, number, optional
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always
from safeloc.language.units import MM, MS
from safeloc.language.verdict import Proved, Violated
from safeloc.language.world import World
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove

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


def test_a_wired_input_is_read_in_a_property() -> None:
    """`of` turns a wired input into what the wire tells in the step: the sum after it."""
    pair = Pair()
    both = compose("both", (pair.counter, pair.alarm), {pair.level: pair.counter.output("sum")})
    assert both.of(pair.alarm)(pair.level) is both.system.variable("counter.sum")


def test_an_earlier_machine_hears_a_later_one_a_step_late() -> None:
    """The alarm rings in the step after the one in which the sum passes the level; at first it hears the first state."""
    pair = Pair()
    whole = compose("both", (pair.alarm, pair.counter), {pair.level: before(pair.sum)}).system
    calm = {"alarm.t": 0, "alarm.quiet": False}
    trace = run(whole, [{"counter.step": 10, **calm}, {"counter.step": 6, **calm}, {"counter.step": 0, **calm}])
    assert [step.fired["alarm.fired"] for step in trace.steps] == ["(stay)", "(stay)", "ring"]
    assert "alarm.level" not in {var.name for var in whole.inputs}


def test_of_an_earlier_machine_too_the_value_before_the_step_can_be_heard() -> None:
    """With `before` the alarm behind the counter rings a step late as well."""
    pair = Pair()
    whole = compose("both", (pair.counter, pair.alarm), {pair.level: before(pair.sum)}).system
    calm = {"alarm.t": 0, "alarm.quiet": False}
    trace = run(whole, [{"counter.step": 10, **calm}, {"counter.step": 6, **calm}, {"counter.step": 0, **calm}])
    assert [step.fired["alarm.fired"] for step in trace.steps] == ["(stay)", "(stay)", "ring"]


@pytest.mark.parametrize("order", list(permutations("abc")))
def test_a_late_wire_reads_the_state_though_another_machine_hears_the_variable(order: Sequence[str]) -> None:
    """One variable is the state of a machine and an input of another: `before` means the state."""
    held, poured, own, told, kept = (number(name, MM, 0, 9) for name in ("held", "poured", "own", "told", "kept"))
    (only,) = table = modes("ONLY")
    hears = Machine("b", table, [held], {own: 0}, {}, [Transition("pour", only, only, set={own: held})])
    machines = {"a": bucket("a", held, poured), "b": hears, "c": replace(bucket("c", kept, told), outputs={})}
    whole = compose("w", [machines[name] for name in order], {told: before(held)}).system
    trace = run(whole, [{"a.poured": poured, "b.held": other} for poured, other in ((5, 1), (6, 2), (7, 3))])
    assert [0, 5, 6] == [step.state["c.kept"] for step in trace.steps]
    twice = [bucket("left", held, poured), bucket("right", held, poured), machines["c"]]
    with pytest.raises(ModelError, match=r"state variables that exactly one of \['left', 'right', 'c'\] has"):
        compose("w", twice, {told: before(held)})


def test_a_claim_reads_what_a_late_wire_tells() -> None:
    """`of` turns the input into the value before the step: a claim of the value after it is refused."""
    pair = Pair()
    both = compose("both", (pair.alarm, pair.counter), {pair.level: before(pair.sum)})
    heard, total = both.of(pair.alarm).num(pair.level), both.of(pair.counter).num(pair.sum)
    assert isinstance(total, NumVar) and isinstance(heard, NumVar)
    assert heard.before is total
    late, at_once = (always(name, heard.eq(term)) for name, term in (("late", before(total)), ("at once", total)))
    found = {one.id: one.result for one in prove(both.system, [late, at_once], Limits(seconds=10))}
    assert isinstance(found["both/property/late"], Proved)
    assert isinstance(found["both/property/at once"], Violated)


def test_a_ghost_before_the_step_is_no_word_for_the_board() -> None:
    """A late wire to an on-board input reads no ghost either; one to a ghost input may."""
    push = number("told", MM, 0, 99)
    heard = walker("left")
    board = Machine("board", (IDLE, BUSY), [push], {}, {}, [Transition("go", IDLE, BUSY, push > 3)])
    with pytest.raises(ModelError) as caught:
        compose("both", [board, heard], {push: before(TRUTH)})
    assert without_place(caught.value) == (
        "composition 'both': the wire to 'told', an on-board input, reads the ghost 'before.truth'; let it read on-board variables only."
    )
    follows = Machine("follows", modes("ONLY"), [], {}, {}, [], world=World({}, [push], {}))
    whole = compose("both", [follows, heard], {push: before(TRUTH)})
    assert "follows.told" not in {var.name for var in whole.system.inputs}


def test_a_shared_input_is_kept_once() -> None:
    """A variable that both declare as the same object is one input, under its own name."""
    pair = Pair()
    twin = Machine("twin", (IDLE, BUSY), [pair.step], {}, {}, [Transition("go", IDLE, BUSY, pair.step > 3)])
    whole = compose("both", (pair.counter, twin), {}, shared=[pair.step]).system
    assert [var.name for var in whole.inputs] == ["step"]
    assert run(whole, [{"step": 4}]).steps[0].fired == {"counter.fired": "add", "twin.fired": "go"}


def without_place(error: BaseException) -> str:
    """The message without the file and line that it names; there has to be one."""
    text, places = re.subn(r" \(\S+test_composition\.py:\d+\)", "", str(error), count=1)
    assert places == 1, text
    return text


def test_a_wired_optional_input_is_no_longer_absent() -> None:
    """If value and presence are wired, the stream has no optional input left."""
    pair = Pair()
    wires: dict[Var, Expr] = {pair.extra.value: pair.step, pair.extra.present: pair.step > 0}
    whole = compose("both", (pair.counter, pair.alarm), wires).system
    assert whole.optionals == ()
    assert "alarm.extra" not in [var.name for var in whole.inputs]


WRONG: dict[str, tuple[Callable[[Pair], dict[Var, Expr]], str]] = {
    "unknown input": (
        lambda pair: {boolean("gone"): pair.step > 0},
        "composition 'both': wires lead to ['gone'], which are no inputs of ['counter', 'alarm']; wire inputs of these "
        "machines only.",
    ),
    "kind": (
        lambda pair: {pair.level: pair.step > 0},
        "composition 'both': the wire to 'level', which is a number, carries a truth value; give a term of the same kind.",
    ),
    "unit": (
        lambda pair: {pair.time: pair.sum},
        "composition 'both': the wire to 't' carries mm, not ms; convert the term.",
    ),
    "reads itself": (
        lambda pair: {pair.quiet: pair.level > 3},
        "composition 'both': the wire to 'quiet' reads ['level'], which no earlier machine has; a wire reads machines "
        "listed before, or the state of any machine before the step, by was() and before().",
    ),
    "input before the step": (
        lambda pair: {pair.quiet: before(pair.step) > 3},
        "composition 'both': the wire to 'quiet' reads ['before.step']; before() and was() are for state variables that exactly one of "
        "['counter', 'alarm'] has.",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_wire_is_refused(name: str) -> None:
    """Unknown input, kind, unit, and a machine that is not earlier: the message names wire and remedy."""
    pair = Pair()
    wires, message = WRONG[name]
    with pytest.raises(ModelError) as caught:
        compose("both", (pair.counter, pair.alarm), wires(pair))
    assert without_place(caught.value) == message


def test_names_must_differ() -> None:
    """The same machine twice would give two variables one name."""
    pair = Pair()
    with pytest.raises(
        ModelError, match=r"the names of its machines \['counter', 'counter'\] must be distinct; rename one\."
    ):
        compose("both", (pair.counter, pair.counter), {})


def bucket(name: str, held: NumVar, poured: NumVar, start: int = 0) -> Machine:
    """A machine that holds what was poured last; several may be made of the same variables."""
    (only,) = table = modes("ONLY")
    pour = Transition("pour", only, only, set={held: poured})
    return Machine(name, table, [poured], {held: start}, {"held": held}, [pour])


HELD, POURED = number("held", MM, 0, 9), number("poured", MM, 0, 9)


def test_machines_of_the_same_variables_stay_apart() -> None:
    """Two machines built from the very same variables have each their own state, first value and inputs."""
    whole = compose("both", [bucket("left", HELD, POURED), bucket("right", HELD, POURED, start=3)], {}).system
    trace = run(whole, [{"left.poured": 1, "right.poured": 5}])
    assert (0, 3) == (trace.initial["left.held"], trace.initial["right.held"])
    assert (1, 5) == (trace.steps[0].state["left.held"], trace.steps[0].state["right.held"])


def test_a_wire_from_an_unclear_variable_is_refused() -> None:
    """If two earlier machines have the same variable, a wire that reads it is ambiguous."""
    pair = Pair()
    earlier = [bucket("left", HELD, POURED), bucket("right", HELD, POURED)]
    with pytest.raises(ModelError) as caught:
        compose("all", [*earlier, pair.alarm], {pair.level: HELD})
    assert without_place(caught.value) == (
        "composition 'all': the wire to 'level' reads ['held'], which several earlier machines have; "
        "give each machine a variable of its own."
    )
    whole = compose("one", [earlier[0], pair.alarm], {pair.level: HELD}).system
    assert "alarm.level" not in [var.name for var in whole.inputs]


def test_state_cannot_be_shared() -> None:
    """Two machines that both write one variable would lose the update of one of them."""
    with pytest.raises(ModelError) as caught:
        compose("both", [bucket("left", HELD, POURED), bucket("right", HELD, POURED)], {}, shared=[HELD])
    assert (
        without_place(caught.value)
        == "composition 'both': 'held' is state of 'left'; only inputs and ghosts can be shared."
    )


TRUTH, PUSH = number("truth", MM, 0, 99), number("push", MM, 0, 9)


def walker(name: str, *, start: int = 0, by: int = 0) -> Machine:
    """A machine in a world with one truth, which is pushed on in each step."""
    world = World({TRUTH: start}, [PUSH], {TRUTH: TRUTH + (PUSH + by)})
    return Machine(name, modes("ONLY"), [], {}, {}, [], world=world)


def test_a_shared_ghost_is_one_truth() -> None:
    """Both machines see the same truth, which moves once in a step."""
    whole = compose("both", [walker("left"), walker("right")], {}, shared=[TRUTH, PUSH]).system
    assert ["left.mode", "truth", "right.mode"] == [var.name for var in whole.state]
    assert 7 == run(whole, [{"push": 3}, {"push": 4}]).steps[-1].state["truth"]


@pytest.mark.parametrize(("changes", "verb"), [({"by": 1}, "moves"), ({"start": 1}, "starts")])
def test_a_shared_ghost_is_alike_everywhere(changes: dict[str, int], verb: str) -> None:
    """One truth cannot start at two places or move in two ways; no machine's word is dropped in silence."""
    with pytest.raises(ModelError) as caught:
        compose("both", [walker("left"), walker("right", **changes)], {}, shared=[TRUTH, PUSH])
    assert (
        without_place(caught.value)
        == f"composition 'both': the shared ghost 'truth' {verb} differently in 'right' and in an earlier machine; declare it alike in both, or do not share it."
    )
