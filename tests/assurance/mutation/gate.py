"""A small machine in a world: one clause that claims need, one that they do not, and claims of different strength."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import NumVar, before, boolean, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import BoolVar
from safeloc.language.spec import Property, always, once, reachable, within
from safeloc.language.units import COUNT, MM_S
from safeloc.language.world import World

FASTEST_MM_S, LIMIT_MM_S = 80, 50


@dataclass(frozen=True, eq=False)
class Own:
    """The variables."""

    speed: NumVar
    noise: NumVar
    opened: BoolVar
    ran: NumVar
    true_speed: NumVar


def own() -> Own:
    """Fresh variables."""
    return Own(
        number("speed_mm_s", MM_S, 0, 100), number("noise", COUNT, 0, 9), boolean("opened"),
        number("ran", COUNT, 0, 3), number("true_speed_mm_s", MM_S, 0, 100),
    )  # fmt: skip


def build(of: Own) -> Machine:
    """SHUT and OPEN; it opens for slow vehicles, and counts in OPEN."""
    shut, open_ = table = modes("SHUT", "OPEN")
    laws = {
        "speed is measured": of.speed.eq(of.true_speed),
        "nobody is fast": of.true_speed <= FASTEST_MM_S,
        "there is little noise": of.noise < 5,
    }
    return Machine(
        name="gate",
        modes=table,
        inputs=[of.speed, of.noise, of.opened],
        state={of.ran: 0},
        outputs={"ran": of.ran},
        transitions=[
            Transition("opens", shut, open_, of.opened & (of.speed <= LIMIT_MM_S), {of.ran: 1}),
            Transition("shuts", open_, shut, of.speed > FASTEST_MM_S, {of.ran: 0}),
            Transition("counts", open_, open_, of.opened, {of.ran: 2}),
        ],
        world=World({}, [of.true_speed], {}, laws),
    )


def claims(made: Machine, of: Own) -> list[Property]:
    """That it opens for slow vehicles only, that it stays open since nobody is fast, and what it counts."""
    shut, open_ = made.modes
    return [
        always("stays open", before(made.mode).eq(open_).implies(made.mode.eq(open_))),
        always("opens for slow ones", (before(made.mode).eq(shut) & made.mode.eq(open_)).implies(of.speed <= LIMIT_MM_S),
               unconditional=True),
        always("opens when asked", once(of.opened & (of.true_speed < 20)).implies(once(made.mode.eq(open_)))),
        within("counts", 1, of.opened & before(made.mode).eq(open_), of.ran.eq(2)),
        reachable("opens", made.mode.eq(open_)),
    ]  # fmt: skip


_OWN: list[Own] = []


def machine() -> Machine:
    """The machine, for `safeloc mutate tests.assurance.mutation.gate:machine`."""
    _OWN[:] = [own()]
    return build(_OWN[0])


def properties(made: Machine) -> list[Property]:
    """Its claims."""
    return claims(made, _OWN[0])


def latest() -> Own:
    """The variables of the machine that was made last."""
    return _OWN[0]
