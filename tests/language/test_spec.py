"""Properties mean what they say: observers against naive definitions over lists; wrong reads are refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import PropertyError, TruthValueError
from safeloc.language.expr import TRUE, Bool, before, boolean, number, was
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.monitor import Broken, Holds, Monitor, Undecided, check, check_all
from safeloc.language.spec import Property, always, never, observe, once, previous, reachable, since, within
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Held, Unknown, Violated
from safeloc.language.world import World

(ON,) = modes("ON")
P, Q = boolean("p"), boolean("q")
N = number("n", COUNT, 0, 1000)
MACHINE = Machine("watched", (ON,), [P, Q], {N: 0}, {}, [Transition("count", ON, ON, N < 1000, {N: N + 1})])
SYSTEM = lower(MACHINE)
Runs = Sequence[tuple[bool, bool]]
RUNS = st.lists(st.tuples(st.booleans(), st.booleans()), max_size=12)


def first_break(prop: Property, run_: Runs) -> int | None:
    """The step at which the property breaks, by the checker."""
    trace = run(SYSTEM, [{"p": p, "q": q} for p, q in run_])
    result = check(trace, prop)
    return len(result.trace.steps) if isinstance(result, Violated) and result.trace is not None else None


def first_false(values: Sequence[bool]) -> int | None:
    """The number of the first false one, counted from 1."""
    return next((number_ for number_, value in enumerate(values, 1) if not value), None)


def oracle(name: str, run_: Runs) -> list[bool]:
    """Return the truth value of a past term in each step, computed from its definition."""
    ps, qs = [p for p, _ in run_], [q for _, q in run_]
    steps = range(len(run_))
    match name:
        case "once":
            return [any(ps[: n + 1]) for n in steps]
        case "previous":
            return [n > 0 and ps[n - 1] for n in steps]
        case "since":
            return [any(qs[m] and all(ps[m + 1 : n + 1]) for m in range(n + 1)) for n in steps]
        case _:
            raise KeyError(name)


TERMS: dict[str, Bool] = {"once": once(P), "previous": previous(P), "since": since(P, Q)}


@given(RUNS, st.sampled_from(sorted(TERMS)))
def test_past_operators(run_: Runs, name: str) -> None:
    """once, previous and since agree with their definitions in every step."""
    assert first_break(always(name, TERMS[name]), run_) == first_false(oracle(name, run_))
    assert first_break(never(name, TERMS[name]), run_) == first_false([not value for value in oracle(name, run_)])


@given(RUNS, st.integers(0, 4))
def test_within(run_: Runs, steps: int) -> None:
    """Each trigger is answered in the same step or at most `steps` later; a break shows when the time is over."""
    late = [
        n + steps + 1
        for n, (p, _) in enumerate(run_)
        if p and n + steps < len(run_) and not any(q for _, q in run_[n : n + steps + 1])
    ]
    assert first_break(within("answered", steps, P, Q), run_) == min(late, default=None)


@given(RUNS)
def test_monitor_and_checks_agree(run_: Runs) -> None:
    """Step by step, all at once or one by one: the same verdict."""
    properties = [always(name, term) for name, term in TERMS.items()]
    trace = run(SYSTEM, [{"p": p, "q": q} for p, q in run_])
    for prop, together in zip(properties, check_all(trace, properties), strict=True):
        monitor = Monitor(observe(SYSTEM, prop))
        for step in trace.stream():
            monitor.step(step)
        match monitor.status:
            case Holds():
                assert isinstance(together, Held)
            case Broken(at):
                assert isinstance(together, Violated)
                assert together.trace is not None
                assert len(together.trace.steps) == at
            case other:
                raise AssertionError(other)


@st.composite
def nested(draw: st.DrawFn, depth: int = 3) -> tuple[Bool, Callable[[Runs], list[bool]]]:
    """A term with past operators inside one another, and its value in each step by definition."""
    kind = draw(st.sampled_from(["p", "q", "not", "and", "previous", "once", "since"])) if depth else "p"
    if kind in "pq":
        at = "pq".index(kind)
        return (P, Q)[at], lambda run_: [step[at] for step in run_]
    (left, ls), (right, rs) = draw(nested(depth=depth - 1)), draw(nested(depth=depth - 1))
    match kind:
        case "not":
            return ~left, lambda run_: [not one for one in ls(run_)]
        case "and":
            return left & right, lambda run_: [a and b for a, b in zip(ls(run_), rs(run_), strict=True)]
        case "previous" | "once":
            term = previous(left) if kind == "previous" else once(left)
            return term, lambda run_: oracle(kind, [(one, False) for one in ls(run_)])
        case _:
            return since(left, right), lambda run_: oracle("since", list(zip(ls(run_), rs(run_), strict=True)))


@given(nested(), RUNS)
def test_past_operators_inside_one_another(term: tuple[Bool, Callable[[Runs], list[bool]]], run_: Runs) -> None:
    """Nested past operators have their defined values, at any depth."""
    assert first_false(term[1](run_)) == first_break(always("nested", term[0]), run_)


@given(RUNS, st.booleans(), st.booleans())
def test_what_is_given_and_what_is_assumed(run_: Runs, assumed: bool, unconditional: bool) -> None:
    """A property says nothing from the step on in which its further assumption, or the machine's, is broken.

    Unconditional ones leave the assumption aside, but not what they are given. The monitor says the same.
    """
    kept = N <= 3
    world = lower(
        Machine(
            "world",
            (ON,),
            [P, Q],
            {N: 0},
            {},
            MACHINE.transitions,
            world=World(clauses={"assumption": kept if assumed else TRUE}, reads_machine="the test asks it"),
        )
    )
    prop = always("no q", ~Q, further_assumption=~P, unconditional=unconditional)
    trace = run(world, [{"p": p, "q": q} for p, q in run_])
    lawful = [not p and (unconditional or not assumed or n <= 3) for n, (p, _) in enumerate(run_)]
    end = (first_false(lawful) or len(run_) + 1) - 1
    expected = first_false([not q for _, q in run_[:end]])
    result, monitor = check(trace, prop), Monitor(observe(world, prop))
    for step in trace.stream():
        monitor.step(step)
    if expected is not None:
        assert isinstance(result, Violated)
        assert result.trace is not None
        assert expected == len(result.trace.steps)
        assert Broken(expected) == monitor.status
    elif end < len(run_):
        assert isinstance(result, Unknown)
        assert end == result.depth
        assert Undecided(end + 1, "the assumption is broken from here on") == monitor.status
    else:
        assert isinstance(result, Held)
        assert Holds() == monitor.status


@given(RUNS)
def test_reachable_is_held_from_the_first_time_on(run_: Runs) -> None:
    """Reached once is reached; not reached in this trace is undecided, never violated."""
    result = check(run(SYSTEM, [{"p": p, "q": q} for p, q in run_]), reachable("both", P & Q))
    reached = first_false([not (p and q) for p, q in run_])
    if reached is not None:
        assert isinstance(result, Held)
        assert reached == result.steps
    else:
        assert isinstance(result, Unknown)
        assert ("not reached in this trace", len(run_)) == (result.reason, result.depth)


def test_a_state_property_is_required_of_the_first_state() -> None:
    """A term over state only is checked before any step."""
    result = check(run(SYSTEM, []), always("counting", N > 0))
    assert isinstance(result, Violated)
    assert result.trace is not None
    assert len(result.trace.steps) == 0


@pytest.mark.parametrize(
    ("prop", "message"),
    [
        (always("strange", boolean("elsewhere")), "reads 'elsewhere', which watched does not have"),
        (within("strange", 3, P, boolean("elsewhere")), "reads 'elsewhere', which watched does not have"),
        (never("strange", once(boolean("elsewhere"))), "reads 'elsewhere', which watched does not have"),
        (always("strange", was(P)), r"reads 'before\.p', but before\(\) and was\(\) are for state variables"),
        (
            always("strange", P, further_assumption=before(N) > 0),
            r"the further assumption reads 'before\.n'; it may read state before the step",
        ),
        (always("strange", P, further_assumption=MACHINE.fired("count")), "the further assumption reads 'fired'"),
        (always("strange", P, further_assumption=boolean("elsewhere")), "the further assumption reads 'elsewhere'"),
    ],
)
def test_unknown_reads_are_refused(prop: Property, message: str) -> None:
    """A property may read what the system has, and says where it was written."""
    with pytest.raises(PropertyError, match=message) as caught:
        observe(SYSTEM, prop)
    assert "test_spec.py:" in str(caught.value)


def test_a_negative_deadline_is_refused() -> None:
    """within() needs 0 or more steps."""
    with pytest.raises(PropertyError, match="steps is -1; give a whole number, 0 or more"):
        within("never", -1, P, Q)


def test_a_status_has_no_truth_value() -> None:
    """`if monitor.status` would take a broken property for a kept one."""
    with pytest.raises(TruthValueError, match=r"^a monitor's status has no truth value: match on Holds, Broken or"):
        bool(Broken(3))
