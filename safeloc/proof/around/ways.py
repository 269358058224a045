"""Ways of asking about the streams of a tube: on board, without any law, or the streams that obey the laws."""

from __future__ import annotations

from dataclasses import dataclass, replace

from safeloc.language.expr import TRUE, all_of
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, first_without_the_world, without_ghosts


@dataclass(frozen=True, eq=False)
class Way:
    """One way of asking: the system that is run, without or with the world."""

    system: TransitionSystem
    words: str
    lawful: bool


def on_board(system: TransitionSystem) -> Way:
    """Return the way of the machine without its world."""
    return Way(without_ghosts(system), "for all inputs of the tube, without any law", lawful=False)


def lawful_way(system: TransitionSystem, prop: Property) -> Way:
    """Return the way of the streams that obey the laws, as a property assumes them."""
    words = "for all streams of the tube that obey the laws"
    if prop.unconditional:
        words, system = (
            "for all streams of the tube",
            replace(system, assume=TRUE, init=first_without_the_world(system)),
        )
    if prop.further_assumption is not TRUE:
        words += " and the further assumption"
        system = replace(system, assume=all_of([system.assume, prop.further_assumption]))
    return Way(system, words, lawful=True)


def plain(prop: Property) -> Property:
    """Return a property without its assumption, which the system that is run has."""
    return replace(prop, unconditional=False, further_assumption=TRUE)
