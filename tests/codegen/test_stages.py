"""The step machine by machine: together the stages move what `next` moves, and generated code goes through them."""

from __future__ import annotations

import pytest
from hypothesis import given

from safeloc.codegen.compiled import compile_system
from safeloc.codegen.stages import Stage, stages
from safeloc.language.composition import Composition, compose
from safeloc.language.expr import Expr, Var, before, ite, maximum, minimum, number, optional
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always, observe, once, watch
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.language.terms import variables
from safeloc.language.units import MM
from safeloc.shipped_machines import ENTRIES
from tests.codegen.test_compiled import assert_same_run
from tests.random_machines import Record, first_states, streams

COMPOSITIONS = ("supervised_odometry", "satellite", "sections", "localizer")


class Line:
    """Three machines in a row: a measured way, its greatest value so far, and how far it has come back since."""

    def __init__(self) -> None:
        step, self.way = optional("step", MM, -3, 3), number("way", MM, 0, 50)
        near, far = table = modes("NEAR", "FAR")
        moved = maximum(minimum(self.way + ite(step.present, step.value, 1), 50), 0)
        rows = [
            Transition("leave", near, far, moved > 20, {self.way: moved}),
            Transition("return", far, near, moved < 5, {self.way: moved}),
            Transition("run", near, near, set={self.way: moved}, rank=1),
            Transition("run far away", far, far, set={self.way: moved}, rank=1),
        ]
        self.runner = Machine("runner", table, [step], {self.way: 0}, {"way": self.way}, rows)
        (only,) = single = modes("ONLY")
        heard, self.most = number("heard", MM, 0, 50), number("most", MM, 0, 50)
        rise = Transition("rise", only, only, heard > self.most, {self.most: heard})
        self.peak = Machine("peak", single, [heard], {self.most: 0}, {"most": self.most}, [rise])
        top, now, self.back = number("top", MM, 0, 50), number("now", MM, 0, 50), number("back", MM, -50, 50)
        (one,) = alone = modes("ONE")
        tell = Transition("tell", one, one, set={self.back: top - now})
        self.shortfall = Machine("shortfall", alone, [top, now], {self.back: 0}, {"back": self.back}, [tell])
        wires: dict[Var, Expr] = {
            heard: self.runner.output("way"),
            top: self.peak.output("most"),
            now: self.runner.output("way"),
        }
        self.whole: Composition = compose("line", [self.runner, self.peak, self.shortfall], wires)

    def watched(self) -> TransitionSystem:
        """The whole with properties that look at the state before the step, and further back."""
        way, most = (self.whole.of(one)(var) for one, var in ((self.runner, self.way), (self.peak, self.most)))
        assert isinstance(way, type(self.way))
        assert isinstance(most, type(self.most))
        goals = [
            observe(self.whole.system, always("no jump", way - before(way) <= 2)),
            observe(self.whole.system, always("a peak stays", once(way > 10).implies(most > before(way) - 1))),
        ]
        return watch(self.whole.system, goals).system


LINE = Line()
COMPILED, WATCHED = compile_system(LINE.whole.system), compile_system(LINE.watched())


def of(system: TransitionSystem, name: str) -> Stage:
    """The stage of this name."""
    return next(stage for stage in stages(system) if stage.name == name)


def test_a_machine_reads_what_the_earlier_ones_have_come_to() -> None:
    """The terms of the first machine do not occur again in the stages of the others."""
    system = LINE.whole.system
    assert [stage.name for stage in stages(system)] == ["runner", "peak", "shortfall"]
    back = of(system, "shortfall")
    read = {back.after[var].name for var in variables(list(back.moved.values())) if var in back.after}
    assert read == {"runner.way", "peak.most"}
    assert not back.before


@pytest.mark.parametrize("name", COMPOSITIONS)
def test_stages_share_the_moves_among_them(name: str) -> None:
    """Of shipped compositions: every variable moves in one stage, which reads no other one's before the step."""
    system = without_ghosts(ENTRIES[name].make(ENTRIES[name].config()).system)
    found = stages(system)
    assert [stage.name for stage in found] == [machine.name for machine in system.machines]
    assert sorted(var.name for stage in found for var in stage.moved) == sorted(var.name for var in system.state)
    assert [var for stage in found for var in stage.fired] == list(system.fired)
    for stage in found:
        read = set(variables([*stage.moved.values(), *stage.fired.values()]))
        assert read <= {*stage.moved, *system.inputs, *stage.after}, stage.name
        assert not stage.before, stage.name


def test_what_is_watched_comes_last_and_knows_the_state_before() -> None:
    """Properties' own variables are no machine's; they read what the machines have already moved as it was."""
    last = stages(WATCHED.system)[-1]
    assert last.moved
    assert "runner.way" in {var.name for var in last.before.values()}


def test_a_machine_by_itself_is_one_stage() -> None:
    """With the terms of `next`."""
    system = without_ghosts(ENTRIES["odometry"].make(ENTRIES["odometry"].config()).system)
    (only,) = stages(system)
    assert all(only.moved[var] is system.next[var] for var in system.state)


@given(stream=streams(LINE.whole.system, 20), first=first_states(LINE.whole.system))
def test_a_composition_runs_as_interpreted(stream: list[Record], first: Record) -> None:
    """Stage by stage, the step comes to what the interpreter comes to."""
    assert_same_run(COMPILED, run(LINE.whole.system, stream, first=first), stream, first)


@given(stream=streams(WATCHED.system, 20), first=first_states(LINE.whole.system))
def test_a_watched_composition_runs_as_interpreted(stream: list[Record], first: Record) -> None:
    """Also where a later stage looks at what an earlier one has moved already."""
    assert_same_run(WATCHED, run(WATCHED.system, stream, first=first), stream, first)


def test_the_text_goes_machine_by_machine() -> None:
    """Each stage is a block of its own that is left when its machine has moved."""
    step = COMPILED.source[: COMPILED.source.index("def moving")]
    named = [line.strip() for line in step.splitlines() if line.strip().startswith("while True:")]
    assert named == ["while True:  # runner", "while True:  # peak", "while True:  # shortfall"]
