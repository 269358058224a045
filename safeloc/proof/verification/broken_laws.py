"""The laws that a recording breaks in the step from which on a property requires nothing of it, and what it may lack."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from safeloc.language.expr import Var
from safeloc.language.interpret import holds
from safeloc.language.machine import ANY
from safeloc.language.nodes import Value
from safeloc.language.observable import Stated, seen
from safeloc.language.trace import Trace
from safeloc.language.verdict import Unknown


def with_laws(verdict: Unknown, trace: Trace, chosen: Mapping[str, Value]) -> Unknown:
    """Return the verdict of a replay with the laws that are broken in the step behind its depth, and where their distances are told.

    chosen  the first values that the recording gives
    """
    at = verdict.depth + 1
    laws = _broken(trace, at)
    if not laws:
        return verdict
    names = "; ".join(f"{law} (owner: {law.law.owner})" if law.law.owner else str(law) for law in laws)
    reason = (
        f"the assumption is broken at step {at}: {names}. Nothing is required from there on. "
        "`safeloc replay` with --assumptions tells by how much" + (_open(trace, chosen) if at == 1 else "")
    )
    return replace(verdict, reason=reason)


def _broken(trace: Trace, at: int) -> list[Stated]:
    """Return the clauses that are assumed and that a step of a run with ghosts breaks; steps count from 1."""
    system, step = trace.system, trace.steps[at - 1]
    if not system.ghosts:
        return []
    around, before = seen(system), trace.steps[at - 2].state if at > 1 else trace.initial
    values: dict[Var, Value] = {
        **{var: step.state[now.name] for var, now in around.after.items()},
        **{var: before[var.name] for var in system.state},
        **{var: step.inputs[var.name] for var in system.inputs},
    }
    return [one for one in around.stated if not one.guaranteed and not holds(one.term, values)]


def _open(trace: Trace, chosen: Mapping[str, Value]) -> str:
    """Say which ghosts began at their value nearest to zero because the recording does not say where."""
    system = trace.system
    ghosts = [var.name for var in system.state if var in system.ghosts and system.initial[var] is ANY]
    left = [name for name in ghosts if name not in chosen]
    if not left:
        return ""
    values = ", ".join(f"{name} = {trace.initial[name]}" for name in left)
    return (
        f". The recording does not say where the world begins, and {values} was taken: `first` in its header chooses "
        "another value, which `simulate` gives with SimulatedRun(steps, first={...})"
    )
