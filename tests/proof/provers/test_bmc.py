"""Bounded search: it finds shortest traces, reports its limits, and the interpreter confirms every result."""

import pytest
import z3

from safeloc.codegen.smt import Unrolling
from safeloc.errors import EngineError
from safeloc.language.spec import always, observe, reachable
from safeloc.language.verdict import Proved, Unknown, Violated
from safeloc.proof.provers import bmc as module
from safeloc.proof.provers import deepening
from safeloc.proof.provers.asking import ask, new_solver
from safeloc.proof.provers.bmc import bmc
from safeloc.proof.provers.limits import Limits
from tests.proof.provers.small import HIGH, LEVEL, MODE, counter, goal, system


def test_a_first_state_can_violate() -> None:
    """A property of the first state fails after no step at all."""
    verdict = bmc(goal(counter(), LEVEL > 0), Limits())
    assert isinstance(verdict, Violated)
    assert verdict.trace is not None
    assert verdict.trace.steps == ()


def test_reachable_yields_the_shortest_witness() -> None:
    """A reachable state is proved by a run that reaches it."""
    verdict = bmc(observe(system(counter()), reachable("high", MODE.eq(HIGH))), Limits())
    assert isinstance(verdict, Proved)
    assert verdict.witness is not None
    assert (verdict.depth, len(verdict.witness.steps)) == (5, 5)
    assert verdict.rechecked == ("interpreter",)
    assert verdict.witness.steps[-1].state["mode"] == HIGH.value


def test_reachable_within_the_depth_limit_only() -> None:
    """A depth limit below the distance gives Unknown, with the depth that was searched."""
    verdict = bmc(observe(system(counter()), reachable("high", MODE.eq(HIGH))), Limits(depth=4))
    assert isinstance(verdict, Unknown)
    assert verdict.depth == 4


def test_no_time_is_unknown() -> None:
    """Without time the verdict is Unknown, with the depth reached."""
    verdict = bmc(goal(counter(), LEVEL <= 9), Limits(seconds=1e-6))
    assert isinstance(verdict, Unknown)
    assert verdict.depth == -1


def test_a_solver_that_lies_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """A stream that does not break the property in the interpreter is an error, never a verdict."""
    monkeypatch.setattr(Unrolling, "values", lambda *_: {})
    with pytest.raises(EngineError, match="is not admissible"):
        bmc(goal(counter(), LEVEL <= 2), Limits())


def test_a_trace_that_breaks_nothing_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """The interpreter, not the model, says whether the property failed."""
    honest = Unrolling.values

    def without_ticks(self: Unrolling, *given: object) -> dict[str, object]:
        values = honest(self, *given)  # type: ignore[arg-type] # handed on as it came
        return {name: False if name == "tick" else value for name, value in values.items()}

    monkeypatch.setattr(Unrolling, "values", without_ticks)
    with pytest.raises(EngineError, match="does not break the property in the interpreter"):
        bmc(observe(system(counter()), always("low", LEVEL <= 2)), Limits())


def test_an_unlucky_seed_is_not_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """A question that one seed does not decide is asked again with another seed."""
    seeds: list[int] = []
    monkeypatch.setattr(module, "new_solver", lambda seed: seeds.append(seed) or new_solver(seed))
    monkeypatch.setattr(deepening, "ask", lambda *given: z3.unknown if seeds[-1] == 7 else ask(*given))
    assert isinstance(bmc(goal(counter(), LEVEL < 3), Limits(seed=7)), Violated)
    assert seeds == [7, 8]
    seeds.clear()
    assert isinstance(bmc(goal(counter(), LEVEL <= 10), Limits(seed=1, depth=4)), Unknown)
    assert seeds == [1]  # all of that depth was searched: another seed finds no more
