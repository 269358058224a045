"""Machines that may be told nothing: taking away all their inputs is proved to stay within what is assumed."""

from __future__ import annotations

import pytest

from safeloc.catalogue import load_target
from safeloc.codegen.smtlib import Query
from safeloc.errors import InputError
from safeloc.language.expr import Expr, Lit, NumVar, Var
from safeloc.language.nodes import Truth
from safeloc.language.system import TransitionSystem, canonical, environment
from safeloc.language.terms import Substitution, conjuncts
from safeloc.proof.provers.implication import unproved
from safeloc.runtime.border import Reason
from safeloc.runtime.embedding import Controller, Program
from safeloc.runtime.embedding.cycle_length import periods
from safeloc.shipped_machines import ENTRIES
from safeloc.target import Target
from tests.runtime.embedding.driving import shipped

PAIRS = [(entry.name, machine) for entry in ENTRIES.values() for machine in entry.silent]
CANNOT = (
    "stop_point",
    "turn_off",
    "fibre",
    "axle_counter",
    "axle_section",
    "train_order",
    "verification_doubted",
)


def neutral(var: Var) -> Expr:
    """What stands in an input that is not given."""
    return Lit(canonical(var), var.unit) if isinstance(var, NumVar) else Truth(False)


def of(system: TransitionSystem, machine: str) -> list[Var]:
    """The inputs of one machine on board."""
    prefix = f"{machine}." if len(system.machines) > 1 else ""
    return [var for var in system.inputs if var not in system.ghosts and var.name.startswith(prefix)]


def broken(target: Target, machine: str) -> dict[str, object]:
    """Parts of the assumption that a step need not keep once the machine is told nothing."""
    system = target.system
    silenced = Substitution({var: neutral(var) for var in of(system, machine)})
    goals = {f"{n}: {part!r:.80}": silenced.bool(part) for n, part in enumerate(conjuncts(system.assume))}
    return dict(unproved(Query("silence", (environment(system), *system.lemmas.values()), goals), 60))


@pytest.mark.thorough(ordinary=5)
@pytest.mark.parametrize(("name", "machine"), PAIRS, ids=lambda one: str(one))
def test_a_silent_step_is_within_the_assumption(name: str, machine: str) -> None:
    """For every state, every truth and every step that obeys the assumption: so does the step without these inputs."""
    target = load_target(name)
    assert of(target.system, machine)
    assert broken(target, machine) == {}


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("name", CANNOT)
def test_others_would_be_wronged(name: str) -> None:
    """Where silence itself says something about the world, it is not declared: the same question is answered no."""
    target = load_target(name)
    assert ENTRIES[name].silent == ()
    assert broken(target, target.machines[0].name)
    assert Program(target).missing({})


def test_a_silent_device_costs_its_source_only() -> None:
    """A cycle in which something of a machine is missing is that in which all of it is missing, and is told."""
    program = shipped("reflector")
    half, none = (Controller(program, period_ms=None if periods(program.target.config) else 100) for _ in range(2))
    report = half.step_inputs({"frame_present": True, "echo_1_error_mm": 5})
    assert report.values == none.step_inputs({}).values
    assert report.anew == none.report.anew == ""
    (fault,) = report.rejections
    assert (fault.channel, fault.reason) == ("reflector", Reason.MISSING)
    assert "no other input of reflector is used" in fault.detail
    assert none.report.rejections == ()


def test_what_may_not_be_silent_ends_there() -> None:
    """An axle counter that missed a cycle cannot say what it counted, and says so."""
    controller = Controller(load_target("axle_section"), period_ms=100)
    with pytest.raises(InputError, match="cannot restart by itself"):
        controller.step_inputs({})
    assert controller.halted == "input axles_in_low is missing"


def test_what_was_refused_is_told_where_it_ends() -> None:
    """A value of a wrong kind is why an input is missing: the controller halts, and says which."""
    controller = Controller(load_target("axle_section"), period_ms=100)
    with pytest.raises(
        InputError, match=r"axles_in_low is missing; head_fault was refused: expected true or false, got 1"
    ):
        controller.step_inputs({"head_fault": 1})
    assert "head_fault was refused" in controller.halted
