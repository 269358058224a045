"""A localizer's position on the trackside: the same train on board and in virtual sections, in one step (FVA-9, RFL-14).

    motion ... delocalized, uplink   the localizer, on board, and its radio link (safeloc.models.localizer)
    ends         on board: where the far end of the train is, while the train is confirmed to be whole
    far_uplink   the same link for the far end: both ends are sent together and arrive together
    trackside    what a new report says of the train, from its rear to its front
    area         the line area that the train was counted into, and follows it by these reports
    section_n    virtual sections: FREE, OCCUPIED, AMBIGUOUS, UNKNOWN

The train is slot 1 of the area; reports of other trains are inputs. That what is told of this train is true is nowhere
assumed: each machine owes it to the next. What counters tell is assumed of the area's environment, as in `sections`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import CompositionConfig
from safeloc.language.composition import Clause, Composition
from safeloc.language.expr import Expr, Lit, Var, ite
from safeloc.language.machine import Machine
from safeloc.language.units import MS
from safeloc.models import area as area_model
from safeloc.models import transmission
from safeloc.models.area import Area, AreaConfig, moves_clause, refuse_inner_detection, reports_clause
from safeloc.models.localizer import Localizer, LocalizerConfig, More, Piece
from safeloc.models.localizer import compose_machines as compose_localizer
from safeloc.models.localizer_sections import train_ends, train_seen
from safeloc.models.localizer_sections.train_ends import TrainConfig, TrainEnds
from safeloc.models.localizer_sections.train_seen import TrainSeen
from safeloc.models.motion import Motion
from safeloc.models.sections import Section, Sections, SectionsConfig, section, section_wires
from safeloc.models.transmission import Transmission
from safeloc.models.vocabulary.absent import wired_interval

NAME = "localizer_sections"


class LocalizerSectionsConfig(CompositionConfig):
    """A vehicle, its train, and the line area that it runs through; all machines have one cycle."""

    localizer: LocalizerConfig = LocalizerConfig(sources=("balise", "fibre"))
    train: TrainConfig = TrainConfig()
    sections: SectionsConfig = SectionsConfig(area=AreaConfig(trains=1, period_ms=100, limit_mm=1_000_000_000))

    @model_validator(mode="after")
    def _one_line(self) -> LocalizerSectionsConfig:
        vehicle, area = self.localizer.motion, self.sections.area
        refuse_inner_detection(area)
        for figure in ("period_ms", "max_speed_mm_s"):
            if getattr(vehicle, figure) != getattr(area, figure):
                raise ValueError(
                    f"sections.area.{figure} is {getattr(area, figure)}, but the vehicle's is {getattr(vehicle, figure)} "
                    "(localizer.motion); make them the same."
                )
        if area.limit_mm < vehicle.position_limit_mm:
            raise ValueError(
                f"sections.area.limit_mm {area.limit_mm} is below localizer.motion.position_limit_mm "
                f"{vehicle.position_limit_mm}: the vehicle can be where the area has no places."
            )
        return self


@dataclass(frozen=True, eq=False)
class LocalizerSections:
    """The machines, and the composition of them; `localizer.composition` is that of the whole."""

    config: LocalizerSectionsConfig
    localizer: Localizer
    ends: TrainEnds
    far_uplink: Transmission
    trackside: TrainSeen
    area: Area
    sections: tuple[Section, ...]

    @property
    def composition(self) -> Composition:
        """All machines in one step."""
        return self.localizer.composition

    @property
    def area_and_sections(self) -> Sections:
        """The trackside part, for the properties that it has by itself."""
        return Sections(self.area, self.sections, self.composition)


def compose_machines(config: LocalizerSectionsConfig | None = None) -> LocalizerSections:
    """Compose the localizer with the area and its sections behind it."""
    config = config or LocalizerSectionsConfig()
    made: list[_Behind] = []

    def behind(moves: Motion, guard: Machine, uplink: Transmission, _: Mapping[str, Piece]) -> More:
        made.append(_Behind(config, moves, guard, uplink))
        return made[0].more()

    localizer = compose_localizer(config.localizer, name=NAME, behind=behind)
    [one] = made
    return LocalizerSections(config, localizer, one.ends, one.far_uplink, one.trackside, one.area, one.sections)


class _Behind:
    """The machines behind a localizer."""

    def __init__(self, config: LocalizerSectionsConfig, moves: Motion, guard: Machine, uplink: Transmission) -> None:
        self._config, self._moves, self._guard, self._uplink = config, moves, guard, uplink
        places = area_model.parts(config.sections.area)
        self.train = places.slots[0]
        self.ends = train_ends.build(train_ends.parts(config.train, self._world(), self.train))
        self.far_uplink = self._far_link()
        self.trackside = train_seen.build(self._seen())
        self.area = area_model.build(places)
        names = (f"section_{number}" for number in range(1, config.sections.sections + 1))
        self.sections = tuple(section(config.sections, name) for name in names)

    def more(self) -> More:
        """Return the machines and wires that the composition adds."""
        machines = (self.ends.machine, self.far_uplink.machine, self.trackside.machine, self.area.machine)
        return More(
            (*machines, *(one.machine for one in self.sections)),
            {**self._into_ends(), **self._into_far_uplink(), **self._into_trackside(), **self._into_area()},
            (self.ends.own.far_end, self.train.true_rear, self.train.true_front),
            (
                Clause(self.ends.machine, train_ends.SENT),
                self.far_uplink.machine,
                self.trackside.machine,
                Clause(self.area.machine, moves_clause(self.train)),
                Clause(self.area.machine, reports_clause(self.train)),
            ),
        )

    def _world(self) -> train_ends.FrontEnd:
        motion, tolerance = self._config.localizer.motion, self._config.localizer.tolerance_mm
        most = motion.max_speed_mm_s * motion.period_ms * 1_000
        return train_ends.FrontEnd(most, motion.position_limit_mm, tolerance, self._moves.own.ghosts.truth)

    def _far_link(self) -> Transmission:
        """The uplink's own figures; its margin wider by what is unknown of the length."""
        near, wider = self._config.localizer.uplink, self._config.train.length_tolerance_mm
        config = near.model_copy(update={"margin_limit_mm": near.margin_limit_mm + wider})
        return transmission.build(transmission.Parts(config, self.ends.own.far_end), "far_uplink")

    def _seen(self) -> train_seen.Parts:
        near, far, area = self._uplink.own.config, self.far_uplink.own.config, self._config.sections.area
        limit = near.position_limit_mm
        return train_seen.parts(
            area.limit_mm,
            near.period_ms,
            near.age_limit_ms,
            train_seen.end_inputs("front", limit, near.margin_limit_mm, self._moves.own.ghosts.truth),
            train_seen.end_inputs("far", limit, far.margin_limit_mm, self.ends.own.far_end),
        )

    # ---------------------------------------------------------------- wires

    def _into_ends(self) -> Mapping[Var, Expr]:
        own, guard = self.ends.own, self._guard
        return {
            own.valid: ~guard.flag("restrictive"),
            **_interval(own, guard),
            own.next_truth: self._moves.own.ghosts.truth,
        }

    def _into_far_uplink(self) -> Mapping[Var, Expr]:
        """Sent and arrived with the front end's report."""
        own, near, ends = self.far_uplink.own, self._uplink.own, self.ends.machine
        return {
            own.sent: near.sent,
            own.arrived: near.arrived,
            own.valid: ends.flag("valid"),
            **_interval(own, ends),
            own.next_truth: self.ends.own.far_end,
        }

    def _into_trackside(self) -> Mapping[Var, Expr]:
        own = self.trackside.own
        wires: dict[Var, Expr] = {
            own.age: self._uplink.machine.output("age_ms"),
            own.upwards: self.ends.own.upwards,
            own.front.next_truth: self._moves.own.ghosts.truth,
            own.far.next_truth: self.ends.own.far_end,
        }
        for reported, link in ((own.front, self._uplink.machine), (own.far, self.far_uplink.machine)):
            wires |= {reported.valid: link.flag("valid"), **_interval(reported, link)}
        return wires

    def _into_area(self) -> Mapping[Var, Expr]:
        """The links have widened the intervals by their age, so the area adds none."""
        train, seen = self.train, self.trackside.machine
        reported = seen.flag("reported")
        wires: dict[Var, Expr] = {
            train.rear.present: reported,
            train.front.present: reported,
            train.rear.value: ite(reported, seen.output("low_mm"), 0),
            train.front.value: ite(reported, seen.output("high_mm"), 0),
            train.age: Lit(0, MS),
            train.trusted: reported,
            train.integer: seen.flag("integer"),
            train.downwards: seen.flag("downwards"),
            train.next_rear: train.true_rear,
            train.next_front: train.true_front,
        }
        for one in self.sections:
            wires |= section_wires(self.area, one)
        return wires


def _interval(own: train_ends.Parts | transmission.Parts | train_seen.EndInputs, says: Machine) -> dict[Var, Expr]:
    """An interval that one machine hears of another."""
    return dict(zip((own.position, own.below, own.above), wired_interval(says), strict=True))
