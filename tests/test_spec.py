"""Properties mean what they say: observers against naive definitions over lists; wrong reads are refused."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import PropertyError
from safeloc.expr import Bool, boolean, number
from safeloc.interpret import run
from safeloc.machine import Machine, Transition, modes
from safeloc.monitor import Broken, Holds, Monitor, check, check_all
from safeloc.spec import Property, always, never, observe, once, previous, since, within
from safeloc.system import lower
from safeloc.units import COUNT
from safeloc.verdict import Held, Violated

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
    """What the term is in each step, from its definition."""
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
        (always("strange", P, given=boolean("elsewhere")), "`given` reads 'elsewhere'"),
    ],
)
def test_unknown_reads_are_refused(prop: Property, message: str) -> None:
    """A property may read what the system has, and says where it was written."""
    with pytest.raises(PropertyError, match=message) as caught:
        observe(SYSTEM, prop)
    assert "test_spec.py:" in str(caught.value)


def test_a_negative_deadline_is_refused() -> None:
    """within() needs 0 or more steps."""
    with pytest.raises(PropertyError, match="must be 0 or more"):
        within("never", -1, P, Q)
