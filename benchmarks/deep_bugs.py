"""Machines with a bug that shows only after dozens of steps: what the falsifier has to find.

python -m benchmarks.deep_bugs          prints found or not, seconds and depth, for the falsifier and for plain BMC
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

from safeloc.language.expr import Bool, Lit, abs_, between, boolean, ceil_div, exact_to, floor_div, ite, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import Goal, Property, always, observe, within
from safeloc.language.system import lower
from safeloc.language.units import COUNT, MM, NM, PPM
from safeloc.language.verdict import Verdict, Violated
from safeloc.language.world import World
from safeloc.proof.provers.bmc import bmc
from safeloc.proof.provers.falsify import falsify
from safeloc.proof.provers.limits import Limits

STEP_MM, RATE_PPM = 5_000, 50_000
PER_STEP_NM = STEP_MM * RATE_PPM


@dataclass(frozen=True, eq=False)
class DeepBug:
    """A machine, the property it breaks, and the fewest steps after which that can show."""

    name: str
    machine: Machine
    prop: Property
    depth: int

    @property
    def goal(self) -> Goal:
        """For an engine."""
        return observe(lower(self.machine), self.prop)


def _odometer(
    name: str, tolerance_nm: int, grow: Callable[..., object] | None = None, slip: int = 0, late: bool = False
) -> tuple[Machine, Bool, Bool]:
    """Margin against truth. `grow` replaces the growth, `slip` loosens the guard, `late` judges the old margin."""
    tracking, lost = modes("TRACKING", "LOST")
    step = number("distance_mm", MM, -STEP_MM, STEP_MM)
    position, run = number("position_mm", MM, -(10**9), 10**9), number("run", COUNT, 0, 10_000)
    margin, reverse = number("margin_nm", NM, 0, 10**13), boolean("reverse")
    truth, moved = number("truth_nm", NM, -(10**15), 10**15), number("true_cycle_distance_nm", NM, -(10**10), 10**10)
    honest = abs_(step) * Lit(RATE_PPM, PPM)
    growth = honest if grow is None else grow(honest, step, run, margin)
    grown = margin + growth  # type: ignore[operator]
    judged = margin if late else grown
    machine = Machine(
        name=name,
        modes=(tracking, lost),
        inputs=[step],
        state={position: 0, margin: 0, run: 0, reverse: False},
        outputs={},
        transitions=[
            Transition("exceeded", tracking, lost, judged > tolerance_nm + slip, rank=0),
            Transition("full", tracking, lost, run >= 9_000, rank=1),
            Transition(
                "run on", tracking, tracking, set={position: position + step, margin: grown, run: run + 1}, rank=2
            ),
        ],
        world=World(
            ghosts={truth: 0},
            choices=[moved],
            moves={truth: truth + moved},
            clauses={
                "assumption": between(-honest, moved - exact_to(step, NM), honest)
                & between(-(10**15), truth + moved, 10**15)
            },
        ),
    )
    is_tracking = machine.mode.eq(tracking)
    inside = is_tracking.implies(abs_(truth - exact_to(position, NM)) <= margin)
    return machine, inside, is_tracking.implies(margin <= tolerance_nm)


def _off_by_one() -> DeepBug:
    machine, _, tolerated = _odometer("off_by_one", 41 * PER_STEP_NM - 1, slip=1)
    return DeepBug("off by one in the tolerance", machine, always("tolerance", tolerated), 41)


def _late_judgement() -> DeepBug:
    machine, _, tolerated = _odometer("late_judgement", 120 * PER_STEP_NM, late=True)
    return DeepBug("the old margin is judged", machine, always("tolerance", tolerated), 121)


def _forgotten_remainder() -> DeepBug:
    grow = lambda honest, *_: floor_div(honest, 1_000_000) * 1_000_000  # noqa: E731 # reads as what it is
    machine, _, _ = _odometer("forgotten_remainder", 10**12, grow)
    truth, position, margin = (lower(machine).variable(n) for n in ("truth_nm", "position_mm", "margin_nm"))
    inside = abs_(truth - exact_to(position, NM)) <= margin + 60 * 950_000  # type: ignore[operator,arg-type]
    return DeepBug("a remainder is forgotten", machine, always("containment", inside), 58)


def _one_branch() -> DeepBug:
    grow = lambda honest, step, run, _: ite(run >= 70, floor_div(honest, 2), honest)  # noqa: E731
    machine, inside, _ = _odometer("one_branch", 10**12, grow)
    return DeepBug("growth is halved after 70 steps", machine, always("containment", inside), 71)


def _wrong_unit() -> DeepBug:
    grow = lambda honest, step, run, margin: ite(margin > 45 * PER_STEP_NM, floor_div(honest, 1000), honest)  # noqa: E731
    machine, inside, _ = _odometer("wrong_unit", 10**12, grow)
    return DeepBug("a wrong unit beyond a margin", machine, always("containment", inside), 47)


def _rare_value() -> DeepBug:
    grow = lambda honest, step, run, _: ite(step.eq(-STEP_MM) & (run >= 150), honest - 1, honest)  # noqa: E731
    machine, inside, _ = _odometer("rare_value", 10**12, grow)
    return DeepBug("one nm less at one speed after 150 steps", machine, always("containment", inside), 151)


def _late_deadline() -> DeepBug:
    idle, waiting = modes("IDLE", "WAITING")
    asked, waited = boolean("asked"), number("waited", COUNT, 0, 200)
    machine = Machine(
        name="late_deadline",
        modes=(idle, waiting),
        inputs=[asked],
        state={waited: 0},
        outputs={},
        transitions=[
            Transition("ask", idle, waiting, asked, {waited: 0}),
            Transition("answer", waiting, idle, waited >= 100, rank=0),
            Transition("wait", waiting, waiting, set={waited: waited + 1}, rank=1),
        ],
    )
    late = within("answered", 100, machine.fired("ask"), machine.fired("answer"))
    return DeepBug("an answer one step late", machine, late, 101)


def _order_of_modes() -> DeepBug:
    first, second, third, bad = modes("FIRST", "SECOND", "THIRD", "BAD")
    held, go = number("held", COUNT, 0, 60), boolean("go")
    moves = []
    for source, target, least in ((first, second, 30), (second, third, 45), (third, bad, 20)):
        name = source.label.lower()
        moves += [
            Transition(f"leave {name}", source, target, go & (held >= least), {held: 0}, rank=0),
            Transition(f"fall back from {name}", source, first, go & (held < least), {held: 0}, rank=0),
            Transition(f"hold {name}", source, source, held < 60, {held: held + 1}, rank=1),
        ]
    machine = Machine("order_of_modes", (first, second, third, bad), [go], {held: 0}, {}, moves)
    return DeepBug("a path through three held modes", machine, always("never bad", machine.mode.ne(bad)), 98)


def _one_sided() -> DeepBug:
    grow = lambda honest, step, run, _: ite((step < 0) & (run >= 90), honest - ceil_div(honest, 100), honest)  # noqa: E731
    machine, inside, _ = _odometer("one_sided", 10**12, grow)
    return DeepBug("less growth backwards after 90 steps", machine, always("containment", inside), 91)


def _stale_limit() -> DeepBug:
    fresh, stale = modes("FRESH", "STALE")
    heard, age = boolean("heard"), number("age", COUNT, 0, 250)
    machine = Machine(
        name="stale_limit",
        modes=(fresh, stale),
        inputs=[heard],
        state={age: 0},
        outputs={},
        transitions=[
            Transition("hear", (fresh, stale), fresh, heard, {age: 0}, rank=0),
            Transition("go stale", fresh, stale, age > 200, rank=1),
            Transition("grow older", fresh, fresh, set={age: age + 1}, rank=2),
        ],
    )
    return DeepBug("a stale limit off by one", machine, always("fresh", machine.mode.eq(stale) | (age <= 200)), 201)


DEEP_BUGS = (
    _off_by_one(),
    _wrong_unit(),
    _forgotten_remainder(),
    _one_branch(),
    _one_sided(),
    _order_of_modes(),
    _late_deadline(),
    _late_judgement(),
    _rare_value(),
    _stale_limit(),
)


def _row(bug: DeepBug, engine: Callable[[Goal, Limits], Verdict], seconds: float) -> str:
    started = time.monotonic()
    verdict = engine(bug.goal, Limits(depth=250, seconds=seconds))
    spent = time.monotonic() - started
    found = (
        f"found at {len(verdict.trace.steps):3}" if isinstance(verdict, Violated) and verdict.trace else "not found   "
    )
    return f"{found} in {spent:5.1f} s"


def main(seconds: float = 30.0) -> None:
    """Print the table."""
    print(f"{'bug':44} {'depth':>5}   {'falsifier':24} {'plain bounded search':24}")
    for bug in DEEP_BUGS:
        print(
            f"{bug.name:44} {bug.depth:5}   {_row(bug, falsify, seconds):24} {_row(bug, bmc, seconds):24}", flush=True
        )


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 30.0)
