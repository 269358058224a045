"""The line of an anchored reflector machine: the map's next reflector, and what telegram and map say of its distance from the group that is read.

The machine computes nothing. It has the map's inputs, and the law on them, which speaks of groups that the balise machine accepts: only
these anchor anything. Of the group it reads the place that the balise machine keeps: a claim of that machine shows that it keeps places as telegram and linking gave them.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Num,
    NumVar,
    Optional,
    Var,
    between,
    boolean,
    number,
    optional,
)
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.units import COUNT, MM
from safeloc.language.world import Law, World
from safeloc.models.balise.reading_world import read_rightly
from safeloc.models.balise.telegram import Reading, Telegram, telegram
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.balise.variables import Parts as BaliseParts
from safeloc.models.reflector.variables import ReflectorConfig

NAME = "line"
_SURVEY = "telegram and map have the reflector at one place"


@dataclass(frozen=True, eq=False)
class Switch:
    """The map's next facing switch.

    position   its place
    reflector  place of the reflector behind it that is watched
    """

    position: Optional
    reflector: Optional


@dataclass(frozen=True, eq=False)
class Line:
    """The machine and its inputs.

    position   the map's next reflector
    reference  its distance from its group by the map; present for the first reflector behind a group
    switch     for a vehicle that watches its course at switches
    read       the telegram as the antenna read it
    accepted   the balise machine accepted the group that was read: the map then gives the first reflector behind it
    kept       the group that set the balise machine's interval last, and its place on the map, mm
    """

    machine: Machine
    position: Optional
    reference: Optional
    switch: Switch | None
    read: Telegram
    accepted: BoolVar
    kept: tuple[NumVar, NumVar]

    def telegram_wires(self, sister: BaliseParts) -> dict[Var, Expr]:
        """Return the wires of the telegram and of the kept group to the balise machine."""
        wires: dict[Var, Expr] = {}
        for mine, theirs in zip(self.read.inputs, sister.read.inputs, strict=True):
            wires |= {mine.value: theirs.value, mine.present: theirs.present}
        return wires | dict(zip(self.kept, (sister.memory.group, sister.memory.last_group_position), strict=True))


def line(of_groups: BaliseConfig, of_reflectors: ReflectorConfig, *, with_switch: bool) -> Line:
    """Build the machine with fresh inputs; `with_switch`: also those of the next facing switch."""
    declared, table = Declared(), modes("KNOWN")
    limit, reach = of_reflectors.position_limit_mm, of_reflectors.range_limit_mm
    position = declared.sensor(optional("next_position_mm", MM, -limit, limit))
    reference = declared.sensor(optional("next_reference_mm", MM, 0, reach))
    switch = _switch(declared, limit) if with_switch else None
    read = telegram(
        declared,
        last_identity=of_groups.last_group_identity,
        position_limit_mm=of_groups.position_limit_mm,
        max_cycle_distance_mm=of_groups.limits.max_cycle_distance_mm,
        age_limit_ms=of_groups.telegram_age_limit_ms,
        reflector_reach_mm=of_groups.reflector_reach_mm,
    )
    accepted = declared.sensor(boolean("group_accepted"))
    kept = (
        declared.sensor(number("kept_group", COUNT, 0, of_groups.last_group_identity)),
        declared.sensor(number("kept_group_position_mm", MM, -limit, limit)),
    )
    made = declared.machine(
        name=NAME,
        modes=table,
        outputs={},
        transitions=[Transition("map looked up", table[0], table[0], TRUE, {}, ("RFL-9",), 0)],
        world=World(
            clauses={
                _SURVEY: _survey(of_reflectors, position, reference, accepted & _is_read(read, kept[0]), kept[1], read)
            }
        ),
        doc="The map's next reflector. Assumed: of a group that is accepted, telegram and map give one place of it.",
    )
    return Line(made, position, reference, switch, read, accepted, kept)


def _switch(declared: Declared, limit: int) -> Switch:
    return Switch(
        declared.sensor(optional("switch_position_mm", MM, -limit, limit)),
        declared.sensor(optional("switch_reflector_mm", MM, -limit, limit)),
    )


def _survey(
    config: ReflectorConfig, position: Optional, reference: Optional, counts: Bool, place: Num, read: Telegram
) -> Law:
    """Return the law for a cycle in which a group counts, whose place on the map is given."""
    most = config.map_accuracy_mm

    def agrees(distance: Optional) -> Bool:
        return distance.present.implies(between(-most, place + distance.value - position.value, most))

    return Law(
        (counts & position.present).implies(agrees(read.reflector) & agrees(reference)),
        "When a group is accepted, the distance from it to a reflector, by the telegram or by the map, is the distance to the map's next reflector in this cycle, "
        "within the survey's accuracy. The place of a group is that of linking, else of its telegram.",
        ("map_accuracy_mm",),
        "[D] one survey for telegram and map",
        "infrastructure",
        "audit of the line's map: distance from balise to reflector; commissioning of every balise. Of the integrator: in a cycle with a telegram the host looks up "
        "the first reflector behind that group",
    )


def _is_read(read: Reading, group: Num) -> Bool:
    """Return whether the group whose place is kept is the one that was read, whole and with right check bits."""
    return read_rightly(read) & read.group.value.eq(group)
