"""A small composition: a watch tells whether a vehicle is slow and whether it is silent, and a door opens for slow ones."""

from __future__ import annotations

from dataclasses import replace

from safeloc.language.composition import Composition, compose
from safeloc.language.expr import Expr, NumVar, Var, boolean, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import COUNT, MM_S
from safeloc.language.world import World
from safeloc.target import Target

SLOW_MM_S = 50
SPEED, LOUD = number("speed_mm_s", MM_S, 0, 100), boolean("loud")
SEEN, LAST = number("seen_mm_s", MM_S, 0, 100), boolean("last_loud")
SLOW, SILENT = boolean("slow"), boolean("silent")
OPENED = number("opened", COUNT, 0, 9)
IS_SLOW, IS_LOUD = boolean("is_slow"), boolean("is_loud")
TRULY_SLOW, TRULY_LOUD = boolean("truly_slow"), boolean("truly_loud")


def watch() -> Machine:
    """Remembers what it saw."""
    (on,) = modes("ON")
    sees = Transition("sees", on, on, set={SEEN: SPEED, LAST: LOUD}, requirements=("REQ-1",))
    told = {"slow": SEEN <= SLOW_MM_S, "silent": ~LAST}
    return Machine("watch", (on,), [SPEED, LOUD], {SEEN: 100, LAST: True}, told, [sees])


def door() -> Machine:
    """Opens for slow vehicles that are silent."""
    shut, open_ = table = modes("SHUT", "OPEN")
    rows = [
        Transition("opens", shut, open_, SLOW & SILENT, {OPENED: 1}, ("REQ-2",)),
        Transition("shuts", open_, shut, ~SLOW, {OPENED: 0}, ("REQ-2",)),
    ]
    return Machine("door", table, [SLOW, SILENT], {OPENED: 0}, {"opened": OPENED}, rows)


def target() -> Target:
    """Both, with one claim of the door by itself and one of the whole."""
    first, second = watch(), door()
    wires: dict[Var, Expr] = {SLOW: first.flag("slow"), SILENT: first.flag("silent")}
    whole = compose("watched_door", [first, second], wires)
    by_itself = always("shut is counted", second.mode.eq(second.modes[0]).implies(OPENED.eq(0)), unconditional=True)
    return Target(
        "watched_door", (first, second), whole.system, tuple(_claims(whole, second)), members={"door": (by_itself,)}
    )


def listening() -> Target:
    """Both, with one claim more: of the wired input that says whether the vehicle is silent. A part of that wire says nothing new."""
    first, second = watch(), door()
    slow, silent = first.flag("slow"), first.flag("silent")
    wires: dict[Var, Expr] = {SLOW: slow, SILENT: silent & (silent | slow)}
    whole = compose("watched_door", [first, second], wires)
    hears = whole.of(second).bool(SILENT).iff(whole.of(first).bool(~LAST))
    heard = always("silence is heard", hears & earlier_bool(hears), unconditional=True)
    return Target("watched_door", (first, second), whole.system, (*_claims(whole, second), heard))


def lasting() -> Target:
    """Both, with nothing claimed of the door by itself, and a claim of the whole that one step of induction does not prove."""
    first, second = watch(), door()
    whole = compose("watched_door", [first, second], {SLOW: first.flag("slow"), SILENT: first.flag("silent")})
    of = whole.of(second)
    shut, nothing = of.bool(second.mode.eq(second.modes[0])), of.bool(OPENED.eq(0))
    lasts = always(
        "a door that stays shut is counted", (shut & earlier_bool(shut)).implies(nothing), unconditional=True
    )
    return Target("watched_door", (first, second), whole.system, (lasts,))


def truthful() -> Target:
    """Both with the truth: the watch's world moves it, the door's world is wired to it, and the door trusts the watch."""
    first, second = watch(), door()
    first = replace(
        first, world=World({IS_SLOW: False, IS_LOUD: True}, (), {IS_SLOW: SPEED <= SLOW_MM_S, IS_LOUD: LOUD})
    )
    trusts = {"slow is true": SLOW.implies(TRULY_SLOW), "silence is true": SILENT.implies(~TRULY_LOUD)}
    second = replace(second, world=World({}, (TRULY_SLOW, TRULY_LOUD), {}, trusts))
    wires: dict[Var, Expr] = {
        SLOW: first.flag("slow"),
        SILENT: first.flag("silent"),
        TRULY_SLOW: IS_SLOW,
        TRULY_LOUD: IS_LOUD,
    }
    whole = compose("watched_door", [first, second], wires, discharge=[second])
    return Target("watched_door", (first, second), whole.system, tuple(_claims(whole, second)))


def _claims(whole: Composition, second: Machine) -> list[Property]:
    """In a figure of its own, from what the watch hears."""
    speed = whole.system.variable("watch.speed_mm_s")
    assert isinstance(speed, NumVar)
    is_open = whole.of(second).bool(second.mode.eq(second.modes[1]))
    return [always("open for slow ones only", is_open.implies(speed <= SLOW_MM_S), unconditional=True)]
