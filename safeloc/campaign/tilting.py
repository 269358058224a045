"""Importance sampling: some vehicles of a situation draw from other distributions, towards what is rare, and each gets its weight.

A vehicle is tilted with the chance `tilted`, and then draws all tilted values from the other distributions q, else from the declared ones p.
It stands for   w = p / ((1 - tilted) p + tilted q)   vehicles drawn as declared, so the mean of w over those with an event is an unbiased
estimate of the event's probability, whatever q is. No weight exceeds 1 / (1 - tilted), which the intervals rest on.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from safeloc.campaign.distributions import Choice, Distribution, Fixed, Floats


class Tilting:
    """The draws of vehicles, of which some are tilted, and the weights that come of them."""

    def __init__(self, share: float | None, number: int, rng: np.random.Generator) -> None:
        self._share, self._number, self._rng = share or 0.0, number, rng
        self._tilted = rng.random(number) < share if share else np.zeros(number, dtype=np.bool_)
        self._ratio = np.ones(number)

    def draw(self, name: str, declared: Distribution, tilts: Mapping[str, Distribution]) -> Floats:
        """Return a value of each vehicle, from the declared distribution, or for the tilted ones from that which takes its place."""
        found = declared.draw(self._rng, self._number)
        if name not in tilts:
            return found
        other = tilts[name]
        assert not isinstance(declared, Fixed) and not isinstance(other, Fixed)
        found = np.where(self._tilted, other.draw(self._rng, self._number), found)
        self._ratio *= other.density(found) / declared.density(found)
        return found

    @property
    def weights(self) -> Floats:
        """The weight of each vehicle, by all that was drawn."""
        return 1 / ((1 - self._share) + self._share * self._ratio)


def refusal(declared: Distribution | None, other: Distribution) -> str:
    """Return why a distribution cannot take the place of the declared one; empty if it can."""
    if declared is None:
        return "nothing of this name is declared that it could take the place of."
    if isinstance(declared, Fixed) or isinstance(other, Fixed):
        return "a fixed value has no density; tilt a distribution by a distribution."
    if other.unit != declared.unit:
        return f"its unit is {declared.unit}, as declared, not {other.unit!r}."
    if isinstance(declared, Choice) or isinstance(other, Choice):
        if not (isinstance(declared, Choice) and isinstance(other, Choice)):
            return "values and ranges have no common density; tilt a choice by a choice, and a range by a range."
        strange = [value for value in other.values if not declared.density(np.array([value]))[0] > 0]
        return f"{strange[0]:g} is none of the declared values." if strange else ""
    if other.support[0] < declared.support[0] or other.support[1] > declared.support[1]:
        return f"{other.words} leaves what is declared, {declared.words}: such a vehicle would stand for none."
    return ""
