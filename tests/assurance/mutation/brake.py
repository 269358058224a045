"""A small machine with one claim that repeats the machine's own term, and one that has a figure of its own."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool, NumVar, boolean, minimum, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import BoolVar
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import COUNT, MM_S

LIMIT_MM_S, SURELY_TOO_FAST_MM_S, MOST = 50, 60, 3


@dataclass(frozen=True, eq=False)
class Own:
    """The variables."""

    speed: NumVar
    released: BoolVar
    brakings: NumVar
    spare: NumVar

    @property
    def too_fast(self) -> Bool:
        """The term that both machine and claim use."""
        return self.speed > LIMIT_MM_S

    @property
    def worn(self) -> Bool:
        """A term over state."""
        return self.brakings >= MOST


def own() -> Own:
    """Fresh variables."""
    return Own(
        number("speed_mm_s", MM_S, 0, 100), boolean("released"), number("brakings", COUNT, 0, MOST),
        number("spare", COUNT, 0, MOST),
    )  # fmt: skip


def build(of: Own) -> Machine:
    """RUN and BRAKE; brakings are counted, `spare` is written and never read."""
    run, brake = table = modes("RUN", "BRAKE")
    more = {of.brakings: minimum(of.brakings + 1, MOST), of.spare: of.brakings}
    return Machine(
        name="brake",
        modes=table,
        inputs=[of.speed, of.released],
        state={of.brakings: 0, of.spare: 0},
        outputs={"brakings": of.brakings},
        transitions=[
            Transition("brakes", run, brake, of.too_fast, more, ("REQ-1",)),
            Transition("releases", brake, run, of.released & ~of.too_fast & ~of.worn, {}, ("REQ-2",)),
        ],
    )


def claims(made: Machine, of: Own) -> list[Property]:
    """The first repeats the guard, the second does not."""
    braking = made.mode.eq(made.modes[1])
    return [
        always("brakes when too fast", of.too_fast.implies(braking), unconditional=True),
        always("brakes when surely too fast", (of.speed > SURELY_TOO_FAST_MM_S).implies(braking), unconditional=True),
        always("worn brakes stay on", (earlier_bool(of.worn & braking)).implies(braking), unconditional=True),
    ]


_OWN: list[Own] = []


def machine() -> Machine:
    """The machine, for `safeloc mutate tests.assurance.mutation.brake:machine`."""
    _OWN[:] = [own()]
    return build(_OWN[0])


def properties(made: Machine) -> list[Property]:
    """Its claims."""
    return claims(made, _OWN[0])
