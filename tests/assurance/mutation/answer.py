"""A judge that hears a step late that the brake behind it acts strongly: a composition with a late wire, for mutants."""

from __future__ import annotations

from safeloc.language.composition import compose
from safeloc.language.expr import Expr, NumVar, Var, before, boolean, minimum, number
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.spec import always, earlier_bool
from safeloc.language.units import COUNT
from safeloc.target import Target


def target() -> Target:
    """The composition, with claims that write the wire down again."""
    calm, alarm = table = modes("CALM", "ALARM")
    heard, value = boolean("heard"), number("value", COUNT, 0, 9)
    judge = Machine(
        name="judge",
        modes=table,
        inputs=[value, heard],
        state={},
        outputs={"alarm": current_mode(table).eq(alarm)},
        transitions=[
            Transition("raise", calm, alarm, value > 7),
            Transition("answered", alarm, calm, heard, rank=1),
        ],
    )
    raised, times = boolean("raised"), number("times", COUNT, 0, 3)
    free, braked = actions = modes("FREE", "BRAKED")
    pressed: dict[Var, Expr] = {times: minimum(times + 1, 3)}
    brake = Machine(
        name="brake",
        modes=actions,
        inputs=[raised],
        state={times: 0},
        outputs={"strong": current_mode(actions).eq(braked) & (times >= 2)},
        transitions=[
            Transition("brake", free, braked, raised, pressed),
            Transition("release", braked, free, ~raised, {times: 0}),
            Transition("press", braked, braked, raised, pressed, rank=1),
        ],
    )
    wires: dict[Var, Expr] = {raised: judge.flag("alarm"), heard: earlier_bool(brake.flag("strong"))}
    whole = compose("answer", [judge, brake], wires)
    acting, often = whole.of(brake).num(brake.mode), whole.of(brake).num(times)
    was_alarmed = earlier_bool(whole.of(judge).bool(judge.mode.eq(alarm)))
    assert isinstance(acting, NumVar) and isinstance(often, NumVar)
    strong = before(acting).eq(braked) & (before(often) >= 2)
    answered = whole.of(judge).bool(judge.fired("answered"))
    claims = (always("a strong brake answers", (was_alarmed & strong).iff(answered)),)
    return Target("answer", (judge, brake), whole.system, claims)
