"""Reflectors that are anchored by groups of balises, in wires.

A telegram that the balise machine rejects is no reading of the reflector machine. That an accepted one holds the front end is not
assumed: the containment of the balise machine proves it.
"""

from __future__ import annotations

from safeloc.language.composition import Clause
from safeloc.language.expr import Bool, Expr, Num, Optional, Var, as_num, between, ite, maximum
from safeloc.language.system import canonical
from safeloc.language.units import MM
from safeloc.models import balise, reflector
from safeloc.models.reflector.world import PRESCRIBED, READING
from safeloc.models.reflector_anchor.line import Line
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.models.vocabulary.reasons import CONTRADICTION


def anchor_wires(groups: balise.Balise, map_: Line, source: reflector.ReflectorMachine) -> dict[Var, Expr]:
    """Return the wires of the line and of a reading, but for what contradicts the reflector machine's position."""
    return {
        **map_.telegram_wires(groups.own),
        map_.accepted: accepted(groups),
        **_reading(groups, source),
        **_distances(groups, map_, source),
    }


def anchored_clauses(source: reflector.ReflectorMachine) -> tuple[Clause, ...]:
    """Return the laws on readings of the reflector machine, which these wires discharge."""
    return Clause(source.machine, READING), Clause(source.machine, PRESCRIBED)


def accepted(groups: balise.Balise) -> Bool:
    """Return whether the balise machine accepted the group that was read."""
    return groups.machine.flag("reference_accepted")


def disproved(groups: balise.Balise) -> Bool:
    """Return whether the balise machine withholds its position because groups contradict it: what was anchored by it is withdrawn too."""
    return groups.machine.output("reason").eq(CONTRADICTION)


def _reading(groups: balise.Balise, source: reflector.ReflectorMachine) -> dict[Var, Expr]:
    """Return the wires of a reading: an accepted group, with the balise machine's own interval at the end of the cycle."""
    counts, given = accepted(groups), source.own.balise
    position, below, above = wired_interval(groups.machine)
    return {
        **present(given.identity, counts, groups.own.memory.group),
        **present(given.position, counts, position),
        **present(given.accuracy, counts, maximum(below, above)),
        given.since.present: counts,
        given.since.value: as_num(0, MM),
    }


def _distances(groups: balise.Balise, map_: Line, source: reflector.ReflectorMachine) -> dict[Var, Expr]:
    """Return the wires of the reflector's distance: counted from the position that is handed over, no longer from the group."""
    counts, machine, given, ahead = accepted(groups), groups.machine, source.own.balise, source.own.ahead
    position, _, _ = wired_interval(machine)
    by_telegram = machine.output("reflector_mm") - position
    search = machine.output("search_mm") - position
    by_map = groups.own.memory.last_group_position + map_.reference.value - position
    return {
        **_within(given.reference, counts & machine.flag("reflector_known"), by_telegram),
        **_within(given.search_from, counts & machine.flag("search_known") & (search > 0), search),
        **_within(ahead.reference, counts & map_.reference.present, by_map),
        ahead.position.value: map_.position.value,
        ahead.position.present: map_.position.present,
    }


def present(to: Optional, condition: Bool, value: Num) -> dict[Var, Expr]:
    """Return the wires of a value that is there under a condition only."""
    return {to.present: condition, to.value: ite(condition, value, canonical(to.value))}


def _within(to: Optional, condition: Bool, value: Num) -> dict[Var, Expr]:
    """Return the wires of a value that is there only if it is in the range of the input: no distance is clipped."""
    return present(to, condition & between(to.value.low, value, to.value.high), value)
