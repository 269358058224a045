"""Whether the vehicle stands: the example of a new machine, which tests/test_new_machine.py adds to a copy of the package."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import between, number
from safeloc.language.machine import Model, Transition, current_mode, modes
from safeloc.language.nodes import Lit
from safeloc.language.units import COUNT, MM_S
from safeloc.language.world import Law, World

REQUIREMENTS = ("OWN-1",)


class StandstillConfig(Config):
    """Figures of the measured speed."""

    cycles: int = quantity(3, "cycles", 2, 100, "[D] example")
    error_mm_s: int = quantity(50, "mm/s", 0, 1_000, "[D] example")
    max_speed_mm_s: int = quantity(50_000, "mm/s", 1_000, 138_889, "[D] example")


class Parts:
    """The variables: the measured speed, the cycles without any, and the true speed as a ghost."""

    def __init__(self, config: StandstillConfig) -> None:
        self.config, self.declared = config, Declared()
        top = config.max_speed_mm_s
        self.measured = self.declared.sensor(number("measured_mm_s", MM_S, 0, top))
        self.quiet = self.declared.state(number("quiet_cycles", COUNT, 0, config.cycles), first=0)
        self.speed = self.declared.ghost(number("speed_mm_s", MM_S, 0, top), first=0)
        self.next_speed = self.declared.choice(number("next_speed_mm_s", MM_S, 0, top))


Standstill = Model[Parts]


def build(own: Parts) -> Standstill:
    """The machine over the given variables."""
    table = modes("MOVING", "STANDING")
    made = own.declared.machine(
        name="standstill",
        modes=table,
        outputs={"standing": current_mode(table).eq(table[1])},
        transitions=list(_table(own, table)),
        world=_world(own),
        lemmas={"not enough while moving": current_mode(table).ne(table[0]) | (own.quiet < own.config.cycles)},
        doc="Tells that the vehicle stands after some cycles without measured speed.",
    )
    return Model(made, own)


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    moving, standing = table
    rests, enough = own.measured.eq(0), own.quiet + 1 >= own.config.cycles
    yield Transition("comes to rest", moving, standing, rests & enough, {own.quiet: own.config.cycles}, REQUIREMENTS)
    yield Transition("rests", moving, moving, rests & ~enough, {own.quiet: own.quiet + 1}, REQUIREMENTS)
    yield Transition("runs", moving, moving, ~rests, {own.quiet: 0}, REQUIREMENTS)
    yield Transition("stays", standing, standing, rests, {}, REQUIREMENTS)
    yield Transition("moves off", standing, moving, ~rests, {own.quiet: 0}, REQUIREMENTS)


def _world(own: Parts) -> World:
    error = own.config.error_mm_s
    measured = Law(
        between(-error, own.measured - own.next_speed, error),
        "The measured speed differs from the true one by no more than its error.",
        figures=("error_mm_s",),
        source="[D] example",
        owner="supplier",
        check="type test",
    )
    return own.declared.world({own.speed: own.next_speed}, {"measured within its error": measured})
