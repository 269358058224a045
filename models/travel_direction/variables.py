"""Variables of the direction machine."""

from __future__ import annotations

from safeloc.config import Config
from safeloc.language.declared import Declared
from safeloc.language.expr import Bool, Num, boolean, choice, enumeration, ite, members
from safeloc.language.machine import ANY
from safeloc.models.vocabulary.reflectors import MODEL, NO_MODEL

DIRECTION = members("travel", "UNKNOWN", "ALONG", "AGAINST")
UNKNOWN, ALONG, AGAINST = DIRECTION


class DirectionConfig(Config):
    """No figures: the map gives the models, and the route gives the expected direction."""


class Parts:
    """The variables of the machine.

    passed_model         model of a reflector that the vehicle passed in this cycle; NONE in most cycles
    ahead_model          model of the nearest reflector measured ahead with the minimum intensity; NONE if there is none
    before, after  the map's models on the two sides of the balise that was read
    backwards      the vehicle moved backwards or changed its driving end: reflectors passed before no longer count
    route_direction       the direction by route and movement authority
    last_passed_model           model of the last reflector that the vehicle passed; awaited_model: model that confirms the half decision
    along          the half decision: in counting direction
    asked_direction          the expected direction, as received last
    runs_along     ghost: the vehicle runs in counting direction
    last_read_model      ghost: model recognised of the last reflector that the vehicle passed since it turned
    true_next_model            ghost: true model of the next reflector after the balise; NONE once the radar has seen one
    first_model_right    ghost: the true model of the last reflector before the balise was recognised
    """

    def __init__(self) -> None:
        self.declared = declared = Declared()
        model, travel = enumeration(MODEL), enumeration(DIRECTION)
        self.passed_model = declared.sensor(choice("passed_model", model))
        self.ahead_model = declared.sensor(choice("ahead_model", model))
        self.balise_read = declared.sensor(boolean("balise_read"))
        self.before = declared.sensor(choice("model_before", model))
        self.after = declared.sensor(choice("model_after", model))
        self.backwards = declared.sensor(boolean("backwards"))
        self.route_direction = declared.sensor(choice("route_direction", travel))
        self.last_passed_model = declared.state(choice("last_passed_model", model), first=NO_MODEL)
        self.awaited_model = declared.state(choice("awaited_model", model), first=NO_MODEL)
        self.along = declared.state(boolean("half_along"), first=False)
        self.asked_direction = declared.state(choice("asked_direction", travel), first=UNKNOWN)
        self.runs_along = declared.ghost(boolean("runs_along"), first=ANY)
        self.last_read_model = declared.ghost(choice("last_read_model", model), first=NO_MODEL)
        self.true_next_model = declared.ghost(choice("true_next_model", model), first=NO_MODEL)
        self.first_model_right = declared.ghost(boolean("first_model_right"), first=False)
        self.next_runs_along = declared.choice(boolean("next_runs_along"))

    @property
    def latest(self) -> Num:
        """Model of the last reflector passed, this cycle included."""
        return ite(self.passed_model.eq(NO_MODEL), self.last_passed_model, self.passed_model)

    @property
    def telling(self) -> Bool:
        """The vehicle reads a balise whose two neighbours have different models."""
        known = self.before.ne(NO_MODEL) & self.after.ne(NO_MODEL)
        return self.balise_read & self.before.ne(self.after) & known

    @property
    def confirmed(self) -> Bool:
        """The reflector ahead has the awaited model."""
        return ~self.balise_read & self.ahead_model.eq(self.awaited_model)

    @property
    def refuted(self) -> Bool:
        """The reflector ahead has another model."""
        return ~self.balise_read & self.ahead_model.ne(NO_MODEL) & self.ahead_model.ne(self.awaited_model)


def parts(_: DirectionConfig | None = None) -> Parts:
    """Return fresh variables for one machine."""
    return Parts()
