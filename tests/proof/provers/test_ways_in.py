"""Ways to a wrong verdict that were found from outside, each with the smallest machine that shows it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from safeloc.codegen.batch import simulate
from safeloc.codegen.c_loader import load_c
from safeloc.errors import InputError, ModelError, PropertyError
from safeloc.language.composition import compose
from safeloc.language.expr import TRUE, Num, as_num, boolean, floor_div, ite, minimum, number, optional, was
from safeloc.language.interpret import run
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.monitor import Broken, Monitor
from safeloc.language.nodes import INT64_MAX, Lit
from safeloc.language.spec import Goal, Property, always, observe, previous, reachable, within
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.units import ONE
from safeloc.language.verdict import Proved, Unknown, Violated, word
from safeloc.language.world import World
from safeloc.proof.provers import reachability
from safeloc.proof.provers.falsify import falsify
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.portfolio import prove, prove_one
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.proof.provers.replayed_evidence import replayed
from safeloc.proof.provers.searches import Runs
from safeloc.proof.results import Finding
from tests.declaring import declared

LIMITS = Limits(depth=12, seconds=10)
(S,), (T,) = modes("S"), modes("T")
X, Y, GO = number("x", ONE, 0, 9), number("y", ONE, 0, 9), boolean("go")
ANYTHING = number("i", ONE, 0, 9)
OTHER = number("j", ONE, 0, 9)


def follower(name: str = "m", **changes: object) -> Machine:
    """x follows its input."""
    fields: dict[str, object] = {"modes": (S,), "inputs": [ANYTHING], "state": {X: 0}, "outputs": {}}
    rows = [Transition("follow", S, S, TRUE, {X: ANYTHING})]
    return declared(name=name, **{**fields, "transitions": rows, **changes})


def owed(system: TransitionSystem) -> dict[str, Finding]:
    """The obligations by name."""
    return {finding.id.split("/", 2)[2]: finding for finding in obligations(system, LIMITS)}


def said(system: TransitionSystem, *properties: Property) -> list[str]:
    """The verdicts on properties, in words."""
    found = prove(system, properties, LIMITS)
    return [word(finding.result) for finding in found if finding.kind == "property"]


@pytest.mark.parametrize("ghostly", [False, True])
def test_a_helper_that_reads_an_input_is_refused(ghostly: bool) -> None:
    """d01: as a hypothesis it would be about one step's input, as a goal about the next one's. A ghost's input is
    refused too.
    """
    armed, heard, pushed = boolean("armed"), number("i", ONE, 0, 1), number("pushed", ONE, 0, 1)
    arm = Transition("arm", S, S, (heard >= 1) & ~armed, {armed: True})
    made = lower(Machine("m", (S,), [heard], {armed: False}, {}, [arm], world=World(choices=[pushed])))
    read = pushed if ghostly else heard
    prop = within(
        "answered",
        1,
        (heard >= 1) & ~was(armed),
        (heard >= 1) & was(armed),
        helper=lambda waited: (waited > 0).implies(armed & (read >= 1)),
    )
    with pytest.raises(PropertyError, match=r"test_ways_in\.py:\d+: property 'answered': its helper reads"):
        prove(made, [prop], LIMITS)


@pytest.mark.parametrize(
    "helper",
    [
        lambda waited: previous(waited > 0),
        lambda waited: was(boolean("go")) | (waited > 0),
        lambda _: follower().fired("follow"),
        lambda _: 1,
    ],
)
def test_a_helper_speaks_of_states(helper: object) -> None:
    """d01: a helper also has no past operators, values before the step, fired transitions or foreign variables, and is
    Boolean.
    """
    prop = within("p", 1, X > 3, X < 3, helper=helper)  # type: ignore[arg-type] # wrong on purpose
    with pytest.raises(PropertyError, match="its helper"):
        observe(lower(follower()), prop)


def test_an_inherited_property_is_proved_as_it_was_made() -> None:
    """d02: unchanged, it is proved on the machine alone; changed afterwards, it is proved like any other."""
    made = follower("a", clauses={"low": ANYTHING <= 3})
    whole = compose("w", [made], {})
    honest = whole.inherited(made, always("x is at most 3", X <= 3))
    free = replace(honest, name="for all inputs", unconditional=True)
    tighter = replace(honest, name="another term", term=whole.of(made).bool(X <= 2))
    assert said(whole.system, honest, free, tighter) == ["proved", "violated", "violated"]
    [finding] = [
        one for one in prove(whole.system, [replace(honest, name="renamed")], LIMITS) if one.kind == "property"
    ]
    assert "of a by itself" in finding.method


def test_an_inherited_property_holds_in_the_first_state_too() -> None:
    """d29: with a wired input a machine's property becomes one of states, so it has to hold in the first state as well."""
    first = follower("a", inputs=[number("i", ONE, 1, 9)], transitions=[])
    heard = number("q", ONE, 0, 9)
    second = Machine(
        "b",
        (T,),
        [heard],
        {Y: 0},
        {},
        [Transition("s", T, T, TRUE, {Y: heard})],
        world=World(clauses={"assumption": heard >= 1}, reads_machine="the test asks it"),
    )
    step = Transition("follow", S, S, TRUE, {X: first.inputs[0]})  # type: ignore[dict-item] # it is a variable
    first = replace(first, transitions=[step])
    whole = compose("w", [first, second], {heard: X}, discharge=[second])
    prop = whole.inherited(second, always("at least 1", heard >= 1))
    assert said(whole.system, prop) == ["violated"]
    assert Monitor(observe(whole.system, prop)).status == Broken(0)
    kept = whole.inherited(second, always("at most 9", heard <= 9))
    [finding] = [one for one in prove(whole.system, [kept], LIMITS) if one.kind == "property"]
    assert isinstance(finding.result, Proved)
    assert any("rule: first state" in text for text in finding.result.certificates.values())


def test_a_shared_variable_has_one_role() -> None:
    """d03, d27, d28: a ghost is no sensor's input, shared or wired."""
    truth, push, told = number("g", ONE, 0, 9), boolean("push"), number("q", ONE, 0, 9)
    world = Machine(
        "world", (T,), [GO], {}, {}, [],
        world=World(ghosts={truth: 0}, choices=[push], moves={truth: ite(push, as_num(1, ONE), truth)})
    )  # fmt: skip
    with pytest.raises(ModelError, match=r"'g' \(.*\) is a ghost of 'world' and an input of 'sensor'"):
        compose("w", [world, follower("sensor", inputs=[truth], transitions=[])], {}, shared=[truth])
    pushed = follower("sensor", inputs=[push], transitions=[Transition("s", S, S, push, {X: 1})])
    with pytest.raises(ModelError, match=r"'push' \(.*\) is a ghost input of 'world' and an input of 'sensor'"):
        compose("w", [world, pushed], {}, shared=[push])
    sensor = follower("sensor", inputs=[told], transitions=[Transition("s", S, S, TRUE, {X: told})])
    with pytest.raises(ModelError, match="the wire to 'q', an on-board input, reads the ghost 'g'"):
        compose("w", [world, sensor], {told: truth})


def tied(**changes: object) -> Machine:
    """x starts where the truth is, and runs away from everywhere else."""
    wide, truth = number("x", ONE, 0, 10), number("g", ONE, 0, 10)
    fields: dict[str, object] = {
        "state": {wide: ANY},
        "outputs": {"x": wide},
        "ghosts": {truth: 0},
        "moves": {truth: truth},
    }
    fields |= {"inputs": [GO], "initially": wide.eq(truth), "lemmas": {"x is 0": wide.eq(0)}}
    up = Transition("up", S, S, GO, {wide: ite(wide > 0, wide + 20, wide)})
    return declared(name="m", modes=(S,), **{**fields, "transitions": [up], **changes})


def test_on_board_nothing_is_known_of_the_truth_at_the_start() -> None:
    """d04: a range that relies on the true start is not proved for all inputs."""
    found = owed(lower(tied()))
    assert isinstance(found["range of x"].result, Violated)
    assert run(without_ghosts(lower(tied())), [{"go": True}], first={"x": 5}).steps[-1].state["x"] == 25


def test_an_unconditional_property_starts_on_board_too() -> None:
    """d04: nor does an unconditional property know the true start; under the assumption it holds."""
    made = lower(tied())
    x = made.variable("x")
    assert isinstance(x, Num)
    free, lawful = always("free", x <= 10, unconditional=True), always("lawful", x <= 10)
    assert said(made, free, lawful) == ["violated", "proved"]


def test_no_term_is_lost_where_texts_are_cut() -> None:
    """d05: terms of one text, cut after 200 nodes, are decided one by one; so the run that leaves 64 bits is found."""
    small, high = number("x", ONE, 0, 10), number("y", ONE, 0, 2**62)
    term: Num = small
    for _ in range(270):
        term = term + Lit(2**55, ONE)
    for _ in range(40):
        term = term + Lit(-(2**55), ONE)
    for _ in range(3):
        term = term + high
    up = Transition("up", S, S, GO & (term > 5), {small: 1, high: 0})
    made = Machine("m", (S,), [GO], {small: 0, high: 0}, {}, [up], lemmas={"y rests": high.eq(0)})
    assert "violated" in {word(one.result) for name, one in owed(lower(made)).items() if name.startswith("overflow")}


def test_long_texts_and_names_are_no_failure() -> None:
    """d06, d07: a long term that may overflow and long names of rows are reported, and nothing else is lost."""
    wide = [number(f"quantity_number_{n}", ONE, 0, 2**62) for n in range(6)]
    total: Num = wide[0]
    for one in wide[1:]:
        total = total + one
    long = "reference lost while the train is moving and its tolerance is exceeded"
    rows = [Transition(f"{long} {n}", S, S, (total > 5) & (wide[0] > n), {GO: True}) for n in range(2)]
    found = owed(lower(Machine("m", (S,), wide, {GO: False}, {}, rows)))
    assert word(found["overflow 1"].result) == "violated"
    assert word(found["overlap m: rows 1 and 2"].result) == "violated"
    assert {f"transition m: {long} 0", f"transition m: {long} 1", "assumption"} <= set(found)


def test_a_source_named_twice_is_refused() -> None:
    """d08: it would count as every mode."""
    a, b, c = modes("A", "B", "C")
    with pytest.raises(ModelError, match="names source mode 'B' twice"):
        Machine("m", (a, b, c), [GO], {}, {}, [Transition("release", (a, b, b), a, GO)])


def test_a_lemma_named_as_a_range_is_a_lemma() -> None:
    """d09: the range itself is checked all the same."""
    up = Transition("up", S, S, GO, {X: X + 1})
    made = lower(Machine("m", (S,), [GO], {X: 0}, {}, [up], lemmas={"range of x": X >= 0}))
    assert word(owed(made)["range of x"].result) == "violated"
    assert owed(made)["ranges"].statement == "1 of 2 state variables stay in their declared ranges"


def test_pairs_of_rows_are_told_apart() -> None:
    """d10: "a / b" with "c", and "a" with "b / c", are two pairs."""
    guards = {"a / b": ANYTHING >= 5, "c": ANYTHING >= 7, "a": ANYTHING.eq(1), "b / c": ANYTHING.eq(2)}
    rows = [Transition(name, S, S, when) for name, when in guards.items()]
    assert word(owed(lower(follower(transitions=rows)))["overlap m: rows 1 and 2"].result) == "violated"


def test_targets_of_one_name_are_told_apart() -> None:
    """d11: machine "train door" with mode OPEN, and machine "train" with mode "door OPEN"."""
    closed, opened = modes("closed", "OPEN")
    dead = Machine("train door", (closed, opened), [GO], {}, {}, [Transition("never", closed, opened, GO & ~GO)])
    shut, wide = modes("door closed", "door OPEN")
    lively = Machine("train", (shut, wide), [boolean("j")], {}, {}, [Transition("o", shut, wide, boolean("k") | TRUE)])
    found = {one.statement: word(one.result) for one in obligations(compose("w", [dead, lively], {}).system, LIMITS)}
    assert found["train door reaches mode OPEN"] == "violated"
    assert found["train reaches mode door OPEN"] == "proved"


def test_names_that_meet_in_a_composition_are_refused() -> None:
    """d12, d18: two lemmas, or two variables, of one name in the composition are refused."""
    second = Machine("a: b", (T,), [OTHER], {Y: 0}, {}, [Transition("s", T, T, TRUE, {Y: OTHER})], lemmas={"l": Y <= 9})
    with pytest.raises(ModelError, match="the lemma 'a: b: l' comes from two machines"):
        compose("w", [follower("a", lemmas={"b: l": X <= 1}), second], {})
    first = follower("a", state={number("b.c", ONE, 0, 3): 0}, transitions=[])
    third = Machine("a.b", (T,), [OTHER], {number("c", ONE, 0, 9): 0}, {}, [])
    with pytest.raises(ModelError, match=r"the variable 'a\.b\.c' comes from two machines"):
        compose("w", [first, third], {})


def test_overflow_rests_on_no_range_that_is_not_proved() -> None:
    """d13: x doubles without end; its declared range does not show that it fits 64 bits."""
    wide = number("x", ONE, 0, 100)
    made = lower(
        Machine("m", (S,), [GO], {wide: 1}, {"x": wide}, [Transition("double", S, S, GO, {wide: wide + wide})])
    )
    found = owed(made)
    assert [word(found[name].result) for name in ("range of x", "overflow")] == ["violated", "unknown"]


def test_ghosts_overflow_under_the_assumption_or_not_at_all() -> None:
    """d14: a run that breaks the assumption is no violation."""
    far, kind, push = number("g", ONE, 0, 2**62), number("h", ONE, 0, 10), number("p", ONE, 0, 2**62)
    swing = ite(kind.eq(0), as_num(2, ONE), ite(kind.eq(2), as_num(0, ONE), kind))
    moves = {far: minimum(far + push + push, 5), kind: swing}
    lawful = (push <= 3) | kind.eq(7)
    made = Machine(
        "m",
        (S,),
        [GO],
        {},
        {},
        [],
        world=World(
            ghosts={far: 0, kind: 0},
            choices=[push],
            moves=moves,
            clauses={"assumption": lawful},
            reads_machine="the test asks it",
        ),
    )
    kinds = {word(one.result) for name, one in owed(lower(made)).items() if name.startswith("overflow of ghosts")}
    assert "violated" not in kinds


def test_first_values_are_judged_exactly_or_not_at_all() -> None:
    """d15: a condition on first values that may leave 64 bits is an obligation, and no batch runs it."""
    a, b = number("a", ONE, 0, INT64_MAX), number("b", ONE, 0, INT64_MAX)
    made = lower(Machine("m", (S,), [GO], {a: ANY, b: ANY}, {}, [], initially=a + b <= 100))
    assert word(owed(made)["overflow of first values"].result) == "violated"
    with pytest.raises(InputError, match="1 terms may exceed 64 bits"):
        simulate(made, {"go": np.array([[True]])}, start_state={"a": np.array([2**62]), "b": np.array([2**62])})


def test_a_first_state_that_is_hard_to_guess_is_no_failure() -> None:
    """d16: the search for deep bugs then starts from the solver's first state."""
    a, b, c = number("a", ONE, 0, 10**9), number("b", ONE, 0, 10**9), number("c", ONE, 0, 10**9)
    hard = (a * 3 + b * 7).eq(7654321) & (a > b * 2) & floor_div(a, 1000).eq(b)
    up = Transition("up", S, S, GO, {c: minimum(c + 1, 10**9)})
    made = lower(Machine("m", (S,), [GO], {a: ANY, b: ANY, c: 0}, {}, [up], initially=hard))
    assert isinstance(falsify(observe(made, always("far", c < 10**6)), Limits(seconds=1)), Unknown)
    assert isinstance(falsify(observe(made, always("near", c < 3)), Limits(seconds=10)), Violated)


def test_certificates_are_named_by_their_content() -> None:
    """d19: a property with the name of a machine's own proof replaces no other certificate."""
    made = Machine("A", (S,), [GO], {X: 0}, {}, [Transition("s", S, S, GO, {X: minimum(X + 1, 8)})])
    whole = compose("w", [made], {})
    claim = ~previous(whole.of(made).bool(X < 0))
    one, two = (
        finding.result for finding in prove(whole.system, [always("A always", claim), always("other", claim)], LIMITS)
    )
    assert isinstance(one, Proved)
    assert isinstance(two, Proved)
    assert len(one.certificates) == len(two.certificates)


def test_odd_words_are_refused_with_their_place() -> None:
    """d22: bars, newlines and past operators give a message with the place, never an internal error."""
    place = r"test_ways_in\.py:\d+"
    with pytest.raises(PropertyError, match=rf"{place}: property 'x \| y': a name must not contain \| and"):
        always("x | y", X >= 0)
    with pytest.raises(PropertyError, match=rf"{place}: property 'p': the further assumption uses a past operator"):
        observe(lower(follower()), always("p", X >= 0, further_assumption=previous(X > 0)))
    with pytest.raises(ModelError, match=r":\d+\):\n  - its name is 'M"):
        follower("M\n(assert false)")
    heard = boolean("j")
    listener = Machine("b", (T,), [heard], {Y: 0}, {}, [])
    with pytest.raises(ModelError, match=rf"{place}\): the wire to 'j' uses a past operator"):
        compose("w", [follower("a"), listener], {heard: previous(X > 3)})


def test_rows_that_meet_in_no_reachable_state_exclude_each_other() -> None:
    """d23: x is 0 or 2 in every run; the overlap that one step finds at 3 is reached by no run."""
    small = number("x", ONE, 0, 4)
    rows = [
        Transition("even", S, S, small.one_of(0, 2) & GO, {small: ite(small.eq(0), as_num(2, ONE), as_num(0, ONE))}),
        Transition("odd", S, S, small.one_of(1, 3)),
        Transition("three", S, S, small.eq(3)),
    ]
    found = owed(lower(Machine("m", (S,), [GO], {small: 0}, {}, rows)))
    overlaps = [one.result for name, one in found.items() if name.startswith("overlap")]
    assert [word(result) for result in overlaps] == ["proved", "proved"]


def test_a_shared_optional_input_reaches_every_machine() -> None:
    """d24: interpreter, numpy, C and provers give every machine the same input."""
    heard = optional("o", ONE, 0, 9)
    first = Machine("a", (S,), [heard], {X: 0}, {}, [Transition("s", S, S, heard.present, {X: heard.value})])
    second = Machine("b", (T,), [heard], {Y: 0}, {}, [Transition("s", T, T, heard.present, {Y: heard.value})])
    whole = compose("w", [first, second], {}, shared=[heard.value, heard.present]).system
    after = run(whole, [{"o": 5}]).steps[-1].state
    assert (after["a.x"], after["b.y"]) == (5, 5)
    assert simulate(whole, {"o": np.array([[5]]), "o.present": np.array([[True]])}).last["a.x"][0] == 5
    compiled = load_c(whole)
    compiled.step({"o": 5})
    assert (compiled.state["a.x"], compiled.state["b.y"]) == (5, 5)
    x = whole.variable("a.x")
    assert isinstance(x, Num)
    assert said(whole, always("x is not 5", x.ne(5))) == ["violated"]
    with pytest.raises(ModelError, match=r"is part of two optional inputs; share value and presence together"):
        compose("w", [first, second], {}, shared=[heard.value])


def test_what_is_dead_in_the_whole_is_told() -> None:
    """d25: a transition that fires in the machine alone, but never in the composition, is violated with that reason."""
    calm, alarm = modes("CALM", "ALARM")
    heard = number("q", ONE, 0, 9)
    second = Machine("b", (calm, alarm), [heard], {}, {}, [Transition("raise", calm, alarm, heard > 5)])
    low = number("i", ONE, 0, 3)
    first = follower("a", inputs=[low], transitions=[Transition("follow", S, S, TRUE, {X: low})])
    whole = compose("w", [first, second], {heard: X})
    found = owed(whole.system)
    assert word(found["transition b: raise"].result) == "violated"
    assert (
        "no run of the composition, whatever the inputs: dead in the composition"
        in found["transition b: raise"].result.reason
    )  # type: ignore[union-attr]
    assert said(whole.system, reachable("alarm", whole.of(second).bool(second.mode.eq(alarm)))) == ["violated"]


def test_what_only_the_machine_by_itself_shows_is_told_as_that(monkeypatch: pytest.MonkeyPatch) -> None:
    """The method gives the length of the machine's run, and no number of steps if the composition was not searched in
    time.
    """
    calm, alarm = modes("CALM", "ALARM")
    heard = number("q", ONE, 0, 9)
    second = Machine("b", (calm, alarm), [heard], {}, {}, [Transition("raise", calm, alarm, heard > 5)])
    whole = compose("w", [follower("a"), second], {heard: X}).system
    search, draw = reachability.first_runs, reachability.drawn

    def hurried(goals: Sequence[Goal], *more: Any) -> Runs:
        out_of_time = any(goal.original is whole for goal in goals)
        return Runs({}, -1) if out_of_time else search(goals, *more)

    def unlucky(goals: Sequence[Goal], *more: Any) -> dict[Goal, Trace]:
        return {} if any(goal.original is whole for goal in goals) else draw(goals, *more)

    monkeypatch.setattr(reachability, "first_runs", hurried)
    monkeypatch.setattr(reachability, "drawn", unlucky)
    (told,) = [one for one in reachability.reached(whole, LIMITS) if one.name == "transition b: raise"]
    assert told.statement.endswith(", by itself")
    expected = "of the machine by itself, witness of 1 steps under its assumption; the whole was not searched in time"
    assert expected == told.method
    assert isinstance(told.verdict, Proved)
    assert 1 == told.verdict.depth


def test_a_shipped_witness_of_one_machine_is_no_run_of_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is reported as of the machine by itself, and the whole is not searched: that was in vain when the witness was made.

    Whether the whole can reach the event at all is asked.
    """
    calm, alarm = modes("CALM", "ALARM")
    heard = number("q", ONE, 0, 9)
    second = Machine("b", (calm, alarm), [heard], {}, {}, [Transition("raise", calm, alarm, heard > 5)])
    low = number("i", ONE, 0, 3)
    first = follower("a", inputs=[low], transitions=[Transition("follow", S, S, TRUE, {X: low})])
    drawn_for: list[str] = []
    draw = reachability.drawn

    def listening(goals: Sequence[Goal], *more: Any) -> dict[Goal, Trace]:
        drawn_for.extend(goal.prop.name for goal in goals if goal.original.parts)
        return draw(goals, *more)

    monkeypatch.setattr(reachability, "drawn", listening)
    for machines, statement in (([first, second], ""), ([follower("a"), second], "b: 'raise' fires")):
        whole = compose("w", machines, {heard: X}).system
        alone = whole.parts[1].alone.name
        for witnesses in ({alone: [Recording({}, [{"q": 6}])]}, {"w": [Recording({}, [{"q": 6}])]}, {}):
            drawn_for.clear()
            found = list(reachability.reached(whole, LIMITS, witnesses=witnesses))
            (one,) = [one for one in found if one.name == "transition b: raise"]
            assert ("row 1 of machine 1" in drawn_for) == (alone not in witnesses)
            assert isinstance(one.verdict, Proved) == bool(statement)
            assert one.statement.startswith(statement)
            of_alone = alone in witnesses and bool(statement)
            assert of_alone == ("by itself" in one.statement)
            assert of_alone == one.method.endswith("; the whole was searched in vain when this witness was made")
            assert "shipped" not in one.method


def test_a_violated_unconditional_property_comes_with_its_run() -> None:
    """A run from a first state that the environment excludes is replayed as it was found."""
    made = lower(tied())
    x = made.variable("x")
    assert isinstance(x, Num)
    goal = observe(made, always("free", x <= 10, unconditional=True))
    verdict = prove_one(goal, LIMITS)
    assert isinstance(verdict, Violated)
    assert verdict.trace is not None
    assert replayed(goal, verdict.trace.initial, [step.inputs for step in verdict.trace.steps]) is not None


@pytest.mark.parametrize("high", [3, 9], ids=["contract kept", "contract broken"])
def test_what_a_machine_excludes_is_excluded_in_the_whole_if_its_assumption_is_kept(
    high: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the machines before it break its assumption, what it excludes under that assumption may still happen, found or not."""
    calm, alarm = modes("CALM", "ALARM")
    heard = number("q", ONE, 0, 9)
    second = declared(
        name="b", modes=(calm, alarm), inputs=[heard], state={}, outputs={}, clauses={"quiet": heard <= 5}, reads_machine="the test asks it",
        transitions=[Transition("raise", calm, alarm, heard > 5)],
    )  # fmt: skip
    first = follower("a", clauses={"low": ANYTHING <= high}, reads_machine="the test asks it")
    whole = compose("w", [first, second], {heard: X}, discharge=[second]).system
    search = reachability.first_runs

    def hurried(goals: Sequence[Goal], *more: Any) -> Runs:
        return Runs({}, -1) if any(goal.original is whole for goal in goals) else search(goals, *more)

    monkeypatch.setattr(reachability, "first_runs", hurried)
    monkeypatch.setattr(reachability, "drawn", lambda *_: {})
    (told,) = [one for one in reachability.reached(whole, LIMITS) if one.name == "transition b: raise"]
    assert ("impossible" in told.method) == (high == 3), told.method
