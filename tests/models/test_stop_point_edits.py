"""A wrong edit of a term of the stop-point machine is noticed by a proof: claims speak of the world, not of the machine's terms."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safeloc.language.expr import FALSE, TRUE, Lit, abs_, ceil_to, maximum, product
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.units import MM, MM_S2, MS
from safeloc.models.stop_point import build
from safeloc.models.stop_point.cycle import Judgement, Window
from safeloc.models.stop_point.variables import StopPointConfig, parts
from safeloc.properties.stop_point import properties
from tests.models.edited_terms import edited, keeps

CONFIG = StopPointConfig()


def made() -> tuple[Machine, list[Property]]:
    """The machine as it is built now, and its claims."""
    model = build(parts(CONFIG))
    return model.machine, properties(model)


def braking(cycle: Judgement, *, error: int = CONFIG.speed_error_mm_s, reaction_ms: int = CONFIG.reaction_ms) -> object:
    """The brake order by other figures."""
    speed = maximum(cycle.own.speed + error, 0)
    reaction = ceil_to(speed * Lit(reaction_ms, MS), MM)
    return product(speed, speed) >= (cycle.to_brake_in - reaction) * Lit(2 * CONFIG.brake_mm_s2, MM_S2)


Wrong = Callable[..., object]
EDITS: dict[str, tuple[type, str, Wrong, str]] = {
    "no reaction distance": (Judgement, "brake_now", lambda c, _: braking(c, reaction_ms=0), "brake order in time"),
    "no speed error": (Judgement, "brake_now", lambda c, _: braking(c, error=0), "brake order in time"),
    "brakes for nothing": (Judgement, "brake_now", lambda _c, _r: TRUE, "no brake order before it is due"),
    "the estimated position alone": (Judgement, "to_brake_in", lambda c, _: c.to_go, "brake order in time"),
    "the window's far end alone": (
        Judgement,
        "to_brake_in",
        lambda c, _: c.pending.ends - c.high,
        "brakes to the stop by the measurement",
    ),
    "the estimate without a measurement": (
        Judgement,
        "to_go",
        lambda c, _: c.pending.stop - c.own.position,
        "brakes to the stop by odometry",
    ),
    "beyond by the near end": (Judgement, "beyond", lambda c, _: c.low > c.pending.ends, "never on beyond the window"),
    "beyond a metre late": (
        Judgement,
        "beyond",
        lambda c, _: c.high > c.pending.ends + 1_000,
        "it comes to stand within the window",
    ),
    "short by the far end": (
        Judgement,
        "short",
        lambda c, _: c.high < c.pending.begins,
        "it comes to stand within the window",
    ),
    "standing without the sign": (
        Judgement,
        "standing",
        lambda c, _: c.own.speed <= CONFIG.standstill_mm_s,
        "in position it stands",
    ),
    "standing at walking pace": (
        Judgement,
        "standing",
        lambda c, _: abs_(c.own.speed) <= 20 * CONFIG.standstill_mm_s,
        "reversing begins near the window",
    ),
    "creeping without the speed error": (
        Judgement,
        "forwards_too_fast",
        lambda c, _: c.own.speed > CONFIG.reduced_speed_mm_s,
        "creeping is slow",
    ),
    "reversing without the speed error": (
        Judgement,
        "backwards_too_fast",
        lambda c, _: -c.own.speed > CONFIG.reduced_speed_mm_s,
        "reversing is slow",
    ),
    "reversing from any distance": (Judgement, "too_far", lambda _c, _r: FALSE, "reversing begins near the window"),
    "always too far": (Judgement, "too_far", lambda _c, _r: TRUE, "repositions when it may"),
    "a stop behind is selected": (
        Judgement,
        "selectable",
        lambda c, _: c.own.valid & c.named & c.known & c.own.selected_stop.value.ne(c.own.served_number),
        "only a stop ahead is selected",
    ),
    "a served stop is selected again": (
        Judgement,
        "selectable",
        lambda c, _: c.own.valid & c.named & c.known & (c.high <= c.chosen.ends),
        "a served stop is not selected at once again",
    ),
    "no stop is selected": (Judgement, "selectable", lambda _c, _r: FALSE, "a stop ahead is selected"),
    "the window shifted": (Window, "ends", lambda w, _: w.stop + w.after + w.before, "brake order in time"),
    "the window before the stop": (Window, "begins", lambda w, _: w.stop, "in position when it stands there"),
}


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The claim that is named is kept by the machine as it is, and not by the one that was edited wrongly."""
    owner, name, wrong, claim = EDITS[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, owner, name, wrong)
    assert not keeps(made(), claim)
