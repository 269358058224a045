"""Figures with which a group that the balise machine accepts is a reading of the reflector machine."""

from __future__ import annotations

from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.reflector.variables import ReflectorConfig

LARGEST_ACCURACY_MM = 100_000
"""The reflector machine takes no reading that is less accurate."""


def check_anchor(groups: BaliseConfig, reflectors: ReflectorConfig) -> None:
    """Refuse figures with which a group that the balise machine accepts is no reading of the reflector machine.

    ValueError, with the figure to change.
    """
    if reflectors.last_balise_identity < groups.last_group_identity:
        raise ValueError(
            f"reflector.last_balise_identity {reflectors.last_balise_identity} is below balise.last_group_identity "
            f"{groups.last_group_identity}: an accepted group could not be handed over; raise it."
        )
    if groups.tolerance_mm > LARGEST_ACCURACY_MM:
        raise ValueError(
            f"balise.tolerance_mm {groups.tolerance_mm} is above {LARGEST_ACCURACY_MM}, the widest reading that the "
            "reflector machine takes; lower it."
        )
    if reflectors.reference_distance_mm:
        raise ValueError(
            "reflector.reference_distance_mm must be 0: it counts from the balise, and the balise machine hands over a "
            "position; let telegram or map give the distance."
        )
