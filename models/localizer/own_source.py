"""A source of your own: a function that makes a machine for a vehicle, and the contract that the machine keeps.

The localizer takes any number of them beside its own sources (`safeloc verify localizer --source FILE.py:NAME`). It reads
of such a machine what the contract names, and nothing else:

    valid                              it states an interval
    position_mm, margin_below_mm, margin_above_mm   the interval: it holds the vehicle's front end at the end of the cycle
    reference_accepted                 it accepted an absolute reference in this cycle: with it a withdrawn position may return
    reason                             why it states nothing (safeloc.models.vocabulary.reasons)

That the interval holds the front end is proved of the machine from the laws of its own world (`Vehicle.world`), once, and so for
every choice of the sources beside it.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from safeloc.errors import InputError
from safeloc.language.expr import Bool, Expr, Num, NumVar, Var
from safeloc.language.machine import ANY, Initial, Machine
from safeloc.language.units import MM
from safeloc.language.world import Law, World
from safeloc.models.arbitration import SOURCES
from safeloc.models.motion import Motion
from safeloc.models.vocabulary.reasons import LOCATED

_FLAGS = ("valid", "reference_accepted")
INTERVAL = ("position_mm", "margin_below_mm", "margin_above_mm")
TAKEN = (
    *SOURCES, "none", "withheld", "motion", "line", "selection", "position", "verification", "downlink", "arbitration", "delocalized", "uplink",
)  # fmt: skip
"""Names that the localizer's own machines and modes have."""
_SHARED_LAWS = ("the vehicle never exceeds its highest speed", "the vehicle stays on the line")


@dataclass(frozen=True, eq=False)
class Vehicle:
    """Vehicle as a source may read it: some figures, and for its world the front end's true place.

    truth, true_cycle_distance    ghosts: the front end's place before the cycle, and its run in the cycle, nm
    period_ms           the cycle
    max_speed_mm_s, max_acceleration_mm_s2   the greatest, either way
    position_limit_mm   the line ends so far from 0, either way
    widest_mm           the greatest margin that the localizer accepts
    """

    truth: NumVar
    true_cycle_distance: NumVar
    period_ms: int
    max_speed_mm_s: int
    max_acceleration_mm_s2: int
    position_limit_mm: int
    widest_mm: int
    laws: Mapping[str, Law] = field(repr=False)

    @property
    def truth_after(self) -> Num:
        """The front end's true place at the end of the cycle, nm; every reported interval has to contain it."""
        return self.truth + self.true_cycle_distance

    @property
    def farthest_mm(self) -> int:
        """The farthest that the vehicle gets in a cycle, rounded up to a millimetre."""
        return -(-self.max_speed_mm_s * self.period_ms // 1_000)

    def world(
        self,
        clauses: Mapping[str, Bool | Law],
        *,
        ghosts: Mapping[Var, Initial] | None = None,
        choices: Sequence[Var] = (),
        moves: Mapping[Var, Expr] | None = None,
    ) -> World:
        """Return the world of a source: the vehicle moves, and the source's sensors obey these clauses.

        ghosts, choices, moves   further ones, as for `World`
        """
        return World(
            ghosts={self.truth: ANY, **(ghosts or {})},
            choices=[self.true_cycle_distance, *choices],
            moves={self.truth: self.truth_after, **(moves or {})},
            clauses={**self.laws, **clauses},
        )


Maker = Callable[[Vehicle], Machine]


@dataclass(frozen=True, eq=False)
class OwnSource:
    """A source that a user added: its machine, the vehicle it was made for, and where its function stands (file and line)."""

    machine: Machine
    vehicle: Vehicle
    place: str


def vehicle_of(moves: Motion, widest_mm: int) -> Vehicle:
    """Return the vehicle that moves like this."""
    config, seen = moves.own.config, moves.own.ghosts
    laws = {name: law for name, law in moves.machine.world.laws.items() if name in _SHARED_LAWS}
    return Vehicle(
        seen.truth, seen.true_cycle_distance, config.period_ms, config.max_speed_mm_s, config.max_acceleration_mm_s2,
        config.position_limit_mm, widest_mm, laws,
    )  # fmt: skip


def own_source(make: Maker, vehicle: Vehicle) -> OwnSource:
    """Make the machine and hold it to the form of the contract.

    InputError that names file, line and what is missing, where an output or the world is missing or of another kind.
    """
    place = _place(make)
    machine = make(vehicle)
    if not isinstance(machine, Machine):
        raise InputError(
            f"{place} returned {type(machine).__name__}; a source is a function of a Vehicle that returns a Machine."
        )
    for name in (*_FLAGS, *INTERVAL, "reason"):
        _check_output(machine, name, place)
    if vehicle.truth not in machine.world.moves:
        raise InputError(
            f"{place}: the world of {machine.name!r} does not say where the vehicle is; give the machine "
            "world=vehicle.world({clause: ...}), with clauses about vehicle.truth_after."
        )
    return OwnSource(machine, vehicle, place)


def distinct(sources: Sequence[OwnSource]) -> None:
    """Refuse a source that is called like another one, or like a machine of the localizer: InputError with file and line."""
    known: dict[str, str] = {}
    known |= dict.fromkeys(TAKEN, "the localizer")
    for one in sources:
        name = one.machine.name
        if not name.isidentifier():
            raise InputError(f"{one.place}: {name!r} is no name for a source; use letters, digits and _.")
        if name in known:
            raise InputError(f"{one.place}: {known[name]} has a machine {name!r} already; give yours another name.")
        known[name] = one.place


def _check_output(machine: Machine, name: str, place: str) -> None:
    wanted = "a truth value" if name in _FLAGS else "a number of mm" if name in INTERVAL else "a member of REASON"
    found = machine.outputs.get(name)
    if found is None:
        raise InputError(f"{place}: machine {machine.name!r} has no output {name!r}; a source states it, {wanted}.")
    unit = MM if name in INTERVAL else LOCATED.unit
    fits = isinstance(found, Bool) if name in _FLAGS else isinstance(found, Num) and found.unit == unit
    if not fits:
        raise InputError(f"{place}: output {name!r} of machine {machine.name!r} must be {wanted}.")


def _place(make: object) -> str:
    code = getattr(make, "__code__", None)
    if code is None:
        raise InputError(f"{make!r} is no function; a source is a function of a Vehicle that returns a Machine.")
    return f"{inspect.getsourcefile(code) or code.co_filename}:{code.co_firstlineno}"
