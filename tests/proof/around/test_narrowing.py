"""Ranges handed over: they are narrowed to what streams reach, and a range that was narrowed too far is never handed over."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest
import z3

from safeloc.language.expr import TRUE, Bool, BoolVar, Num, NumVar, as_num, boolean, ite, maximum, minimum, number
from safeloc.language.interpret import read_inputs
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.ranges import Bounds
from safeloc.language.system import lower
from safeloc.language.units import MM
from safeloc.proof.around.course import Course, Space, first_piece
from safeloc.proof.around.deviations import Deviations
from safeloc.proof.around.hand_over import hand_over
from safeloc.proof.around.narrowing import Narrowing
from safeloc.proof.around.tube import Given, Tube
from safeloc.proof.provers.limits import deadline
from safeloc.proof.provers.models import GaveUpError, Models

STEP = number("distance_mm", MM, -1000, 1000)
FAR, CUT, APART = (number(name, MM, -10_000, 10_000) for name in ("far_mm", "cut_mm", "apart_mm"))
(RUNNING,) = TABLE = modes("RUNNING")


def course(steps: int = 3, width: int = 50) -> Course:
    """Some steps of 100 mm, each up to `width` longer or shorter, of a machine that chooses among numbers."""
    machine = Machine(
        "choosing",
        TABLE,
        [STEP],
        {FAR: 0, CUT: 0, APART: 0},
        {},
        [
            Transition(
                "go",
                RUNNING,
                RUNNING,
                TRUE,
                {
                    FAR: ite(STEP > 120, 5000 + STEP, minimum(FAR + STEP, 8000)),
                    CUT: ite(CUT + STEP <= 330, CUT + STEP, 0),
                    APART: maximum(STEP, 100) - minimum(STEP, 100),
                },
            )
        ],
    )
    system = lower(machine)
    tube = Tube(system, Given([read_inputs(system, {"distance_mm": 100})] * steps), Deviations({"distance_mm": width}))
    space = Space(system, tube)
    return Course(space, first_piece(space), 0).to(steps)


def reached(steps: int, width: int) -> dict[NumVar, Bounds]:
    """The least and the greatest value of each number, over all streams, computed in plain Python."""
    after = {(0, 0, 0)}
    for _ in range(steps):
        after = {
            (
                5000 + step if step > 120 else min(far + step, 8000),
                cut + step if cut + step <= 330 else 0,
                max(step, 100) - min(step, 100),
            )
            for far, cut, _ in after
            for step in range(100 - width, 101 + width)
        }
    return {
        var: (min(column), max(column)) for var, column in zip((FAR, CUT, APART), zip(*after, strict=True), strict=True)
    }


def narrowing(of: Course) -> Narrowing:
    """All numbers at the end of a course."""
    numbers: dict[NumVar, Num] = {var: term for var in (FAR, CUT, APART) if isinstance(term := of.states[-1][var], Num)}
    sure = {var: of.intervals(term) for var, term in numbers.items()}
    return Narrowing(of, of.hypotheses(of.end), numbers, sure, deadline(30.0))


@pytest.mark.parametrize(("steps", "width"), [(1, 0), (1, 50), (2, 30), (3, 50), (4, 20)])
def test_ranges_are_those_that_streams_reach(steps: int, width: int) -> None:
    """Each end of a range is a value of some stream, whatever the terms allow by themselves."""
    of = course(steps, width)
    assert narrowing(of).ranges() == reached(steps, width)


def test_the_terms_alone_allow_more() -> None:
    """So there is something to narrow: the cut number can not be as great as its terms may be."""
    of = course()
    assert narrowing(of).sure[CUT] != reached(3, 50)[CUT]


def test_a_range_that_is_too_narrow_is_not_handed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    """If it were, a stream would leave it: the proof refuses it, and the bounds of the terms are handed over instead."""
    of = course()
    wrong = {var: (least, least) for var, (least, _) in reached(3, 50).items()}
    monkeypatch.setattr(Narrowing, "ranges", lambda self: {var: wrong[var] for var in self.numbers})
    [piece] = hand_over(of, deadline(30.0), "test").pieces
    sure = narrowing(of).sure
    assert {var: piece.ranges[var] for var in wrong} == {var: sure[var] for var in wrong}


def test_where_the_solver_gives_up_a_range_is_as_wide_as_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    """After so many questions: each end is that of the terms, or one that no stream goes beyond."""
    of, left = course(), [0]
    in_which = Models.in_which

    def gives_up(self: Models, condition: Any, seconds: float) -> Mapping[Any, Any] | None:
        left[0] -= 1
        if left[0] < 0:
            raise GaveUpError
        return in_which(self, condition, seconds)

    monkeypatch.setattr(Models, "in_which", gives_up)
    streams, sure = reached(3, 50), narrowing(of).sure
    for most in range(0, 24, 3):
        left[0] = most
        for var, (low, high) in narrowing(of).ranges().items():
            assert sure[var][0] <= low <= streams[var][0]
            assert streams[var][1] <= high <= sure[var][1]


def test_more_combinations_than_are_told_apart() -> None:
    """Four flags and a mode have more combinations than pieces: one piece holds them all, any mode included."""
    steps = [number(f"step_{place}_mm", MM, -1000, 1000) for place in range(1, 5)]
    flags = [boolean(f"long_{place}") for place in range(1, 5)]
    slow, fast = table = modes("SLOW", "FAST")
    longer: dict[NumVar | BoolVar, Num | Bool | int] = {
        flag: step > 100 for flag, step in zip(flags, steps, strict=True)
    }
    machine = Machine(
        "flags",
        table,
        steps,
        {**dict.fromkeys(flags, False), FAR: 0},
        {},
        [
            Transition("faster", slow, fast, steps[0] > steps[1], {**longer, FAR: minimum(FAR + steps[0], 8000)}),
            Transition("as before", slow, slow, TRUE, {**longer, FAR: maximum(FAR + steps[1], -8000)}),
        ],
    )
    system = lower(machine)
    given = Given([read_inputs(system, {step.name: 100 for step in steps})])
    tube = Tube(system, given, Deviations({step.name: 2 for step in steps}))
    space = Space(system, tube)
    [piece] = hand_over(Course(space, first_piece(space), 0).to(1), deadline(30.0), "test").pieces
    by_name = {var.name: bounds for var, bounds in piece.ranges.items()}
    assert (98, 102) == by_name["far_mm"]
    assert (0, 1) == by_name["mode"]
    assert not piece.fixed


def test_a_question_that_is_too_hard_gets_a_new_solver(monkeypatch: pytest.MonkeyPatch) -> None:
    """What one question could not decide does not stay with the next one."""
    asked: list[z3.Solver] = []

    def ask(solver: z3.Solver, seconds: float) -> z3.CheckSatResult:
        asked.append(solver)
        return z3.unknown if seconds == 0 else solver.check()

    monkeypatch.setattr("safeloc.proof.provers.models.ask", ask)
    models = Models([STEP > as_num(3, MM)], [STEP])
    assert models.in_which(STEP < 3, 1.0) is None
    assert models.in_which(STEP < 5, 1.0) == {STEP: 4}
    assert asked[0] is asked[1]
    with pytest.raises(GaveUpError):
        models.in_which(STEP < 5, 0)
    assert models.in_which(STEP < 5, 1.0) == {STEP: 4}
    assert asked[2] is not asked[3]
