"""The harm that each rule prevents: with the rule the declaration is refused, without it a wrong verdict or a crash results.

Some harm is kept out twice: where a machine is declared, with its place, and of every system that is handed to a prover,
whoever made it. `also` names those further rules; without them as well the harm is there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import pytest

from safeloc.errors import EngineError, SafelocError
from safeloc.language.checks import composition, machine, properties, system
from safeloc.language.checks.rule import Rule
from safeloc.language.checks.table import RULES
from safeloc.language.composition import compose
from safeloc.language.expr import FALSE, TRUE, Bool, before, boolean, minimum, number, optional, was
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.monitor import Broken, Holds, Monitor
from safeloc.language.nodes import Compare, FloorDiv, NumVar
from safeloc.language.spec import always, observe, previous, reachable, within
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.units import ONE
from safeloc.language.verdict import Proved, Violated
from safeloc.language.world import World
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import CHECKS
from safeloc.proof.provers.portfolio import prove_one
from safeloc.proof.provers.searches import first_runs
from tests.declaring import declared

LIMITS = Limits(depth=4, seconds=10)
A, B, C = modes("A", "B", "C")
(S,) = modes("S")
HEARD, GO = number("i", ONE, 0, 9), boolean("go")
X, Q, G = number("x", ONE, 0, 9), boolean("q"), number("g", ONE, 0, 9)
FOLLOW = Transition("follow", S, S, TRUE, {X: HEARD})


def plain(**changes: object) -> Machine:
    """A machine that follows its input, with something changed."""
    fields: dict[str, object] = {
        "name": "m",
        "modes": (S,),
        "inputs": [HEARD, GO],
        "state": {X: 0},
        "outputs": {"x": X},
    }
    return declared(**{**fields, "transitions": [FOLLOW], **changes})


def proves(what: TransitionSystem, term: Bool) -> bool:
    """Return whether the prover calls the term proved."""
    return isinstance(prove_one(observe(what, always("claim", term)), LIMITS), Proved)


def proves_anything(what: TransitionSystem) -> None:
    """A wrong verdict: that nothing is true is called proved."""
    assert proves(what, FALSE)


def fails(work: Callable[[], object]) -> None:
    """A crash: any error but one that is made for whoever declares; EngineError tells of a failure of our own."""
    try:
        work()
    except SafelocError as error:
        if not isinstance(error, EngineError):
            raise
    except NameError:  # a slip of this file
        raise
    except Exception:  # that it may be any exception is the point
        return
    else:
        raise AssertionError("nothing came of it")


# ------------------------------------------------------------------ machines


def lemma_of_another_kind() -> None:
    """A number in the place of a truth value reaches the solver."""
    fails(lambda: proves(lower(plain(lemmas={"l": X})), X >= 0))


def empty_range() -> None:
    """No value is in the range, so that nothing can be said against anything."""
    nothing = NumVar("i", ONE, 1, 0)
    assert proves(lower(plain(inputs=[nothing, GO], transitions=[])), GO & ~GO)


def no_modes() -> None:
    """A machine is in some mode."""
    fails(lambda: lower(plain(modes=(), transitions=[])))


def two_rows_of_one_name() -> None:
    """`fired` speaks of the first of them, and the other one fires."""
    rows = [Transition("go", A, B, HEARD > 3), Transition("go", B, C, HEARD > 3)]
    made = Machine("m", (A, B, C), [HEARD], {}, {}, rows)
    assert made.fired("go") is not made.fired("go")
    assert proves(lower(made), made.fired("go").implies(~made.mode.eq(C)))


def bar_in_a_name() -> None:
    """cvc5 cannot read the text of the proof."""
    odd = number("a|b", ONE, 0, 9)
    fails(lambda: proves(lower(plain(state={odd: 0}, outputs={}, transitions=[])), odd <= 9))


def source_named_twice() -> None:
    """The row fires in the third mode as well, which `overlap` does not look at."""
    rows = [
        Transition("ab", A, C, HEARD.eq(0)),
        Transition("release", (A, B, B), A, HEARD.eq(2)),
        Transition("own", C, B, HEARD.eq(2)),
    ]
    [found] = CHECKS["overlap"](lower(Machine("m", (A, B, C), [HEARD], {}, {}, rows)), LIMITS)
    assert isinstance(found.verdict, Proved)


def truth_from_a_number() -> None:
    """What is set to 1 becomes false."""
    made = plain(state={X: 0, Q: False}, transitions=[Transition("set", S, S, TRUE, {Q: 1})])
    assert proves(lower(made), ~Q)


def first_value_out_of_range() -> None:
    """There is no first state, so that nothing can be said against anything."""
    proves_anything(lower(plain(state={X: 77})))


def stranger_in_a_guard() -> None:
    """A variable that nobody has stands for one value, the same in every step."""
    stranger = boolean("stranger")
    made = lower(plain(transitions=[Transition("follow", S, S, stranger, {X: HEARD})]))
    fails(lambda: proves(made, X.eq(0)))


def ghost_that_rests_undeclared() -> None:
    """Without a move there is no next value."""
    made = lower(plain(ghosts={G: 0}, clauses={"low": G >= 0}))
    fails(lambda: Monitor(observe(made, always("it", G >= 0))).step({"i": 0, "go": True}))


def string_for_an_input() -> None:
    """A name is no variable."""
    fails(lambda: lower(plain(inputs=["i", GO], transitions=[])))


# ------------------------------------------------------------------ compositions


def machine_twice() -> None:
    """Two machines of one name have variables of one name: cvc5 cannot read the text."""
    (t,) = modes("T")
    j, y = number("j", ONE, 0, 9), number("x", ONE, 0, 9)
    other = Machine("m", (t,), [j], {y: 5}, {}, [Transition("s", t, t, TRUE, {y: minimum(j + 1, 9)})])
    fails(lambda: proves(compose("w", [plain(outputs={}), other], {}).system, FALSE))


def wire_from_nowhere() -> None:
    """What nobody has stands for some value."""
    stranger = number("stranger", ONE, 0, 9)
    made = plain()
    fails(lambda: proves((whole := compose("w", [made], {HEARD: stranger})).system, whole.of(made).bool(X <= 9)))


def late_wire_from_nowhere() -> None:
    """What nobody has has no value before the step either."""
    fails(lambda: compose("w", [plain()], {HEARD: before(number("stranger", ONE, 0, 9))}))


def wire_by_hand() -> None:
    """A divisor of zero: solvers make up what the quotient is, and no run computes it."""
    (t,) = modes("T")
    j, y = number("j", ONE, 0, 9), number("y", ONE, 0, 9)
    after = Machine("after", (t,), [j], {y: 0}, {}, [Transition("s", t, t, TRUE, {y: j})])
    whole = compose("w", [plain(), after], {j: FloorDiv(X, 0, ONE)})
    fails(lambda: proves(whole.system, whole.of(after).bool(y <= 9)))


def wire_of_another_kind() -> None:
    """A truth value in the place of a number cannot be put into a sum."""
    (t,) = modes("T")
    j, y = number("j", ONE, 0, 9), number("y", ONE, 0, 9)
    after = Machine("after", (t,), [j], {y: 0}, {}, [Transition("s", t, t, TRUE, {y: minimum(j + 1, 9)})])
    fails(lambda: compose("w", [plain(), after], {j: X > 3}))  # type: ignore[dict-item] # that is the slip


def lemmas_of_one_name() -> None:
    """Of two lemmas of one name one is lost, and nobody is told that it is false."""
    (t,) = modes("T")
    y, j = number("y", ONE, 0, 9), number("j", ONE, 0, 3)
    first = plain(name="a", lemmas={"b: l": X <= 1})
    second = Machine("a: b", (t,), [j], {y: 0}, {}, [Transition("s", t, t, TRUE, {y: j})], lemmas={"l": y <= 3})
    assert list(compose("w", [first, second], {}).system.lemmas) == ["a: b: l"]


# ------------------------------------------------------------------ systems


def by_hand(**changes: object) -> TransitionSystem:
    """The plain machine's system, changed by hand."""
    return replace(lower(plain()), **changes)  # type: ignore[arg-type] # one dict, many kinds


def terms_by_hand() -> None:
    """An operator that the language does not have."""
    fails(lambda: proves(by_hand(assume=Compare("!=", X, X)), X >= 0))  # type: ignore[arg-type] # that is the slip


def fact_of_another_kind() -> None:
    """A number in the place of a truth value reaches the solver."""
    fails(lambda: proves(by_hand(lemmas={"l": X}), X >= 0))


def two_variables_of_one_name() -> None:
    """z3 takes them for one, which starts at two values at once; only that cvc5 cannot read the text saves the verdict."""
    twin, made = number("x", ONE, 0, 9), lower(plain())
    moved = {**made.next, twin: minimum(X + 1, 9)}
    first = made.init & twin.eq(5)
    doubled = replace(made, state=(*made.state, twin), next=moved, init=first, initial={**made.initial, twin: 5})
    fails(lambda: proves(doubled, FALSE))


def state_and_input_at_once() -> None:
    """The truth, shared with a sensor's input: solvers hold it still, and the sensor may tell anything."""
    (t,) = modes("T")
    world = Machine("world", (t,), [GO], {}, {}, [], world=World(ghosts={G: 0}, moves={G: G}))
    sensor = Machine("sensor", (S,), [G], {X: 0}, {}, [Transition("s", S, S, TRUE, {X: G})])
    whole = compose("w", [world, sensor], {}, shared=[G])
    prop = always("x stays 0", whole.of(sensor).bool(X.eq(0)))
    assert isinstance(prove_one(observe(whole.system, prop), LIMITS), Proved)
    monitor = Monitor(observe(whole.system, prop))
    assert monitor.step({"world.go": True, "g": 3}) == Broken(1)


def no_next_value() -> None:
    """A state variable that nothing moves."""
    made = lower(plain())
    stuck = replace(made, next={made.state[0]: made.next[made.state[0]]})
    fails(lambda: Monitor(observe(stuck, always("it", X >= 0))).step({"i": 0, "go": True}))


def move_reads_a_stranger() -> None:
    """A variable that nobody has."""
    made = lower(plain())
    strange = replace(made, next={**made.next, X: minimum(number("s", ONE, 0, 9), 9)})
    fails(lambda: proves(strange, X.eq(0)))


def wire_from_a_ghost() -> None:
    """A sensor that hears the truth itself is always right, and cannot run on board."""
    (t,) = modes("T")
    told = number("told", ONE, 0, 9)
    world = Machine("world", (t,), [GO], {}, {}, [], world=World(ghosts={G: 0}, choices=[HEARD], moves={G: HEARD}))
    sensor = Machine("sensor", (S,), [told], {X: 0}, {}, [Transition("s", S, S, TRUE, {X: told})])
    whole = compose("w", [world, sensor], {told: G})
    assert proves(whole.system, whole.of(sensor).num(X).eq(whole.of(world).num(G)))


def role_by_hand() -> None:
    """An input that is state as well: solvers take it for one value, and every step may tell another one."""
    made = lower(plain(state={X: 0, Q: False}))
    both = replace(made, inputs=(*made.inputs, Q))
    prop = always("q stays", ~Q)
    assert isinstance(prove_one(observe(both, prop), LIMITS), Proved)
    monitor = Monitor(observe(both, always("x stays", X.eq(0))))
    assert monitor.step({"i": 0, "go": False, "q": True}) == Holds()


def ghost_by_hand() -> None:
    """What is computed on board from the truth is always right, and cannot be computed on board."""
    made = lower(plain(ghosts={G: 0}, choices=[], moves={G: G}))
    told = replace(made, next={**made.next, X: G})
    assert proves(told, X.eq(G))
    fails(lambda: run(without_ghosts(told), [{"i": 0, "go": False}]))


def half_an_optional() -> None:
    """One value under two presences: solvers find steps that no record can say."""
    (t,) = modes("T")
    o, y = optional("o", ONE, 1, 9), number("y", ONE, 0, 9)
    first = Machine("a", (S,), [o], {X: 0}, {}, [Transition("s", S, S, o.present, {X: o.value})])
    second = Machine("b", (t,), [o], {y: 0}, {}, [Transition("s", t, t, o.present, {y: o.value})])
    whole = compose("w", [first, second], {}, shared=[o.value])
    fails(lambda: proves(whole.system, whole.of(first).bool(X < 5)))


# ------------------------------------------------------------------ properties


def bar_in_a_propertys_name() -> None:
    """cvc5 cannot read the name of the observer."""
    fails(lambda: prove_one(observe(lower(plain()), always("x | y", previous(X >= 0) | (X >= 0))), LIMITS))


def claim_by_hand() -> None:
    """An operator that the language does not have."""
    fails(lambda: proves(lower(plain()), Compare("!=", X, X)))  # type: ignore[arg-type] # that is the slip


def fewer_than_no_steps() -> None:
    """An answer before its trigger: called violated before there was a trigger."""
    verdict = prove_one(observe(lower(plain()), within("p", -1, X > 3, X > 3)), LIMITS)
    assert isinstance(verdict, Violated)


def claim_about_a_stranger() -> None:
    """A variable that nobody has."""
    fails(lambda: proves(lower(plain()), number("stranger", ONE, 0, 9) <= 9))


def past_in_further_assumption() -> None:
    """A further assumption speaks of one step."""
    fails(lambda: prove_one(observe(lower(plain()), always("p", X >= 0, further_assumption=previous(GO))), LIMITS))


def helper_that_reads_an_input() -> None:
    """One input stands for that of the step before and of the step after: a false claim is proved."""
    armed = boolean("armed")
    arm = Transition("arm", S, S, (HEARD >= 1) & ~armed, {armed: True})
    made = lower(Machine("m", (S,), [HEARD], {armed: False}, {}, [arm]))
    trigger, response = (HEARD >= 1) & ~was(armed), (HEARD >= 1) & was(armed)
    prop = within("answered", 1, trigger, response, helper=lambda waited: (waited > 0).implies(armed & (HEARD >= 1)))
    assert isinstance(prove_one(observe(made, prop), LIMITS), Proved)
    monitor = Monitor(observe(made, prop))
    monitor.step({"i": 1})
    assert monitor.step({"i": 0}) == Broken(2)


def two_goals_of_one_name() -> None:
    """Solvers take their observers for one, so that no run comes to either."""
    made = lower(plain())
    goals = [observe(made, reachable("same", GO & (HEARD > 3))), observe(made, reachable("same", GO & (HEARD < 3)))]
    runs = first_runs(goals, LIMITS)
    assert (len(runs.found), runs.depth) == (0, LIMITS.depth)


def truth_that_follows_the_machine() -> None:
    """The truth is put where the machine believed to be: that it was right is called proved of any machine."""
    assert proves(lower(plain(ghosts={G: 0}, moves={G: X})), G.eq(before(X)))


# ------------------------------------------------------------------ the table


@dataclass(frozen=True)
class Offence:
    """What shows the harm once the rule is gone, and the rules that keep the same harm out a second time."""

    harm: Callable[[], None]
    also: tuple[str, ...] = ()


WHOLE_TERMS, WHOLE_READS = "terms of the system are well formed", "reads of the system are known"
OFFENCES: dict[str, Offence] = {
    "variables are variables": Offence(string_for_an_input, ("terms are well formed",)),
    "terms are terms": Offence(lemma_of_another_kind),
    "terms are well formed": Offence(empty_range, (WHOLE_TERMS,)),
    "modes are one enumeration": Offence(no_modes),
    "names are distinct": Offence(two_rows_of_one_name),
    "names can be written": Offence(bar_in_a_name),
    "sources are named once": Offence(source_named_twice),
    "updates fit": Offence(truth_from_a_number),
    "initial values fit": Offence(first_value_out_of_range),
    "reads are declared": Offence(stranger_in_a_guard, (WHOLE_READS,)),
    "ghosts move": Offence(ghost_that_rests_undeclared, ("every state variable moves",)),
    "the world is apart": Offence(truth_that_follows_the_machine),
    "machines have distinct names": Offence(
        machine_twice, ("joined names are distinct", "names of the system are distinct")
    ),
    "wires are well formed": Offence(wire_by_hand, (WHOLE_TERMS,)),
    "shared variables have one role": Offence(
        state_and_input_at_once, ("every variable has one role", "no ghost is read on board")
    ),
    "wires fit": Offence(wire_of_another_kind),
    "wires read no ghosts": Offence(wire_from_a_ghost, ("no ghost is read on board",)),
    "wires read earlier machines": Offence(wire_from_nowhere, (WHOLE_READS,)),
    "values before the step are state": Offence(late_wire_from_nowhere),
    "joined names are distinct": Offence(lemmas_of_one_name),
    WHOLE_TERMS: Offence(terms_by_hand),
    "facts of the system are truth values": Offence(fact_of_another_kind),
    "names of the system are distinct": Offence(two_variables_of_one_name),
    "every variable has one role": Offence(role_by_hand),
    "every state variable moves": Offence(no_next_value),
    WHOLE_READS: Offence(move_reads_a_stranger),
    "no ghost is read on board": Offence(ghost_by_hand),
    "optional inputs are whole": Offence(half_an_optional),
    "a property's name can be written": Offence(bar_in_a_propertys_name),
    "a property's terms are well formed": Offence(claim_by_hand),
    "a property's steps can be counted": Offence(fewer_than_no_steps),
    "a property reads what is there": Offence(claim_about_a_stranger),
    "a further assumption reads the step": Offence(past_in_further_assumption),
    "a helper speaks of states": Offence(helper_that_reads_an_input),
    "observers have distinct names": Offence(two_goals_of_one_name),
}
TABLES: tuple[tuple[Any, str], ...] = (
    (machine, "SHAPE"),
    (machine, "MACHINE"),
    (composition, "JOINING"),
    (system, "SYSTEM"),
    (properties, "PROPERTY"),
    (properties, "READING"),
    (properties, "WATCHING"),
)


def remove(monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    """Take rules out of their tables."""
    for module, table in TABLES:
        rules: tuple[Rule[Any], ...] = getattr(module, table)
        monkeypatch.setattr(module, table, tuple(rule for rule in rules if rule.name not in names))


def test_the_table_holds_every_rule_once() -> None:
    """The list contains exactly the applied rules, and no two rules share a name."""
    applied = [rule for module, table in TABLES for rule in getattr(module, table)]
    assert list(RULES) == applied
    assert len({rule.name for rule in RULES}) == len(RULES)


def test_every_rule_that_keeps_out_harm_has_its_offence() -> None:
    """A rule without an offence here is one against slips of the pen, and says so."""
    assert set(OFFENCES) == {rule.name for rule in RULES if rule.keeps_out != "a slip"}


@pytest.mark.parametrize("name", OFFENCES)
def test_with_the_rule_it_is_refused(name: str) -> None:
    """The declaration ends with an error for whoever wrote it: no verdict, no crash."""
    with pytest.raises(SafelocError) as caught:
        OFFENCES[name].harm()
    assert not isinstance(caught.value, EngineError)


@pytest.mark.parametrize("name", OFFENCES)
def test_without_the_rule_the_harm_is_back(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A wrong verdict or a crash, as the rule says."""
    remove(monkeypatch, name, *OFFENCES[name].also)
    OFFENCES[name].harm()


@pytest.mark.parametrize("name", [name for name, offence in OFFENCES.items() if offence.also])
def test_what_is_kept_out_twice_is_refused_without_the_first_rule(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The further rules are there for it: with them, the first one alone may go."""
    remove(monkeypatch, name)
    with pytest.raises(SafelocError):
        OFFENCES[name].harm()
