"""Variables of the direction machine."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.config import Config
from safeloc.language.expr import Bool, BoolVar, Num, NumVar, boolean, choice, enumeration, ite, members
from safeloc.models.vocabulary.reflectors import MODEL, NO_MODEL

DIRECTION = members("travel", "UNKNOWN", "ALONG", "AGAINST")
UNKNOWN, ALONG, AGAINST = DIRECTION


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
    last_read      ghost: the model read of the reflector passed last, since the vehicle turned
    due            ghost: the model of the reflector that truly comes next after the balise; NONE once one was seen
    first_right    ghost: of the reflector passed last before the balise the true model was read
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
    last_read: NumVar
    due: NumVar
    first_right: BoolVar

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
        last_read=choice("last_read_model", model),
        due=choice("true_next_model", model),
        first_right=boolean("first_model_right"),
    )
