"""Reflectors behind a balise and the direction of travel as one device: a wrong direction ends the position (RFL-D5, source l. 285 to 295).

    motion, balise, line   as in `reflector_device`
    travel_direction       finds the direction from the models of the reflectors before and after an accepted group
    reflector              anchored by what the balise machine accepted; a contradicted direction withdraws its position
    delocalized            passes the position on, or makes the vehicle restrictive

All act in one step. The comparison of measurement and map is one of distance and of direction. Where the direction is another one than
route and movement authority give, it has failed, as where groups contradict: the reflector machine withdraws the position in that step.

A group counts for the direction only if the balise machine accepted it. Places grow in the direction of travel, so the vehicle turned where
it is measured behind the farthest place that it reached, or where no distance is measured: then the reflectors that it passed no longer count.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.composition import Composition, compose
from safeloc.language.expr import Bool, Expr, Var
from safeloc.language.machine import Machine
from safeloc.models import balise, delocalized, reflector, travel_direction
from safeloc.models.motion import Motion
from safeloc.models.reflector_device.anchored import anchored
from safeloc.models.reflector_device.line import Line
from safeloc.models.reflector_direction.configuration import ReflectorDirectionConfig
from safeloc.models.travel_direction import TravelDirection
from safeloc.models.vocabulary.measured import ADMITTED

__all__ = ["ReflectorDirection", "ReflectorDirectionConfig", "compose_machines"]
NAME = "reflector_direction"


@dataclass(frozen=True, eq=False)
class ReflectorDirection:
    """The composition and its machines."""

    config: ReflectorDirectionConfig
    composition: Composition
    motion: Motion
    groups: balise.Balise
    line: Line
    direction: TravelDirection
    source: reflector.ReflectorMachine
    restrictive: Machine


def compose_machines(config: ReflectorDirectionConfig | None = None) -> ReflectorDirection:
    """Compose the device of a vehicle; all machines share one truth."""
    config = config or ReflectorDirectionConfig()
    located = anchored(config)
    moves, source = located.motion, located.source
    direction = travel_direction.build(travel_direction.parts())
    behind = delocalized.parts(config.host)
    restrictive = delocalized.build(behind)
    wires: dict[Var, Expr] = {
        **located.wires,
        direction.own.balise_read: located.accepted,
        direction.own.backwards: _turned(located.groups),
        source.own.contradicted: located.contradicted | direction.machine.flag("contradicts"),
        **located.into_host(behind),
    }
    whole = compose(
        NAME,
        [*located.before_the_reflectors, direction.machine, source.machine, restrictive],
        wires,
        shared=moves.shared,
        discharge=[*located.discharged, restrictive],
    )
    return ReflectorDirection(config, whole, moves, located.groups, located.line, direction, source, restrictive)


def _turned(groups: balise.Balise) -> Bool:
    """Return whether the vehicle is measured behind the farthest place that it reached, or may have run unmeasured."""
    heading = groups.own.heading
    return heading.backwards | (heading.rolled > 0) | groups.machine.output("odometer").ne(ADMITTED)
