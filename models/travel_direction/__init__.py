"""Direction of travel from the reflector models before and after a balise (RFL-D5; source l. 161, 290).

One balise alone does not tell which way a vehicle runs along the line; the models of the reflectors on its two sides,
in the order in which they are met, do. `before` and `after` are meant in the line's counting direction.

    UNKNOWN  nothing is stated
    HALF     a balise was passed, and the reflector passed last fits one direction; the one ahead has to confirm it
    ALONG    the vehicle runs in counting direction
    AGAINST  it runs against it
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.config import Config
from safeloc.language.expr import Bool, BoolVar, Expr, Lit, Num, NumVar, Var, boolean, choice, enumeration, ite, members
from safeloc.language.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.models.vocabulary.reflectors import MODEL, NO_MODEL

DIRECTION = members("travel", "UNKNOWN", "ALONG", "AGAINST")
UNKNOWN, ALONG, AGAINST = DIRECTION
TRACE = ("RFL-D5",)


class DirectionConfig(Config):
    """Nothing to configure: the map gives the models, the route the direction that is expected."""


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine.

    passed         model of a reflector that was passed in this cycle; NONE in most cycles
    ahead          model of the nearest reflector measured ahead, with the minimum intensity; NONE if there is none
    before, after  the map's models on the two sides of the balise that is read
    backwards      the vehicle moved backwards or changed its driving end: what was passed no longer counts
    expected       the direction by route and movement authority
    runs_along     ghost: the vehicle runs in counting direction
    half_right     ghost: the reflector passed last before the balise was the one that the map has there
    """

    passed: NumVar
    ahead: NumVar
    balise: BoolVar
    before: NumVar
    after: NumVar
    backwards: BoolVar
    expected: NumVar
    last: NumVar
    awaited: NumVar
    along: BoolVar
    asked: NumVar
    runs_along: BoolVar
    next_runs_along: BoolVar
    half_right: BoolVar

    @property
    def latest(self) -> Num:
        """The model passed last, this cycle included."""
        return ite(self.passed.eq(NO_MODEL), self.last, self.passed)

    @property
    def telling(self) -> Bool:
        """A balise is read whose neighbours are of different models."""
        known = self.before.ne(NO_MODEL) & self.after.ne(NO_MODEL)
        return self.balise & self.before.ne(self.after) & known

    @property
    def confirmed(self) -> Bool:
        """The reflector ahead is of the awaited model."""
        return ~self.balise & self.ahead.eq(self.awaited)

    @property
    def refuted(self) -> Bool:
        """The reflector ahead is of another model."""
        return ~self.balise & self.ahead.ne(NO_MODEL) & self.ahead.ne(self.awaited)


@dataclass(frozen=True, eq=False)
class TravelDirection:
    """The machine together with its variables, for properties to speak about."""

    machine: Machine
    own: Parts


def machine(_: DirectionConfig | None = None) -> Machine:
    """The direction machine (RFL-D5)."""
    return build(parts()).machine


def parts(_: DirectionConfig | None = None) -> Parts:
    """Fresh variables for one machine."""
    model, travel = enumeration(MODEL), enumeration(DIRECTION)
    return Parts(
        passed=choice("passed_model", model),
        ahead=choice("ahead_model", model),
        balise=boolean("balise_read"),
        before=choice("model_before", model),
        after=choice("model_after", model),
        backwards=boolean("backwards"),
        expected=choice("route_direction", travel),
        last=choice("last_passed_model", model),
        awaited=choice("awaited_model", model),
        along=boolean("half_along"),
        asked=choice("asked_direction", travel),
        runs_along=boolean("runs_along"),
        next_runs_along=boolean("next_runs_along"),
        half_right=boolean("half_is_right"),
    )


def build(own: Parts) -> TravelDirection:
    """The machine over the given variables."""
    table = modes("UNKNOWN", "HALF", "ALONG", "AGAINST")
    current = current_mode(table)
    _, half, along, against = table
    true_model = ite(own.runs_along, own.before, own.after)
    made = Machine(
        name="travel_direction",
        modes=table,
        inputs=[own.passed, own.ahead, own.balise, own.before, own.after, own.backwards, own.expected],
        state={own.last: NO_MODEL, own.awaited: NO_MODEL, own.along: False, own.asked: UNKNOWN},
        outputs={
            "direction": ite(current.eq(along), ALONG, ite(current.eq(against), AGAINST, UNKNOWN)),
            "contradicts": ite(current.eq(along), own.asked.eq(AGAINST), current.eq(against) & own.asked.eq(ALONG)),
        },
        transitions=list(_table(own, current, table)),
        ghosts={own.runs_along: ANY, own.half_right: False},
        ghost_inputs=[own.next_runs_along],
        ghost_moves={
            own.runs_along: ite(own.backwards, own.next_runs_along, own.runs_along),
            own.half_right: ite(own.telling, own.latest.eq(true_model), own.half_right),
        },
        assumption=_recognition_law(own, current.eq(half)),
        lemmas=_lemmas(own, current, table),
        definitions={"neighbours differ": own.telling, "confirmed ahead": own.confirmed, "refuted ahead": own.refuted},
        mode_variable=current,
        doc=(
            "Direction of travel from the models of the reflectors before and after a balise, in the order in which they "
            "are met. Assumed: of the two models recognised around a balise at least one is that of the map's reflector "
            "there, and the direction changes only where the vehicle says that it moves backwards."
        ),
    )
    return TravelDirection(made, own)


def _table(own: Parts, current: Num, table: tuple[Lit, ...]) -> Iterator[Transition]:
    unknown, half, along, against = table
    heard: dict[Var, Expr | int | bool] = {own.last: own.latest, own.asked: own.expected}
    nothing: dict[Var, Expr | int | bool] = {**heard, own.awaited: NO_MODEL, own.along: False}
    fits_along = own.telling & own.latest.eq(own.before) & current.ne(along)
    fits_against = own.telling & own.latest.eq(own.after) & current.ne(against)
    yield Transition("turned", table, unknown, own.backwards, {**nothing, own.last: NO_MODEL}, TRACE, 0)
    begun = {**heard, own.awaited: own.after, own.along: True}
    yield Transition("fits along", table, half, fits_along, begun, TRACE, 1)
    begun = {**heard, own.awaited: own.before, own.along: False}
    yield Transition("fits against", table, half, fits_against, begun, TRACE, 1)
    yield Transition("fits neither", half, unknown, own.balise, nothing, TRACE, 2)
    yield Transition("confirmed along", half, along, own.confirmed & own.along, nothing, TRACE, 2)
    yield Transition("confirmed against", half, against, own.confirmed & ~own.along, nothing, TRACE, 2)
    yield Transition("refuted", half, unknown, own.refuted, nothing, TRACE, 2)
    for mode in table:
        yield Transition(f"stay {mode.label.lower()}", mode, mode, set=heard, requirements=TRACE, rank=3)


def _recognition_law(own: Parts, half: Bool) -> Bool:
    """At the decision one of the two models is right: the one passed before, or the one ahead."""
    ahead_right = own.ahead.eq(own.awaited).iff(own.along.iff(own.runs_along))
    return (half & (own.confirmed | own.refuted) & ~own.backwards).implies(own.half_right | ahead_right)


def _lemmas(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    _, half, along, against = table
    return {
        "a half that is right is right": (current.eq(half) & own.half_right).implies(own.along.iff(own.runs_along)),
        "a half awaits a model": current.eq(half).implies(own.awaited.ne(NO_MODEL)),
        "along is along": current.eq(along).implies(own.runs_along),
        "against is against": current.eq(against).implies(~own.runs_along),
    }
