"""A long run that violates a property, in words: what repeats is told once, so that the step that matters is seen."""

from __future__ import annotations

from safeloc.explain.explanation import violation
from safeloc.language.expr import boolean, number
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always
from safeloc.language.system import lower
from safeloc.language.units import COUNT

FRESH, STALE = modes("FRESH", "STALE")
HEARD, AGE = boolean("heard"), number("age", COUNT, 0, 400)


def receiver() -> Machine:
    """It calls its word stale one cycle late: after 244 cycles, where 243 are allowed."""
    return Machine(
        "receiver",
        modes=(FRESH, STALE),
        inputs=[HEARD],
        state={AGE: 0},
        outputs={},
        transitions=[
            Transition("hear", (FRESH, STALE), FRESH, HEARD, {AGE: 0}, rank=0),
            Transition("go stale", FRESH, STALE, AGE > 243, rank=1),
            Transition("grow older", FRESH, FRESH, set={AGE: AGE + 1}, rank=2),
        ],
    )


def test_steps_that_repeat_are_three_lines() -> None:
    """Of 244 steps without an input that matters the first and the last stand there, with the number between them, and the part that fails."""
    machine = receiver()
    prop = always("fresh", machine.mode.eq(STALE) | (AGE <= 243))
    inputs, failing = violation(run(lower(machine), [{"heard": False}] * 244), prop)
    assert ["   1  grow older  []", "      ... 242 more steps: grow older", " 244  grow older  []"] == list(
        inputs.lines
    )
    assert "The part that fails in step 244, with its values" == failing.heading
    assert any("age = 244" in line for line in failing.lines)


def test_a_step_with_an_input_that_matters_is_told_as_it_is() -> None:
    """Three quiet steps are no fold, and the input stands at its step."""
    machine = receiver()
    stream = [{"heard": step in (1, 5)} for step in range(1, 9)]
    inputs, _ = violation(run(lower(machine), stream), always("young", AGE < 3))
    fired = ["grow older  []", "hear  [heard=true]"]
    assert [f"{step:4}  {fired[step in (1, 5)]}" for step in range(1, 9)] == list(inputs.lines)
